"""Numbers of judgement of reading and reduction."""

from __future__ import annotations

from tir.constant import Count, Real

# Levels of the set-points
LOAD_LEVEL_TOLERANCE = Real(
    0.08,
    "-",
    "Loads further apart than this share may be two levels; a rig's scatter is at most a third of it.",
)
CAMBER_LEVEL_TOLERANCE = Real(0.8, "deg", "Camber angles further apart than this may be two levels.")
PRESSURE_LEVEL_TOLERANCE = Real(10e3, "Pa", "Pressures further apart than this may be two levels.")
SPEED_LEVEL_TOLERANCE = Real(0.1, "-", "Speeds further apart than this share may be two levels.")
SIDESLIP_LEVEL_TOLERANCE = Real(0.4, "deg", "Sideslip angles further apart than this may be two levels.")
SMALLEST_LEVEL = Real(0.02, "-", "Values that a level needs, per value of the largest level.")
LEVEL_FLANK = Real(
    0.3,
    "-",
    "Density, per density of the densest place half a tolerance away, below which values are the flank of that place.",
)
HELD_DISTANCE = Real(
    1.0 / 3.0, "-", "Distance from its level, in tolerances, that a held setting mostly keeps."
)
MOST_AWAY_FROM_LEVELS = Real(
    0.3, "-", "Share of values beyond that distance from which a setting counts as spread rather than held."
)

# Samples that are no measurement
UNLOADED = Real(
    0.1, "-", "Share of the usual load of a recording below which the tyre does not roll on its belt."
)
FREE_ROLLING_SLIP = Real(0.02, "-", "Longitudinal slip up to which the wheel counts as rolling freely.")
STUCK_TIME = Real(0.5, "s", "A sensor that reads one value to the last digit for this long is stuck.")
FEWEST_STUCK_SAMPLES = Count(20, "-", "Equal samples of a stuck sensor at least, at low sampling rates.")
CLIPPED_SAMPLES = Count(6, "-", "Samples in a row at the very end of a channel's range that mean clipping.")
LIVELY_SHARE = Real(
    0.8,
    "-",
    "Share of samples that differ from the one before, from which on a value that stays is suspicious.",
)
MOVED_FORCE = Real(
    12.0, "-", "Range of the side force, per noise of a sample, that an axis at rest does not explain."
)
SPIKE_OVER_NOISE = Real(
    12.0, "-", "Distance of a spike from the median of its neighbours, per standard deviation."
)
SPIKE_OF_FORCE = Real(0.15, "-", "Distance of a spike of a force from that median, per usual load, at least.")
SPIKE_OF_MOMENT = Real(
    0.03, "m", "Distance of a spike of a moment from that median, per usual load, at least."
)
SPIKE_WINDOW = Count(5, "-", "Samples of the running median beside which a spike shows.")
MOST_SAMPLES_FOR_NOISE = Count(100_000, "-", "Samples from which the noise of a channel is estimated.")

# Stretches of a recording
STEP_OF_ANGLE = Real(
    0.15,
    "deg",
    "Change of an angle that makes another set-point; a logger's noise is below, a set-point's step above.",
)
STEP_OF_CONDITION = Real(
    0.08, "-", "Relative change of load, pressure or speed that makes another set-point."
)
STEP_OVER_NOISE = Real(
    6.0, "-", "Change of a setting over the noise of its mean that makes another set-point."
)
COMPARED_APART = Real(0.5, "s", "Time between the settings that are compared to find a change.")
EDGE_AVERAGE = Real(
    0.1, "s", "Time over which a condition is averaged to find where its change begins and ends."
)
SHORTEST_STRETCH = Real(2.0, "s", "Duration that a stretch needs after its transient.")
FEWEST_SAMPLES_OF_STRETCH = Count(8, "-", "Samples that a stretch needs after its transient.")
TRANSIENT_ROLL = Real(
    2.0, "m", "Rolling distance that is always dropped behind a change: three to ten relaxation lengths."
)
SLOWEST_ROLLING = Real(0.1, "m/s", "Speed below which the transient distance is not converted to time.")
STAIRCASE_SHARE = Real(
    0.5,
    "-",
    "A condition whose angles rest for more of its time is a staircase of plateaus with moves between them.",
)
SMALLEST_SWEEP = Real(3.0, "deg", "Range of an angle that makes its motion a sweep.")
RETURNED_SHARE = Real(
    0.3, "-", "Share of its range that a sweep beside plateaus goes back; a move does not return."
)
GAP_OVER_STEP = Real(5.0, "-", "A gap in time is this many usual steps.")
SHORTEST_GAP = Real(0.1, "s", "A gap in time is at least this long.")
MOST_SAMPLES_FOR_SCALE = Count(20_000, "-", "Samples from which the usual size of the settings is estimated.")
BLOCKS_OF_STRETCH = Count(10, "-", "Blocks of a stretch; leading ones are compared with its second half.")
LEADING_BLOCK = Real(
    3.5,
    "-",
    "A leading block this many of its standard errors away from the second half belongs to the transient.",
)
PROVEN_DRIFT = Real(6.0, "-", "Standard errors of the change over a stretch that prove a drift.")
HARMLESS_DRIFT_OF_FORCE = Real(
    0.02, "-", "Drift of Fy within a stretch, per load, that is averaged rather than refused."
)
HARMLESS_DRIFT_OF_MOMENT = Real(
    0.002, "m", "Drift of Mz within a stretch, per load, that is averaged rather than refused."
)
COLD_TREAD = Real(
    10.0, "K", "The first sweeps are left out while the tread is this much colder than in the middle sweep."
)
FEWEST_WARM_SWEEPS = Count(3, "-", "Sweeps that must remain for the first ones to be left out as cold.")
WANDERING_LOAD = Real(
    0.5,
    "-",
    "Range of the load within a sweep (5th to 95th percentile), per median, beyond which its load is not held.",
)
MOST_REPEATED_SAMPLES = Real(
    0.01, "-", "Share of samples with the time of the one before that a recorder may have written twice."
)
STRETCHES_IN_SENTENCE = Count(3, "-", "Dropped stretches that a sentence names one by one.")

# Means
LARGEST_ORDER_OF_NOISE = Count(
    4,
    "-",
    "Order of the autoregressive process: two for the noise, two for a ripple such as once per revolution.",
)
AVERAGED_TIME = Real(0.1, "s", "Time over which the samples of a moving sweep are averaged.")
AVERAGED_ANGLE = Real(0.5, "deg", "Angle over which the samples of a moving sweep are averaged at most.")
FILLED_BLOCK = Real(0.5, "-", "Share of its samples that a block of a moving sweep needs to give a point.")

# Lag of moving sweeps
FORCE_NEAR_ZERO = Real(
    0.25,
    "-",
    "Side force, per largest of its sweep, within which its curve is straight enough to be read at zero.",
)
EVEN_RATE = Real(
    0.5, "-", "Deviation of the rate of sideslip, per usual rate, up to which a sample shows the lag."
)
FEWEST_POINTS_AT_ZERO = Count(8, "-", "Points near zero force that each way of a sweep needs.")
WORST_CONDITION_AT_ZERO = Real(
    1e8, "-", "Condition number beyond which the points do not fix the lines: one side of zero is missing."
)
FEWEST_SWEEPS_OF_LAG = Count(3, "-", "Sweeps whose scatter shows how well the median of their lags is known.")
BINS_OF_HYSTERESIS = Count(25, "-", "Bins of the angle in which the two ways of a sweep are compared.")
PROVEN_LAG = Real(2.0, "-", "Standard uncertainties by which a lag differs from zero to be taken off.")

# Bare tables
STAND_IN_PRESSURE = Real(
    250e3, "Pa", "Pressure of a bare table that holds none; the alignment does not depend on it."
)
STAND_IN_SPEED = Real(
    1.0, "m/s", "Speed of a bare table that holds none; the alignment does not depend on it."
)
