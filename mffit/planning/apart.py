"""What is fitted apart from the forces: relaxation lengths and loaded radius, and what further runs would add."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from mffit.config import Config
from mffit.fit import FitResult, Posterior
from mffit.fit.constants import CARCASS_TERM_SPREAD, USUAL_MISFIT_OF_RADIUS
from mffit.fit.posterior import spread_through
from mffit.fit.relaxation import Relaxation
from mffit.fit.upright import upright
from mffit.fit.wheel.vertical import RollingParts, radius
from mffit.planning import constants
from mffit.planning.runs import PlannedRun
from mffit.scatter import rms
from tir import Tyre
from tir.derivatives import gradient, plain, traced

PLANNED_STEPS = {
    "alpha": np.radians(constants.PLAN_STEPS),
    "kappa": np.array(constants.PLAN_STEPS_OF_SLIP),
}
"""Values of a run of steps, by the setting that steps [rad or -]."""
LOADED = ("VERTICAL_STIFFNESS", "Q_RE0", "Q_FZ2", "PFZ1")


class FittedApart:
    """Relative uncertainty of relaxation lengths and loaded radius after any list of runs.

    Each is linear in a few numbers with wide priors; readings add their information.
    """

    def __init__(self, config: Config, found: FitResult, tested: Mapping[str, float]) -> None:
        self.tyre, self.nominal = found.tyre, config.tyre.nominal_load
        self.loads = np.array([tested["FZMIN"], self.nominal, tested["FZMAX"]])
        self.pressure = float(found.tyre["NOMPRES"])
        sigma = found.search.problem.sigma if found.search else {}
        side = float(np.median(sigma["Fy"])) if "Fy" in sigma else 1.0
        noise = {name: float(np.median(sigma[name])) if name in sigma else side for name in ("Fx", "Fy")}
        self.lags = [
            _OfSteps(one, self.tyre, self.nominal, noise[one.direction.force]) for one in found.relaxation
        ]
        known = [scale for lag in self.lags if (scale := lag.noisier_than_expected)]
        for lag in self.lags:  # a run like those that were made is as exact as they are
            lag.noise *= lag.noisier_than_expected or (float(np.median(known)) if known else 1.0)
        self._radius = np.diag(self._spread_of_radius() ** -2.0)
        rolling, u = found.radii.rolling, found.radii.rms.get("RL")
        self.u_radius = max(float(USUAL_MISFIT_OF_RADIUS), u or 0.0)
        if rolling is not None and u:
            self._radius = self._radius + self._of_radii(
                rolling.select(np.isfinite(rolling.loaded)), self.u_radius
            )

    def u_relaxation(self, runs: Iterable[PlannedRun]) -> list[float]:
        """Standard uncertainty of each relaxation length over the length, rms over three loads and pressures."""
        runs = list(runs)
        loads, pressures = self._grid(self.loads)
        return [
            _rms(lag.by_terms(loads, pressures), lag.information(runs), np.ones(len(loads)))
            for lag in self.lags
        ]

    def u_carcass(self, name: str, runs: Iterable[PlannedRun], posterior: Posterior) -> float:
        """Standard uncertainty of a coefficient of the carcass, with that of the slip stiffness from which it follows."""
        lag = next(lag for lag in self.lags if name in lag.direction.names)
        return lag.u_of(name, list(runs), posterior)

    def _grid(self, loads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Loads (n,) [N] and pressures (n,) [Pa]: every load at three pressures."""
        Fz, p = np.meshgrid(loads, np.array(constants.PLAN_ROLLING_PRESSURES) * self.pressure)
        return Fz.ravel(), p.ravel()

    def u_loaded_radius(self, runs: Iterable[PlannedRun]) -> float:
        """Standard uncertainty of the loaded radius over the deflection, rms over three loads and pressures."""
        information = self._radius
        for run in runs:
            if run.addition.rolling and run.points is not None:
                p = run.points
                at = RollingParts(p.Fz, p.gamma, p.p, p.V, np.zeros(len(p)), np.full(len(p), np.nan))
                information = information + self._of_radii(at, self.u_radius)
        loads, pressures = self._grid(self.loads[1:])
        n = len(loads)
        at = RollingParts(
            loads,
            np.zeros(n),
            pressures,
            np.full(n, float(self.tyre["LONGVL"])),
            np.zeros(n),
            np.full(n, np.nan),
        )
        deflection = loads / float(self.tyre["VERTICAL_STIFFNESS"])
        return _rms(self._slopes(at), information, deflection)

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


class _OfSteps:
    """What runs of steps show of the relaxation length in one direction."""

    def __init__(self, found: Relaxation, tyre: Tyre, nominal: float, noise: float) -> None:
        self.direction, self.tyre, self.nominal = found.direction, tyre, nominal
        self.noise = noise  #: of a finished point [N]
        self.made = [(run.load, run.pressure, run.length.u / run.length.value) for run in found.runs]

    @property
    def noisier_than_expected(self) -> float | None:
        """Uncertainty that runs of steps gave over that forecast; None without any."""
        return float(np.median([u / self.u_of_step(*at) for *at, u in self.made])) if self.made else None

    def by_terms(self, loads: np.ndarray, pressures: np.ndarray) -> np.ndarray:
        """Derivatives (n, 4) of the logarithm of the carcass stiffness by that of the nominal one and by the terms."""
        dfz, dpi = loads / self.nominal - 1.0, pressures / float(self.tyre["NOMPRES"]) - 1.0
        return np.column_stack([np.ones_like(dfz), dfz, dfz**2, dpi])

    def readings(self, runs: Iterable[PlannedRun]) -> np.ndarray:
        """Load [N], pressure [Pa] and relative uncertainty of the length (n, 3) of the runs made and of further ones."""
        new = [r.points for r in runs if r.addition.steps == self.direction.setting and r.points is not None]
        at = [(float(p.Fz[0]), float(p.p[0])) for p in new]
        rows = [*self.made, *((load, pressure, self.u_of_step(load, pressure)) for load, pressure in at)]
        return np.reshape(np.array(rows, dtype=float), (-1, 3))

    def information(self, runs: Iterable[PlannedRun]) -> np.ndarray:
        """Information (4, 4) about the logarithm of the carcass stiffness, with its prior, after further runs."""
        loads, pressures, u = self.readings(runs).T
        weighted = self.by_terms(loads, pressures) / u[:, None]
        prior = np.diag(np.array([constants.PLAN_UNKNOWN_CARCASS, *CARCASS_TERM_SPREAD]) ** -2.0)
        information: np.ndarray = prior + weighted.T @ weighted
        return information

    def u_of(self, name: str, runs: Sequence[PlannedRun], posterior: Posterior) -> float:
        """Standard uncertainty of a coefficient after further runs, in its unit."""
        k = self.direction.names.index(name)
        loads, pressures, u = self.readings(runs).T
        covariance = np.linalg.inv(self.information(runs))
        by_run = covariance[k] @ (self.by_terms(loads, pressures) / u[:, None] ** 2).T
        rows = [row for row, known in enumerate(posterior.names) if known in self.tyre.values]
        at = traced({posterior.names[row]: float(self.tyre[posterior.names[row]]) for row in rows})
        K = self.direction.slip_stiffness(*upright({**self.tyre.values, **at}, loads, pressures))
        relative = gradient(K, list(at.values())) / np.reshape(plain(K), (-1, 1))
        of_stiffness = spread_through((by_run @ relative)[None], posterior.covariance[np.ix_(rows, rows)])[0]
        own = math.hypot(math.sqrt(covariance[k, k]), float(of_stiffness))
        return own * float(self.tyre[name]) if k == 0 else own

    def u_of_step(self, load: float, pressure: float) -> float:
        """Relative uncertainty of the length that one run of steps shows, offset and gain of the force free.

        The noise is a first-order process, taken off as the fit takes it off.
        """
        state = self.tyre.state(load, p=pressure)
        sigma, K = (abs(float(getattr(state, name))) for name in (self.direction.sigma, self.direction.K))
        V, hold, rate = (
            float(x) for x in (constants.PLAN_STEP_SPEED, constants.PLAN_STEP_HOLD, constants.PLAN_STEP_RATE)
        )
        values = PLANNED_STEPS[self.direction.setting]
        time = np.arange(0.0, len(values) * hold, 1.0 / rate)
        response, slope = np.zeros(len(time)), np.zeros(len(time))
        for k, height in enumerate(K * np.diff(values), 1):
            way = np.maximum(time - k * hold, 0.0) * V
            response += height * (1.0 - np.exp(-way / sigma))
            slope -= height * way / sigma * np.exp(-way / sigma)  # by the logarithm of the length
        tau = float(constants.PLAN_STEP_CORRELATION)
        noise = sample_noise(self.noise)
        keeps = math.exp(-1.0 / (rate * tau))
        design = np.column_stack([np.ones(len(time)), response, slope])
        white = (design[1:] - keeps * design[:-1]) / (noise * math.sqrt(1.0 - keeps**2))
        return float(np.sqrt(np.linalg.inv(white.T @ white)[2, 2]))


def sample_noise(of_point: float) -> float:
    """Standard deviation of a sample of a recording, from that of a finished point."""
    return of_point * math.sqrt(constants.PLAN_POINT_TIME / (2.0 * constants.PLAN_STEP_CORRELATION))


def _rms(slopes: np.ndarray, information: np.ndarray, size: np.ndarray) -> float:
    size_of = 1.0 / np.sqrt(np.diag(information))  # numbers of very different units
    covariance = np.linalg.inv(information * np.outer(size_of, size_of)) * np.outer(size_of, size_of)
    return rms(np.sqrt(np.einsum("ij,jk,ik->i", slopes, covariance, slopes)) / size)
