"""Numbers of judgement by which the units of recordings are guessed."""

from __future__ import annotations

from tir.constant import Count, Real, Series

PERCENTILE_OF_SIZE = Real(
    99.5, "%", "Percentile of the readings that is the size of a column; ignores single spikes."
)
LARGEST_ANGLE_IN_RADIANS = Real(
    1.6, "rad", "Angles that stay below this are in radians: no rig leans a wheel by 90 deg."
)
LARGEST_FORCE_IN_KILONEWTONS = Real(
    100.0, "kN", "Forces that stay below this are in kilonewtons: no sweep has loads of only 100 N."
)
GRIP_THAT_MEANS_ANOTHER_UNIT = Real(
    5.0, "-", "Force over load above which the load has another unit than the force."
)
SHORTEST_LEVER_ARM_IN_RECORDING = Real(
    1e-3, "m", "Largest moment over largest load below which moments are in kN m."
)
FASTEST_SPEED_IN_METRES = Real(25.0, "m/s", "Larger speeds are in km/h: rigs run at 90 km/h at most.")
CAR_TYRE_PRESSURES = Series(
    (50.0, 400.0), "kPa", "Pressures of the tyres of cars, motorcycles and racing cars."
)
LORRY_TYRE_PRESSURES = Series((400.0, 1200.0), "kPa", "Pressures of the tyres of lorries.")
ANY_TYRE_PRESSURES = Series((40.0, 1200.0), "kPa", "No tyre has a pressure outside this range.")
HOTTEST_TREAD_IN_FAHRENHEIT = Real(
    250.0, "degF", "Median of a tread's temperature up to which it may be in degF; kelvin are above."
)
ANY_LOADED_RADII = Series((0.1, 0.8), "m", "Loaded radii of tyres, from karts to lorries.")
LARGEST_LEVER_ARM_IN_FEET = Real(
    0.4,
    "-",
    "Largest moment over largest load, both without units, below which American moments are in ft-lb: with lever arms of "
    "20 to 60 mm it is 0.07 to 0.2 in feet and 0.8 to 2.4 in inches.",
)
LORRY_LOAD = Real(10_000.0, "N", "Largest load above which the tyre is one of a lorry.")
RECORDED_TIME_STEPS = Series((1e-5, 5.0), "s", "Time between samples of a moving angle.")
SHORTEST_RECORDING = Real(
    1.0, "s", "Shortest recording of a moving angle; a time that gives less is not in ms or us."
)
TIME_BETWEEN_POINTS = Series(
    (5.0, 3600.0),
    "s",
    "Time between the rows of a table of finished points: longer than between the samples of any recording, and less than "
    "a unit other than seconds would give.",
)
STEERING_RATES = Series((0.02, 100.0), "deg/s", "Rates at which rigs steer.")
STEERING_PERCENTILE = Real(95.0, "%", "Percentile of the rates that is the rate of steering; ignores pauses.")
STEERING_TRAVEL = Real(1.0, "deg", "Smaller motions of an angle show no rate.")
SAMPLES_PER_RATE = Count(20, "samples", "Distance over which a rate is taken, to average noise of the angle.")
LARGEST_SLIP_AS_RATIO = Real(
    2.0,
    "-",
    "Size of a column of slip above which it is in per cent: no rig drives a wheel at three times the speed.",
)
ROLLING_RADIUS_RANGE = Series(
    (0.75, 1.25), "-", "Speed over rotation, in unloaded radii, if the rotation is the wheel's."
)

# Summaries of a test
LARGEST_SUMMARY = Count(1_000_000, "bytes", "Larger tables are not taken for the summary of a test.")
SET_POINT_TOLERANCE = Real(
    2.0,
    "-",
    "Distance of a recorded level from its set-point, in tolerances of a level: 16 % of the load, which programmes step by a "
    "quarter.",
)

# Disc or belt
ZERO_OF_A_DISC = Real(
    0.8,
    "deg",
    "Zero of the side force beyond which the path is likely curved: ply-steer and conicity move it by 0.3 deg, the alignment "
    "of a belt by 0.2 deg, a disc of 1.3 m radius by 1 to 2 deg.",
)
NEAR_STRAIGHT = Real(3.0, "deg", "Sideslip up to which the side force is nearly straight.")
FEWEST_FOR_ZERO = Count(5, "-", "Fewest points that show where the side force vanishes.")
FEWEST_FOR_PATTERN = Count(4, "-", "Fewest recordings that are named by one pattern instead of one by one.")
