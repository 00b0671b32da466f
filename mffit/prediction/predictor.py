"""Predictor of a build: forces of its tyre at any conditions, with model error and uncertainty."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import pandas as pd

from mffit.constants import COVERAGE_FACTOR_95
from mffit.least_squares import root
from mffit.linearised import LinearisedChannel, LinearisedFit
from mffit.linearised.combined import Combinations
from mffit.linearised.components import Components
from mffit.linearised.inputs import SLIPS, Input, forwards, turned
from mffit.linearised.smooth import SmoothFunctions
from mffit.numbers import Numbers
from mffit.points import Points, main_path, make_points
from mffit.points.points import OF_SI
from mffit.prediction.conditions import PATH, UNITS
from mffit.quantities import column, u_column
from mffit.rig import Readings, Simulation
from mffit.rig_errors import BESIDE, T_REF, V_REF, ZEROS, error_of
from tir import Tyre
from tir.correction import share_of_load, slip_beyond
from tir.frozen import ReadOnlyArrays


class Remaining(NamedTuple):
    """Shares (n,) of the model error at conditions where nothing was tested."""

    load: np.ndarray
    """Of the error at the lowest tested load; it falls with the load, and its uncertainty with it."""
    slip: np.ndarray  #: :func:`tir.correction.slip_beyond` of the tested longitudinal slip

    @property
    def share(self) -> np.ndarray:
        """Share (n,) of the model error that is left, by both."""
        return np.asarray(self.load * np.exp(-self.slip))


@dataclass(frozen=True, slots=True, eq=False)
class MissedChannel(ReadOnlyArrays):
    """Model error of a channel, scatter of its runs, and uncertainty of its coefficients."""

    smooth: SmoothFunctions  #: m functions
    components: Components
    missed: np.ndarray
    """(m,) estimated weights of the functions with the file's coefficients [unit of the channel]."""
    root: np.ndarray
    """(m + k, r): root @ root.T is the covariance of the weights and of changes of coefficients and calibrations."""
    noise: float  #: standard deviation of the noise of a typical reading [unit of the channel]
    size: float  #: rms model error at the readings [unit of the channel]
    growth: np.ndarray  #: (d,) as :func:`mffit.linearised.ends.growths`
    combinations: Combinations  #: of the conditions, tested and untested ones
    is_proven: bool  #: whether the model error is more than noise and scatter of runs

    @property
    def covariance(self) -> np.ndarray:
        """Covariance (k, k) of the coefficients and calibrations."""
        own = self.root[len(self.missed) :]
        return np.asarray(own @ own.T)

    def at(
        self,
        settings: np.ndarray,
        force: np.ndarray,
        by_numbers: Sequence[np.ndarray],
        left: Remaining,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The model error (n,), the variance of the tyre's force (n,), and the variance of a reading of it (n,).

        The estimate keeps the file's coefficients, so it is 0 where the formula describes the tyre exactly; errors of the
        coefficients count in the variance. ``force`` (n,) is that of the formula at the conditions ``settings`` (n, d),
        ``by_numbers`` are :meth:`by_numbers` there, ``left`` is what remains of the model error where nothing was tested.
        """
        untold, functions = self.smooth.faded(settings)
        functions = functions * left.share[:, None]
        shared = functions @ self.root[: len(self.missed)]
        mean, reading = (np.sum((shared + one) ** 2, axis=1) for one in by_numbers)
        # Between the lowest tested load and none, where it is zero again, the model error is free as a bridge is.
        free = 2.0 * left.slip * left.load**2 + left.load * (1.0 - left.load)
        share = untold * left.load**2 + free * self.smooth.variance(settings)
        unlike = share * self.components.missed**2 + self._strays(settings) * force**2
        never = self.combinations.at(settings) * force**2  # it holds what the model knows of its error there
        unlike = unlike + np.maximum(never - mean - unlike, 0.0)
        return functions @ self.missed, mean + unlike, reading + unlike

    def mean(self, settings: np.ndarray) -> np.ndarray:
        """The model error (n,) alone, as in :meth:`at`, averaged over conditions that are NaN."""
        return self.smooth.estimate(self.missed, settings)

    def u(self, settings: np.ndarray, slopes: np.ndarray) -> np.ndarray:
        """Standard uncertainty (n,) of coefficients and model error together; ``settings`` and ``slopes`` as in :meth:`at`."""
        both = np.hstack([np.nan_to_num(self.smooth.fading(settings)), slopes]) @ self.root
        return np.asarray(np.sqrt(np.sum(both**2, axis=1)))

    def u_between(self, settings: np.ndarray, slopes: np.ndarray) -> float:
        """Standard uncertainty of the difference of two forces at ``settings`` (2, d), with derivatives ``slopes`` (2, k)."""
        one, other = np.hstack([self.smooth.fading(settings), slopes]) @ self.root
        unlike = self.smooth.untold_change(settings)
        return float(np.sqrt(np.sum((one - other) ** 2) + unlike * self.components.missed**2))

    def by_numbers(self, slopes: np.ndarray, of_tyre: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Roots (n, r) of the covariance of forces with these ``slopes`` (n, k): by numbers ``of_tyre`` (mask), and by all."""
        own = self.root[len(self.missed) :]
        tyre = slopes[:, of_tyre] @ own[of_tyre]
        return tyre, tyre + slopes[:, ~of_tyre] @ own[~of_tyre]

    def _strays(self, settings: np.ndarray) -> np.ndarray:
        """Variance (n,) of the formula's error beyond the tested ranges, over the square of the force."""
        each = zip(self.smooth.inputs, settings.T, self.growth, strict=True)
        return sum((growth**2 * one.strayed(at) for one, at, growth in each), np.zeros(len(settings)))


@dataclass(frozen=True, slots=True, eq=False)
class PredictedForce(ReadOnlyArrays):
    """The force of a tyre at conditions (n,) and its variances, in the unit of the channel."""

    file: np.ndarray  #: force of the property file
    best: np.ndarray  #: best estimate: force of the fitted model plus the estimated model error
    variance: np.ndarray  #: variance of the best estimate as the mean force of the tyre
    of_run: np.ndarray  #: variance of a reading of a new run on the same rig around the best estimate
    of_setup: np.ndarray  #: the same after the rig was set up anew, with other zeros

    @property
    def u_file(self) -> np.ndarray:
        """Standard deviation of a reading of a new run around the force of the file."""
        return np.asarray(np.sqrt((self.best - self.file) ** 2 + self.of_run))


@dataclass(frozen=True, slots=True, eq=False)
class Predictor(ReadOnlyArrays):
    """Predicts forces at any conditions, with model error and uncertainty."""

    path: float  #: path curvature of most readings [1/m], the default of predictions; 0 on a flat track
    names: tuple[str, ...]  #: (k,) names of the uncertain coefficients and of the rig's calibrations
    channels: Mapping[str, MissedChannel]
    zeros: Mapping[str, float]
    """Fitted zeros of the rig, each the largest of all set-ups; they are part of a reading."""
    beside: Mapping[str, float]
    """Effects of the tyre for which a property file has no coefficient, and its temperature terms."""
    V_range: tuple[float, float]  #: tested speeds [m/s]
    T_range: tuple[float, float] | None = None  #: tested temperatures [degC], to which the terms are held
    lowest_load: float = 0.0  #: lowest tested load [N], below which the model error falls with the load
    setups: Mapping[str, float] = field(default_factory=dict)
    """Standard deviation of the zeros from one set-up of the rig to the next."""
    stated: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    """(k, r): stated @ stated.T is the covariance of the numbers as the fit states it; empty if it states none."""

    @property
    def curved(self) -> bool:
        """Whether the readings were taken on a curved path."""
        return self.path != 0.0

    @property
    def sharpest(self) -> float:
        """Largest tested curvature of the path, to either side [1/m]."""
        return float(max(map(abs, (self.path, *self._shown.get("phi_t", ())))))

    @property
    def _shown(self) -> dict[str, tuple[float, float]]:
        """:attr:`Input.shown` of every condition that varies for some channel."""
        inputs = itertools.chain.from_iterable(one.smooth.inputs for one in self.channels.values())
        return {one.name: one.shown for one in inputs}

    def predict(
        self, tyre: Tyre, fitted: Tyre, conditions: pd.DataFrame, channels: Iterable[str] | None = None
    ) -> pd.DataFrame:
        """The conditions with the forces of the file and the best estimates, all with standard uncertainties; ISO-W axes.

        ``tyre`` is the plain file of the build, ``fitted`` that of the fitted model; on a disc it differs from a plain file for
        turn slip off. Of the conditions, ``alpha_deg``, ``gamma_deg`` and ``Fz_N`` are required, other columns of a sweep and
        ``phi_t_per_m`` optional; of a disc, the result has the last one for every condition. Each channel, here Fy, gets
        ``Fy_N``, ``u_Fy_N``, ``Fy_best_N``, ``u_Fy_best_N``, ``u_Fy_run_N``, ``u_Fy_setup_N``.
        """
        points = self.points(tyre, conditions)
        plain = Simulation.of(tyre, turn_slip=tyre.turn_slip)
        found = conditions.copy()
        if self.curved:
            found[PATH] = points.phi_t
        simulation = Simulation.of(fitted, turn_slip=self.curved)
        for name, one in self.forces(plain, simulation, points, channels).items():
            found[column(name)] = one.file
            found[u_column(name)] = one.u_file
            found[column(name, "best")] = one.best
            found[f"u_{column(name, 'best')}"] = np.sqrt(one.variance)
            found[f"u_{column(name, 'run')}"] = np.sqrt(one.of_run)
            found[f"u_{column(name, 'setup')}"] = np.sqrt(one.of_setup)
        return found

    def forces(
        self, file: Simulation, fitted: Simulation, points: Points, channels: Iterable[str] | None = None
    ) -> dict[str, PredictedForce]:
        """By channel, the forces and variances at the conditions of ``points``, for some or all fitted channels.

        ``file`` and ``fitted`` simulate a file of the build and the fitted model on a rig without errors.
        """
        names = [name for name in self.channels if channels is None or name in channels]
        plain, points = file.readings(points, names), self._held(points)
        if self.T_range is None:
            return self._forces(plain, fitted, points, names)
        unstated = ~np.isfinite(points.T)
        held = points.replace(T=np.clip(points.T, *self.T_range))
        if not np.any(unstated):
            return self._forces(plain, fitted, held, names)
        each = [
            self._forces(plain, fitted, held.replace(T=np.where(unstated, T, held.T)), names)
            for T in self._usual_temperatures()
        ]
        return {name: _mixed([one[name] for one in each]) for name in names}

    @property
    def follows_speed(self) -> bool:
        """Whether the best estimate changes with the speed, which is then held to the tested ones."""
        return V_REF in self.beside or "V" in self._shown

    def _held(self, points: Points) -> Points:
        return points.replace(V=np.clip(points.V, *self.V_range)) if self.follows_speed else points

    def _usual_temperatures(self) -> tuple[float, ...]:
        """Temperatures [degC] over which a prediction that states none averages."""
        inputs = itertools.chain.from_iterable(one.smooth.inputs for one in self.channels.values())
        found = next((one.averaged for one in inputs if one.name == "T"), ())
        return found or (float(self.beside[T_REF]),)

    def _forces(
        self, plain: Readings, fitted: Simulation, points: Points, names: Sequence[str]
    ) -> dict[str, PredictedForce]:
        fitted = fitted.with_numbers(self.beside)
        forces, slopes = fitted.sensitivities(points, self.names, names)
        by_zeros = fitted.sensitivities(points, [*self.setups], names)[1]
        as_read = fitted.with_numbers(self.zeros).readings(points, names)
        off, slid = self._off_path(fitted, points, slopes), self._slid(fitted, points, forces)
        found = {}
        for name in names:
            channel = self.channels[name]
            missed, variance, of_reading = self._missed(channel, points, forces[name], slopes[name])
            further = np.maximum(off[name] - variance, 0.0) + slid[name]
            variance, of_reading = variance + further, of_reading + further
            best = forces[name] + missed
            tight = of_reading + channel.components.run_variance(best) + channel.noise**2
            of_run = tight + (as_read[name] - forces[name]) ** 2
            of_setup = tight + by_zeros[name] ** 2 @ np.array([*self.setups.values()]) ** 2
            found[name] = PredictedForce(plain[name], best, variance, of_run, of_setup)
        return found

    def _off_path(
        self, fitted: Simulation, points: Points, slopes: Mapping[str, np.ndarray]
    ) -> dict[str, np.ndarray]:
        """By channel, the variance (n,) of the change that the formula makes to a force from the tested path to another one.

        Readings on one path hold the forces there, but not each coefficient. ``slopes`` (n, k) are derivatives of the forces.
        """
        tested = np.where(points.phi_t * self.path < 0.0, -self.path, self.path)
        rows = np.flatnonzero(points.phi_t != tested)
        out = {name: np.zeros(len(points)) for name in slopes}
        if len(rows) and len(self.stated):
            there = points.replace(phi_t=tested).select(rows, with_table=False)
            for name, own in fitted.sensitivities(there, self.names, [*slopes])[1].items():
                out[name][rows] = np.sum(((slopes[name][rows] - own) @ self.stated) ** 2, axis=1)
        return out

    def _slid(
        self, fitted: Simulation, points: Points, forces: Mapping[str, np.ndarray]
    ) -> dict[str, np.ndarray]:
        """By channel, the variance (n,) of the change that the formula makes to a force beyond the tested slips.

        A tyre with a proven model error may go on otherwise: the change may be none, or twice, or any between.
        """
        slips = {name: ends for name, ends in self._shown.items() if name in SLIPS}
        near = points.replace(**{name: np.clip(getattr(points, name), *ends) for name, ends in slips.items()})
        rows = np.flatnonzero((near.alpha != points.alpha) | (near.kappa != points.kappa))
        out = {name: np.zeros(len(points)) for name in forces}
        unlike = [name for name in forces if self.channels[name].is_proven]
        if len(rows) and unlike:
            for name, force in fitted.readings(near.select(rows, with_table=False), unlike).items():
                out[name][rows] = (forces[name][rows] - force) ** 2 / 3.0
        return out

    def stating(self, numbers: Numbers) -> Predictor:
        """This predictor with the covariance of the numbers as the fit states it, which counts on other paths than the tested."""
        return replace(self, stated=root(numbers.covariance_of(self.names))) if self.curved else self

    def u_between(self, fitted: Tyre, conditions: pd.DataFrame, channel: str) -> float:
        """Standard uncertainty of the difference of the tyre's mean force between two conditions, [unit of the channel].

        Conditions that are not stated are those in the middle of their values.
        """
        points, own = self.points(fitted, conditions), self.channels[channel]
        if self.T_range is not None:
            points = points.replace(
                T=np.where(np.isfinite(points.T), points.T, np.mean(self._usual_temperatures()))
            )
        model = Simulation.of(fitted, turn_slip=self.curved).with_numbers(self.beside)
        slopes = model.sensitivities(points, self.names, [channel])[1][channel] * self._of_tyre
        middle = np.mean([*_settings(points, own.smooth.inputs)], axis=0)
        return own.u_between(middle, slopes)

    def least_known(self, fitted: Tyre, channel: str) -> str:
        """The coefficient that adds most to the uncertainty of a channel of the upright wheel at nominal load and no slip."""
        points = self.points(
            fitted, pd.DataFrame({"alpha_deg": [0.0], "gamma_deg": 0.0, "Fz_N": fitted["FNOMIN"]})
        )
        of_tyre = np.flatnonzero(self._of_tyre)
        names = [self.names[k] for k in of_tyre]
        slopes = Simulation.of(fitted, turn_slip=self.curved).sensitivities(points, names, [channel])[1][
            channel
        ]
        own = self.channels[channel]
        u = np.linalg.norm(own.root[len(own.missed) :][of_tyre], axis=1)
        return names[int(np.argmax(np.abs(slopes[0]) * u))]

    @property
    def _of_tyre(self) -> np.ndarray:
        """Mask (k,) of the numbers that are the tyre's."""
        return np.array([(error := error_of(name)) is None or error in BESIDE for name in self.names])

    def band(
        self, file: Simulation, fitted: Simulation, points: Points, channels: Iterable[str] | None = None
    ) -> Readings:
        """Half widths (n,) of the 95 % bands around a file for readings of a new run; arguments as in :meth:`forces`."""
        found = self.forces(file, fitted, points, channels)
        return Readings(**{name: COVERAGE_FACTOR_95 * one.u_file for name, one in found.items()})

    def beyond(self, fitted: Tyre, points: Points, names: Collection[str]) -> Readings:
        """By channel, the force (n,) of effects for which a property file has no coefficient."""
        file, points = Simulation.of(fitted, turn_slip=self.curved), self._held(points)
        whole, plain = (one.readings(points, names) for one in (file.with_numbers(self.beside), file))
        return Readings(**{name: whole[name] - plain[name] for name in names})

    def never_combined(self, points: Points, found: pd.DataFrame) -> list[tuple[str, ...]]:
        """For each of the points, the fields that were never tested together; ``found`` is their prediction.

        Empty where this is not the largest part of the uncertainty of any channel with a proven model error.
        """
        out: list[tuple[str, ...]] = [()] * len(points)
        for name, own in ((name, own) for name, own in self.channels.items() if own.is_proven):
            settings, best = _stated(points, own.smooth.inputs), column(name, "best")
            never = own.combinations.at(settings) * found[best].to_numpy() ** 2
            rows = np.flatnonzero(2.0 * never > found[f"u_{best}"].to_numpy() ** 2)
            for row, names in zip(rows.tolist(), own.combinations.untested(settings[rows]), strict=True):
                out[row] = out[row] or names
        return out

    def missed(self, name: str, points: Points) -> np.ndarray:
        """The estimated model error (n,) of a channel, rolling either way, averaged over conditions that are not stated."""
        channel, sign, points = self.channels[name], turned(points, name), forwards(points)
        left = self._left(channel, points)
        return np.asarray(sign * left.share * channel.mean(_stated(points, channel.smooth.inputs)))

    def u_missed(self, name: str, fitted: Simulation, points: Points) -> np.ndarray:
        """Standard uncertainty (n,) of what formula and model error give together for a reading of the same rig."""
        channel, slopes = self.channels[name], fitted.sensitivities(points, self.names, (name,))[1][name]
        at = _stated(forwards(points), channel.smooth.inputs)
        return channel.u(at, turned(points, name)[:, None] * slopes)

    def _left(self, channel: MissedChannel, points: Points) -> Remaining:
        """What is left of a channel's model error, by the rule of :class:`tir.correction.Correction`."""
        slip = np.zeros(len(points))
        if "kappa" not in [one.name for one in channel.smooth.inputs]:
            slip = slip_beyond(points.kappa, points.alpha, *self._shown.get("kappa", (0.0, 0.0)))
        return Remaining(np.asarray(share_of_load(points.Fz, max(self.lowest_load, 1e-9))), slip)

    def points(self, tyre: Tyre, conditions: pd.DataFrame) -> Points:
        """The conditions as points; a missing temperature is NaN, other missing conditions get nominal values."""
        speed = float(tyre["LONGVL"])

        def stated(name: str, otherwise: float) -> np.ndarray:
            if name not in conditions:
                return np.full(len(conditions), otherwise)
            values = conditions[name].to_numpy(dtype=float)
            return np.where(np.isfinite(values), values / OF_SI.get(UNITS[name], 1.0), otherwise)

        return make_points(
            stated("alpha_deg", np.nan),
            stated("gamma_deg", np.nan),
            stated("Fz_N", np.nan),
            kappa=stated("kappa", 0.0),
            p=stated("p_kPa", float(tyre["NOMPRES"])),
            V=stated("V_mps", float(np.clip(speed, *self.V_range)) if self.follows_speed else speed),
            phi_t=stated(PATH, self.path) if self.curved else 0.0,
            T=stated("T_degC", np.nan),
        )

    def _missed(
        self, channel: MissedChannel, points: Points, force: np.ndarray, slopes: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Model error (n,), variance of the force (n,) and of a reading (n,), averaged over conditions that are not stated.

        The variance of a reading includes the scatter over the conditions that are not stated.
        """
        left, by_numbers = self._left(channel, points), channel.by_numbers(slopes, self._of_tyre)
        found = [
            channel.at(settings, force, by_numbers, left)
            for settings in _settings(points, channel.smooth.inputs)
        ]
        means, variances, readings = (np.array(own) for own in zip(*found, strict=True))
        return means.mean(axis=0), variances.mean(axis=0), readings.mean(axis=0) + means.var(axis=0)


def _mixed(each: Sequence[PredictedForce]) -> PredictedForce:
    """The prediction for an unstated condition that is one of several."""
    best = np.array([one.best for one in each])
    variance, of_run, of_setup = (
        np.mean([getattr(one, name) for one in each], axis=0) for name in ("variance", "of_run", "of_setup")
    )
    scatter = best.var(axis=0)
    return PredictedForce(each[0].file, best.mean(axis=0), variance, of_run + scatter, of_setup + scatter)


def _settings(points: Points, inputs: Sequence[Input]) -> Iterator[np.ndarray]:
    """The conditions (n, d), once for every combination of values of the conditions that are not stated."""
    stated = _stated(points, inputs)
    unstated = ~np.all(np.isfinite(stated), axis=0)
    each = (one.averaged if asked else () for one, asked in zip(inputs, unstated, strict=True))
    for values in itertools.product(*(own or (np.nan,) for own in each)):
        yield np.where(np.isfinite(stated), stated, values)


def _stated(points: Points, inputs: Sequence[Input]) -> np.ndarray:
    """The conditions (n, d), NaN where they are not stated."""
    unstated = np.full(len(points), np.nan)
    columns = [getattr(points, one.name, unstated) for one in inputs]
    return np.array(columns, dtype=float).reshape(len(inputs), len(points)).T


def predictor(
    points: Points,
    left: LinearisedFit,
    rig: Mapping[str, float],
    known: Collection[str] = (),
    terms: Collection[str] = (),
    setups: Mapping[str, float] = MappingProxyType({}),
) -> Predictor:
    """The predictor of a build, from the linear model of its residuals and the fitted rig errors.

    Rig errors ``known`` are taken as exact, to find how much they widen the bands. ``terms`` are names of the temperature terms
    of the fit, with their reference. ``setups`` are standard deviations of zeros from set-up to set-up.
    """
    # Coefficients, terms of speed, and rig errors that a further run shares with the readings: calibrations and lasting zeros.
    kept = [
        i
        for i, n in enumerate(left.numbers)
        if (error := error_of(n.name)) is None
        or (n.name == error.name and (error.has_prior or error.counts_from == V_REF))
    ]
    spread = {
        i: 0.0 if number.name in known else number.spread
        for i, number in enumerate(left.numbers)
        if number.held or number.name in known
    }
    channels = {
        name: MissedChannel(
            own.smooth,
            own.components,
            own.missed,
            root_with_held(own, kept, spread),
            own.noise,
            own.size,
            left.growths[name],
            left.combinations[name],
            own.is_proven,
        )
        for name, own in left.channels.items()
    }
    names = tuple(left.numbers[i].name for i in kept)
    V_range = float(np.min(points.V)), float(np.max(points.V))
    beside = {name: rig[name] for name in (*(error.name for error in BESIDE), *terms) if name in rig}
    T_range = (float(np.nanmin(points.T)), float(np.nanmax(points.T))) if terms else None
    zeros = _largest_zeros(rig, known)
    return Predictor(
        main_path(points), names, channels, zeros, beside, V_range, T_range, float(np.min(points.Fz)), setups
    )


def _largest_zeros(rig: Mapping[str, float], known: Collection[str]) -> dict[str, float]:
    """By rig error, the zero that lies farthest from 0 of all set-ups; none of those that are ``known``."""
    zeros: dict[str, float] = {}
    for number, value in rig.items():
        error = error_of(number)
        if error in ZEROS and number not in known and abs(value) >= abs(zeros.get(error.name, 0.0)):
            zeros[error.name] = value
    return zeros


def root_with_held(own: LinearisedChannel, kept: Sequence[int], spread: Mapping[int, float]) -> np.ndarray:
    """Root (m + k, r) of the covariance of the functions' weights and the numbers ``kept``.

    Numbers that the fit took as exact are not updated by the readings: they keep their prior standard deviation ``spread`` (by
    index among all numbers), and the other numbers are conditioned on them.
    """
    functions, found = len(own.missed), own.posterior.root
    of_numbers = own.turn @ found[functions:]
    whole = np.vstack([found[:functions], of_numbers[kept]])
    if not spread:
        return whole
    held = of_numbers[list(spread)]
    back = np.linalg.pinv(held, rcond=1e-9)
    follow = whole @ back  # regression on the held numbers; the identity for these themselves
    return np.hstack([whole - follow @ held, follow * [*spread.values()]])
