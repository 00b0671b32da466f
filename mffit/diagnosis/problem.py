"""The data, their noise and the given model; fits hypotheses and computes their evidence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag

from mffit.diagnosis import constants
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.inexact import EXACT, known_around, slopes_of, together
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.priors import anchor, beyond_declaration, moving, number, starts, switched, usual_start
from mffit.diagnosis.smooth import Smooth, SmoothStructure
from mffit.effects import Effect, Free
from mffit.fit.constants import REFIT_STEPS, STAGE_TOLERANCE
from mffit.least_squares import FreeNumber, LeastSquaresProblem, Linear, Solution, solve, touches
from mffit.left_out import moved_without
from mffit.linearised.gaussian import Informed
from mffit.numbers import Numbers
from mffit.points import Points
from mffit.rig import Simulation
from tir.parameters import BY_NAME as COEFFICIENTS

STEEPEST = 1e5
"""Upper limit of the norm of a scaled column in units of the noise, so that it does not swamp sums of squares."""


class DiagnosisProblem:
    """The comparison of readings with a simulation.

    ``declared`` has the value and standard uncertainty of each declared rig error. ``offset`` (c n,) is added to the readings if
    ``start`` is not at the mean of the coefficients' prior. ``beside`` (c n, k) is the basis of smooth structure that the
    evidence of every hypothesis allows for, ``allowed`` its amplitude by channel that is expected of the model, and ``excused``
    that which needs no cause if it is found.
    """

    def __init__(
        self,
        points: Points,
        start: Simulation,
        noise: Noise,
        declared: Mapping[str, tuple[float, float]] | None = None,
        offset: np.ndarray | None = None,
        beside: np.ndarray | None = None,
        allowed: Mapping[str, float] | None = None,
        excused: Mapping[str, float] | None = None,
    ) -> None:
        self.points, self.start, self.noise = points, start, noise
        basis = np.zeros((len(noise.u), 0)) if beside is None else beside
        self.structure = SmoothStructure(noise, basis, allowed or {}, excused or {})
        self.amplitude: Mapping[str, float] = {}  # of the structure in the covariance, by channel
        self.declared, self.offset = declared or {}, offset
        self.measured = noise.measured(points)
        if offset is not None:
            self.measured = self.measured + offset
        self._at_amplitudes: dict[frozenset[tuple[str, float]], DiagnosisProblem] = {}

    @cached_property
    def null(self) -> Hypothesis:
        """The hypothesis without effects."""
        return self._fitted((), {})

    @property
    def channels(self) -> tuple[str, ...]:
        """Names (c,) of the channels whose readings are compared."""
        return self.noise.channels

    def predict(self, state: Simulation) -> np.ndarray:
        """Readings (c n,) of a simulation at the points."""
        return state.predict(self.points, self.channels)

    def seen_through(self, noise: Noise) -> DiagnosisProblem:
        """The problem of the readings as they are, with another noise and without smooth structure."""
        return DiagnosisProblem(self.points, self.start, noise, self.declared)

    def at_amplitude(self, smooth: Smooth) -> DiagnosisProblem:
        """The problem with the amplitudes of smooth structure, as found with a hypothesis, in the covariance."""
        amplitude = smooth.amplitude if smooth.found else smooth.expected
        if amplitude == self.amplitude:
            return self
        kept = self._at_amplitudes  # few amplitudes are tried, each beside many hypotheses
        kept.setdefault(frozenset(self.amplitude.items()), self)
        key = frozenset(amplitude.items())
        if key not in kept:
            other = copy(self)
            other.amplitude, other.noise = amplitude, self.structure.noise(amplitude)
            vars(other).pop("null", None)  # that of the other amplitude
            kept[key] = other
        return kept[key]

    def with_structure_of(self, found: Hypothesis) -> tuple[DiagnosisProblem, Hypothesis]:
        """The problem with the smooth structure found with a hypothesis in the covariance, and the hypothesis refitted in it."""
        own = self.at_amplitude(found.smooth)
        return own, found if own is self else refitted(own, found, found.effects)

    def whitened(self, state: Simulation) -> np.ndarray:
        """Whitened residual (m,), measured minus simulated."""
        return self.noise.whiten(np.nan_to_num(self.measured - self.predict(state)))

    def fit(self, effects: Sequence[Effect], start: Mapping[str, float] | None = None) -> Hypothesis:
        """The best fit of all numbers of the effects; the last effect starts from every value of its scan."""
        trials = starts(effects[-1], start or {}, self.start, self.points)
        return max((self._fitted(effects, trial) for trial in trials), key=lambda found: found.log_evidence)

    def fit_together(self, effects: Sequence[Effect], at: Mapping[str, float] | None = None) -> Hypothesis:
        """The fit of all effects at once, each held to its usual size by its prior; ``at`` has starting values.

        Effects that end at a bound are left out: there, an infinite derivative can keep all other numbers from moving.
        """
        usual = {free.name: usual_start(free, self.start, self.points) for free in moving(effects)}
        found = self._fitted(tuple(effects), usual | dict(at or {}))
        at_bound = {f.name for f in moving(effects) if touches(found.numbers[f.name], f.lower, f.upper)}
        others = [effect for effect in effects if at_bound.isdisjoint(effect.parameters)]
        return found if len(others) == len(effects) else self.fit_together(others, at)

    def refine(
        self, chosen: Hypothesis, inexact: Numbers = EXACT
    ) -> tuple[Hypothesis, dict[str, tuple[float, float]]]:
        """The hypothesis estimated together with the model's coefficients, and these: name -> (value, standard error).

        If an effect changes a coefficient by more than usual, its prior is widened to the change found, so that the prior does
        not pull the estimate back.
        """
        numbers, prior = self._refined_numbers(chosen, inexact)
        now = np.array([self.start.number(name, self.points) for name in prior.names])
        begin = np.linalg.pinv(prior.root) @ (now - prior.expected)
        units = [FreeNumber(n, x, spread=1.0) for n, x in zip(prior.names, begin.tolist(), strict=True)]
        found, values, unit = self._solved(chosen.effects, [*numbers, *units], prior)
        errors = self._standard_errors(found, unit)
        refined = replace(
            chosen,
            numbers={name: value for name, value in values.items() if name not in prior.names},
            stderr={n.name: errors[n.name] for n in numbers},
            state=self.start.with_numbers(values),
        )
        return refined, {name: (values[name], errors[name]) for name in prior.names}

    def uncertain(self, refined: Hypothesis, inexact: Numbers) -> Numbers:
        """The numbers of a refined hypothesis that are off their bounds, then those of a prior, at their values there."""
        numbers, prior = self._refined_numbers(refined, inexact)
        inside = {n.name: n for n in numbers if not touches(n.start, n.lower, n.upper)}
        own = known_around(
            {name: n.expected for name, n in inside.items()}, [n.spread for n in inside.values()]
        )
        found = together(own, prior)
        return replace(found, values=np.array([refined.state.number(n, self.points) for n in found.names]))

    def _refined_numbers(self, chosen: Hypothesis, inexact: Numbers) -> tuple[list[FreeNumber], Numbers]:
        """The numbers of the effects with widened priors, and the prior of all other coefficients."""
        frees = moving(chosen.effects)
        usual = [number(free, chosen.numbers, self.start, self.points) for free in frees]
        numbers = [
            replace(n, spread=max(n.spread, abs(n.start - n.expected))) if n.name in COEFFICIENTS else n
            for n in usual
        ]
        return numbers, inexact.without({free.name for free in frees})

    def linear(self, refined: Hypothesis, known: Numbers) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives (c n, k) of the readings by known numbers, and the whitened residual (m,) at their prior means."""
        slopes = slopes_of(refined.state, self.points, known.names, self.channels)
        away = self.noise.whiten(slopes @ (known.values - known.expected))
        return slopes, self.whitened(refined.state) + away

    def without_groups(
        self, refined: Hypothesis, inexact: Numbers, group: np.ndarray
    ) -> tuple[Sequence[str], np.ndarray, list[np.ndarray]]:
        """Names (k,) of the numbers of a refined hypothesis, the derivatives (c n, k) of the readings by them, and their changes.

        By group of points, (n,) indices, the change (k,) if it is left out, to first order. Numbers at a bound are held.
        """
        known = self.uncertain(refined, inexact)
        away = known.values - known.expected
        slopes, residual = self.linear(refined, known)
        white = self.noise.whiten(slopes @ known.root)
        information, gradient = np.eye(len(away)) + white.T @ white, -white.T @ residual
        of_row = np.tile(group, len(self.channels))[self.noise.used]
        changes = [
            known.root @ moved_without(white[rows], -residual[rows], information, gradient) - away
            for rows in (np.flatnonzero(of_row == k) for k in range(int(group.max()) + 1))
        ]
        return known.names, slopes, changes

    def columns(
        self, state: Simulation, effects: Sequence[Effect], steps: int | None = None
    ) -> dict[Effect, list[np.ndarray]]:
        """By effect, changes of the readings (c n, k) at its usual size: by derivatives, and by finite steps to each start.

        ``steps`` is the largest number of these steps; None: all.
        """
        names = [free.name for free in moving(effects)]
        slopes = slopes_of(state, self.points, names, self.channels)
        here, out = np.nan_to_num(self.predict(state)), {}
        for effect in effects:
            frees = moving((effect,))
            own = slopes[:, [names.index(free.name) for free in frees]]
            if effect.switches:
                out[effect] = [self._moved(state, switched((effect,)), here)[:, None]]
                continue
            spreads = [free.spread * anchor(free, self.start, self.points)[1] for free in frees]
            out[effect] = [own * spreads]
            if len(frees) == 1:
                out[effect] += self._scanned(state, frees[0], spreads[0], here, steps)
        return out

    def _scanned(
        self, state: Simulation, free: Free, spread: float, here: np.ndarray, steps: int | None
    ) -> list[np.ndarray]:
        """Changes of the readings (c n, 1) by finite steps to the starts of a number, scaled to the usual size."""
        value, unit = state.number(free.name, self.points), anchor(free, self.start, self.points)[1]
        places = [float(np.clip(value + step * unit, free.lower, free.upper)) for step in free.scan if step]
        return [
            (self._moved(state, {free.name: place}, here) * (spread / (place - value)))[:, None]
            for place in [place for place in places if place != value][:steps]
        ]

    def _moved(self, state: Simulation, numbers: Mapping[str, float], here: np.ndarray) -> np.ndarray:
        """Change of the readings (c n,) by new values of some numbers."""
        return np.nan_to_num(self.predict(state.with_numbers(numbers))) - here

    def _fitted(self, effects: Sequence[Effect], start: Mapping[str, float]) -> Hypothesis:
        """The fit from one start, with its evidence (Laplace approximation)."""
        numbers = [number(free, start, self.start, self.points) for free in moving(effects)]
        found, values, unit = self._solved(effects, numbers)
        occam = 0.0
        if numbers:
            scaled = found.jacobian * np.array([n.spread for n in numbers])
            occam = 0.5 * Informed.of_rows(scaled, found.data).log_determinant
        known = sum(beyond_declaration(n, values[n.name], self.declared) for n in numbers)
        hypothesis = Hypothesis(
            effects=tuple(effects),
            numbers=values,
            stderr=self._standard_errors(found, unit),
            chi2=float(found.data @ found.data),
            log_evidence=-0.5 * found.cost - occam + known,
            state=self.start.with_numbers(values),
            residual=-found.data,
            jacobian=-found.jacobian,
        )
        return self._weighed(hypothesis, numbers)

    def _weighed(self, fitted: Hypothesis, numbers: Sequence[FreeNumber]) -> Hypothesis:
        """The hypothesis with evidence that allows for smooth structure, by the linear model at its numbers.

        The prior log odds against structure are ``STRUCTURE_EVIDENCE``.
        """
        if not self.structure.basis.shape[1]:
            return replace(fitted, alone=fitted.log_evidence)
        columns, residual = self._at_priors(fitted, numbers)
        model, now = self.structure.beside(columns, residual), self.amplitude
        found, alone = model.best(), fitted.log_evidence
        if now or found.expected:
            alone -= self.noise.half_log_determinant - self.structure.scatter.half_log_determinant
            alone -= model.evidence(now) + model.improbable(now) - model.evidence(found.expected)
        value = float(np.logaddexp(alone, alone + found.gain - constants.STRUCTURE_EVIDENCE))
        return replace(fitted, log_evidence=value, smooth=found, alone=alone)

    def _at_priors(self, fitted: Hypothesis, numbers: Sequence[FreeNumber]) -> tuple[np.ndarray, np.ndarray]:
        """Changes (m, k) by one prior standard deviation of every number, and the residual (m,) at the prior means.

        The whitening for changes that readings share is undone in both.
        """
        away = np.array([(fitted.numbers[n.name] - n.expected) / n.spread for n in numbers])
        columns = not_too_steep(fitted.jacobian * np.array([n.spread for n in numbers]))
        at_centre = fitted.residual - columns @ away
        found = self.noise.unshared(np.column_stack([at_centre, columns]))
        return found[:, 1:], found[:, 0]

    def _standard_errors(self, found: Solution, unit: np.ndarray) -> dict[str, float]:
        """By name, standard errors that include the effect of estimated outlier weights.

        ``unit`` (k, k) are the changes of the named numbers by those of the solution.
        """
        moves = found.covariance @ unit.T
        pull = self.noise.beyond_weights[:, None] * found.jacobian @ moves
        variance = np.sum(pull**2, axis=0) + found.prior @ moves**2
        return dict(zip(found.names, np.sqrt(variance).tolist(), strict=True))

    def _solved(
        self, effects: Sequence[Effect], numbers: Sequence[FreeNumber], prior: Numbers = EXACT
    ) -> tuple[Solution, dict[str, float], np.ndarray]:
        """The solution in the numbers (k,), the values by name, and the changes (k, k) of these by the numbers.

        The last ``numbers``, independent and with prior variance 1, move those of ``prior``.
        """
        fixed, names, nothing = switched(effects), [n.name for n in numbers], np.zeros(0)
        own = len(names) - len(prior.names)
        centre, unit = np.append(np.zeros(own), prior.expected), block_diag(np.eye(own), prior.root)

        def values(x: np.ndarray) -> dict[str, float]:
            return {**fixed, **dict(zip(names, (centre + unit @ x).tolist(), strict=True))}

        def residual(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return -self.whitened(self.start.with_numbers(values(x))), nothing

        def linear(x: np.ndarray) -> Linear:
            state = self.start.with_numbers(values(x))
            out, slope = state.sensitivities(self.points, names, self.channels)
            rows = np.column_stack([out.stacked - self.measured, slope.stacked])
            white = self.noise.whiten(np.nan_to_num(np.where(np.isfinite(self.measured)[:, None], rows, 0.0)))
            return Linear(white[:, 0], white[:, 1:] @ unit, nothing, np.zeros((0, len(names))))

        problem = LeastSquaresProblem(residual, linear)
        found = solve(problem, numbers, max_steps=REFIT_STEPS, tolerance=STAGE_TOLERANCE)
        return found, values(found.x), unit


def not_too_steep(columns: np.ndarray) -> np.ndarray:
    """Columns (m, k) with nearly infinite derivatives, such as that of a square root at zero, limited to ``STEEPEST``."""
    size = np.linalg.norm(columns, axis=0)
    return columns * np.where(size > STEEPEST, STEEPEST / np.maximum(size, STEEPEST), 1.0)


def refitted(problem: DiagnosisProblem, chosen: Hypothesis, effects: Sequence[Effect]) -> Hypothesis:
    """A hypothesis with only some of its effects, refitted from its own numbers."""
    return problem.fit(effects, chosen.numbers_of(effects)) if effects else problem.null
