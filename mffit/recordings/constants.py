"""Numbers of judgement by which the units of recordings are guessed."""

from __future__ import annotations

from tir.constant import Count, Real, Series

PERCENTILE_OF_SIZE = Real(
    99.5, "%", "The size of a column is this percentile of its readings: one spike is not another unit."
)
LARGEST_ANGLE_IN_RADIANS = Real(
    1.6, "rad", "Angles that all stay below this are in radians: no rig leans a wheel by 90 deg."
)
LARGEST_FORCE_IN_KILONEWTONS = Real(
    100.0,
    "kN",
    "Forces that all stay below this number are in kilonewtons: no sweep has loads of only 100 N.",
)
GRIP_THAT_MEANS_ANOTHER_UNIT = Real(
    5.0,
    "-",
    "If another force is more than this times the load, the load has another unit than the other forces.",
)
SHORTEST_LEVER_ARM_IN_RECORDING = Real(
    1e-3, "m", "If the largest moment over the largest load is below this, the moments are in kN m."
)
FASTEST_SPEED_IN_METRES = Real(
    25.0, "m/s", "Speeds below this number are in m/s, larger ones in km/h: rigs run at 90 km/h at most."
)
CAR_TYRE_PRESSURES = Series(
    (50.0, 400.0), "kPa", "Pressures of the tyres of cars, motorcycles and racing cars."
)
LORRY_TYRE_PRESSURES = Series((400.0, 1200.0), "kPa", "Pressures of the tyres of lorries.")
ANY_TYRE_PRESSURES = Series((40.0, 1200.0), "kPa", "Pressures outside this range belong to no tyre.")
LORRY_LOAD = Real(10_000.0, "N", "If the largest load exceeds this, the tyre is one of a lorry.")
RECORDED_TIME_STEPS = Series((1e-5, 5.0), "s", "Time between samples of a moving angle.")
STEERING_RATES = Series((0.02, 100.0), "deg/s", "Rates at which rigs steer.")
STEERING_PERCENTILE = Real(
    95.0, "%", "The rate of steering is this percentile of the rates, so that pauses do not count."
)
STEERING_TRAVEL = Real(1.0, "deg", "An angle that moves less than this shows no rate.")
SAMPLES_PER_RATE = Count(
    20, "samples", "Distance over which a rate is taken, so that noise of the angle does not count."
)
RATES_PER_RECORDING = Count(
    4, "-", "If a recording is not longer than this many distances, rates are taken from sample to sample."
)
FEWEST_SAMPLES_FOR_RATE = Count(5, "samples", "A shorter recording gives no rate.")
ROLLING_RADIUS_RANGE = Series(
    (0.75, 1.25),
    "-",
    "Speed over speed of rotation is within these multiples of the unloaded radius if the column is the wheel's.",
)
LONGEST_TEXT_OF_RECORDING = Count(
    60, "characters", "Tyre or title of a recording in tyre.toml is cut after this."
)
