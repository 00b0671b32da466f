"""Examination of a fit's residuals: model error, the effect that would explain them best, held numbers, left-out sweeps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc

from mffit.as_json import estimates, keys
from mffit.constants import (
    CANDIDATES_FITTED,
    MOST,
    NAMED_IN_SENTENCE,
    PREDICTION_FALSE_ALARM,
    WEAKEST_DIRECTION,
)
from mffit.diagnosis import constants
from mffit.diagnosis.needs import possible
from mffit.diagnosis.noise import Noise, Scatter
from mffit.diagnosis.priors import anchor, moving
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.effects import CATALOG, Effect, Free
from mffit.fit.fitted import Fitted
from mffit.fit.influences.joint import JointFit
from mffit.least_squares import FreeNumber, touches
from mffit.linearised import LinearisedFit
from mffit.linearised.constants import LEAST_KNOWN
from mffit.points import Points
from mffit.scatter import beyond, rms
from mffit.suspicion import HeldNumber, LeftOutSweeps
from tir.frozen import ReadOnlyArrays
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class OneStep(ReadOnlyArrays):
    """Score test of one effect, to first order, with all fitted numbers free."""

    effect: Effect
    log_chance: float
    """Natural logarithm of the p-value: the probability that the effect explains as much if it is absent."""
    numbers: dict[str, tuple[float, float]]
    """Value and standard error by name, from the readings alone."""
    share: float  #: share of the residual sum of squares that the effect removes
    known: bool = False  #: whether the fit has these numbers with a prior, which the readings then contradict
    change: np.ndarray = field(default_factory=lambda: np.zeros(0), repr=False, compare=False)
    """(m,) change of the residuals by these numbers, less the part that fitted numbers follow, in units of their weights"""


@dataclass(frozen=True, slots=True)
class BestEffect:
    """The effect that explains the residuals best, and the number of effects tried."""

    best: OneStep
    rivals: tuple[OneStep, ...]  #: effects that explain them equally well
    tried: int
    gain: float = -math.inf
    """Gain of log evidence if the best effect is added to a model with smooth model error and scatter of runs, less half the
    logarithm of the number of readings for every number after the first."""
    missed: float = 0.0  #: log evidence for the smooth model error that remains with the effect

    @property
    def chance(self) -> float:
        """Probability that any of the tried effects explains as much in the residuals of a sound fit, at most 1."""
        return min(1.0, self.tried * math.exp(self.best.log_chance))

    @property
    def sigma(self) -> float:
        """This probability as two-sided standard deviations of a normal distribution; 0 if it is 1."""
        return _sigma(self.best.log_chance + math.log(self.tried))

    @property
    def possible(self) -> bool:
        """Whether neither chance nor scatter of runs explains it; model error may."""
        return self.chance < PREDICTION_FALSE_ALARM and self.gain > math.log(
            self.tried / PREDICTION_FALSE_ALARM
        )

    @property
    def significant(self) -> bool:
        """Whether it explains more than the remaining model error does as well."""
        return self.possible and self.gain > self.missed

    @property
    def explains_most(self) -> bool:
        """Whether it is an effect of rig or environment that removes most of the misfit, beyond chance."""
        most = self.best.share > MOST
        return most and self.possible and self.best.effect.kind != "tyre"


keys(
    BestEffect,
    "id=best.effect.id name=best.effect.name kind=best.effect.kind parameters share=best.share was_expected=best.known sigma "
    "chance significant as_good tried",
    parameters=lambda found: estimates(found.best.numbers),
    as_good=lambda found: [other.effect.id for other in found.rivals],
)


@dataclass(frozen=True, slots=True)
class OddSweep:
    """The sweep that contradicts all others most, and its likely cause."""

    name: str
    looks: str  #: the known mistake or single number that explains it; empty if no known cause does


keys(OddSweep, "name looks_like=looks")


@dataclass(frozen=True, slots=True)
class Remains:
    """The residuals of a fit, examined."""

    linear: LinearisedFit | None = None
    effect: BestEffect | None = None  #: the best of all effects, significant or not; None if none is visible
    sweep: OddSweep | None = None  #: the sweep that contradicts the others most
    held: tuple[HeldNumber, ...] = ()  #: numbers at a bound or a physical limit, or held by hand
    left_out: Mapping[str, LeftOutSweeps] = field(default_factory=dict)
    """By channel, prediction errors of left-out sweeps."""


keys(
    Remains,
    "effect missed sweep held left_out",
    missed=lambda found: {
        name: {"rms": one.size, "log_evidence": one.proof, "over": one.missed_over}
        for name, one in (found.linear.channels if found.linear else {}).items()
    },
)


NOTHING_REMAINS = Remains()


def remains(fitted: Fitted, linear: LinearisedFit) -> Remains:
    """The examination of a fit's residuals at its solution, from their linear model."""
    left = Left.of(fitted, linear)
    return Remains(
        linear=linear, effect=best_effect(left), held=held_numbers(left), left_out=left_out_sweeps(linear)
    )


def left_out_sweeps(linear: LinearisedFit) -> dict[str, LeftOutSweeps]:
    """By channel with several sweeps, the prediction errors of each sweep from all others."""
    out = {}
    for name, channel in linear.channels.items():
        if len(channel.model.groups) < 2:
            continue
        found = channel.without_runs(channel.model.groups, missed=False)
        out[name] = LeftOutSweeps(
            sweeps=len(found),
            fitted=rms(channel.unit * channel.model.residual),
            predicted=rms(np.concatenate([one.error for one in found])),
            typical=float(np.median([rms(one.error) for one in found])),
        )
    return out


class Left(NamedTuple):
    """The residuals of a fit as one linear model of all channels, in units of their weights."""

    fitted: Fitted
    linear: LinearisedFit
    joint: JointFit
    points: Points  #: (n,) points in the linear model
    expected: Mapping[str, tuple[float, float]]
    """Prior mean and standard deviation of every uncertain number except the free coefficients."""

    @classmethod
    def of(cls, fitted: Fitted, linear: LinearisedFit) -> Left:
        problem, numbers = fitted.problem, fitted.inner
        held = [
            FreeNumber(name, value := problem.value(name), -math.inf, math.inf, expected=value, spread=u)
            for name, u in fitted.taken_as_exact.items()
        ]
        known = [*(n for n in numbers if n.name not in BY_NAME), *held]
        joint = JointFit.of(problem, [*numbers, *held], (), problem.points.sweep)
        return cls(
            fitted,
            linear,
            joint,
            problem.points.select(joint.looked_at),
            {n.name: (n.expected, n.spread) for n in known},
        )

    def test(self, change: np.ndarray) -> _Test | None:
        """The score test of changes (c n, j); None if fitted numbers imitate all of them."""
        rows = np.zeros((len(self.joint.model.residual), change.shape[1]))
        rows[: len(change)] = np.nan_to_num(change) / self.joint.sigma.ravel()[:, None]
        found = self.joint.further(rows)
        seen = np.diag(found.information) > LEAST_KNOWN * np.maximum(np.sum(rows**2, axis=0), 1e-12)
        if not seen.any():
            return None
        information, pull = found.information[np.ix_(seen, seen)], found.pull[seen]
        size = np.sqrt(np.diag(information))
        strength, axes = np.linalg.eigh(information / np.outer(size, size))
        clear = strength > WEAKEST_DIRECTION**2
        inverse = (axes[:, clear] / strength[clear]) @ axes[:, clear].T / np.outer(size, size)
        explained, amount = float(pull @ inverse @ pull), inverse @ pull
        return _Test(
            seen=seen,
            amount=amount,
            u=np.sqrt(np.diag(inverse)),
            log_chance=_log_chance(explained, int(clear.sum())),
            share=min(explained / max(self.joint.misfit, 1e-12), 1.0),
            change=found.outside[:, seen] @ amount,
        )

    def by_channel(self, change: np.ndarray) -> dict[str, np.ndarray]:
        """By channel, a change of the rows (m,) at the readings of the channel's linear model, in its unit."""
        sigma, out = self.joint.sigma, {}
        parts = dict(zip(self.joint.channels, change[: sigma.size].reshape(sigma.shape), strict=True))
        u_of = dict(zip(self.joint.channels, sigma, strict=True))
        for name, channel in self.linear.channels.items():  # only those that were measured
            near = np.searchsorted(self.joint.looked_at, channel.rows, side="right") - 1
            out[name] = (parts[name] * np.where(np.isfinite(u_of[name]), u_of[name], 0.0))[near]
        return out


class _Test(NamedTuple):
    """The score test of several changes."""

    seen: np.ndarray  #: mask (j,) of the changes that fitted numbers do not imitate
    amount: np.ndarray  #: estimated amounts of these changes
    u: np.ndarray  #: standard errors of the amounts
    log_chance: float  #: natural logarithm of the p-value
    share: float  #: share of the sum of squares that they explain
    change: np.ndarray  #: (m,) estimated change of the rows, less the part that fitted numbers follow


def best_effect(left: Left, effects: Sequence[Effect] = CATALOG) -> BestEffect | None:
    """The effect that gains most log evidence, of those with the smallest p-values; None if no effect is visible.

    Each effect's change of the readings, less the part that fitted numbers follow, is compared with the residuals. A rig error
    that is a number of the fit is compared with its declaration. Model error counts as noise.
    """
    best_of: dict[str, OneStep] = {}
    for step in sorted(_steps(left, effects), key=lambda step: step.log_chance):
        best_of.setdefault(step.effect.id, step)
    if not best_of:
        return None
    # All starts of one effect change the readings in nearly the same direction, so each effect counts as one trial.
    likely = list(best_of.values())[:CANDIDATES_FITTED]
    found = [_weighed(left, step, len(best_of)) for step in likely]
    best = max(found, key=lambda one: (one.gain, -one.best.log_chance))
    near = [step for step in best_of.values() if step is not best.best and _as_good(step, best.best)]
    return replace(best, rivals=tuple(near[: NAMED_IN_SENTENCE - 1]))


def _weighed(left: Left, step: OneStep, tried: int) -> BestEffect:
    """An effect with its evidence in addition to model error and scatter of runs, if chance does not explain it."""
    found = BestEffect(step, (), tried)
    if found.chance >= PREDICTION_FALSE_ALARM:
        return found
    acts = {name: part for name, part in left.by_channel(step.change).items() if np.any(part)}
    gains, missed = zip(*(left.linear.channels[name].gain(part) for name, part in acts.items()), strict=True)
    freedom = 0.5 * max(len(step.numbers) - 1, 0) * math.log(max(len(step.change), 1))
    return replace(found, gain=sum(gains) - freedom, missed=sum(max(one, 0.0) for one in missed))


def _as_good(other: OneStep, best: OneStep) -> bool:
    """Whether another effect explains the same residuals about as well as the best one."""
    a, b = other.change, best.change
    if float(a @ b) ** 2 < MOST * float(a @ a) * float(b @ b):
        return False
    return other.log_chance < best.log_chance - math.log(constants.TIE_EXCLUDED_BY_CHANCE)


def _steps(left: Left, effects: Sequence[Effect]) -> Iterator[OneStep]:
    simulation, u = left.fitted.simulation, left.joint.sigma.ravel()
    scatter = dict.fromkeys(left.joint.channels, Scatter())
    noise = Noise(u=u, stated=u, chain=np.zeros(len(u)), origin=None, scatter=scatter)
    problem = DiagnosisProblem(left.points, simulation, noise)
    freed = {n.name for n in left.fitted.numbers if n.name in BY_NAME}
    visible, _ = possible(effects, left.points, simulation)
    candidates = [e for e in visible if e.switches or any(f.name not in freed for f in moving((e,)))]
    for effect, groups in problem.columns(simulation, candidates).items():
        frees = moving((effect,))
        kept = [k for k, free in enumerate(frees) if free.name not in freed]
        for columns in groups:
            found = left.test(columns if effect.switches else columns[:, kept])
            if found is None:
                continue
            step = _step(left, effect, [frees[k] for k in kept], found)
            if all(_is_possible(step, free) for free in frees):
                yield step


def _is_possible(step: OneStep, free: Free) -> bool:
    """Whether the estimated number is within the bounds of a real rig or tyre."""
    value, _ = step.numbers.get(free.name, (free.lower, 0.0))
    return free.lower <= value <= free.upper


def _step(left: Left, effect: Effect, frees: Sequence[Free], found: _Test) -> OneStep:
    seen = [free for free, visible in zip(frees, found.seen, strict=False) if visible]
    numbers = {
        free.name: _estimate(left, free, by, u)
        for free, by, u in zip(seen, found.amount.tolist(), found.u.tolist(), strict=False)
    }
    known = bool(numbers) and all(name in left.expected for name in numbers)
    return OneStep(effect, found.log_chance, numbers, found.share, known, found.change)


def _estimate(left: Left, free: Free, by: float, u: float) -> tuple[float, float]:
    """Value and standard error of a number from the readings alone; its step ``by`` and error ``u`` are in usual sizes."""
    simulation = left.fitted.simulation
    unit = free.spread * anchor(free, simulation, left.points)[1]
    if free.name in left.expected:  # the error of the step contains the prior
        value, spread = left.expected[free.name]
        return value + by * unit, math.sqrt(max((u * unit) ** 2 - spread**2, 0.0))
    return simulation.number(free.name, left.points) + by * unit, u * unit


def _log_chance(square: float, n: int) -> float:
    """Natural logarithm of the probability of a larger chi-square of ``n`` numbers, also where that underflows."""
    chance, half = float(chdtrc(n, square)), 0.5 * square
    if chance > 0.0:
        return math.log(chance)
    # the leading term, exact to n / square
    return (0.5 * n - 1.0) * math.log(half) - half - math.lgamma(0.5 * n)


def _sigma(log_chance: float) -> float:
    """Standard deviations of a two-sided normal p-value, even if the p-value itself underflows."""
    if log_chance >= 0.0:
        return 0.0
    if log_chance > -600.0:
        return beyond(math.exp(log_chance))
    return math.sqrt(-2.0 * log_chance)


def held_numbers(left: Left) -> tuple[HeldNumber, ...]:
    """The numbers held by a bound, a physical limit or by hand, with the significance of the readings' contradiction."""
    fitted, hand = left.fitted, left.fitted.hand
    names = sorted({*fitted.at_bound, *(name for name in hand.held if BY_NAME[name].stage)})
    if not names:
        return ()
    bounds = {n.name: (n.lower, n.upper) for n in fitted.numbers}
    slopes = fitted.simulation.sensitivities(left.points, names, left.joint.channels)[1].stacked
    out = []
    for name, change in zip(names, slopes.T, strict=True):
        found = left.test(change[:, None])
        if found is None:
            continue
        value = fitted.simulation.number(name, left.points)
        lower, upper = bounds.get(name, (-math.inf, math.inf))
        if touches(value, lower, upper) and (found.amount[0] > 0.0) == (value - lower < upper - value):
            continue  # the readings pull it away from the bound
        by_hand = name in hand.held or name in hand.bounded
        out.append(HeldNumber(name, _sigma(found.log_chance), found.share, by_hand, name in fitted.at_limit))
    return tuple(out)
