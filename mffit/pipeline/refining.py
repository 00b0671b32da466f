"""What a fit changes in the direct measurements: rejected readings, and the bias of finite spin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mffit import fit as fitting
from mffit.config import Config
from mffit.fit import FitResult
from mffit.measured import Measured
from mffit.pipeline.measuring import epsilon_gamma, measure, without_play
from mffit.points import Points
from mffit.quantities import SIDEWAYS
from mffit.rig import Simulation
from mffit.rig_errors import NO_FAULTS
from tir import Tyre


def without_outliers(
    config: Config, points: Points, measured: Measured, fitted: FitResult, base: Tyre | None
) -> Measured | None:
    """The direct method without the readings that the fit rejected; None if they make no difference."""
    if not fitted.outliers:
        return None
    readings = {}
    for channel in SIDEWAYS:
        rejected = [outlier.row for outlier in fitted.outliers if outlier.channel == channel]
        readings[channel] = np.where(
            np.isin(np.arange(len(points)), rejected), np.nan, getattr(points, channel)
        )
    sound = points.replace(**readings).select(np.isfinite(readings["Fy"]))
    again = measure(config, sound, base)[1]
    return None if again == measured else again


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
