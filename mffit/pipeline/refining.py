"""The fit, and what it adds to the direct measurements: rejected readings, the bias of finite spin, stiffnesses at rest."""

from dataclasses import replace

import numpy as np

from mffit import fit as fitting
from mffit.comparison.characteristics import characteristics
from mffit.config import Config, axis_signs
from mffit.config.loading import as_declared
from mffit.errors import InputError
from mffit.fit import FitResult
from mffit.fit.coefficients import with_u
from mffit.measured import Measured
from mffit.measured.constants import SPIN_BIAS_OF_MODEL
from mffit.measured.result import AfterFit
from mffit.parts import Parts
from mffit.pipeline.measuring import epsilon_gamma, measure, without_play
from mffit.points import Points
from mffit.points.loading import Reading
from mffit.progress import Progress
from mffit.quantities import KEYS, SIDEWAYS
from mffit.rig import Simulation
from mffit.rig_errors import NO_FAULTS
from mffit.suspicion.all_files import angles_exchanged, angles_fit_exchanged
from mffit.suspicion.rereadings import ANGLES_EXCHANGED
from tir import Quantity, Tyre


def fit_and_measure(
    config: Config, reading: Reading, parts: Parts, before: Measured, base: Tyre | None, progress: Progress
) -> tuple[Measured, FitResult]:
    """The fit, and the direct measurements with what the fit adds to them.

    ``before`` are the measurements without a fit. The fit is repeated if its outliers, or its bias of finite spin, change the
    eps_gamma that it holds.
    """
    points = reading.points

    def fit(measured: Measured) -> FitResult:
        return fitting.fit(config, points, parts, measured, base, progress, reading.steps)

    fitted = fit(before)
    sound = without_outliers(points, fitted)
    if sound is not points:
        again = measure(config, sound, base)[1]
        if again != before:
            before, fitted = again, fit(again)
    spin = spin_of_model(config, points, before, undistorted(config, fitted), base)
    if spin is not None and before.carried is not None and before.carried.source == "debiased":
        before = measure(config, sound, base, AfterFit(spin=spin))[1]
        fitted = fit(before)
    after = measure(config, sound, base, _after(config, points, before, fitted, spin))[1]
    own = fitted.coefficients["PECP1"]
    # the bias of finite spin is known better than before the fit
    if after.carried is not None and own.stderr is not None:
        stated = {**fitted.coefficients, "PECP1": with_u(own, after.carried.pecp1.u)}
        fitted = replace(fitted, coefficients=stated)
    return after, fitted


def refuse_exchanged_angles(
    config: Config, reading: Reading, base: Tyre | None, fitted: FitResult, progress: Progress
) -> None:
    """Raise InputError if the readings look as if sideslip and camber were exchanged, and a fit to them read so agrees."""
    if not any(True for _ in angles_exchanged.find(reading.points, config)):
        return
    points = ANGLES_EXCHANGED.undone(reading.points, axis_signs(config))
    try:
        parts, before = measure(config, points, base)
        other = fitting.fit(config, points, parts, before, base, progress, reading.steps)
    except InputError:
        return
    misfits = [{name: one.rmse for name, one in fit.channels.items()} for fit in (fitted, other)]
    with as_declared(config):
        for facts in angles_fit_exchanged.find(*misfits):
            raise angles_fit_exchanged.refusal(facts)


def _after(
    config: Config, points: Points, before: Measured, fitted: FitResult, spin: Quantity | None
) -> AfterFit:
    """What a fit adds to the measurements ``before`` it."""
    stiffnesses = {} if config.rig.on_disc else on_straight_path(config, points, before, fitted)
    if config.rig.on_disc and before.nominal is not None:
        straight = fitting.straight_cornering_stiffness(fitted, points, before.nominal)
        if straight is not None:
            load = before.nominal.load
            missed = of_forces(fitted, load, turn_slip=True)[KEYS["C_alpha"]].u  # counts the model error
            u = max(straight.u, missed)
            stiffnesses = {load: {"C_alpha_straight": straight._replace(u=u, origin="fitted")}}
    stderr = fitted.coefficients["PECP1"].stderr
    pecp1 = Quantity(float(fitted.written["PECP1"]), stderr or 0.0, "-")
    return AfterFit(spin, fitted.epsilon_gamma_model, pecp1, stiffnesses)


def on_straight_path(
    config: Config, points: Points, before: Measured, fitted: FitResult
) -> dict[float, dict[str, Quantity]]:
    """By load [N], stiffnesses of the fitted model on a straight path; where sweeps moved, instead of the measured ones.

    The force lags behind a moving angle, and few readings at rest hardly show a slope. The fit separates
    the lag from the tyre. They are then stated at the nominal load, too, which is that of a build's headline.
    """
    keys, loads = {"C_alpha_straight": KEYS["C_alpha"]}, [row.load for row in before.per_load]
    if np.any(np.isfinite(points.time) & points.free_rolling):
        keys |= {name: KEYS[name] for name in ("C_alpha", "C_gamma")}
        loads.append(config.tyre.nominal_load)
    found = {}
    for load in loads:
        numbers = of_forces(fitted, load, turn_slip=False)
        named = {name: numbers[key] for name, key in keys.items()}
        found[load] = {name: q._replace(origin="fitted") for name, q in named.items() if q.u}
    return found


def of_forces(fitted: FitResult, load: float, *, turn_slip: bool) -> dict[str, Quantity]:
    """The characteristics of the fitted tyre at a load [N], with their uncertainties."""
    return characteristics(
        fitted.tyre, load, turn_slip=turn_slip, known=fitted.posterior, predictor=fitted.prediction
    )


def without_outliers(points: Points, fitted: FitResult) -> Points:
    """The points without the readings of Fy and Mz that the fit rejected; the same record if it rejected none."""
    if not fitted.outliers:
        return points
    readings = {}
    for channel in SIDEWAYS:
        rejected = [outlier.row for outlier in fitted.outliers if outlier.channel == channel]
        readings[channel] = np.where(
            np.isin(np.arange(len(points)), rejected), np.nan, getattr(points, channel)
        )
    return points.replace(**readings).select(np.isfinite(readings["Fy"]))


def spin_of_model(
    config: Config, points: Points, before: Measured, simulation: Simulation | None, base: Tyre | None
) -> Quantity | None:
    """Bias of finite spin over (1 - eps_gamma) phi_t^2 [m^2], by a fitted model; None if eps_gamma was not measured."""
    row, bias = before.nominal, finite_spin_bias(config, points, simulation, base)
    if bias is None or row is None or row.epsilon_gamma is None:
        return None
    size = bias / ((1.0 - row.epsilon_gamma.value) * row.paths[0] ** 2)
    return Quantity(size, float(SPIN_BIAS_OF_MODEL) * abs(size), "m^2")


def finite_spin_bias(
    config: Config, points: Points, simulation: Simulation | None, base: Tyre | None
) -> float | None:
    """Bias of eps_gamma of the direct method due to finite spin on a disc; None without a disc.

    The method is applied to noise-free readings of a rig without errors, of a model whose eps_gamma is known.
    """
    if simulation is None:
        return None
    readings = replace(simulation, faults=NO_FAULTS, of_parts={}).readings(points)
    found = epsilon_gamma(without_play(config), points.replace(**readings), base)
    return None if found is None else found.value - float(simulation.values["PECP1"])


def undistorted(config: Config, fitted: FitResult) -> Simulation | None:
    """The fitted model with a PECP1 that the points determine, as the bias needs it; None without turn slip."""
    if not config.rig.on_disc or fitted.epsilon_gamma_model is None:
        return None
    assert fitted.search is not None
    return fitting.with_free_epsilon(fitted.search)
