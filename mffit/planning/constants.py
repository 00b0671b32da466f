"""Numbers of judgement of ``mffit plan``."""

from __future__ import annotations

from tir.constant import Count, Real, Series

PLAN_ZERO_ANGLES = Series(
    (-1.0, -0.5, 0.0, 0.5, 1.0),
    "deg",
    "Sideslip angles of a run that measures zeros; close enough to zero that the side force is linear.",
)
PLAN_SMALL_CAMBERS = Series(
    (-20.0, -15.0, -12.5, -10.0, -7.5, -5.0, -2.5, 0.0, 2.5, 5.0, 7.5, 10.0, 12.5, 15.0, 20.0),
    "deg",
    "Camber angles of a run for the camber stiffness, which the direct method reads below 20 deg.",
)
PLAN_SWEEP_SHARES = Series(
    (-1.0, -0.75, -0.5, -0.375, -0.25, -0.125, -0.0625, 0.0, 0.0625, 0.125, 0.25, 0.375, 0.5, 0.75, 1.0),
    "-",
    "Angles of a full sweep over the largest angle that was run; closer together where the curves bend.",
)
PLAN_FLIPPED_SHARES = Series(
    PLAN_SWEEP_SHARES[3:-3],
    "-",
    "Angles of the sweep on the flipped mount over the largest angle that was run; conicity needs no peak.",
)
PLAN_COUPLED_CAMBERS = Series((10.0, 20.0, 35.0), "deg", "Cambers at which a sideslip sweep is proposed.")
PLAN_NEW_LOAD_FACTORS = Series(
    (0.7, 1.3), "-", "Proposed new loads over the smallest and over the largest load of the programme."
)
PLAN_NEW_PRESSURE_FACTORS = Series((0.8, 1.2), "-", "Proposed new pressures over the programme's pressure.")
PLAN_SECOND_RADIUS_FACTOR = Real(
    0.7, "-", "Second path radius over the usual one: still on the disc, and far enough from the usual path."
)
PLAN_RIG_IMPROVEMENT = Real(
    1.0 / 3.0, "-", "Uncertainty of a rig number measured better, over the uncertainty declared now."
)
PLAN_SMALLEST_CAMBER_SWEPT = Real(
    1.0, "deg", "Programmes whose largest camber does not exceed this have no camber sweep to repeat."
)
PLAN_COUPLED_LOAD_TOLERANCE = Real(
    0.05, "-", "Relative distance within which a point counts as run at a given load."
)
PLAN_COUPLED_SIDESLIP = Real(
    0.5, "deg", "Points with more sideslip than this at camber count as a coupled sweep."
)
PLAN_WORTHWHILE_FALL = Real(
    0.05, "-", "A run is added only if it lowers the uncertainty of the goal by this share."
)
PLAN_EQUALLY_GOOD = Real(
    0.02,
    "-",
    "Runs whose resulting uncertainties differ by less than this share count as equal; the one with fewer points is taken.",
)
PLAN_NOMINAL_LOAD_TOLERANCE = Real(
    0.06, "-", "Relative distance from the nominal load within which points count for eps_gamma at that load."
)
PLAN_PRESSURE_TOLERANCE = Real(
    5e3, "Pa", "Distance from the main pressure within which points count for eps_gamma."
)
PLAN_NOISE_DRAWS = Count(
    8, "-", "Noise draws of the new points, over which the promised u of the direct method is the rms."
)
PLAN_BAND_ANGLES = Count(21, "-", "Angles per curve at which a 95 % band is evaluated.")
PLAN_BAND_SPEED = Real(10.0, "m/s", "Speed at which a 95 % band is evaluated; the bands hardly depend on it.")
