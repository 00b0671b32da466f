"""Effects of the rig: each becomes a correction of the readings."""

from __future__ import annotations

from mffit.effects.effect import Effect, Free

SIDESLIP_MISALIGNMENT = Effect(
    "sideslip-misalignment", "sideslip axis misaligned", "rig",
    "The steering axis reads zero while the wheel runs at a small sideslip angle.",
    (Free("alpha_0_deg", 0.2, (0.0,), -5.0, 5.0),), (), "even in alpha; turns with the direction",
    ("ply-steer",),
    remedy="turn the steering axis by {opposite} deg at its reading of zero and call that zero; or add {value} deg "
    "to all readings of the sideslip angle",
    axes=("alpha",),
)  # fmt: skip
CAMBER_MISALIGNMENT = Effect(
    "camber-misalignment", "camber axis misaligned", "rig",
    "The camber axis reads zero while the wheel leans a little.",
    (Free("gamma_0_deg", 0.4, (0.0,), -5.0, 5.0),), (), "even in gamma", ("camber-reduction", "path-radius"),
    remedy="lean the wheel by {opposite} deg at its reading of zero and call that zero; or add {value} deg "
    "to all readings of the camber angle",
    axes=("gamma",),
)  # fmt: skip
LOADCELL_OFFSET_FY = Effect(
    "loadcell-offset-fy", "load-cell zero of Fy", "rig",
    "The side-force load cell was zeroed while the tyre was still deformed.",
    (Free("F0_N", 10.0, (0.0,), -1e3, 1e3),), (), "even, the same at every load", ("conicity", "crosstalk-fz-fy"),
    remedy="zero the side-force channel with the tyre off the ground; or take {value} N off its readings",
    axes=("Fy",),
)  # fmt: skip
LOADCELL_OFFSET_MZ = Effect(
    "loadcell-offset-mz", "load-cell zero of Mz", "rig",
    "The moment load cell was zeroed while the tyre was still twisted.",
    (Free("M0_Nm", 1.0, (0.0,), -1e2, 1e2),), ("moment",), "even, the same at every load", ("residual-torque",),
    remedy="zero the moment channel with the tyre off the ground; or take {value} Nm off its readings",
    axes=("Mz",),
)  # fmt: skip
LOADCELL_GAIN = Effect(
    "loadcell-gain", "calibration of Fy", "rig",
    "The side-force channel reads a few per cent too much or too little.",
    (Free("gain", 0.02, (0.0,), 0.5, 2.0),), (), "as Fy",
    remedy="calibrate the side-force channel; or divide its readings by {value}",
)  # fmt: skip
CROSSTALK_FZ_FY = Effect(
    "crosstalk-fz-fy", "crosstalk of Fz into Fy", "rig",
    "Part of the vertical load appears in the side-force channel.",
    (Free("crosstalk", 0.01, (0.0,), -0.3, 0.3),), ("loads",), "even, proportional to load", ("conicity", "loadcell-offset-fy"),
    remedy="level the load cell or calibrate its cross terms; or take {value} of the load off the side force",
    axes=("Fy",),
)  # fmt: skip
BACKLASH = Effect(
    "backlash", "backlash of the sideslip axis", "rig",
    "The moment on the wheel takes up the play of the steering, so the angle is off by half the play against the moment.",
    (Free("backlash_deg", 0.2, (0.05, 0.15, 0.3), 0.0, 3.0),), ("moment",), "partly odd",
    remedy="take the play of {value} deg out of the steering axis, or declare it as backlash_deg under [rig]",
)  # fmt: skip
PATH_RADIUS = Effect(
    "path-radius", "path radius", "rig",
    "The contact point runs on another radius than declared.",
    (Free("path_radius_m", 0.03, (0.0,), 0.1, 100.0, relative=True),), ("curved",), "as turn slip", ("camber-reduction",),
    remedy="measure the four lengths of the path again; path_radius under [rig] should be {value} m",
)  # fmt: skip

STEERING_COMPLIANCE = Effect(
    "steering-compliance", "compliance of the steering axis", "rig",
    "The aligning moment turns the wheel a little, as the steering and its frame are not rigid.",
    (Free("compliance_deg_per_Nm", 0.004, (0.0,), -0.05, 0.05),), ("moment", "slip"), "odd", ("backlash", "pressure"),
    remedy="stiffen the steering; or add {value} deg for every Nm of the reported moment to its readings",
    axes=("alpha", "Mz",),
)  # fmt: skip
LOADCELL_NONLINEARITY = Effect(
    "loadcell-nonlinearity", "nonlinearity of the Fy load cell", "rig",
    "The side-force channel reads large forces a little larger, or smaller, than in proportion.",
    (Free("nonlinearity_per_kN", 0.01, (0.0,), -0.2, 0.2),), ("slip",), "as Fy", ("loadcell-gain",),
    remedy="calibrate the side-force channel at large forces: its readings grow by {value} per kN too much",
)  # fmt: skip
HYSTERESIS = Effect(
    "hysteresis", "hysteresis of sideslip sweeps", "rig",
    "The force lags behind the angle as it is read, by a fixed angle in either sense of the sweep.",
    (Free("hysteresis_deg", 0.1, (0.0,), -2.0, 2.0),), ("senses",), "changes sign with the sense of the sweep", ("relaxation",),
    remedy="free the sideslip drive; or take {value} deg off its readings where they rise and add it where they fall",
)  # fmt: skip
RUN_OFFSETS_FY = Effect(
    "run-offsets-fy", "load-cell zero of Fy that differs from run to run", "rig",
    "The side-force load cell is zeroed before every run, each time a little differently.",
    (Free("F0_N", 5.0, (0.0,), -1e3, 1e3, per_run=True),), ("runs",), "even, the same within a run", ("loadcell-offset-fy",),
    remedy="zero the side-force channel in the same state before every run; or take what the table says off each run",
)  # fmt: skip
RUN_OFFSETS_MZ = Effect(
    "run-offsets-mz", "load-cell zero of Mz that differs from run to run", "rig",
    "The moment load cell is zeroed before every run, each time a little differently.",
    (Free("M0_Nm", 0.5, (0.0,), -1e2, 1e2, per_run=True),), ("runs", "moment"), "even, the same within a run",
    ("loadcell-offset-mz",),
    remedy="zero the moment channel in the same state before every run; or take what the table says off each run",
)  # fmt: skip
RUN_OFFSETS_ALPHA = Effect(
    "run-offsets-alpha", "sideslip zero that differs from run to run", "rig",
    "The steering axis is set up anew before every run and stands a little differently each time.",
    (Free("alpha_0_deg", 0.1, (0.0,), -5.0, 5.0, per_run=True),), ("runs",), "even in alpha, the same within a run",
    ("sideslip-misalignment",),
    remedy="set the steering axis up against a stop before every run; or add what the table says to the readings of each run",
)  # fmt: skip

RIG_EFFECTS = (
    SIDESLIP_MISALIGNMENT, CAMBER_MISALIGNMENT, LOADCELL_OFFSET_FY, LOADCELL_OFFSET_MZ, LOADCELL_GAIN, CROSSTALK_FZ_FY,
    BACKLASH, PATH_RADIUS, STEERING_COMPLIANCE, LOADCELL_NONLINEARITY, HYSTERESIS,
    RUN_OFFSETS_FY, RUN_OFFSETS_MZ, RUN_OFFSETS_ALPHA,
)  # fmt: skip
