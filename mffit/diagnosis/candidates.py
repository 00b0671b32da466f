"""Fit one hypothesis, a set of effects, to the residuals and weigh its evidence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.diagnosis.noise import Noise
from mffit.effects import Effect, Free
from mffit.least_squares import Linear, Number, solve
from mffit.least_squares import Problem as LeastSquares
from mffit.points import Points
from mffit.rig import Simulation

STEPS = 12
CONVERGED = 1e-3  # of chi2


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
    """The data, their noise and the model to start from; evaluates hypotheses."""

    def __init__(self, points: Points, start: Simulation, noise: Noise) -> None:
        self.points, self.start, self.noise = points, start, noise
        self.measured = np.concatenate([points.Fy, points.Mz])
        self.null = self.evaluate((), {})

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

    def _descend(
        self, effects, moving: list[Free], fixed: Mapping[str, float], start: Mapping[str, float]
    ) -> Hypothesis:
        """Fit the numbers from one start and weigh the evidence of the answer."""
        numbers = []
        for free in moving:
            current, unit = self._anchor(free)
            at = start.get(free.name, current)
            numbers.append(Number(free.name, at, free.lower, free.upper, current, free.spread * unit))
        found = solve(
            self._free([n.name for n in numbers], fixed), numbers, max_steps=STEPS, tolerance=CONVERGED
        )
        spread = np.array([n.spread for n in numbers])
        scaled = found.jacobian * spread
        occam = (
            0.5 * float(np.linalg.slogdet(scaled.T @ scaled + np.eye(len(numbers)))[1]) if numbers else 0.0
        )
        stderr = dict(zip(found.names, np.sqrt(np.diag(found.covariance)).tolist(), strict=True))
        values = {**fixed, **found.values}
        chi2 = float(found.data @ found.data)
        state = self.start.with_numbers(values)
        return Hypothesis(
            effects, values, stderr, chi2, -0.5 * found.cost - occam, state, -found.data, -found.jacobian
        )

    def _free(self, names: Sequence[str], fixed: Mapping[str, float]) -> LeastSquares:
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

        return LeastSquares(residual, linear)
