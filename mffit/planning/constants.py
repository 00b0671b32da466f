"""Numbers of judgement of ``mffit plan``."""

from __future__ import annotations

from tir.constant import Count, Real, Series

PLAN_ZERO_ANGLES = Series(
    (-1.0, -0.5, 0.0, 0.5, 1.0),
    "deg",
    "Sideslip angles of a run for zeros; the side force is linear within them.",
)
PLAN_SMALL_CAMBERS = Series(
    (-20.0, -15.0, -12.5, -10.0, -7.5, -5.0, -2.5, 0.0, 2.5, 5.0, 7.5, 10.0, 12.5, 15.0, 20.0),
    "deg",
    "Camber angles of a run for the camber stiffness, which is read below 20 deg.",
)
PLAN_SWEEP_SHARES = Series(
    (-1.0, -0.75, -0.5, -0.375, -0.25, -0.125, -0.0625, 0.0, 0.0625, 0.125, 0.25, 0.375, 0.5, 0.75, 1.0),
    "-",
    "Angles of a full sweep over the largest angle run; closer where the curves bend.",
)
PLAN_FLIPPED_SHARES = Series(
    PLAN_SWEEP_SHARES[3:-3],
    "-",
    "Angles of a sweep on the flipped mount over the largest one; conicity needs no peak.",
)
PLAN_COUPLED_CAMBERS = Series((10.0, 20.0, 35.0), "deg", "Cambers at which a sideslip sweep is proposed.")
PLAN_COMBINED_SIDESLIPS = Series(
    (2.0, 6.0), "deg", "Sideslips at which a sweep of longitudinal slip is proposed: below and near the peak."
)
PLAN_LEANED_SLIP_CAMBERS = Series((4.0,), "deg", "Cambers at which a sweep of longitudinal slip is proposed.")
PLAN_LARGEST_SLIP = Real(
    0.15, "-", "Largest longitudinal slip that is proposed where none was run: beyond the peak of dry tyres."
)
PLAN_SMALLEST_SLIP_SWEPT = Real(
    0.05, "-", "Programmes with less slip have no sweep of slip: steps go to 0.025."
)
PLAN_STEPS = Series(
    (0.0, 1.0, 0.0, -1.0, 0.0),
    "deg",
    "Angles of a run of steps, one after the other; the side force is linear within them.",
)
PLAN_STEPS_OF_SLIP = Series(
    (0.0, 0.025, 0.0, -0.025, 0.0),
    "-",
    "Slips of a run of steps, one after the other: more than the 0.02 up to which a wheel counts as rolling freely, and with "
    "three quarters or more of the slope of Fx at zero slip left, so that the relaxation length is that of small slip.",
)
PLAN_STEP_SPEED = Real(1.0, "m/s", "Speed of a run of steps.")
PLAN_STEP_HOLD = Real(6.0, "s", "Time for which each angle is held in a run of steps.")
PLAN_STEP_RATE = Real(20.0, "1/s", "Samples per second of a run of steps: several per time of settling.")
PLAN_STEP_CORRELATION = Real(
    0.8,
    "s",
    "Correlation time of the noise of a recording: cells and belts sway as long; that of the virtual rig.",
)
PLAN_POINT_TIME = Real(
    2.0,
    "s",
    "Time over which a finished point is averaged at least; single samples scatter accordingly more.",
)
PLAN_UNKNOWN_CARCASS = Real(
    0.3, "-", "Relative standard deviation of a carcass stiffness at nominal load of a tyre without steps."
)
PLAN_UNKNOWN_STIFFNESS = Real(
    0.3, "-", "Relative standard deviation of a vertical stiffness that was not measured."
)
PLAN_UNKNOWN_RADIUS = Real(0.01, "-", "Standard deviation of Q_RE0 where it was not measured.")
PLAN_UNKNOWN_PRESSURE = Real(0.3, "-", "Standard deviation of PFZ1 where it was not measured.")
PLAN_ROLLING_PRESSURES = Series(
    (0.8, 1.0, 1.2), "-", "Pressures of a rolling run over the programme's pressure."
)
PLAN_NEW_LOAD_FACTORS = Series(
    (0.7, 1.3), "-", "Proposed new loads over the smallest and the largest load of the programme."
)
PLAN_NEW_PRESSURE_FACTORS = Series((0.8, 1.2), "-", "Proposed new pressures over the programme's pressure.")
PLAN_SECOND_RADIUS_FACTOR = Real(
    0.7, "-", "Second path radius over the usual one: still on the disc, but clearly different."
)
PLAN_RIG_IMPROVEMENT = Real(1.0 / 3.0, "-", "Uncertainty of a remeasured rig number over the declared one.")
PLAN_SMALLEST_CAMBER_SWEPT = Real(1.0, "deg", "Programmes with less camber have no camber sweep to repeat.")
PLAN_COUPLED_LOAD_TOLERANCE = Real(0.05, "-", "Relative distance within which a point belongs to a load.")
PLAN_COUPLED_SIDESLIP = Real(
    0.5, "deg", "Points with camber and more sideslip than this make a coupled sweep."
)
PLAN_WORTHWHILE_FALL = Real(0.05, "-", "Share by which a run must lower the uncertainty of the goal.")
PLAN_EQUALLY_GOOD = Real(
    0.02, "-", "Runs whose uncertainties differ by less count as equal; the one with fewer points is taken."
)
PLAN_NOMINAL_LOAD_TOLERANCE = Real(
    0.06, "-", "Relative distance from the nominal load within which points count for eps_gamma."
)
PLAN_PRESSURE_TOLERANCE = Real(5e3, "Pa", "Distance from the main pressure of points that count.")
PLAN_NOISE_DRAWS = Count(8, "-", "Noise draws over which the promised u of the direct method is the rms.")
PLAN_BAND_ANGLES = Count(21, "-", "Angles per curve of a 95 % band.")
PLAN_BAND_SPEED = Real(10.0, "m/s", "Speed of a 95 % band, which hardly depends on it.")

# Order of the runs
SWAPS_OF_RUNS = Count(1000, "-", "Swaps of two sweeps tried in the search for an order.")

UNSEEN_SKEW = Real(
    0.5, "deg", "Camber skew whose consequence a plan states: large, and no other run shows it."
)
