"""Errors of camber, load, path and longitudinal slip between the set-points and the true conditions of the tyre."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from mffit.rig_errors import constants
from mffit.rig_errors.record import RADIANS, Appearance, Declared, Place, RigError, Slopes, calibration

_of_camber = partial(RigError, kind="rig", place=Place.CAMBER, acts_on=("gamma",), limits=(-5.0, 5.0))

CAMBER_GAIN = calibration(
    "gamma",
    "gain_gamma",
    "true camber = gain_gamma times the reading, before its zero is added",
    u=constants.ANGLE_GAIN,
    place=Place.CAMBER,
    slopes=lambda at: Slopes(C_gamma=1.0),
)
LOAD_GAIN = calibration(
    "Fz", "gain_Fz", "true load = gain_Fz times the reading", place=Place.LOAD, slopes=lambda at: at.over_load
)
CAMBER_ZERO = _of_camber(
    name="gamma_0_deg",
    unit="deg",
    meaning="true camber = reading + gamma_0",
    formula=lambda zero, gamma, at: gamma + zero * RADIANS,
    spread=0.4,
    of_setup=True,
    seen_as=Appearance(
        id="camber-misalignment",
        name="camber axis misaligned",
        physics="The camber axis reads zero while the wheel leans a little.",
        remedy="lean the wheel by {opposite} deg at its reading of zero and call that zero; or add {value} deg "
        "to all readings of the camber angle",
        axes=("gamma",),
    ),
    declared=Declared(
        key="u_camber_alignment_deg",
        unit="deg",
        default=constants.CAMBER_ZERO,
        source="camber alignment",
        force_at_zero=lambda zero, at: RADIANS * at.C_gamma * zero,
    ),
)
CAMBER_ZERO_LOAD = _of_camber(
    name="gamma_0_deg_per_kN",
    unit="deg/kN",
    meaning="true camber = reading + gamma_0_deg_per_kN (load - FNOMIN)",
    formula=lambda growth, gamma, at: gamma + growth * (RADIANS * 1e-3) * (at.points.Fz - at.nominal_load),
    spread=0.3,
    seen_as=Appearance(
        id="camber-zero-load",
        name="camber zero that changes with load",
        physics="The frame gives way under the load, so that the wheel leans a little.",
        needs=("loads",),
        remedy="stiffen the frame or measure the camber under load; or add {value} deg per kN above the nominal load to "
        "the readings of the camber angle",
        axes=("gamma",),
    ),
)
DISC_TILT = _of_camber(
    name="disc_tilt_deg_per_kN",
    unit="deg/kN",
    meaning="true camber = reading + disc_tilt load, with the sign of phi_t: the disc gives way under the wheel",
    formula=lambda growth, gamma, at: (
        gamma + growth * (RADIANS * 1e-3) * np.sign(at.points.phi_t) * at.points.Fz
    ),
    spread=0.2,
    seen_as=Appearance(
        id="disc-tilt",
        name="tilt of the disc under load",
        physics="The load bends the disc down at the contact, so that its surface leans under the wheel.",
        needs=("curved", "loads"),
        remedy="support the disc under the contact; or measure its tilt of {value} deg per kN with a dial gauge",
    ),
    declared=Declared(
        key="u_disc_tilt_deg_per_kN",
        unit="deg/kN",
        default=0.0,
        source="tilt of the disc",
        force_at_zero=lambda tilt, at: RADIANS * 1e-3 * at.C_gamma * at.load * tilt,
    ),
)
LOAD_CAMBER = RigError(
    name="load_camber",
    shown_in=("%", 100.0),
    unit="-",
    meaning="true load = reading times 1 + load_camber sin(true camber)^2",
    kind="rig",
    place=Place.LOAD,
    acts_on=("Fz",),
    formula=lambda share, Fz, at: Fz * (1.0 + share * np.sin(at.gamma) ** 2),
    spread=0.03,
    limits=(-0.5, 0.5),
    seen_as=Appearance(
        id="load-camber",
        name="load that changes with camber",
        physics="The load on the tyre falls, or rises, as the wheel leans, because its cell leans with it or is no longer "
        "above the contact point.",
        needs=("camber",),
        remedy="hold the load constant over camber by a cell under the disc; or multiply the reported load by 1 + {value} "
        "times the square of the sine of the camber angle",
    ),
)
LOAD_CAMBER_ODD = RigError(
    name="load_camber_odd",
    shown_in=("%", 100.0),
    unit="-",
    meaning="true load = reading times 1 + load_camber_odd sin(true camber)",
    kind="rig",
    place=Place.LOAD,
    acts_on=("Fz",),
    formula=lambda share, Fz, at: Fz * (1.0 + share * np.sin(at.gamma)),
    spread=0.02,
    limits=(-0.5, 0.5),
    seen_as=Appearance(
        id="load-camber-odd",
        name="load that differs between both sides of camber",
        physics="The load rises as the wheel leans to one side and falls to the other, because its cell carries part of the "
        "side force or stands beside the contact point.",
        needs=("camber",),
        remedy="set the cell of the load under the contact point; or multiply the reported load by 1 + {value} times the "
        "sine of the camber angle",
        axes=("gamma",),
    ),
)
PATH_RADIUS = RigError(
    name="path_radius_m",
    unit="m",
    meaning="true radius of the path",
    kind="rig",
    place=Place.PATH,
    acts_on=("phi_t",),
    # All paths share the error of the usual path's radius, because the distances between paths are known.
    formula=lambda radius, phi_t, at: np.sign(phi_t) / (radius + at.beyond_usual_path),
    undisturbed=math.nan,
    spread=0.03,
    limits=(0.1, 100.0),
    relative=True,
    seen_as=Appearance(
        id="path-radius",
        name="path radius",
        physics="The contact point runs on another radius than declared.",
        needs=("curved",),
        remedy="measure the four lengths of the path again; path_radius under [rig] should be {value} m",
    ),
    declared=Declared(key="u_path_radius", unit="m", default=None, source="path radius", value="radius"),
)
CROWN = RigError(
    name="crown_m",
    shown_in=("mm", 1e3),
    unit="m",
    meaning="the contact point is crown sin(true camber) to the right of where it is upright, on another radius of the disc",
    kind="rig",
    place=Place.PATH,
    acts_on=("phi_t",),
    formula=lambda crown, phi_t, at: phi_t / (1.0 - crown * phi_t * np.sin(at.gamma)),
    spread=0.05,
    limits=(-0.5, 0.5),
    seen_as=Appearance(
        id="crown",
        name="path radius that changes with camber",
        physics="A leaning wheel rolls on the side of its round tread, or leans about an axis above or below the road, so "
        "that its contact point moves over the disc.",
        needs=("curved", "camber"),
        remedy="move the wheel back over its path by {value} m times the sine of the camber angle",
        axes=("gamma",),
    ),
    declared=Declared(
        key="u_crown_m",
        unit="m",
        default=0.0,
        source="path radius that changes with camber",
        calibrates=lambda at: Slopes(C_gamma=at.spin_of_camber),
    ),
)
SLIP_ZERO = RigError(
    name="kappa_0",
    shown_in=("%", 100.0),
    unit="-",
    meaning="true longitudinal slip = reading + kappa_0",
    kind="rig",
    place=Place.SLIP,
    acts_on=("kappa",),
    formula=lambda zero, kappa, at: kappa + zero,
    spread=0.002,
    limits=(-0.1, 0.1),
    seen_as=Appearance(
        id="slip-zero",
        name="zero of longitudinal slip",
        physics="The slip reads zero while the wheel is driven or braked a little, because its rolling radius or a speed is "
        "not exactly known.",
        needs=("drive",),
        remedy="count slip from the speed of the freely rolling wheel; or add {value} to all readings of the slip, "
        "which is positive when driven",
    ),
    declared=Declared(key="u_slip_zero", unit="-", default=0.0, source="zero of slip"),
)

CONDITION_ERRORS = (
    CAMBER_GAIN,
    CAMBER_ZERO,
    CAMBER_ZERO_LOAD,
    DISC_TILT,
    LOAD_GAIN,
    LOAD_CAMBER,
    LOAD_CAMBER_ODD,
    PATH_RADIUS,
    CROWN,
    SLIP_ZERO,
)
