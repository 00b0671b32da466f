"""Fit one hypothesis, a set of effects, to the residuals and weigh its evidence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.diagnosis.noise import Noise
from mffit.diagnosis.state import State
from mffit.effects import Effect, Free
from mffit.points import Points

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
    state: State
    residual: np.ndarray  #: whitened, (m,)
    jacobian: np.ndarray  #: whitened, per freed number (m, k)


class Problem:
    """The data, their noise and the model to start from; evaluates hypotheses."""

    def __init__(self, points: Points, start: State, noise: Noise) -> None:
        self.points, self.start, self.noise = points, start, noise
        self.measured = np.concatenate([points.Fy, points.Mz])
        self.null = self.evaluate((), {})

    def whitened(self, state: State) -> np.ndarray:
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
        """Gauss-Newton with step halving on chi2 plus the spreads' prior."""
        anchors = [self._anchor(free) for free in moving]
        centre = np.array([current for current, _ in anchors])
        spread = np.array([free.spread * unit for free, (_, unit) in zip(moving, anchors, strict=True)])
        lower = np.array([free.lower for free in moving])
        upper = np.array([free.upper for free in moving])
        names = [free.name for free in moving]
        x = np.array([start.get(name, c) for name, c in zip(names, centre, strict=True)])

        def residual(x: np.ndarray) -> np.ndarray:
            return self.whitened(
                self.start.with_numbers({**fixed, **dict(zip(names, x.tolist(), strict=True))})
            )

        def cost(r: np.ndarray, x: np.ndarray) -> float:
            return float(r @ r + np.sum(((x - centre) / spread) ** 2))

        r = residual(x)
        value = cost(r, x)
        J = np.empty((len(r), 0))
        for _ in range(STEPS if names else 0):
            J = self._jacobian(residual, r, x, spread, lower, upper)
            H = J.T @ J + np.diag(spread**-2.0)
            step = -np.linalg.solve(H, J.T @ r + (x - centre) / spread**2)
            for shrink in (1.0, 0.4, 0.1, 0.02):
                trial = np.clip(x + shrink * step, lower, upper)
                r_trial = residual(trial)
                if (new := cost(r_trial, trial)) < value:
                    break
            else:
                break
            gained = value - new
            x, r, value = trial, r_trial, new
            if gained < CONVERGED * max(1.0, 1e-3 * value):
                break
        numbers = {**fixed, **dict(zip(names, x.tolist(), strict=True))}
        stderr, occam = {}, 0.0
        if names:
            J = self._jacobian(residual, r, x, spread, lower, upper)
            scaled = J * spread
            H = scaled.T @ scaled + np.eye(len(names))
            occam = 0.5 * float(np.linalg.slogdet(H)[1])
            stderr = dict(zip(names, (spread * np.sqrt(np.diag(np.linalg.inv(H)))).tolist(), strict=True))
        state = self.start.with_numbers(numbers)
        return Hypothesis(effects, numbers, stderr, float(r @ r), -0.5 * value - occam, state, r, J)

    def _jacobian(self, residual, r, x, spread, lower, upper) -> np.ndarray:
        J = np.empty((len(r), len(x)))
        for k in range(len(x)):
            step = 1e-3 * spread[k]
            if x[k] + step > upper[k]:
                step = -step
            shifted = x.copy()
            shifted[k] += step
            J[:, k] = (residual(shifted) - r) / step
        return J
