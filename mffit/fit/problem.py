"""The least-squares problem of the fit: simulated minus measured readings."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.config import Config
from mffit.constants import ASSUMED_NOISE_SHARE
from mffit.fit import constants, weights
from mffit.fit.constraints import Envelope, limits
from mffit.fit.ranges import covered_ranges, envelope
from mffit.fit.rig.rig_numbers import known_faults, known_zeros
from mffit.fit.second_hand import by_force_read
from mffit.fit.wheel.rolling import effective_radius
from mffit.least_squares import FreeNumber, LeastSquaresProblem, Linear, condensed
from mffit.measured import Measured, RadiusReading, radius_readings
from mffit.points import Points
from mffit.points.noise import estimated_noise, stating
from mffit.quantities import SIDEWAYS
from mffit.rig import Readings, Simulation, reference_speed, successive
from mffit.scatter import rms
from mffit.suspicion.reversals import reversals_of
from tir.derivatives import gradient, plain, traced
from tir.frozen import ReadOnlyArrays


@dataclass(frozen=True, slots=True)
class FitProblem(ReadOnlyArrays):
    """Points with weights, and a simulation: gives the residuals for any choice of free numbers."""

    points: Points
    simulation: Simulation  #: its numbers are the starting values of a search
    sigma: Mapping[str, np.ndarray]
    """By channel, standard uncertainty (n,) used as weight [N] or [Nm]; inf where the channel is not used."""
    envelope: Envelope | None = None  #: ranges over which the physical limits must hold
    radii: tuple[RadiusReading, ...] = ()  #: measured effective radii, which count as data
    speed: float = 1.0  #: at which the radii were measured [m/s]

    def select(self, index: np.ndarray) -> FitProblem:
        """The problem restricted to the points with these indices (m,)."""
        sigma = {name: u[index] for name, u in self.sigma.items()}
        return replace(self, points=self.points.select(index), sigma=sigma)

    def thinned(self, stride: int) -> FitProblem:
        """The problem with every ``stride``-th point, each counted ``stride`` times so that priors keep their relative weight."""
        if stride == 1:
            return self
        part = self.select(np.arange(0, len(self.points), stride))
        share = 1.0 / np.sqrt(stride)
        return replace(part, sigma={name: share * u for name, u in part.sigma.items()})

    def with_values(self, values: Mapping[str, float]) -> FitProblem:
        """The same problem with some numbers of the simulation replaced."""
        return replace(self, simulation=self.simulation.with_numbers(values))

    def value(self, name: str) -> float:
        """Current value of a coefficient or rig error."""
        return self.simulation.number(name, self.points)

    def starting_here(self, numbers: Sequence[FreeNumber]) -> list[FreeNumber]:
        """The numbers with their current values as starting values."""
        return [replace(n, start=self.value(n.name)) for n in numbers]

    def reweighted(self) -> FitProblem:
        """The problem with weights enlarged to its own misfit.

        A channel that the model misses by more than its noise must not dominate the other channels. Readings that depart from
        their sweep where it turns back are weighted by their own scatter.
        """
        sigma, misfit = {}, self.misfit()
        for name, turning in self.turning(misfit).items():
            z = misfit[name]
            factor = weights.enlarged(np.where(turning, 0.0, z))
            if np.any(turning):
                factor = np.where(turning, factor * max(rms(z[turning]) / rms(z[~turning]), 1.0), factor)
            sigma[name] = self.sigma[name] * factor
        return replace(self, sigma=sigma)

    def turning(self, misfit: Mapping[str, np.ndarray] | None = None) -> dict[str, np.ndarray]:
        """By channel, mask (n,) of the readings that depart from their sweep because it turns back there."""
        reversals, misfit = reversals_of(self.points), self.misfit() if misfit is None else misfit
        return {
            # An unused reading has an infinite sigma.
            name: reversals.off(np.where(self._used(name), z, np.nan) * self.sigma[name])
            for name, z in misfit.items()
        }

    def with_noise_of_misfit(self) -> FitProblem:
        """The problem in which readings without stated uncertainty are assigned at most the scatter of their misfit.

        The scatter of neighbouring readings is the lower limit, because a fit absorbs some of the noise.
        """
        readings, sigma = self.readings(), dict(self.sigma)
        neighbours = estimated_noise(self.points, readings)
        for name, z in self.misfit(readings).items():
            used = self._used(name)
            silent = used & ~stating(self.points.u(name))
            least = max(
                ASSUMED_NOISE_SHARE * rms(self.points.channel(name)[used]), np.nan_to_num(neighbours[name])
            )
            scatter = np.maximum(weights.robust_scale(z[silent]) * sigma[name][silent], least)
            sigma[name] = sigma[name].copy()
            sigma[name][silent] = np.minimum(scatter, sigma[name][silent])
        return replace(self, sigma=sigma)

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels that the fit uses, in the order of ``CHANNELS``."""
        return tuple(self.sigma)

    def readings(self) -> Readings:
        """The simulated readings at the points, in the channels of the fit."""
        return self.simulation.readings(self.points, self.sigma)

    def misfit(self, readings: Readings | None = None) -> dict[str, np.ndarray]:
        """By channel, (model - measured) / sigma (n,); 0 where the channel is not used."""
        readings = self.readings() if readings is None else readings
        out = {}
        for name, sigma in self.sigma.items():
            model = readings[name]
            if name == "Mx" and "Fy" in self.sigma:
                model, _ = self._at_second_hand((), slice(None), readings)
            out[name] = np.where(self._used(name), (model - self.points.channel(name)) / sigma, 0.0)
        return out

    def free(self, names: Sequence[str]) -> LeastSquaresProblem:
        """Residuals and derivatives with the named numbers free."""

        def at(x: np.ndarray) -> FitProblem:
            return self.with_values(dict(zip(names, x.tolist(), strict=True)))

        def residual(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            here = at(x)
            data = np.concatenate([*here.misfit().values(), here.radii_rows([])[0]])
            return data, here._limits([])[0]

        def linear(x: np.ndarray) -> Linear:
            here = at(x)
            data, slope = condensed(
                itertools.chain((rows[1:] for rows in here.blocks(names)), [here.radii_rows(names)])
            )
            return Linear(data, slope, *here._limits(names))

        return LeastSquaresProblem(residual, linear)

    def blocks(self, names: Sequence[str]) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Indices (m,) of the points, block by block, with their residuals (c m,) and derivatives (c m, k).

        Blocks are those of :meth:`mffit.rig.Simulation.in_blocks`. Within a block, channel follows channel; unused rows are 0.
        """
        for rows, readings, by_channel in self.simulation.in_blocks(self.points, names, self.sigma):
            c, m, which = len(self.sigma), len(rows), successive(rows)
            data, slopes = np.empty((c, m)), np.empty((len(names), c, m))
            for k, (name, sigma) in enumerate(self.sigma.items()):
                measured, u = self.points.channel(name)[which], sigma[which]
                used = np.isfinite(u) & np.isfinite(measured)
                model, slope = readings[name], by_channel[name]
                if name == "Mx" and "Fy" in self.sigma:
                    model, slope = self._at_second_hand(names, which, readings, by_channel)
                data[k] = np.where(used, (model - measured) / u, 0.0)
                np.multiply(slope.T, used / u, out=slopes[:, k])
            yield rows, data.ravel(), slopes.reshape(len(names), -1).T

    def _at_second_hand(
        self,
        names: Sequence[str],
        rows: np.ndarray | slice,
        readings: Readings,
        by_channel: Readings | None = None,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Mx (m,) and its derivatives (m, k), with the side force as read where it has a weight."""
        part, read = self.points.select(rows, with_table=False), self._used("Fy")[rows]
        forces = np.where(read, part.Fy, readings.Fy), readings.Fy
        change, by_number, by_force = by_force_read(self.simulation, part, forces, names)
        if by_channel is None:
            return readings.Mx + change, by_number
        of_Fy = (read * by_force)[:, None] * by_channel.Fy
        return readings.Mx + change, by_channel.Mx + by_number + of_Fy

    def rows(self, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
        """Residuals (c n + r,) and their derivatives, channel by channel, then of the measured radii."""
        c, n = len(self.sigma), len(self.points)
        data, slopes = np.empty((c, n)), np.empty((c, n, len(names)))
        for rows, residual, slope in self.blocks(names):
            data[:, rows] = residual.reshape(c, -1)
            slopes[:, rows] = slope.reshape(c, -1, len(names))
        radii, by_radii = self.radii_rows(names)
        return np.append(data, radii), np.concatenate([slopes.reshape(c * n, -1), by_radii])

    def _used(self, channel: str) -> np.ndarray:
        return np.asarray(np.isfinite(self.sigma[channel]) & np.isfinite(self.points.channel(channel)))

    def radii_rows(self, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
        """Residuals (r,) of the measured effective radii and their derivatives (r, k).

        A radius measured over a path length is proportional to the path radius.
        """
        if not self.radii:
            return np.zeros(0), np.zeros((0, len(names)))
        numbers = traced({name: self.value(name) for name in names})
        coefficients = {name: x for name, x in numbers.items() if name in self.simulation.values}
        load = np.array([row.load for row in self.radii])
        measured, u = (np.array([getattr(row, name) for row in self.radii]) for name in ("value", "u"))
        follows = np.array([1.0 if row.follows_path else 0.0 for row in self.radii])
        longer: Any = 0.0
        if np.any(follows):
            R = numbers.get("path_radius_m", self.value("path_radius_m"))
            longer = follows * (R / self.simulation.declared(self.points) - 1.0)
        Re = effective_radius({**self.simulation.values, **coefficients}, load, self.speed)
        out = (Re - measured * (1.0 + longer)) / u
        slope = np.broadcast_to(gradient(out, list(numbers.values())), (len(load), len(names)))
        return np.broadcast_to(plain(out), len(load)), slope

    def _limits(self, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
        """Residuals of the physical limits, positive where a limit is violated, and their derivatives."""
        if self.envelope is None:
            return np.zeros(0), np.zeros((0, len(names)))
        values = self.simulation.values
        coefficients = traced({name: float(values[name]) for name in names if name in values})
        p = SimpleNamespace(**{**values, **coefficients})
        value, by_coefficient = limits(p, self.envelope, list(coefficients.values()))
        slope = np.zeros((len(value), len(names)))
        slope[:, [k for k, name in enumerate(names) if name in coefficients]] = by_coefficient
        weight = constants.LIMIT_WEIGHT_OF_FIT
        return weight * value, weight * slope


def fit_problem(
    config: Config,
    points: Points,
    measured: Measured,
    values: Mapping[str, Any],
    channels: Iterable[str] = SIDEWAYS,
) -> FitProblem:
    """The problem before the fit: points as read, weights from stated uncertainties, rig errors at their known values.

    Without Fx among the ``channels`` no coefficient of longitudinal slip is free, so driven and braked points have no weight.
    """
    disc = config.rig.on_disc
    used = np.ones(len(points), dtype=bool) if "Fx" in channels else points.free_rolling
    return FitProblem(
        points=points,
        simulation=Simulation(
            values=values,
            faults=known_faults(config, measured, points.used_setups),
            of_parts=known_zeros(measured, points.used_setups),
            turn_slip=disc,
            radius_m=config.rig.radius or float("nan"),
        ),
        sigma={
            name: np.where(
                used,
                weights.stated_or_nominal(points.u(name), np.where(used, points.channel(name), np.nan)),
                np.inf,
            )
            for name in channels
        },
        envelope=envelope(covered_ranges(points)),
        radii=radius_readings(config),
        speed=reference_speed(points),
    )
