"""Numbers of judgement of reading and reduction."""

from __future__ import annotations

from tir.constant import Count, Real

# Levels of the set-points: values further apart than a tolerance may be two levels; the scatter of a rig is a third of it
LOAD_LEVEL_TOLERANCE = Real(0.08, "-", "Relative distance of two loads that may be two levels.")
CAMBER_LEVEL_TOLERANCE = Real(0.8, "deg", "Distance of two camber angles that may be two levels.")
PRESSURE_LEVEL_TOLERANCE = Real(10e3, "Pa", "Distance of two pressures that may be two levels.")
SPEED_LEVEL_TOLERANCE = Real(0.1, "-", "Relative distance of two speeds that may be two levels.")
SIDESLIP_LEVEL_TOLERANCE = Real(0.4, "deg", "Distance of two sideslip angles that may be two levels.")
SMALLEST_LEVEL = Real(0.02, "-", "Values that a level needs, per value of the largest level.")
LEVEL_FLANK = Real(0.3, "-", "Below this share of the density half a tolerance away, values are its flank.")
HELD_DISTANCE = Real(1.0 / 3.0, "-", "Distance from its level, in tolerances, that a held setting keeps.")
MOST_AWAY_FROM_LEVELS = Real(0.3, "-", "Share of values beyond that distance that makes a setting spread.")

# Samples that are no measurement
UNLOADED = Real(0.1, "-", "Share of the usual load below which the tyre does not roll on its belt.")
FREE_ROLLING_SLIP = Real(0.02, "-", "Longitudinal slip up to which the wheel counts as rolling freely.")
STUCK_TIME = Real(0.5, "s", "A sensor that reads one value to the last digit for this long is stuck.")
FEWEST_STUCK_SAMPLES = Count(20, "-", "Equal samples of a stuck sensor at least, at low sampling rates.")
CLIPPED_SAMPLES = Count(6, "-", "Samples in a row at the very end of a channel's range that mean clipping.")
LIVELY_SHARE = Real(0.8, "-", "Share of samples unlike the one before, from which a rest is suspicious.")
MOVED_FORCE = Real(12.0, "-", "Range of Fy, per noise of a sample, that an axis at rest does not explain.")
SPIKE_OVER_NOISE = Real(12.0, "-", "Distance of a spike from its neighbours' median, per standard deviation.")
SPIKE_OF_FORCE = Real(0.15, "-", "Smallest spike of a force, per usual load.")
SPIKE_OF_MOMENT = Real(0.03, "m", "Smallest spike of a moment, per usual load.")
SPIKE_WINDOW = Count(5, "-", "Samples of the running median beside which a spike shows.")
MOST_SAMPLES_FOR_NOISE = Count(100_000, "-", "Samples from which the noise of a channel is estimated.")

# Stretches of a recording
STEP_OF_ANGLE = Real(0.15, "deg", "A change that makes another set-point; a logger's noise is below it.")
STEP_OF_CONDITION = Real(0.08, "-", "Relative change of load, pressure or speed to another set-point.")
STEP_OVER_NOISE = Real(6.0, "-", "Change over the noise of its mean that makes another set-point.")
COMPARED_APART = Real(0.5, "s", "Time between the settings that are compared to find a change.")
EDGE_AVERAGE = Real(0.1, "s", "A condition is averaged over this to find where its change begins and ends.")
SHORTEST_STRETCH = Real(2.0, "s", "Duration that a stretch needs after its transient.")
FEWEST_SAMPLES_OF_STRETCH = Count(8, "-", "Samples that a stretch needs after its transient.")
TRANSIENT_ROLL = Real(2.0, "m", "Rolling distance dropped behind a change: three to ten relaxation lengths.")
SLOWEST_ROLLING = Real(0.1, "m/s", "Smallest speed that is used to convert the transient distance to time.")
STAIRCASE_SHARE = Real(0.5, "-", "Share of rest above which angles move between plateaus, not sweep.")
SMALLEST_SWEEP = Real(3.0, "deg", "Range of an angle that makes its motion a sweep.")
RETURNED_SHARE = Real(0.3, "-", "Share of its range that a sweep beside plateaus goes back, unlike a move.")
GAP_OVER_STEP = Real(5.0, "-", "A gap in time is this many usual steps.")
SHORTEST_GAP = Real(0.1, "s", "A gap in time is at least this long.")
MOST_SAMPLES_FOR_SCALE = Count(20_000, "-", "Samples from which the usual size of the settings is estimated.")
BLOCKS_OF_STRETCH = Count(10, "-", "Blocks of a stretch; leading ones are compared with its second half.")
LEADING_BLOCK = Real(3.5, "-", "Standard errors from the second half that make a block transient.")
PROVEN_DRIFT = Real(6.0, "-", "Standard errors of the change over a stretch that prove a drift.")
HARMLESS_DRIFT_OF_FORCE = Real(0.02, "-", "Drift of Fy within a stretch, per load, that is averaged.")
HARMLESS_DRIFT_OF_MOMENT = Real(0.002, "m", "Drift of Mz within a stretch, per load, that is averaged.")
COLD_TREAD = Real(10.0, "K", "First sweeps are dropped while this much colder than the middle one.")
FEWEST_WARM_SWEEPS = Count(3, "-", "Sweeps that must remain for the first ones to be left out as cold.")
WANDERING_LOAD = Real(0.5, "-", "Range of a load that is not held (5th to 95th percentile), per median.")
MOST_REPEATED_SAMPLES = Real(0.01, "-", "Share of samples that a recorder may have written twice.")
STRETCHES_IN_SENTENCE = Count(3, "-", "Dropped stretches that a sentence names one by one.")

# Means
LARGEST_ORDER_OF_NOISE = Count(4, "-", "Autoregressive: two for noise, two for a ripple per revolution.")
AVERAGED_TIME = Real(0.1, "s", "Time over which the samples of a moving sweep are averaged.")
AVERAGED_ANGLE = Real(0.5, "deg", "Angle over which the samples of a moving sweep are averaged at most.")
FILLED_BLOCK = Real(0.5, "-", "Share of its samples that a block of a moving sweep needs to give a point.")

# Lag of moving sweeps
FORCE_NEAR_ZERO = Real(0.25, "-", "Fy, per largest of its sweep, up to which its curve is nearly straight.")
EVEN_RATE = Real(0.5, "-", "Deviation of the sideslip rate, per usual rate, up to which a lag shows.")
FEWEST_POINTS_AT_ZERO = Count(8, "-", "Points near zero force that each way of a sweep needs.")
WORST_CONDITION_AT_ZERO = Real(1e8, "-", "Condition number beyond which one side of zero force is missing.")
FEWEST_SWEEPS_OF_LAG = Count(3, "-", "Sweeps whose scatter shows how well the median of their lags is known.")
BINS_OF_HYSTERESIS = Count(25, "-", "Bins of the angle in which the two ways of a sweep are compared.")
PROVEN_LAG = Real(2.0, "-", "Standard uncertainties by which a lag differs from zero to be taken off.")

# Bare tables
STAND_IN_PRESSURE = Real(250e3, "Pa", "For a bare table without pressure; the alignment ignores it.")
STAND_IN_SPEED = Real(1.0, "m/s", "For a bare table without speed; the alignment ignores it.")
