"""What is fitted apart from the forces: relaxation length and loaded radius, and what further runs would add."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from mffit.config import Config
from mffit.fit import FitResult
from mffit.fit.constants import USUAL_MISFIT_OF_RADIUS
from mffit.fit.wheel.vertical import RollingParts, radius
from mffit.planning import constants
from mffit.planning.runs import PlannedRun
from mffit.scatter import rms
from tir.derivatives import gradient, traced

LOADED = ("VERTICAL_STIFFNESS", "Q_RE0", "Q_FZ2", "PFZ1")


class FittedApart:
    """Relative uncertainty of relaxation length and loaded radius after any list of runs.

    Each is linear in a few numbers with wide priors; readings add their information.
    """

    def __init__(self, config: Config, found: FitResult) -> None:
        assert found.files is not None
        self.tyre, self.nominal = found.tyre, config.tyre.nominal_load
        tested = found.files.tested
        self.loads = np.array([tested["FZMIN"], self.nominal, tested["FZMAX"]])
        self.pressure = float(found.tyre["NOMPRES"])
        self.noise = float(np.median(found.search.problem.sigma["Fy"])) if found.search else 1.0
        self._relaxation = np.diag(np.array(constants.PLAN_UNKNOWN_CARCASS) ** -2.0)
        steps = found.relaxation.runs if found.relaxation else ()
        for run in steps:
            self._relaxation = self._relaxation + self._of_step(run.load, run.length.u / run.length.value)
        if steps:  # a run like those that were made is as exact as they are
            self.noise *= float(
                np.median([run.length.u / run.length.value / self.u_of_step(run.load) for run in steps])
            )
        self._radius = np.diag(self._spread_of_radius() ** -2.0)
        rolling, u = found.radii.rolling, found.radii.rms.get("RL")
        self.u_radius = max(float(USUAL_MISFIT_OF_RADIUS), u or 0.0)
        if rolling is not None and u:
            self._radius = self._radius + self._of_radii(
                rolling.select(np.isfinite(rolling.loaded)), self.u_radius
            )

    def u_relaxation(self, runs: Iterable[PlannedRun]) -> float:
        """Standard uncertainty of the relaxation length over the length, rms over three loads."""
        information = self._relaxation + sum(
            (self._of_step(run.load, self.u_of_step(run.load)) for run in runs if run.addition.steps), 0.0
        )
        return self._rms(_by_load(self.loads / self.nominal - 1.0), information, np.ones(len(self.loads)))

    def u_loaded_radius(self, runs: Iterable[PlannedRun]) -> float:
        """Standard uncertainty of the loaded radius over the deflection, rms over three loads and pressures."""
        information = self._radius
        for run in runs:
            if run.addition.rolling and run.points is not None:
                p = run.points
                at = RollingParts(p.Fz, p.gamma, p.p, p.V, np.zeros(len(p)), np.full(len(p), np.nan))
                information = information + self._of_radii(at, self.u_radius)
        loads, pressures = np.meshgrid(self.loads[1:], np.array([0.8, 1.0, 1.2]) * self.pressure)
        n = loads.size
        at = RollingParts(
            loads.ravel(), np.zeros(n), pressures.ravel(), np.full(n, float(self.tyre["LONGVL"])),
            np.zeros(n), np.full(n, np.nan),
        )  # fmt: skip
        deflection = loads.ravel() / float(self.tyre["VERTICAL_STIFFNESS"])
        return self._rms(self._slopes(at), information, deflection)

    def u_of_step(self, load: float) -> float:
        """Relative uncertainty of the length that one run of steps shows, offset and gain of the force free."""
        state = self.tyre.state(load)
        sigma = float(state.sigma_y)
        height = abs(float(state.K_ya)) * constants.PLAN_STEP.rad
        spacing = float(constants.PLAN_STEP_SPEED) * float(constants.PLAN_STEP_INDEPENDENT)
        way = np.arange(0.0, float(constants.PLAN_STEP_SPEED) * float(constants.PLAN_STEP_HOLD), spacing)
        settles = np.exp(-way / sigma)
        slope = -height * way / sigma * settles  # by the logarithm of the length
        known = np.column_stack([np.ones_like(way), 1.0 - settles])
        left = slope - known @ np.linalg.lstsq(known, slope, rcond=None)[0]
        return self.noise / math.sqrt(4.0 * max(float(left @ left), 1e-12))

    def _of_step(self, load: float, u: float) -> np.ndarray:
        row = _by_load(np.array([load / self.nominal - 1.0]))[0]
        return np.outer(row, row) / u**2

    def _spread_of_radius(self) -> np.ndarray:
        stiffness = constants.PLAN_UNKNOWN_STIFFNESS * float(self.tyre["VERTICAL_STIFFNESS"])
        square = stiffness * float(self.tyre["UNLOADED_RADIUS"]) / self.nominal
        return np.array(
            [stiffness, constants.PLAN_UNKNOWN_RADIUS, square, float(constants.PLAN_UNKNOWN_PRESSURE)]
        )

    def _slopes(self, at: RollingParts) -> np.ndarray:
        """Derivatives of the loaded radius (n, 4) [m]."""
        free = traced({name: float(self.tyre[name]) for name in LOADED})
        out = radius({**self.tyre.values, **free}, at, "RL")
        return np.broadcast_to(gradient(out, list(free.values())), (len(at.Fz), len(LOADED)))

    def _of_radii(self, at: RollingParts, u: float) -> np.ndarray:
        slopes = self._slopes(at)
        information: np.ndarray = slopes.T @ slopes / u**2
        return information

    @staticmethod
    def _rms(slopes: np.ndarray, information: np.ndarray, size: np.ndarray) -> float:
        size_of = 1.0 / np.sqrt(np.diag(information))  # numbers of very different units
        covariance = np.linalg.inv(information * np.outer(size_of, size_of)) * np.outer(size_of, size_of)
        return rms(np.sqrt(np.einsum("ij,jk,ik->i", slopes, covariance, slopes)) / size)


def _by_load(dfz: np.ndarray) -> np.ndarray:
    """Derivatives (n, 3) of the logarithm of the carcass stiffness."""
    return np.column_stack([np.ones_like(dfz), dfz, dfz**2])
