"""Influences of the environment and of wear on the tyre during the test."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from mffit.rig_errors import constants
from mffit.rig_errors.record import Appearance, Place, RigError
from tir.temperature import SCALED_BY

WARMTH = "(T - T_ref)"
T_REF = "T_ref_degC"
"""Number with the temperature at which the fitted model holds."""


def _warmed(k: Any, value: Any, at: Any) -> Any:
    """A force or a scaling factor times 1 + k (T - T_ref)."""
    return value * (1.0 + k * at.warmth)


_of_forces = partial(RigError, kind="environment", place=Place.ENVIRONMENT, acts_on=("Fy", "Mz"))
_of_temperature = partial(
    RigError,
    unit="1/K",
    kind="environment",
    formula=_warmed,
    limits=(-0.05, 0.05),
    known_sign=-1,
    counts_from=T_REF,
)
_of_run = partial(
    RigError,
    unit="-",
    kind="environment",
    place=Place.COEFFICIENTS,
    formula=lambda share, value, at: value * (1.0 + share),
    spread=0.02,
    limits=(-0.5, 0.5),
)

TEMPERATURE_GRIP = _of_temperature(
    name="k_T_grip_per_K",
    shown_in=("% per K", 100.0),
    meaning=f"friction times 1 + k {WARMTH}",
    place=Place.COEFFICIENTS,
    acts_on=(SCALED_BY["k_T_grip_per_K"],),
    spread=0.002,
    seen_as=Appearance(
        id="temperature-grip",
        name="friction with tyre temperature",
        physics="The friction of rubber depends on its temperature: the peak of the curves moves, their slope at zero "
        "stays.",
        needs=("temperatures",),
    ),
)
TEMPERATURE_GRIP_CURVATURE = RigError(
    name="k_T_grip_per_K2",
    unit="1/K^2",
    kind="environment",
    meaning=f"friction times 1 + k_T_grip_per_K {WARMTH} + k {WARMTH}^2",
    place=Place.COEFFICIENTS,
    acts_on=(SCALED_BY["k_T_grip_per_K2"],),
    formula=lambda k2, value, at: (
        value * (1.0 + k2 * at.warmth**2 / (1.0 + at.numbers["k_T_grip_per_K"] * at.warmth))
    ),
    spread=1e-4,
    limits=(-5e-3, 5e-3),
    counts_from=T_REF,
)
TEMPERATURE_STIFFNESS = _of_temperature(
    name="k_T_stiffness_per_K",
    shown_in=("% per K", 100.0),
    meaning=f"cornering stiffness times 1 + k {WARMTH}",
    place=Place.COEFFICIENTS,
    acts_on=(SCALED_BY["k_T_stiffness_per_K"],),
    spread=0.002,
    seen_as=Appearance(
        id="temperature-stiffness",
        name="cornering stiffness with tyre temperature",
        physics="Warm rubber is softer: the slope of the side force at zero changes, its peak stays.",
        needs=("temperatures",),
    ),
)
TEMPERATURE_CAMBER = _of_temperature(
    name="k_T_camber_per_K",
    word="camber stiffness with tyre temperature",
    shown_in=("% per K", 100.0),
    meaning=f"camber stiffness times 1 + k {WARMTH}",
    place=Place.COEFFICIENTS,
    acts_on=(SCALED_BY["k_T_camber_per_K"],),
    spread=0.002,
)
TEMPERATURE_DRIVE_GRIP = _of_temperature(
    name="k_T_drive_grip_per_K",
    meaning=f"longitudinal friction times 1 + k {WARMTH}",
    place=Place.COEFFICIENTS,
    acts_on=(SCALED_BY["k_T_drive_grip_per_K"],),
    spread=0.002,
)
TEMPERATURE_SLIP_STIFFNESS = _of_temperature(
    name="k_T_slip_stiffness_per_K",
    meaning=f"longitudinal slip stiffness times 1 + k {WARMTH}",
    place=Place.COEFFICIENTS,
    acts_on=(SCALED_BY["k_T_slip_stiffness_per_K"],),
    spread=0.005,
)
TEMPERATURE = _of_temperature(
    name="k_T_per_K",
    shown_in=("% per K", 100.0),
    meaning=f"Fy and Mz times 1 + k_T {WARMTH}",
    place=Place.ENVIRONMENT,
    acts_on=("Fy", "Mz"),
    spread=0.001,
    seen_as=Appearance(
        id="temperature",
        name="tyre temperature",
        physics="Warm rubber grips and stiffens differently: forces scale with temperature.",
        needs=("temperatures",),
        together_with=(T_REF,),
    ),
)
PRESSURE_ARM = RigError(
    name="k_p_arm_per_kPa",
    word="QSX3 over pressure",
    unit="1/kPa",
    kind="tyre",
    meaning="arm of the side force in Mx, QSX3, plus k (p - p_ref_kPa)",
    place=Place.COEFFICIENTS,
    acts_on=("QSX3",),
    formula=lambda k, QSX3, at: QSX3 + k * at.pressure_above_reference,
    spread=5e-4,
    limits=(-0.01, 0.01),
    counts_from="p_ref_kPa",
    seen_as=Appearance(
        id="overturning-pressure",
        name="overturning moment of the side force over pressure",
        physics="A harder tyre moves less sideways under a side force, so that the load stays nearer to the middle of the "
        "wheel; MF 6.2 has a term of pressure for camber only (PPMX1).",
        needs=("pressures", "overturning"),
    ),
)
RUN_GRIP = _of_run(
    name="run_grip",
    meaning="friction times 1 + run_grip, a number of every run",
    acts_on=(SCALED_BY["k_T_grip_per_K"],),
)
RUN_STIFFNESS = _of_run(
    name="run_stiffness",
    meaning="cornering stiffness times 1 + run_stiffness, a number of every run",
    acts_on=(SCALED_BY["k_T_stiffness_per_K"],),
)
SWEEP_HEATING = RigError(
    name="sweep_heating",
    shown_in=("%", 100.0),
    unit="-",
    kind="environment",
    meaning="friction times 1 + sweep_heating q, q from 0 at the first point of a sweep to 1 at its last",
    place=Place.COEFFICIENTS,
    acts_on=(SCALED_BY["k_T_grip_per_K"],),
    formula=lambda change, value, at: value * (1.0 + change * at.along_sweep),
    spread=0.02,
    limits=(-0.5, 0.5),
    seen_as=Appearance(
        id="sweep-heating",
        name="heating within a sweep",
        physics="The tread warms during every sweep and cools between sweeps: its friction changes along the sweep.",
        needs=("slip",),
    ),
)
REFERENCE_TEMPERATURE = RigError(
    name=T_REF,
    word="temperature at which the model holds",
    unit="degC",
    meaning="temperature at which the model holds, T_ref; the mean of the data unless it is fitted",
    kind="environment",
    place=None,
    undisturbed=constants.REFERENCE_TEMPERATURE,
    spread=10.0,
    limits=(-40.0, 200.0),
)
REFERENCE_PRESSURE = RigError(
    name="p_ref_kPa",
    word="pressure at which the model holds",
    unit="kPa",
    meaning="pressure at which the model holds; NOMPRES unless a build states it",
    kind="tyre",
    place=None,
    undisturbed=math.nan,
    spread=20.0,
    limits=(1.0, 1e4),
)
SPEED = _of_forces(
    name="k_V_per_mps",
    shown_in=("% per m/s", 100.0),
    unit="s/m",
    meaning="Fy and Mz times 1 + k_V (V - V_ref), V_ref the most frequent speed",
    formula=lambda k, force, at: force * (1.0 + k * at.speed_above_usual),
    spread=0.005,
    limits=(-0.2, 0.2),
    seen_as=Appearance(
        id="speed",
        name="speed",
        physics="Friction and carcass depend on speed: forces scale with it.",
        needs=("speeds",),
    ),
)
DRIFT = _of_forces(
    name="k_t_per_s",
    shown_in=("% per hour", 3.6e5),
    unit="1/s",
    meaning="Fy and Mz times 1 + k_t t, t the time at which the point was taken",
    formula=lambda k, force, at: force * (1.0 + k * at.time),
    spread=1e-6,
    limits=(-1e-3, 1e-3),
    seen_as=Appearance(
        id="drift",
        name="drift over the test",
        physics="Wear and ageing change the forces with time.",
        needs=("times",),
    ),
)
WEAR = _of_forces(
    name="wear_per_km",
    shown_in=("% per km", 100.0),
    unit="1/km",
    meaning="Fy and Mz times 1 + wear s, s the distance rolled",
    formula=lambda wear, force, at: force * (1.0 + wear * at.distance_km),
    spread=3e-4,
    limits=(-0.1, 0.1),
    seen_as=Appearance(
        id="wear",
        name="wear over the distance rolled",
        physics="The tread wears with every kilometre, which changes the forces.",
        needs=("distances",),
    ),
)
WARM_UP = _of_forces(
    name="warm_up",
    shown_in=("%", 100.0),
    unit="-",
    meaning="Fy and Mz times 1 - warm_up exp(-s/1 km), s the distance rolled",
    formula=lambda share, force, at: force * (1.0 - share * np.exp(-at.distance_km)),
    spread=0.03,
    limits=(-0.5, 0.5),
    seen_as=Appearance(
        id="warm-up",
        name="warm-up at the start",
        physics="A tyre that starts cold has other forces until it has rolled about a kilometre.",
        needs=("times",),
    ),
)

COEFFICIENT_ERRORS = (
    REFERENCE_TEMPERATURE,
    REFERENCE_PRESSURE,
    TEMPERATURE_GRIP,
    TEMPERATURE_GRIP_CURVATURE,
    TEMPERATURE_STIFFNESS,
    TEMPERATURE_CAMBER,
    TEMPERATURE_DRIVE_GRIP,
    TEMPERATURE_SLIP_STIFFNESS,
    PRESSURE_ARM,
    RUN_GRIP,
    RUN_STIFFNESS,
    SWEEP_HEATING,
)
ENVIRONMENT_ERRORS = (TEMPERATURE, DRIFT, WEAR, WARM_UP, SPEED)
