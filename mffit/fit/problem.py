"""The least-squares problem: what the simulation says at the raw points, against what was measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np

from mffit import least_squares
from mffit.fit.constraints import Envelope, limits
from mffit.measured import RadiusReading
from mffit.points import Points
from mffit.rig import Simulation
from tir.derivatives import gradient, plain, traced
from tir.outputs import outputs_of

LIMIT_WEIGHT = 3000.0
"""Residual in units of noise per unit of violation; large enough to hold, small enough to keep the problem smooth."""


@dataclass(frozen=True, slots=True)
class Problem:
    """Points with their weights and the simulation to start from; residuals for any choice of free numbers."""

    points: Points
    simulation: Simulation
    sigma_Fy: np.ndarray  #: (n,) standard uncertainty used as weight [N]; inf where not used
    sigma_Mz: np.ndarray  #: (n,) [Nm]
    envelope: Envelope | None = None  #: over which the physical limits hold
    radii: tuple[RadiusReading, ...] = ()  #: measured effective radii, which count as data
    speed: float = 1.0  #: at which they were measured [m/s]

    def select(self, index: np.ndarray) -> Problem:
        """The problem of some points (m,)."""
        return replace(
            self,
            points=self.points.select(index),
            sigma_Fy=self.sigma_Fy[index],
            sigma_Mz=self.sigma_Mz[index],
        )

    def with_values(self, values) -> Problem:
        """The same from another start."""
        return replace(self, simulation=self.simulation.with_numbers(values))

    def misfit(self) -> np.ndarray:
        """(model - measured) / sigma at the start for Fy and then Mz, shape (2n,); 0 where a channel is not used."""
        out = self.simulation.readings(self.points)
        return np.concatenate([self._weighted(out.Fy, 0), self._weighted(out.Mz, 1)])

    def free(self, names: Sequence[str]) -> least_squares.Problem:
        """Residuals and derivatives with the named numbers free."""

        def at(x: np.ndarray) -> Problem:
            return self.with_values(dict(zip(names, x.tolist(), strict=True)))

        def residual(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            here = at(x)
            return np.concatenate([here.misfit(), here._radii([])[0]]), here._limits([])[0]

        def linear(x: np.ndarray) -> least_squares.Linear:
            here = at(x)
            out, slope = here.simulation.sensitivities(here.points, names)
            radii, radii_slope = here._radii(names)
            limits, limits_slope = here._limits(names)
            rows = [here._weighted(out.Fy, 0), here._weighted(out.Mz, 1), radii]
            slopes = [
                slope.Fy / here.sigma_Fy[:, None] * here._used(0)[:, None],
                slope.Mz / here.sigma_Mz[:, None] * here._used(1)[:, None],
                radii_slope,
            ]
            return least_squares.Linear(np.concatenate(rows), np.concatenate(slopes), limits, limits_slope)

        return least_squares.Problem(residual, linear)

    def _channel(self, channel: int) -> tuple[np.ndarray, np.ndarray]:
        return ((self.points.Fy, self.sigma_Fy), (self.points.Mz, self.sigma_Mz))[channel]

    def _used(self, channel: int) -> np.ndarray:
        measured, sigma = self._channel(channel)
        return np.isfinite(sigma) & np.isfinite(measured)

    def _weighted(self, model: np.ndarray, channel: int) -> np.ndarray:
        measured, sigma = self._channel(channel)
        return np.where(self._used(channel), (model - np.nan_to_num(measured)) / sigma, 0.0)

    def _radii(self, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
        """Effective radii of the model against the measured ones, which follow the path radius they were taken on."""
        if not self.radii:
            return np.zeros(0), np.zeros((0, len(names)))
        numbers = traced({name: self.simulation.number(name, self.points) for name in names})
        coefficients = {n: x for n, x in numbers.items() if n in self.simulation.values}
        p = SimpleNamespace(**{**self.simulation.values, **coefficients})
        load = np.array([row.load for row in self.radii])
        measured, u = (np.array([getattr(row, name) for row in self.radii]) for name in ("value", "u"))
        declared = self.simulation.declared(self.points)
        R = numbers.get("path_radius_m", self.simulation.number("path_radius_m", self.points))
        follows = np.array([1.0 if row.follows_path else 0.0 for row in self.radii])
        (Re,) = outputs_of(("Re",), p, {"Fz": load, "Vx": self.speed})
        out = (Re - measured * (1.0 + follows * (R / declared - 1.0))) / u
        slope = np.broadcast_to(gradient(out, list(numbers.values())), (len(load), len(names)))
        return np.broadcast_to(plain(out), len(load)), slope

    def _limits(self, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
        """Broken physical limits of the model."""
        if self.envelope is None:
            return np.zeros(0), np.zeros((0, len(names)))
        coefficients = traced(
            {name: float(self.simulation.values[name]) for name in names if name in self.simulation.values}
        )
        rows = limits(SimpleNamespace(**{**self.simulation.values, **coefficients}), self.envelope)
        m = self.envelope.size
        slope = np.zeros((len(rows) * m, len(names)))
        columns = [k for k, name in enumerate(names) if name in coefficients]
        value = np.concatenate([np.broadcast_to(plain(row), m) for row in rows])
        if columns:
            wrt = list(coefficients.values())
            slope[:, columns] = np.concatenate(
                [np.broadcast_to(gradient(row, wrt), (m, len(wrt))) for row in rows]
            )
        broken = value > 0.0
        return LIMIT_WEIGHT * np.where(broken, value, 0.0), LIMIT_WEIGHT * slope * broken[:, None]
