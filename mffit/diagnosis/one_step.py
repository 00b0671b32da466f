"""Which effect would explain what a fit leaves: the score test of every effect, beside all fitted numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.special import chdtrc, fdtrc, ndtri

from mffit.constants import PREDICTION_FALSE_ALARM
from mffit.diagnosis import constants
from mffit.diagnosis.needs import possible
from mffit.diagnosis.noise import Noise, Scatter
from mffit.diagnosis.priors import anchor, moving
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.remainder import Remainder, log_of
from mffit.effects import CATALOG, Effect, Free
from mffit.fit.fitted import Fitted
from mffit.least_squares import touches
from mffit.suspicion import HeldNumber
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class OneStep:
    """What one effect would explain, to first order."""

    effect: Effect
    log_chance: (
        float  #: natural logarithm of the probability that residuals without the effect explain as much
    )
    numbers: dict[
        str, tuple[float, float]
    ]  #: value and standard error by name, as the readings alone have them
    share: float  #: of the sum of squares of the residuals that the effect removes
    known: bool = False  #: whether the fit had its numbers with a prior, which they then contradict
    change: np.ndarray = field(default_factory=lambda: np.zeros(0), repr=False, compare=False)
    """(m,) of the residuals by these numbers, in units of their uncertainty"""


@dataclass(frozen=True, slots=True)
class BestEffect:
    """The effect that explains a remainder best, and how many were tried."""

    best: OneStep
    rivals: tuple[OneStep, ...]  #: that explain it as well
    tried: int

    @property
    def chance(self) -> float:
        """Probability that any of the effects explains as much in the residuals of a sound fit, at most 1."""
        return min(1.0, self.tried * math.exp(self.best.log_chance))

    @property
    def sigma(self) -> float:
        """The same in standard deviations of a normal distribution, two-sided; 0 if it is likely."""
        log = self.best.log_chance + math.log(self.tried)
        return _sigma(log)

    @property
    def significant(self) -> bool:
        """Whether chance does not explain it."""
        return self.chance < PREDICTION_FALSE_ALARM


def best_effect(left: Remainder, effects: Sequence[Effect] = CATALOG) -> BestEffect | None:
    """The effect that explains most beyond chance; None if the readings show no effect that the fit does not follow.

    Each effect's change of the readings is compared with the residuals, without what fitted numbers can follow. A rig error
    that is itself a number of the fit is compared with its declaration. Far above the noise, residuals of a sweep are not
    independent: the scatter between sweeps decides what is significant then, and the share that is explained what is best.
    """
    found = list(_steps(left, effects))
    if not found:
        return None
    best_of: dict[str, OneStep] = {}
    for step in sorted(found, key=lambda step: step.log_chance):
        best_of.setdefault(step.effect.id, step)
    tried = len(best_of)  # the starts of one effect are nearly the same direction
    if not left.at_noise:
        beyond_chance = math.log(PREDICTION_FALSE_ALARM / tried)
        best_of = {
            s.effect.id: s
            for s in sorted(best_of.values(), key=lambda s: (s.log_chance > beyond_chance, -s.share))
        }
    best, *others = best_of.values()
    near = [o for o in others if _as_good(o, best, left)]
    return BestEffect(best, tuple(near[: constants.MOST_RIVALS_NAMED]), tried)


def _as_good(other: OneStep, best: OneStep, left: Remainder) -> bool:
    """Whether another effect explains the same residuals as well as the best one."""
    a, b = other.change, best.change
    if float(a @ b) ** 2 < constants.SAME_RESIDUALS * float(a @ a) * float(b @ b):
        return False
    if left.at_noise:
        return other.log_chance < best.log_chance - math.log(constants.TIE_EXCLUDED_BY_CHANCE)
    return other.share > constants.AS_GOOD_SHARE * best.share


def _steps(left: Remainder, effects: Sequence[Effect]) -> Iterator[OneStep]:
    sweeps = len(left.points.sweep_names)
    chain = np.concatenate([left.points.sweep + k * sweeps for k in range(len(left.channels))])
    scatter = dict.fromkeys(left.channels, Scatter())
    noise = Noise(u=left.sigma, stated=left.sigma, chain=chain, origin=None, scatter=scatter)
    problem = DiagnosisProblem(left.points, left.simulation, noise)
    visible, _ = possible(effects, left.points, left.simulation)
    candidates = [e for e in visible if e.switches or any(f.name not in left.free for f in moving((e,)))]
    for effect, groups in problem.columns(left.simulation, candidates).items():
        frees = moving((effect,))
        kept = [k for k, free in enumerate(frees) if free.name not in left.free]
        for columns in groups:
            some = columns if effect.switches else columns[:, kept]
            step = _step(left, effect, [frees[k] for k in kept], left.whitened(some))
            if step is not None and all(_is_possible(step, free) for free in frees):
                yield step


def _is_possible(step: OneStep, free: Free) -> bool:
    """Whether the readings ask for a number that a rig or a tyre can have."""
    value, _ = step.numbers.get(free.name, (free.lower, 0.0))
    return free.lower <= value <= free.upper


def _step(left: Remainder, effect: Effect, frees: Sequence[Free], change: np.ndarray) -> OneStep | None:
    """The score test of changes (m, j), each of one usual size; None where fitted numbers imitate all of them."""
    visible = np.einsum("ij,ij->j", change, left.outside(change)) > constants.IMITATED_SHARE * np.maximum(
        np.einsum("ij,ij->j", change, change), 1e-12
    )
    if not visible.any() or (not left.at_noise and effect.differs_by_run):
        return None
    frees = [free for free, seen in zip(frees, visible, strict=True) if seen] if frees else []
    change = change[:, visible]
    own = left.outside(change)
    information = change.T @ own
    size = np.sqrt(np.diag(information))
    power, axes = np.linalg.eigh(information / np.outer(size, size))
    clear = power > constants.DISTINCT_DIRECTION
    inverse = (axes[:, clear] / power[clear]) @ axes[:, clear].T / np.outer(size, size)
    score = change.T @ left.residual
    amount, explained = inverse @ score, float(score @ inverse @ score)
    chance = log_of(chdtrc(int(clear.sum()), explained))
    if not left.at_noise:
        chance = max(chance, _between_sweeps(left, change, own @ amount, amount, inverse))
    numbers = {
        free.name: _estimate(left, free, by, u)
        for free, by, u in zip(frees, amount.tolist(), np.sqrt(np.diag(inverse)).tolist(), strict=True)
    }
    total = max(float(left.residual @ left.residual), 1e-12)
    known = bool(numbers) and all(name in left.expected for name in numbers)
    return OneStep(effect, chance, numbers, min(explained / total, 1.0), known, own @ amount)


def _estimate(left: Remainder, free: Free, by: float, u: float) -> tuple[float, float]:
    """Value and standard error of a number by the readings alone, from its step and that step's error in usual sizes."""
    unit = free.spread * anchor(free, left.simulation, left.points)[1]
    if free.name in left.expected:  # its prior is part of the step's error
        value, spread = left.expected[free.name]
        return value + by * unit, math.sqrt(max((u * unit) ** 2 - spread**2, 0.0))
    return left.simulation.number(free.name, left.points) + by * unit, u * unit


def _between_sweeps(
    left: Remainder, change: np.ndarray, explained: np.ndarray, amount: np.ndarray, inverse: np.ndarray
) -> float:
    """Logarithm of the probability by the scatter between sweeps (Hotelling): each sweep counts as one observation."""
    k = np.linalg.matrix_rank(inverse)
    parts = change * (left.residual - explained)[:, None]
    names, index = np.unique(left.sweep, return_inverse=True)
    by_sweep = np.zeros((len(names), change.shape[1]))
    np.add.at(by_sweep, index, parts)
    n = len(names)
    if n <= k + 1:
        return 0.0
    covariance = inverse @ (by_sweep.T @ by_sweep) @ inverse * n / (n - 1.0)
    distance = float(amount @ np.linalg.pinv(covariance) @ amount)
    return log_of(fdtrc(k, n - k, distance * (n - k) / (k * (n - 1.0))))


def _sigma(log_chance: float) -> float:
    """Standard deviations of a two-sided normal chance, also where the chance itself underflows."""
    if log_chance >= 0.0:
        return 0.0
    if log_chance > -600.0:
        return -float(ndtri(0.5 * math.exp(log_chance)))
    return math.sqrt(-2.0 * log_chance)


def held_numbers(left: Remainder, fitted: Fitted) -> tuple[HeldNumber, ...]:
    """The numbers that a bound, a physical limit or the engineer holds, and how far the readings contradict it."""
    hand = fitted.hand
    names = sorted({*fitted.at_bound, *(name for name in hand.held if BY_NAME[name].stage)})
    if not names:
        return ()
    bounds = {n.name: (n.lower, n.upper) for n in fitted.numbers}
    slopes = left.whitened(left.simulation.sensitivities(left.points, names, left.channels)[1].stacked)
    total = max(float(left.residual @ left.residual), 1e-12)
    out = []
    for name, change in zip(names, slopes.T, strict=True):
        own = left.outside(change[:, None])
        power = float(change @ own[:, 0])
        if power <= constants.IMITATED_SHARE * float(change @ change):
            continue
        step = float(change @ left.residual) / power
        value = left.simulation.number(name, left.points)
        lower, upper = bounds.get(name, (-math.inf, math.inf))
        if touches(value, lower, upper) and (step > 0.0) == (value - lower < upper - value):
            continue  # the readings pull it back inside
        explained = step**2 * power
        chance = log_of(chdtrc(1, explained))
        if not left.at_noise:
            at = np.array([step])
            chance = max(
                chance,
                _between_sweeps(left, change[:, None], step * own[:, 0], at, np.array([[1.0 / power]])),
            )
        by_hand = name in hand.held or name in hand.bounded
        out.append(HeldNumber(name, _sigma(chance), min(explained / total, 1.0), by_hand))
    return tuple(out)
