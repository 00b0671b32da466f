"""Numbers of judgement of reading and reduction."""

from __future__ import annotations

from tir.constant import Count, Real, Series

# Levels of the set-points: values further apart than a tolerance may be two levels; the scatter of a rig is a third of it
LOAD_LEVEL_TOLERANCE = Real(0.08, "-", "Loads of one level differ by less, relatively.")
CAMBER_LEVEL_TOLERANCE = Real(0.8, "deg", "Camber angles of one level differ by less.")
PRESSURE_LEVEL_TOLERANCE = Real(10e3, "Pa", "Pressures of one level differ by less.")
SPEED_LEVEL_TOLERANCE = Real(0.1, "-", "Speeds of one level differ by less, relatively.")
SIDESLIP_LEVEL_TOLERANCE = Real(0.4, "deg", "Sideslip angles of one level differ by less.")
SLIP_LEVEL_TOLERANCE = Real(0.02, "-", "Longitudinal slips of one level differ by less.")
SMALLEST_LEVEL = Real(0.02, "-", "Fewest values of a level over those of the largest level.")
LEVEL_FLANK = Real(
    0.3, "-", "Density over that half a tolerance away below which values are a flank of that level."
)
HELD_DISTANCE = Real(
    1.0 / 3.0, "-", "Distance from its level, in tolerances, that a held setting rarely exceeds."
)
MOST_AWAY_FROM_LEVELS = Real(
    0.3, "-", "Share of values beyond that distance above which a setting is not held."
)

HELD_SPAN = Real(
    2.5,
    "-",
    "Range of the load within a sweep, in tolerances, up to which the sweep holds it: load control wanders by 10 % to either "
    "side at small loads, and programmes step it by a quarter or more.",
)
LONGEST_HELD_SPAN = Real(
    4.5,
    "-",
    "The same without a gap between the readings, as while braking: 18 % to either side; a step of a quarter that wanders by "
    "10 % spans 5.",
)
GAP_OF_A_STEP = Real(
    0.5, "-", "Smallest gap between the sorted loads of a sweep, in tolerances, that means a step."
)
PERCENTILES_OF_HELD = Series((5.0, 95.0), "%", "Ends of that range; ignores single values.")

# Samples that are no measurement
UNLOADED = Real(0.1, "-", "Share of the usual load below which the tyre is off the belt.")
FREE_ROLLING_SLIP = Real(0.02, "-", "Longitudinal slip up to which the wheel counts as rolling freely.")
STUCK_TIME = Real(0.5, "s", "A sensor that reads one value to the last digit for this long is stuck.")
FEWEST_STUCK_SAMPLES = Count(20, "-", "Fewest equal samples of a stuck sensor, at low sampling rates.")
CLIPPED_SAMPLES = Count(6, "-", "Successive samples at the end of a channel's range that mean clipping.")
LIVELY_SHARE = Real(
    0.8, "-", "Share of samples unlike the one before above which a constant value is suspicious."
)
MOVED_FORCE = Real(12.0, "-", "Range of Fy over the noise of a sample that means the axis moved.")
SPIKE_OVER_NOISE = Real(
    12.0, "-", "Distance of a spike from the median of its neighbours, in standard deviations."
)
SPIKE_OF_FORCE = Real(0.15, "-", "Smallest spike of a force over the usual load.")
SPIKE_OF_MOMENT = Real(0.03, "m", "Smallest spike of a moment over the usual load.")
SPIKE_WINDOW = Count(5, "-", "Samples of the running median that shows spikes.")
MOST_SAMPLES_FOR_NOISE = Count(100_000, "-", "Most samples from which the noise of a channel is estimated.")

# Stretches of a recording
STEP_OF_ANGLE = Real(
    0.15, "deg", "Smallest change that makes another set-point; the noise of a logger is below it."
)
STEP_OF_SLIP = Real(
    0.015,
    "-",
    "Smallest change of longitudinal slip that makes another set-point; that of free rolling wanders less.",
)
STEP_OF_CONDITION = Real(0.08, "-", "Relative change of load, pressure or speed to another set-point.")
STEP_OVER_NOISE = Real(6.0, "-", "Change over the noise of its mean that makes another set-point.")
COMPARED_APART = Real(0.5, "s", "Time between settings that are compared to find a change.")
EDGE_AVERAGE = Real(0.1, "s", "Averaging time of conditions in the search for the ends of a change.")
SHORTEST_STRETCH = Real(2.0, "s", "Shortest stretch after its transient.")
FEWEST_SAMPLES_OF_STRETCH = Count(8, "-", "Fewest samples of a stretch after its transient.")
TRANSIENT_ROLL = Real(2.0, "m", "Distance dropped after a change: three to ten relaxation lengths.")
SLOWEST_ROLLING = Real(0.1, "m/s", "Smallest speed that converts this distance to time.")
STAIRCASE_SHARE = Real(
    0.5, "-", "Share of rest above which angles move from plateau to plateau instead of sweeping."
)
SMALLEST_SWEEP = Real(3.0, "deg", "Smallest range of a sweeping angle.")
STEP_OF_CONDITION_WHILE_DRIVEN = Real(
    0.25,
    "-",
    "Relative change of load, pressure or speed to another set-point while slip moves: drive and brake forces "
    "disturb the control of the load by a tenth, and the points keep the load as read.",
)
SMALLEST_SWEEP_OF_SLIP = Real(0.05, "-", "Smallest range of a sweep of longitudinal slip.")
RETURNED_SHARE = Real(
    0.3, "-", "Share of its range that a sweep beside plateaus returns; a move does not return."
)
GAP_OVER_STEP = Real(5.0, "-", "Smallest gap in time over the usual step.")
SHORTEST_GAP = Real(0.1, "s", "Shortest gap in time.")
MOST_SAMPLES_FOR_SCALE = Count(
    20_000, "-", "Most samples from which the usual size of the settings is estimated."
)
BLOCKS_OF_STRETCH = Count(10, "-", "Blocks of a stretch; leading ones are compared with its second half.")
LEADING_BLOCK = Real(
    3.5, "-", "Standard errors from the second half beyond which a leading block is transient."
)
PROVEN_DRIFT = Real(6.0, "-", "Standard errors of a change over a stretch that prove a drift.")
HARMLESS_DRIFT_OF_FORCE = Real(0.02, "-", "Drift of Fy within a stretch, over the load, that is averaged.")
HARMLESS_DRIFT_OF_MOMENT = Real(0.002, "m", "Drift of Mz within a stretch, over the load, that is averaged.")
COLD_TREAD = Real(
    10.0, "K", "First sweeps are dropped if the tread is this much colder than in the middle one."
)
FEWEST_WARM_SWEEPS = Count(3, "-", "Fewest sweeps that must remain when cold ones are dropped.")
COLDER_BEGINNING = Real(
    3.0,
    "K",
    "A recording begins cold if its first sweeps are this much colder than later ones: grip changes by 1 %.",
)
COLDER_OVER_SCATTER = Real(
    4.0,
    "-",
    "Standard deviations of the later sweeps' temperature by which the first ones must be colder as well.",
)
FEWEST_LATER_SWEEPS = Count(5, "-", "Fewest later sweeps that show the usual temperature and its scatter.")
WANDERING_LOAD = Real(
    0.5, "-", "Range of the load (5th to 95th percentile) over its median above which it is not held."
)
MOST_REPEATED_SAMPLES = Real(0.01, "-", "Share of samples that a recorder may have written twice.")
STRETCHES_IN_SENTENCE = Count(3, "-", "Most dropped stretches that a sentence names.")

# Means
LARGEST_ORDER_OF_NOISE = Count(
    4, "-", "Autoregressive order: two for noise, two for a ripple such as once per revolution."
)
AVERAGED_TIME = Real(0.1, "s", "Averaging time of a moving sweep.")
AVERAGED_ANGLE = Real(0.5, "deg", "Largest angle over which a moving sweep is averaged.")
AVERAGED_SLIP = Real(
    0.02,
    "-",
    "Largest slip over which a moving sweep is averaged: the curve bends by 1 % of its peak over it.",
)
FILLED_BLOCK = Real(0.5, "-", "Share of its samples that such an averaged block needs.")

# Lag of moving sweeps
FORCE_NEAR_ZERO = Real(
    0.25, "-", "Fy over the largest of its sweep below which the curve is nearly straight."
)
EVEN_RATE = Real(
    0.5, "-", "Relative deviation from the usual rate of sideslip up to which a sample shows the lag."
)
FEWEST_POINTS_AT_ZERO = Count(8, "-", "Fewest points near zero force that each way of a sweep needs.")
WORST_CONDITION_AT_ZERO = Real(1e8, "-", "Condition number above which one side of zero force is missing.")
FEWEST_SWEEPS_OF_LAG = Count(3, "-", "Fewest sweeps whose scatter gives the uncertainty of the median lag.")
BINS_OF_HYSTERESIS = Count(25, "-", "Bins of the angle in which both ways of a sweep are compared.")
PROVEN_LAG = Real(2.0, "-", "Standard uncertainties that a lag must exceed to be corrected.")

# Noise of readings that state none
FEWEST_POINTS_FOR_NEIGHBOURS = Count(
    6, "-", "Fewest points of a sweep whose third differences show its noise."
)

# Definition of slip
FORCE_NEAR_FREE_ROLLING = Real(
    0.3, "-", "Fx over the load up to which slip and force are nearly proportional, apart from a cubic term."
)
LOADS_OF_ZERO = Series((10.0, 50.0, 90.0), "%", "Percentiles of the load at which the zero of slip is said.")
SLIP_OF_ZERO_FORCE = Real(
    0.004,
    "-",
    "Slip of zero Fx up to which slip is against free rolling: rolling resistance moves it by 0.001, a calibration of speed "
    "by 0.002; slip against the loaded radius is 0.01 to 0.04 off at full load.",
)
SOFTEST_SLIP_STIFFNESS = Real(
    2.0,
    "-",
    "Slope of Fx per load over slip below which the slip is in per cent: tyres have 5 to 50 per unit of slip.",
)
SLIP_WITH_FORCE = Real(0.05, "-", "Longitudinal slip beyond which every tyre has a longitudinal force.")
SMALLEST_DRIVEN_FORCE = Real(
    0.02, "-", "|Fx| over load that every tyre exceeds beyond it: kN read as N are at most 0.002."
)
LARGEST_SHIFT_OF_SLIP = Real(
    0.12,
    "-",
    "Slip of zero Fx beyond which the slip is against no radius of the tyre: they differ by less than a tenth.",
)
OUTLIER_OF_ZERO = Real(
    4.0, "-", "Standard deviations beyond which a reading does not count for the zero of slip."
)
WEAKEST_DIRECTION_OF_ZERO = Real(
    1e-3,
    "-",
    "Singular value over the largest below which the zero does not follow a combination of conditions.",
)

# Bare tables
STAND_IN_PRESSURE = Real(
    250e3, "Pa", "For a bare table without pressure; the alignment does not depend on it."
)
STAND_IN_SPEED = Real(1.0, "m/s", "For a bare table without speed; the alignment does not depend on it.")

# Steps of the sideslip angle and of longitudinal slip
SMALLEST_STEP = Real(0.3, "deg", "Smallest change of the angle that is a step.")
STRAIGHT_ON = Real(
    0.5,
    "deg",
    "Sideslip up to which a step of slip shows the relaxation length of straight running; beyond it Fx answers to both.",
)
LONGEST_STEP = Real(
    0.5,
    "-",
    "Way of a step, and distance between samples, over the unloaded radius: relaxation lengths are 0.25 to 2 radii.",
)
SHORTEST_REST = Real(3.0, "-", "Distance rolled after a step, over the unloaded radius.")
LOAD_RANGE_OF_STEPS = Real(
    0.2, "-", "Largest range of the load over its mean while the angle or the slip steps."
)
