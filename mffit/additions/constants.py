"""Numbers of judgement of the runs that a rig could add; set-points of one kind of run are in its record."""

from tir.constant import Real, Series

SWEEP_SHARES = Series(
    (-1.0, -0.75, -0.5, -0.375, -0.25, -0.125, -0.0625, 0.0, 0.0625, 0.125, 0.25, 0.375, 0.5, 0.75, 1.0),
    "-",
    "Angles of a sweep over its largest; closer where the curves bend.",
)
LARGEST_SLIP = Real(
    0.15, "-", "Largest longitudinal slip that is proposed where none was run: beyond the peak of dry tyres."
)
NEW_LOAD_FACTORS = Series(
    (0.7, 1.3), "-", "Proposed new loads over the smallest and the largest load of the programme."
)
NEW_PRESSURE_FACTORS = Series((0.8, 1.2), "-", "Proposed new pressures over the programme's pressure.")
SECOND_RADIUS_FACTOR = Real(
    0.7, "-", "Second path radius over the usual one: still on the disc, but clearly different."
)
FASTER = Real(2.0, "-", "Speed of an added run over the usual one.")
WARMER = Real(20.0, "K", "Temperature of an added run above the usual one.")

WORTHWHILE_FALL = Real(
    0.05,
    "-",
    "Share by which a run must lower the uncertainty of the goal; runs that differ by less count as equal, and the one with "
    "fewer points is taken.",
)
