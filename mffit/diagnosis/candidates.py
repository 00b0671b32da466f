"""Fit one hypothesis, a set of effects, to the residuals and weigh its evidence."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mffit.diagnosis.inexact import EXACT, Inexactness
from mffit.diagnosis.noise import Noise
from mffit.effects import Effect, Free
from mffit.least_squares import LeastSquaresProblem, Linear, Number, solve
from mffit.points import Points
from mffit.rig import Simulation

STEPS = 12
CONVERGED = 1e-3  # of chi2
PROMISING = 12
"""Most candidates that are fitted in full in each step; the others are far behind already to first order."""
BEYOND_DECLARED = 0.05
"""Share of rigs that are worse than their owner declares."""


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """A set of effects, refitted together."""

    effects: tuple[Effect, ...]
    numbers: Mapping[str, float]  #: fitted value of every freed number
    stderr: Mapping[str, float]
    chi2: float
    log_evidence: (
        float  #: relative to the same data without any effect only through chi2; comparable across hypotheses
    )
    state: Simulation
    residual: np.ndarray  #: whitened, (m,)
    jacobian: np.ndarray  #: whitened, per freed number (m, k)


class Problem:
    """The data, their noise and the model to start from; evaluates hypotheses.

    Parameters
    ----------
    points, start, noise : what was measured, the model, and how uncertain both are
    declared : what the rig's owner says of its errors: name -> (value, standard uncertainty)
    offset : (2n,) added to the readings, where ``start`` is not at the centre of the coefficients' prior
    """

    def __init__(
        self,
        points: Points,
        start: Simulation,
        noise: Noise,
        declared: Mapping[str, tuple[float, float]] | None = None,
        offset: np.ndarray | None = None,
    ) -> None:
        self.points, self.start, self.noise = points, start, noise
        self.declared, self.offset = declared or {}, offset
        self.measured = np.concatenate([points.Fy, points.Mz])
        if offset is not None:
            self.measured = self.measured + offset
        self.null = self.evaluate((), {})

    def part(self, keep: np.ndarray) -> Problem:
        """The same with some of the points (mask (n,))."""
        offset = None if self.offset is None else self.offset[np.concatenate([keep, keep])]
        return Problem(self.points.select(keep), self.start, self.noise.subset(keep), self.declared, offset)

    def seen_through(self, noise: Noise) -> Problem:
        """The same with another noise."""
        return Problem(self.points, self.start, noise, self.declared, self.offset)

    def whitened(self, state: Simulation) -> np.ndarray:
        """Measured minus simulated in units of the joint uncertainty (m,)."""
        return self.noise.whiten(np.nan_to_num(self.measured - state.predict(self.points)))

    def evaluate(self, effects: Sequence[Effect], numbers: Mapping[str, float]) -> Hypothesis:
        """A hypothesis at given numbers, not fitted."""
        state = self.start.with_numbers(numbers)
        residual = self.whitened(state)
        chi2 = float(residual @ residual)
        return Hypothesis(
            tuple(effects),
            dict(numbers),
            {},
            chi2,
            -0.5 * chi2,
            state,
            residual,
            np.empty((len(residual), 0)),
        )

    def fit(self, effects: Sequence[Effect], start: Mapping[str, float] | None = None) -> Hypothesis:
        """Fit all numbers of the effects, the last effect from every start of its scan; return the best."""
        start = dict(start or {})
        frees = [free for effect in effects for free in effect.free]
        switches = [free for free in frees if free.name == "turn_slip"]
        moving = [free for free in frees if free.name != "turn_slip"]
        fixed = {free.name: 1.0 for free in switches}
        best: Hypothesis | None = None
        for trial in self._starts(effects[-1], start):
            found = self._descend(tuple(effects), moving, fixed, trial)
            if best is None or found.log_evidence > best.log_evidence:
                best = found
        assert best is not None
        return best

    def refine(
        self, chosen: Hypothesis, inexact: Inexactness = EXACT
    ) -> tuple[Hypothesis, dict[str, tuple[float, float]]]:
        """The hypothesis with the model's coefficients estimated beside its numbers, and these: name -> (value, error)."""
        frees = [free for e in chosen.effects for free in e.free if free.name != "turn_slip"]
        fixed = {name: value for name, value in chosen.numbers.items() if name == "turn_slip"}
        prior = inexact.without(frozenset(free.name for free in frees))
        if not prior:
            return chosen, {}
        numbers = [self._number(free, chosen.numbers) for free in frees]
        numbers += [Number(name, float(self.start.values[name])) for name in prior.names]
        names, k = [n.name for n in numbers], len(frees)
        precision = np.linalg.pinv(prior.root)
        plain = Problem(self.points, self.start, self.noise, self.declared).within(names, fixed)

        def residual(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            data, limits = plain.residual(x)
            return np.concatenate([data, precision @ (x[k:] - prior.expected)]), limits

        def linear(x: np.ndarray) -> Linear:
            here = plain.linear(x)
            rows = np.hstack([np.zeros((len(precision), k)), precision])
            return Linear(
                np.concatenate([here.data, precision @ (x[k:] - prior.expected)]),
                np.vstack([here.slope, rows]),
                here.limits,
                here.limits_slope,
            )

        found = solve(LeastSquaresProblem(residual, linear), numbers, max_steps=STEPS, tolerance=CONVERGED)
        values = {**fixed, **found.values}
        errors = dict(zip(found.names, np.sqrt(np.diag(found.covariance)).tolist(), strict=True))
        own = {n: values[n] for n in (*fixed, *(free.name for free in frees))}
        refined = replace(
            chosen,
            numbers=own,
            stderr={n: errors[n] for n in own if n in errors},
            state=self.start.with_numbers(values),
        )
        return refined, {n: (values[n], errors[n]) for n in prior.names}

    def promising(self, before: Hypothesis, candidates: Sequence[Effect]) -> list[tuple[Effect, float]]:
        """Candidates with the gain in log evidence that they promise to first order, best first."""
        projected = before.residual
        Q = np.linalg.qr(before.jacobian)[0] if before.jacobian.shape[1] else np.empty((len(projected), 0))
        projected = projected - Q @ (Q.T @ projected)
        out = []
        for effect, groups in self.columns(before.state, candidates).items():
            gains = [0.0]
            for columns in groups:
                white = self.noise.whiten(columns)
                white = white - Q @ (Q.T @ white)
                power = white.T @ white + np.eye(white.shape[1])
                score = white.T @ projected
                gains.append(0.5 * float(score @ np.linalg.solve(power, score) - np.linalg.slogdet(power)[1]))
            out.append((effect, max(gains)))
        return sorted(out, key=lambda row: -row[1])

    def columns(self, state: Simulation, effects: Sequence[Effect]) -> dict[Effect, list[np.ndarray]]:
        """Changes of the readings (2n, k) by each effect at its usual size: to first order, and from each start."""
        names = [f.name for e in effects for f in e.free if f.name != "turn_slip"]
        _, slope = state.sensitivities(self.points, names) if names else (None, None)
        rows = np.nan_to_num(np.concatenate(slope)) if slope is not None else None
        here, column, out = np.nan_to_num(state.predict(self.points)), 0, {}
        for effect in effects:
            groups = []
            if any(f.name == "turn_slip" for f in effect.free):
                on = np.nan_to_num(state.with_numbers({"turn_slip": 1.0}).predict(self.points))
                groups.append((on - here)[:, None])
            else:
                assert rows is not None
                spreads = [f.spread * self._anchor(f)[1] for f in effect.free]
                groups.append(rows[:, column : column + len(spreads)] * spreads)
                column += len(spreads)
                for free, spread in zip(effect.free, spreads, strict=True):
                    for change in (c for c in free.scan if c and len(effect.free) == 1):
                        value, unit = state.number(free.name, self.points), self._anchor(free)[1]
                        to = float(np.clip(value + change * unit, free.lower, free.upper))
                        if to != value:
                            moved = np.nan_to_num(state.with_numbers({free.name: to}).predict(self.points))
                            groups.append(((moved - here) * (spread / (to - value)))[:, None])
            out[effect] = groups
        return out

    def _starts(self, effect: Effect, start: dict[str, float]) -> list[dict[str, float]]:
        scans = [free.scan for free in effect.free]
        trials = []
        for k in range(max(len(scan) for scan in scans)):
            trial = dict(start)
            for free in effect.free:
                if free.name == "turn_slip" or free.name in start:
                    continue
                current, unit = self._anchor(free)
                change = free.scan[min(k, len(free.scan) - 1)]
                trial[free.name] = float(np.clip(current + change * unit, free.lower, free.upper))
            trials.append(trial)
        return trials

    def _anchor(self, free: Free) -> tuple[float, float]:
        """Current value, and the unit of spread and scan."""
        current = self.start.number(free.name, self.points)
        if not free.relative:
            return current, 1.0
        # A coefficient that the model has at zero gives no scale; the width of its plausible values does.
        return current, abs(current) if current else 0.2 * (free.upper - free.lower)

    def _number(self, free: Free, start: Mapping[str, float]) -> Number:
        current, unit = self._anchor(free)
        at = start.get(free.name, current)
        return Number(free.name, at, free.lower, free.upper, current, free.spread * unit)

    def _descend(
        self, effects, moving: list[Free], fixed: Mapping[str, float], start: Mapping[str, float]
    ) -> Hypothesis:
        """Fit the numbers from one start and weigh the evidence of the answer."""
        numbers = [self._number(free, start) for free in moving]
        found = solve(
            self.within([n.name for n in numbers], fixed), numbers, max_steps=STEPS, tolerance=CONVERGED
        )
        spread = np.array([n.spread for n in numbers])
        scaled = found.jacobian * spread
        occam = (
            0.5 * float(np.linalg.slogdet(scaled.T @ scaled + np.eye(len(numbers)))[1]) if numbers else 0.0
        )
        stderr = dict(zip(found.names, np.sqrt(np.diag(found.covariance)).tolist(), strict=True))
        values = {**fixed, **found.values}
        chi2 = float(found.data @ found.data)
        known = sum(self._beyond(n, values[n.name]) for n in numbers)
        state = self.start.with_numbers(values)
        return Hypothesis(
            effects, values, stderr, chi2, -0.5 * found.cost - occam + known, state, -found.data, -found.jacobian
        )  # fmt: skip

    def _beyond(self, number: Number, value: float) -> float:
        """Log prior of a rig error against what is declared of it; never a gain, as the spread is already paid for."""
        if number.name not in self.declared:
            return 0.0
        expected, u = self.declared[number.name]
        near = -0.5 * ((value - expected) / u) ** 2 + 0.5 * ((value - number.expected) / number.spread) ** 2
        within = (1.0 - BEYOND_DECLARED) * math.exp(
            min(near + math.log(number.spread / u) if u < number.spread else near, 30.0)
        )
        return min(math.log(within + BEYOND_DECLARED), 0.0)

    def within(self, names: Sequence[str], fixed: Mapping[str, float]) -> LeastSquaresProblem:
        """Simulated minus measured in units of the joint uncertainty, as functions of the named numbers."""
        nothing = np.zeros(0)

        def at(x: np.ndarray) -> Simulation:
            return self.start.with_numbers({**fixed, **dict(zip(names, x.tolist(), strict=True))})

        def residual(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return -self.whitened(at(x)), nothing

        def linear(x: np.ndarray) -> Linear:
            out, slope = at(x).sensitivities(self.points, names)
            data = self.noise.whiten(np.nan_to_num(np.concatenate(out) - self.measured))
            rows = np.where(np.isfinite(self.measured)[:, None], np.concatenate(slope), 0.0)
            return Linear(data, self.noise.whiten(rows), nothing, np.zeros((0, len(names))))

        return LeastSquaresProblem(residual, linear)
