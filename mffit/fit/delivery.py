"""The property files of a fit, from fitted, measured and estimated values."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import reduce

import numpy as np

from mffit.config import Config, Declaration, declared_rig
from mffit.constants import USUAL_CORNERING_STIFFNESS
from mffit.fit.beside import BesideNumbers, with_beside
from mffit.fit.coefficients import Coefficient, coefficient_records
from mffit.fit.comments import file_comments
from mffit.fit.fitted import Fitted
from mffit.fit.known import Known, known_after_fit
from mffit.fit.relaxation import Relaxation, relaxation
from mffit.fit.wheel.rolling import FX_ZERO, MY_ZERO, Resistance, coasting, rolling_resistance
from mffit.fit.wheel.vertical import Vertical
from mffit.fit.written.files import Files, make_files
from mffit.numbers import Numbers
from mffit.points import Points
from tir import Tyre

NO_ZERO = Declaration(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Beside:
    """Sources of coefficients other than the main fit."""

    radii: Vertical  #: from loaded radius and wheel speed
    steps: Mapping[str, Points] = field(default_factory=dict)  #: samples of steps, by stepped setting


@dataclass(frozen=True, slots=True)
class Delivered:
    """The files of a fit and the records behind them."""

    known: Known  #: every value of the property file, with its origin
    coefficients: dict[str, Coefficient]
    files: Files
    relaxation: tuple[Relaxation, ...]  #: one per direction
    posterior: Numbers  #: of all coefficients and rig errors
    zeros: Mapping[str, tuple[float, float]]  #: zeros of My, with standard errors


def deliver(
    config: Config,
    known: Known,
    points: Points,
    base: Tyre | None,
    fitted: Fitted,
    beside: Beside,
    only: str | None = None,
) -> Delivered:
    """The files of a fit and the records of their coefficients; ``only`` limits the files to one use."""
    held = {name: fitted.simulation.values[name] for name in fitted.held}
    known = known_after_fit(known, fitted.values, fitted.regularised, held, base)
    rolling = _rolling_resistance(config, known, points)
    for name, q in rolling.found.items():
        known = known.having({name: q.value}, "regularised" if name in rolling.regularised else "fitted")
    lag = relaxation(beside.steps, fitted.simulation, fitted.posterior, known.hand.held)
    lags = {name: q for direction in lag for name, q in direction.found.items()}
    known = known.having({name: q.value for name, q in lags.items()}, "fitted")
    own: tuple[BesideNumbers, ...] = (
        beside.radii.beside,
        rolling.beside,
        *(direction.beside for direction in lag),
    )
    posterior = reduce(with_beside, own, fitted.posterior)
    found = {**rolling.found, **beside.radii.found, **lags}
    coefficients = coefficient_records(known, fitted, found)
    files = make_files(config, known, points, base, only=only)
    annotated = files.annotated(file_comments(files, known.origin, coefficients))
    return Delivered(known, coefficients, annotated, lag, posterior, rolling.zeros)


def _rolling_resistance(config: Config, known: Known, points: Points) -> Resistance:
    """Rolling resistance from the measured moment My or, without My, from Fx of the coasting wheel."""
    declared = declared_rig(config.rig, USUAL_CORNERING_STIFFNESS)
    hand, side = known.hand.held, config.tyre.side
    if np.any(np.isfinite(points.My)):
        u_gain = math.hypot(config.rig.u("gain_My"), config.rig.u("gain_Fz"))
        return rolling_resistance(known.values, points, declared.get(MY_ZERO, NO_ZERO), hand, side, u_gain)
    zero = declared.get(FX_ZERO, NO_ZERO)
    radius = float(known.values["UNLOADED_RADIUS"])
    of_moment = Declaration(zero.value * radius, zero.u * radius)
    u_gain = math.hypot(config.rig.u("gain_Fx"), config.rig.u("gain_Fz"))
    coasted = coasting(points, known.values)
    found = rolling_resistance(known.values, coasted, of_moment, hand, side, u_gain)
    return replace(found, zeros={})  # the zero of Fx is already a number of the main fit
