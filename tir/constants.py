"""Numbers of judgement of ``tir``: how a call is carried out, what a check accepts, what a picture shows.

The equations have none: their constants are those of the sources. Those of the generated code: ``tir/codegen/constants.py``.
"""

from __future__ import annotations

from tir.constant import Count, Real, Series

# Calls
SMALLEST_LOAD = Real(
    1e-6, "N", "Replaces a load Fz <= 0, at which formulae are 0/0; the forces returned there are exactly 0."
)
CONDITIONS_PER_BLOCK = Count(
    8192, "-", "Conditions that numpy computes together; intermediate results stay in the cache."
)
SCALAR_CALLS_WORTH_LOADING = Count(
    4000, "-", "Scalar calls before a kernel is loaded: half the time that loading takes.", "docs/speed.md"
)
CONDITIONS_WORTH_LOADING = Count(
    250_000,
    "-",
    "Conditions computed in numpy before a kernel is loaded: about the time that loading takes.",
    "docs/speed.md",
)
CONDITIONS_PER_CALL = Count(
    1000, "-", "Conditions that take as long as what every call in numpy takes beside them.", "docs/speed.md"
)
COMPILE_FROM_CONDITIONS = Count(
    1_000_000,
    "-",
    "A call with this many conditions waits for the compiler, if the kernel is not in the cache.",
    "docs/speed.md",
)
THREADS_FROM_CONDITIONS = Count(32_768, "-", "A call with this many conditions is worth starting threads.")

# Text of a file
NAMES_IN_A_SENTENCE = Count(6, "-", "Most keys that a message names; it counts the others.")
LONGEST_WRITTEN_LINE = Count(118, "-", "Longest written line in characters; some readers stop at 120.")
LONGEST_READABLE_LINE = Count(200, "-", "Longest line that the smallest known buffers hold.")
MARGIN_INSIDE_RANGE = Real(
    1e-3, "-", "Distance of starting values from the ends of a usual range, over its width."
)

# Single values that can only be in another unit
RADIUS_RANGE = Series((0.05, 1.5), "m", "Unloaded radii of road vehicles' tyres lie well inside.")
RADIUS_IN_MILLIMETRES = Real(50.0, "m", "A larger number for a radius can only be in millimetres.")
WIDEST_TYRE = Real(2.0, "m", "No tyre is wider; a larger number is in millimetres or inches.")
LOWEST_PRESSURE = Real(5e3, "Pa", "No tyre runs with less; a smaller number is in kPa or bar.")
HIGHEST_PRESSURE = Real(1e7, "Pa", "No tyre holds more.")
LARGEST_SIDESLIP_LIMIT = Real(1.7, "rad", "More than a right angle, so a larger limit is in degrees.")
LARGEST_CAMBER_LIMIT = Real(1.6, "rad", "More than a wheel lying flat, so a larger limit is in degrees.")

# Ranges to which simulations hold their inputs
NARROW_CAMBER_RANGE = Real(0.15, "rad", "Motorcycles lean further than this in ordinary corners.")
NARROW_SIDESLIP_RANGE = Real(15.0, "deg", "Vehicles rarely slide further, so a wider limit does not matter.")
LOADS_TO_REACH = Series((0.2, 1.5), "-", "Lowest and highest usual load of vehicles over the nominal one.")
SIDESLIP_FOR_THE_PEAK = Series((0.1, 30.0), "deg", "Range in which the peak of the side force is searched.")
STEPS_FOR_THE_PEAK = Count(300, "-", "Angles at which the side force is computed to find its peak.")

# Physics
EFFECTIVE_RADIUS_RANGE = Series(
    (0.85, 1.05), "-", "Usual effective over unloaded radius; outside, a coefficient is probably wrong."
)
EPS_GAMMA_NEAR_ONE = Real(
    0.1, "-", "Distance of eps_gamma from 1 below which turn-slip stiffness exceeds ten times that at 0."
)
CAMBER_FORCE_MISMATCH = Real(
    0.01, "-", "Relative difference of camber forces with and without turn slip due to rounded coefficients."
)
NO_CAMBER_FORCE = Real(1e-9, "N", "Smaller camber forces are zero but for rounding.")
CREDIBLE_FRICTION = Real(4.0, "-", "Larger friction coefficients are extrapolation, not a tyre.")
REVERSED_FORCE_SHARE = Real(
    0.01, "-", "Share by which a force may change its sign: within the accuracy of a rig."
)

# Search for the worst point of a file's ranges
VALUES_PER_SEARCHED_RANGE = Series(
    (7, 9, 5, 9, 5), "-", "Values of load, camber, pressure, sideslip and longitudinal slip per round."
)
ROUNDS_OF_THE_SEARCH = Count(
    4, "-", "Rounds of the search; each narrows to the neighbourhood of the worst point."
)
JUST_OUTSIDE = Real(
    0.1, "-", "Distance beyond a range, over its width, to which a simulation may extrapolate."
)
LOWEST_SHARE_OUTSIDE = Real(
    0.2, "-", "Share of the lower end of a range down to which load and pressure are searched."
)
LOWEST_SEARCHED_LOAD = Real(
    0.02, "-", "Lowest searched load over the nominal one; below it no force matters."
)
SEARCHED_CAMBER = Real(1.05, "rad", "Largest searched camber, 60 deg, even if a file allows more.")
SEARCHED_SIDESLIP = Real(0.5, "rad", "Largest searched sideslip, even if a file allows more.")
SEARCHED_PRESSURES = Series(
    (0.5, 1.5), "-", "Searched pressures over the nominal one, even if a file allows others."
)
LOADS_FOR_EPS_GAMMA = Count(21, "-", "Loads over the range at which eps_gamma is checked.")

# Pictures
DRAWN_LOADS = Series((0.5, 1.0, 1.5), "-", "Loads of a picture over the nominal one.")
DRAWN_SIDESLIP = Real(15.0, "deg", "End of a picture even if the file's range is wider.")
DRAWN_CAMBER = Real(50.0, "deg", "End of a picture even if the file's range is wider.")
DRAWN_SLIP = Real(0.3, "-", "End of a picture even if the file's range is wider.")
POINTS_PER_CURVE = Count(161, "-", "Points of a drawn curve: a smooth peak in a panel of a few centimetres.")
NOTEBOOK_DPI = Count(80, "-", "Resolution of a notebook's picture: small in the file, readable on a screen.")
