"""What data must vary for an effect to be seen, in words; :mod:`mffit.diagnosis.needs` tests the points for it."""

NEEDS = {
    "curved": "a curved path",
    "spin": "a curved path or large camber",
    "camber": "points at camber",
    "coupled": "sideslip and camber together",
    "slip": "a sideslip sweep",
    "loads": "two loads",
    "pressures": "two pressures",
    "moment": "Mz",
    "temperatures": "temperatures that differ (T_degC)",
    "speeds": "two speeds",
    "times": "the time of every point (t_s)",
    "distances": "speeds that keep distance out of proportion to time",
    "runs": "at least three runs, each in a file of its own",
    "directions": "runs in both directions of rolling",
    "senses": "sideslip swept both up and down",
    "continuous": "a continuous sweep (time_s, moving alpha)",
    "drive": "sweeps of longitudinal slip with Fx",
    "combined": "longitudinal slip and sideslip together",
    "combined_camber": "longitudinal slip, sideslip and camber together",
    "overturning": "Mx",
}
OF_CHANNEL = frozenset(("drive", "overturning"))
"""Needs of channels that many rigs do not measure: without them, an effect is neither tried nor listed as invisible."""
