"""Errors between the sideslip angle as read and the true one, in the order in which they act."""

from __future__ import annotations

from functools import partial

import numpy as np

from mffit.rig_errors import constants
from mffit.rig_errors.record import RADIANS, Appearance, Declared, Place, RigError, Slopes, calibration

_of_angle = partial(RigError, kind="rig", place=Place.ANGLE, acts_on=("alpha",))

SIDESLIP_GAIN = calibration(
    "alpha",
    "gain_alpha",
    "true sideslip angle = gain_alpha times the reading, before its zero is added",
    u=constants.ANGLE_GAIN,
    place=Place.ANGLE,
    slopes=lambda at: Slopes(C_alpha=1.0),
)
RELAXATION = RigError(
    name="relaxation_m",
    unit="m",
    meaning="relaxation length sigma of moving sweeps: sigma d(alpha')/ds + alpha' = alpha; the force follows alpha'",
    kind="tyre",
    place=Place.ANGLE,
    acts_on=("alpha",),
    formula=lambda sigma, alpha, at: at.lagged(alpha, sigma),
    spread=0.2,
    scan=(0.05, 0.15, 0.3),
    limits=(0.0, 2.0),
    known_sign=1,
    seen_as=Appearance(
        id="relaxation",
        name="relaxation length",
        physics="Side force builds up over a rolled distance, so a moving sweep lags behind its angle.",
        needs=("continuous",),
    ),
)
SIDESLIP_ZERO = _of_angle(
    name="alpha_0_deg",
    unit="deg",
    meaning="true sideslip angle = reading + alpha_0",
    formula=lambda zero, alpha, at: alpha + zero * RADIANS,
    spread=0.2,
    limits=(-5.0, 5.0),
    of_setup=True,
    seen_as=Appearance(
        id="sideslip-misalignment",
        name="sideslip axis misaligned",
        physics="The steering axis reads zero while the wheel runs at a small sideslip angle.",
        remedy="turn the steering axis by {opposite} deg at its reading of zero and call that zero; or add {value} deg "
        "to all readings of the sideslip angle",
        axes=("alpha",),
    ),
    seen_per_run=Appearance(
        id="run-offsets-alpha",
        name="sideslip zero that differs from run to run",
        physics="The steering axis is set up again before every run, each time at a slightly different angle.",
        needs=("runs",),
        remedy="set the steering axis up against a stop before every run; or add the values of the table to the "
        "readings of each run",
        spread=0.1,
    ),
    declared=Declared(
        key="u_slip_alignment_N",
        unit="N",
        default=constants.SIDESLIP_FORCE,
        source="sideslip alignment",
        force_at_zero=lambda force, at: force,
        turns_with_direction=True,
    ),
)
HYSTERESIS = _of_angle(
    name="hysteresis_deg",
    unit="deg",
    meaning="true sideslip angle = reading - hysteresis sense, sense 1 or -1 as the sweep goes up or down",
    formula=lambda width, alpha, at: alpha - width * (RADIANS * at.sense),
    known_sign=1,
    spread=0.1,
    limits=(-2.0, 2.0),
    seen_as=Appearance(
        id="hysteresis",
        name="hysteresis of sideslip sweeps",
        physics="The force lags behind the angle as read, by a fixed angle in either sense of the sweep.",
        needs=("senses",),
        remedy="free the sideslip drive; or subtract {value} deg from its readings where they rise and add it where "
        "they fall",
    ),
)
COMPLIANCE = _of_angle(
    name="compliance_deg_per_Nm",
    unit="deg/Nm",
    meaning="true sideslip angle = reading + compliance Mz",
    formula=lambda give, alpha, at: at.turned_by_moment(alpha, give * RADIANS),
    spread=0.004,
    limits=(-0.05, 0.05),
    seen_as=Appearance(
        id="steering-compliance",
        name="compliance of the steering axis",
        physics="The aligning moment turns the wheel a little, as the steering and its frame are not rigid.",
        needs=("moment", "slip"),
        remedy="stiffen the steering; or add {value} deg for every Nm of the reported moment to its readings",
        axes=("alpha", "Mz"),
    ),
    declared=Declared(
        key="u_steering_compliance_deg_per_Nm",
        unit="deg/Nm",
        default=0.0,
        source="steering compliance",
        calibrates=lambda at: Slopes(*(RADIANS * share for share in at.by_moment)),
    ),
)
BACKLASH = _of_angle(
    name="backlash_deg",
    unit="deg",
    meaning="full play; true sideslip angle = reading - play/2 sign(Mz)",
    formula=lambda play, alpha, at: at.held_in_play(alpha, 0.5 * RADIANS * play),
    spread=0.2,
    scan=(0.05, 0.15, 0.3),
    limits=(0.0, 3.0),
    seen_as=Appearance(
        id="backlash",
        name="backlash of the sideslip axis",
        physics="The moment on the wheel takes up the play of the steering, so the angle is off by half the play "
        "against the moment.",
        needs=("moment",),
        remedy="take the play of {value} deg out of the steering axis, or declare it as backlash_deg under [rig]",
    ),
    declared=Declared(
        key="u_backlash_deg",
        unit="deg",
        default=0.0,
        source="backlash",
        value="backlash_deg",
        force_at_zero=lambda play, at: 0.5 * RADIANS * at.C_alpha * at.side_of_play * play,
    ),
)
CAMBER_SKEW = _of_angle(
    name="camber_skew_deg",
    unit="deg",
    meaning="true sideslip angle = reading + camber_skew sin(true camber)",
    formula=lambda skew, alpha, at: alpha + skew * RADIANS * np.sin(at.gamma),
    spread=0.2,
    limits=(-5.0, 5.0),
    seen_as=Appearance(
        id="camber-skew",
        name="camber axis not square to the steering axis",
        physics="Leaning the wheel also steers it a little, as the camber axis is not square to the steering axis.",
        needs=("camber",),
        remedy="square the camber axis to the steering axis; or add {value} deg times the sine of the camber angle to all "
        "readings of the sideslip angle",
        axes=("alpha", "gamma"),
    ),
    declared=Declared(
        key="u_camber_skew_deg",
        unit="deg",
        default=constants.CAMBER_SKEW,
        source="camber skew",
        camber_stiffness=lambda skew, at: RADIANS * at.C_alpha * skew,
    ),
)

ANGLE_ERRORS = (SIDESLIP_GAIN, RELAXATION, SIDESLIP_ZERO, CAMBER_SKEW, HYSTERESIS, COMPLIANCE, BACKLASH)
