"""Errors of the load cells: between the force of the tyre and its reading, in the order in which they act."""

from __future__ import annotations

from functools import partial

import numpy as np

from mffit.rig_errors import constants
from mffit.rig_errors.record import Appearance, Declared, Place, RigError, Slopes, calibration

_of_reading = partial(RigError, kind="rig", place=Place.FORCE)
_zero_of = partial(_of_reading, formula=lambda zero, reading, at: reading + zero, of_setup=True)
FORCE = "reported Fy = gain Fy + F0 + crosstalk Fz"


def _crosstalk(force: str, moment: str, *, spread: float, appearance: Appearance) -> RigError:
    """The error by which part of a force appears in a moment, with an arm [m] of usual size ``spread``."""
    return _of_reading(
        name=f"crosstalk_{force}_{moment}_m",
        shown_in=("mm", 1e3),
        unit="m",
        meaning=f"reported {moment} = {moment} + crosstalk_{force}_{moment} {force}",
        acts_on=(moment,),
        formula=lambda arm, reading, at: reading + arm * at.true[force],
        reads=(force,),
        spread=spread,
        limits=(-0.1, 0.1),
        seen_as=appearance,
        declared=Declared(
            key=f"u_{force}_into_{moment}_m",
            unit="m",
            default=0.0,
            source=f"crosstalk of {force} into {moment}",
        ),
    )


GAIN = calibration(
    "Fy",
    "gain",
    FORCE,
    slopes=lambda at: Slopes(1.0, 1.0, 1.0),
    seen_as=Appearance(
        id="loadcell-gain",
        name="calibration of Fy",
        physics="The side-force channel reads a few per cent too much or too little.",
        remedy="calibrate the side-force channel; or divide its readings by {value}",
    ),
)
NONLINEARITY = _of_reading(
    name="nonlinearity_per_kN",
    shown_in=("% per kN", 100.0),
    unit="1/kN",
    meaning="reported Fy times 1 + nonlinearity |Fy|",
    acts_on=("Fy",),
    formula=lambda growth, Fy, at: Fy * (1.0 + 1e-3 * growth * abs(Fy)),
    spread=0.01,
    limits=(-0.2, 0.2),
    seen_as=Appearance(
        id="loadcell-nonlinearity",
        name="nonlinearity of the Fy load cell",
        physics="The side-force channel reads large forces a little larger, or smaller, than in proportion.",
        needs=("slip",),
        remedy="calibrate the side-force channel at large forces: its readings grow by {value} per kN too much",
    ),
)
CROSSTALK = _of_reading(
    name="crosstalk",
    shown_in=("%", 100.0),
    unit="-",
    meaning=FORCE,
    acts_on=("Fy",),
    formula=lambda share, Fy, at: Fy + share * at.Fz,
    spread=0.01,
    limits=(-0.3, 0.3),
    seen_as=Appearance(
        id="crosstalk-fz-fy",
        name="crosstalk of Fz into Fy",
        physics="Part of the vertical load appears in the side-force channel.",
        needs=("loads",),
        remedy="level the load cell or calibrate its cross terms; or subtract {value} of the load from the side force",
        axes=("Fy",),
    ),
)
CROSSTALK_CAMBER = _of_reading(
    name="crosstalk_camber",
    shown_in=("%", 100.0),
    unit="-",
    meaning="reported Fy = Fy + crosstalk_camber sin(true camber) Fz",
    acts_on=("Fy",),
    formula=lambda share, Fy, at: Fy + share * np.sin(at.gamma) * at.Fz,
    spread=0.01,
    limits=(-0.3, 0.3),
    seen_as=Appearance(
        id="crosstalk-camber",
        name="crosstalk of Fz into Fy that grows with camber",
        physics="The load cell leans with the wheel, and its axes lean by more or less than the camber that is read, or its "
        "channels along and across the wheel are not calibrated alike.",
        needs=("camber",),
        remedy="turn the axes of the load cell into those of the wheel; or subtract {value} of the load times the sine of "
        "the camber angle from the side force",
        axes=("Fy", "gamma"),
    ),
    declared=Declared(
        key="u_crosstalk_camber",
        unit="-",
        default=0.0,
        source="crosstalk that grows with camber",
        calibrates=lambda at: Slopes(C_gamma=at.load_of_camber),
    ),
)
DIRECTION_ZERO = _of_reading(
    name="F0_direction_N",
    unit="N",
    meaning="reported Fy = Fy + F0_direction rolling forwards, Fy - F0_direction backwards",
    acts_on=("Fy",),
    formula=lambda zero, Fy, at: Fy + zero * at.points.direction,
    spread=5.0,
    limits=(-1e3, 1e3),
    seen_as=Appearance(
        id="loadcell-offset-direction",
        name="load-cell zero of Fy that differs by direction",
        physics="Friction or heat of a bearing between wheel and load cell turns with the direction of rolling.",
        needs=("directions",),
        remedy="zero the side-force channel in both directions of rolling; or subtract {value} N from forward readings and "
        "add it to backward ones",
        axes=("Fy",),
    ),
)
FORCE_ZERO = _zero_of(
    name="F0_N",
    unit="N",
    meaning=FORCE,
    acts_on=("Fy",),
    spread=10.0,
    limits=(-1e3, 1e3),
    seen_as=Appearance(
        id="loadcell-offset-fy",
        name="load-cell zero of Fy",
        physics="The side-force load cell was zeroed while the tyre was still deformed.",
        remedy="zero the side-force channel with the tyre off the ground; or subtract {value} N from its readings",
        axes=("Fy",),
    ),
    seen_per_run=Appearance(
        id="run-offsets-fy",
        name="load-cell zero of Fy that differs from run to run",
        physics="The side-force load cell is zeroed before every run, each time a little differently.",
        needs=("runs",),
        remedy="zero the side-force channel in the same state before every run; or subtract the value of the table from "
        "each run",
        spread=5.0,
    ),
    declared=Declared(
        key="u_loadcell_offset_N",
        unit="N",
        default=constants.LOADCELL_ZERO,
        source="load-cell offset",
        force_at_zero=lambda zero, at: zero,
    ),
)
MOMENT_ZERO = _zero_of(
    name="M0_Nm",
    unit="Nm",
    meaning="reported Mz = Mz + M0",
    acts_on=("Mz",),
    spread=1.0,
    limits=(-1e2, 1e2),
    seen_as=Appearance(
        id="loadcell-offset-mz",
        name="load-cell zero of Mz",
        physics="The moment load cell was zeroed while the tyre was still twisted.",
        needs=("moment",),
        remedy="zero the moment channel with the tyre off the ground; or subtract {value} Nm from its readings",
        axes=("Mz",),
    ),
    seen_per_run=Appearance(
        id="run-offsets-mz",
        name="load-cell zero of Mz that differs from run to run",
        physics="The moment load cell is zeroed before every run, each time a little differently.",
        needs=("runs", "moment"),
        remedy="zero the moment channel in the same state before every run; or subtract the value of the table from "
        "each run",
        spread=0.5,
    ),
)
LONGITUDINAL_ZERO = _zero_of(
    name="Fx0_N",
    unit="N",
    meaning="reported Fx = Fx + Fx0",
    acts_on=("Fx",),
    spread=20.0,
    limits=(-1e3, 1e3),
    seen_as=Appearance(
        id="loadcell-offset-fx",
        name="load-cell zero of Fx",
        physics="The longitudinal load cell was zeroed while a force acted on it.",
        needs=("drive",),
        remedy="zero the longitudinal channel with the tyre off the ground; or subtract {value} N from its readings",
        axes=("Fx",),
    ),
    declared=Declared(
        key="u_Fx_offset_N", unit="N", default=constants.LONGITUDINAL_ZERO, source="zero of Fx"
    ),
)
OVERTURNING_ZERO = _zero_of(
    name="Mx0_Nm",
    unit="Nm",
    meaning="reported Mx = Mx + Mx0",
    acts_on=("Mx",),
    spread=30.0,
    limits=(-500.0, 500.0),
    seen_as=Appearance(
        id="loadcell-offset-mx",
        name="load-cell zero of Mx",
        physics="The reading of the overturning moment has a constant offset: its load cell has a wrong zero, or the wheel "
        "is not centred in the rig.",
        needs=("overturning",),
        remedy="zero the channel of the overturning moment with the tyre off the ground; or subtract {value} Nm from its "
        "readings",
        axes=("Mx",),
    ),
    declared=Declared(
        key="u_Mx_offset_Nm", unit="Nm", default=constants.OVERTURNING_ZERO, source="zero of Mx"
    ),
)
ROLLING_ZERO = _zero_of(
    name="My0_Nm",
    word="load-cell zero of My",
    unit="Nm",
    meaning="reported My = My + My0",
    acts_on=("My",),
    spread=5.0,
    limits=(-100.0, 100.0),
    declared=Declared(key="u_My_offset_Nm", unit="Nm", default=constants.ROLLING_ZERO, source="zero of My"),
)
LONGITUDINAL_GAIN = calibration(
    "Fx",
    "gain_Fx",
    "reported Fx = gain_Fx Fx + Fx0",
    seen_as=Appearance(
        id="loadcell-gain-fx",
        name="calibration of Fx",
        physics="The longitudinal channel reads a few per cent too much or too little.",
        needs=("drive",),
        remedy="calibrate the longitudinal channel; or divide its readings by {value}",
    ),
)
MOMENT_GAINS = tuple(
    calibration(name, f"gain_{name}", f"reported {name} = gain_{name} {name}, before its zero is added")
    for name in ("Mx", "My", "Mz")
)
LONGITUDINAL_DRAG = _of_reading(
    name="drag_Fx_N",
    unit="N",
    meaning="reported Fx = Fx - drag_Fx rolling forwards, Fx + drag_Fx backwards",
    acts_on=("Fx",),
    formula=lambda drag, Fx, at: Fx - drag * at.points.direction,
    spread=15.0,
    limits=(-500.0, 500.0),
    seen_as=Appearance(
        id="longitudinal-drag",
        name="drag of brake and bearings",
        physics="A dragging brake, bearings or seals between wheel and load cell add a force against the rolling, which "
        "turns with the direction.",
        needs=("drive",),
        remedy="free the brake and warm up the bearings, or measure Fx between them and the wheel; or add {value} N to the "
        "readings of forward runs",
        axes=("Fx",),
    ),
)
FX_INTO_MZ = _crosstalk(
    "Fx",
    "Mz",
    spread=0.002,
    appearance=Appearance(
        id="crosstalk-fx-mz",
        name="crosstalk of Fx into Mz",
        physics="Part of the longitudinal force appears in the moment channel, as if it had an arm.",
        needs=("drive", "moment"),
        remedy="calibrate the cross terms of the load cell or move its origin to the middle of the wheel; or subtract "
        "{value} m times Fx from Mz",
        axes=("Fx", "Mz"),
    ),
)
FX_INTO_MX = _crosstalk(
    "Fx",
    "Mx",
    spread=0.002,  # half a degree times a wheel's radius of 0.25 m
    appearance=Appearance(
        id="crosstalk-fx-mx",
        name="crosstalk of Fx into Mx",
        physics="Part of the longitudinal force appears in the overturning moment, as if the axes of the load cell were turned "
        "against those of the wheel, so that it reads a share of the drive or brake torque.",
        needs=("drive", "overturning"),
        remedy="calibrate the cross terms of the load cell or turn its axes into those of the wheel; or subtract {value} m "
        "times Fx from Mx",
        axes=("Fx", "Mx"),
    ),
)
FY_INTO_MX = _crosstalk(
    "Fy",
    "Mx",
    spread=0.003,
    appearance=Appearance(
        id="crosstalk-fy-mx",
        name="crosstalk of Fy into Mx",
        physics="Part of the side force appears in the overturning moment, as if the origin of the load cell were above or "
        "below the road.",
        needs=("overturning", "slip"),
        remedy="calibrate the cross terms of the load cell or correct the height of its origin; or subtract {value} m times "
        "Fy from Mx",
        axes=("Fy", "Mx"),
    ),
)

FORCE_ERRORS = (
    GAIN,
    *MOMENT_GAINS,
    NONLINEARITY,
    CROSSTALK,
    CROSSTALK_CAMBER,
    DIRECTION_ZERO,
    FORCE_ZERO,
    MOMENT_ZERO,
    LONGITUDINAL_GAIN,
    FX_INTO_MZ,
    FX_INTO_MX,
    FY_INTO_MX,
    LONGITUDINAL_DRAG,
    LONGITUDINAL_ZERO,
    OVERTURNING_ZERO,
    ROLLING_ZERO,
)
