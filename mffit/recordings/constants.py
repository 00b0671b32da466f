"""Numbers of judgement by which the units of recordings are guessed."""

from tir.constant import Count, Real, Series

PERCENTILE_OF_SIZE = Real(
    99.5, "%", "Percentile of readings, or of rates of steering, that is their size; ignores single spikes."
)
FASTEST_SPEED_IN_METRES = Real(25.0, "m/s", "Larger speeds are in km/h: rigs run at 90 km/h at most.")
USUAL_CONTACT_PATCH = Real(
    0.02,
    "m2",
    "Load over pressure, from motorcycles (0.006) to lorries (0.04): decides between units of pressure.",
)
TYRE_PRESSURES = Series((40.0, 1200.0), "kPa", "Pressures of tyres, from karts to lorries.")
TIME_BETWEEN_POINTS = Series(
    (5.0, 3600.0),
    "s",
    "Time between the rows of a table of finished points: longer than between the samples of any recording, and less than "
    "a unit other than seconds would give.",
)
STEERING_RATES = Series((0.02, 100.0), "deg/s", "Rates at which rigs steer.")
SAMPLES_PER_RATE = Count(20, "samples", "Distance over which a rate is taken, to average noise of the angle.")
ROLLING_RADIUS_RANGE = Series(
    (0.75, 1.25), "-", "Speed over rotation, in unloaded radii, if the rotation is the wheel's."
)

# Summaries of a test
LARGEST_SUMMARY = Count(1_000_000, "bytes", "Larger tables are not taken for the summary of a test.")

# Disc or belt
ZERO_OF_A_DISC = Real(
    0.8,
    "deg",
    "Zero of the side force beyond which the path is likely curved: ply-steer and conicity move it by 0.3 deg, the alignment "
    "of a belt by 0.2 deg, a disc of 1.3 m radius by 1 to 2 deg.",
)

LOOK_AT_RECORDINGS = Real(
    0.5, "s", "Time between looks at new recordings: a copy that is under way grows meanwhile on any disk."
)
LOOKS_OF_PATIENCE = Count(
    20,
    "-",
    "Looks at a folder for which a file that ends within a line is taken for one that is still being written: programs at a rig "
    "write their buffers every few seconds.",
)
LOOKS_BEFORE_REFUSAL = Count(
    4,
    "-",
    "Looks for which a file that cannot be read must not change until it is refused; it is read again when it does.",
)
