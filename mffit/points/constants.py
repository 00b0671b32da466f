"""Numbers of judgement of reading and reduction."""

from tir.constant import Count, Real, Series

# Levels of the set-points; those of camber and sideslip are UPRIGHT and STRAIGHT of mffit/constants.py. A tolerance is three
# standard deviations of a rig's control.
CONDITION = Real(
    0.08,
    "-",
    "Loads and speeds of one level differ by less, relatively; a larger change is another set-point.",
)
PRESSURE = Real(10e3, "Pa", "Pressures of one level differ by less.")
SLIP = Real(
    0.02,
    "-",
    "Longitudinal slips of one level differ by less: a wheel rolls freely up to it.",
)
LEVEL_FLANK = Real(
    0.3, "-", "Density over that half a tolerance away below which values are a flank of that level."
)
HELD_LOAD = Real(
    0.5,
    "-",
    "Range of the load over its median up to which a sweep holds it: braking disturbs its control by 18 % to either side.",
)
CORE = Series(
    (5.0, 95.0), "%", "Percentiles between which a setting's range is taken; ignores single values."
)

# Samples that are not measurements
UNLOADED = Real(0.1, "-", "Share of the usual load below which the tyre is off the belt.")
SPIKE = Real(0.15, "-", "Smallest spike of a force over the usual load.")
HARMLESS_DRIFT = Real(0.02, "-", "Drift of a force within a stretch, over the load, that is averaged.")
ARM = Real(
    0.2, "m", "What counts for a force counts for a moment with this arm, the largest that a tyre has."
)

SPIKE_WINDOW = Count(5, "-", "Samples of the running median that shows spikes.")

# Stretches of a recording
STEP_OF_ANGLE = Real(
    0.15, "deg", "Smallest change that makes another set-point; the noise of a logger is below it."
)
COMPARED_APART = Real(
    0.5,
    "s",
    "Time between readings that are compared: a setting that changed, a sensor that is stuck shows over it.",
)
SHORTEST_STRETCH = Real(
    2.0, "s", "Stretch after its transient that is long enough although the wheel hardly rolls."
)
FEWEST_POINTS = Count(8, "-", "Fewest samples or points that show a level, a line or a noise.")
TRANSIENT_ROLL = Real(
    2.0,
    "m",
    "Distance dropped after a change: three to ten relaxation lengths; what rests as long again, a turn of a wheel, is long "
    "enough for a mean.",
)
SMALLEST_SWEEP_OF_SLIP = Real(
    0.05,
    "-",
    "Smallest range of a sweep of longitudinal slip; every tyre has a longitudinal force beyond it.",
)
GAP_OVER_STEP = Real(
    5.0, "-", "Smallest gap in time over the usual step: readings begin anew, and errors with a memory."
)
BLOCKS_OF_STRETCH = Count(10, "-", "Blocks of a stretch; leading ones are compared with its second half.")

# Means of moving sweeps
LARGEST_ORDER_OF_NOISE = Count(
    4, "-", "Autoregressive order: two for noise, two for a ripple such as once per revolution."
)
AVERAGED_TIME = Real(0.1, "s", "Averaging time of a moving sweep, and shortest gap in time.")
RANGE_OF_A_TURN = Real(
    2.0,
    "-",
    "One turn of the wheel over the usual averaging time up to which means are over whole turns: within it a curve over slip "
    "bends by 0.4 % of its peak at most.",
)
NEAR_ZERO = Real(0.25, "-", "Fx over the load below which its curve over slip is nearly straight.")

# Files under like conditions
UNLIKE_SHARE = Real(
    0.1,
    "-",
    "Difference of the side forces of two files at like conditions, over their size, that is pointed out: 20 K change them by "
    "6 %, a worn tread by less.",
)

# Definition of slip
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
LARGEST_BRAKE_SLIP_OF_FORM = Real(
    0.9, "-", "Slip of braking beyond which the wheel nearly stands and speeds imply no radius."
)

# Steps of the sideslip angle and of longitudinal slip
LONGEST_STEP = Real(
    0.5,
    "-",
    "Way of a step, and distance between samples, over the unloaded radius: relaxation lengths are 0.25 to 2 radii.",
)
SHORTEST_REST = Real(3.0, "-", "Distance rolled after a step, over the unloaded radius.")
