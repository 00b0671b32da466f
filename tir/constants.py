"""Numbers of judgement of ``tir``: how a call is carried out, what a check accepts, what a picture shows.

The equations have none: their constants are those of the sources. Those of the generated code: ``tir/codegen/constants.py``.
"""

from __future__ import annotations

from tir.constant import Count, Real, Series

# Calls
SMALLEST_LOAD = Real(
    1e-6,
    "N",
    "Replaces a load Fz <= 0, at which several formulae are 0/0; the forces returned there are exactly 0.",
)
CONDITIONS_PER_BLOCK = Count(
    8192,
    "-",
    "Conditions that numpy computes together, so that intermediate results stay in the processor's cache.",
)
COMPILE_FROM_CONDITIONS = Count(
    100_000,
    "-",
    "A call with this many conditions pays for loading the compiled kernel, or compiling it once after installation.",
    "docs/speed.md",
)
THREADS_FROM_CONDITIONS = Count(
    32_768,
    "-",
    "A call with this many conditions pays for starting threads.",
)

# Text of a file
NAMES_IN_A_SENTENCE = Count(6, "-", "A message names this many keys and counts the others.")
LONGEST_WRITTEN_LINE = Count(118, "-", "Characters of a line; some readers stop at 120.")
LONGEST_READABLE_LINE = Count(200, "-", "Characters of a line that the shortest known buffers hold.")
MARGIN_INSIDE_RANGE = Real(
    1e-3,
    "-",
    "Share of a plausible range by which a starting value keeps off its ends, where a search can be held.",
)

# Single values that can only be in another unit
RADIUS_RANGE = Series((0.05, 1.5), "m", "Unloaded radii of road vehicles' tyres lie well inside.")
RADIUS_IN_MILLIMETRES = Real(50.0, "m", "A larger number for a radius can only be in millimetres.")
WIDEST_TYRE = Real(2.0, "m", "No tyre is wider; a larger number is in millimetres or inches.")
LOWEST_PRESSURE = Real(5e3, "Pa", "No tyre runs below; a smaller number is in kPa or bar.")
HIGHEST_PRESSURE = Real(1e7, "Pa", "No tyre holds more.")
LARGEST_SIDESLIP_LIMIT = Real(1.7, "rad", "More than a right angle; a larger limit is in degrees.")
LARGEST_CAMBER_LIMIT = Real(1.6, "rad", "More than a wheel lying flat; a larger limit is in degrees.")

# Ranges to which simulations hold their inputs
NARROW_CAMBER_RANGE = Real(0.15, "rad", "Motorcycles lean further in ordinary corners.")
NARROW_SIDESLIP_RANGE = Real(
    15.0, "deg", "Vehicles rarely slide further, so a limit beyond this does not matter."
)
LOADS_TO_REACH = Series(
    (0.2, 1.5), "-", "Lowest and highest load, over the nominal one, that vehicles usually reach."
)
SIDESLIP_FOR_THE_PEAK = Series((0.1, 30.0), "deg", "Range in which the peak of the side force is searched.")
STEPS_FOR_THE_PEAK = Count(300, "-", "Angles at which the side force is computed to find its peak.")

# Physics
EFFECTIVE_RADIUS_RANGE = Series(
    (0.85, 1.05),
    "-",
    "Effective over unloaded radius of usual tyres; outside, a coefficient is probably wrong.",
)
EPS_GAMMA_NEAR_ONE = Real(
    0.1,
    "-",
    "Distance of eps_gamma from 1 below which the turn-slip stiffness is over ten times that at eps_gamma = 0.",
)
CAMBER_FORCE_MISMATCH = Real(
    0.01,
    "-",
    "Relative difference of the camber forces with and without turn slip that rounded coefficients may leave.",
)
NO_CAMBER_FORCE = Real(1e-9, "N", "A smaller camber force is zero but for rounding.")
CREDIBLE_FRICTION = Real(4.0, "-", "A larger friction coefficient is an extrapolation, not a tyre.")
REVERSED_FORCE_SHARE = Real(
    0.01, "-", "A force may change its sign by this share: a rig cannot tell it from zero."
)

# Search for the worst point of a file's ranges
VALUES_PER_SEARCHED_RANGE = Series(
    (7, 9, 5, 9, 5),
    "-",
    "Values of load, camber, pressure, sideslip and longitudinal slip that one round combines.",
)
ROUNDS_OF_THE_SEARCH = Count(4, "-", "The search narrows to the neighbourhood of its worst point this often.")
JUST_OUTSIDE = Real(0.1, "-", "How far beyond a range a simulation may extrapolate, as a share of its width.")
LOWEST_SHARE_OUTSIDE = Real(
    0.2, "-", "Below a range, load and pressure are searched down to this share of its end."
)
LOWEST_SEARCHED_LOAD = Real(0.02, "-", "Over the nominal load; below it no force matters.")
SEARCHED_CAMBER = Real(1.05, "rad", "60 deg: no tyre is judged beyond, whatever its file allows.")
SEARCHED_SIDESLIP = Real(0.5, "rad", "No tyre is judged beyond, whatever its file allows.")
SEARCHED_PRESSURES = Series((0.5, 1.5), "-", "Over the nominal pressure; no tyre is judged outside.")
LOADS_FOR_EPS_GAMMA = Count(21, "-", "Loads at which eps_gamma is looked at over the load range.")

# Pictures
DRAWN_LOADS = Series((0.5, 1.0, 1.5), "-", "Loads of a picture, over the nominal one.")
DRAWN_SIDESLIP = Real(15.0, "deg", "A picture ends here even if the file's range goes further.")
DRAWN_CAMBER = Real(50.0, "deg", "A picture ends here even if the file's range goes further.")
DRAWN_SLIP = Real(0.3, "-", "A picture ends here even if the file's range goes further.")
POINTS_PER_CURVE = Count(161, "-", "Enough for a smooth peak in a panel of a few centimetres.")
NOTEBOOK_DPI = Count(80, "-", "Resolution of a notebook's picture: small in the file, readable on a screen.")
