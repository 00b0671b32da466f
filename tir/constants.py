"""Numbers of judgement of ``tir``: how a call is carried out, what a check accepts, what a picture shows.

The equations have none: their constants are those of the sources. Those of the generated code: ``tir/codegen/constants.py``.
"""

from tir.constant import Count, Real, Series

# Calls
SMALLEST_LOAD = Real(
    1e-6, "N", "Replaces a load Fz <= 0, at which formulae are 0/0; the forces returned there are exactly 0."
)
CONDITIONS_PER_BLOCK = Count(
    8192,
    "-",
    "Conditions that numpy computes together, in tir and in mffit; intermediate results stay in the cache.",
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
CONDITIONS_ONE_BY_ONE = Count(
    60, "-", "Fewest conditions of an array that numpy computes sooner than scalar calls one after the other."
)

# Model error
SLIP_OF_FREE_ROLLING = Real(
    0.05,
    "-",
    "Longitudinal slip over which a model error fades where nobody measured it, at zero sideslip: about that of the largest Fx, "
    "where what sideslip did before is gone.",
)

# Text of a file
NAMES_IN_A_SENTENCE = Count(6, "-", "Most keys that a message names; it counts the others.")
LONGEST_WRITTEN_LINE = Count(118, "-", "Longest written line in characters; some readers stop at 120.")
LONGEST_READABLE_LINE = Count(200, "-", "Longest line that the smallest known buffers hold.")
MARGIN_INSIDE_RANGE = Real(
    1e-3, "-", "Distance of starting values from the ends of a usual range, over its width."
)

# Single values that can only be in another unit
LENGTH_RANGE = Series(
    (0.05, 1.5),
    "m",
    "Radii and widths of road vehicles' tyres lie inside; the same numbers are seen in millimetres.",
)
PRESSURE_RANGE = Series(
    (5e3, 1e7), "Pa", "Tyres run within; a smaller number is in kPa or bar; My takes no less."
)
LARGEST_ANGLE = Real(
    1.7, "rad", "Sideslip and camber stay below a right angle; a larger limit is in degrees."
)

# Ranges to which simulations hold their inputs
NARROW_CAMBER_RANGE = Real(0.15, "rad", "Motorcycles lean further than this in ordinary corners.")
USUAL_SIDESLIP = Real(
    15.0,
    "deg",
    "Vehicles rarely slide further: wider limits do not matter, pictures end here, checks at twice as much.",
)
IN_USE = Series(
    (0.5, 1.5),
    "-",
    "Loads drawn and pressures searched, over the nominal ones, even if a file allows others.",
)
LOADS_TO_REACH = Series((0.2, 1.5), "-", "Lowest and highest usual load of vehicles over the nominal one.")

# Physics
EFFECTIVE_RADIUS_RANGE = Series(
    (0.85, 1.05), "-", "Usual effective over unloaded radius; outside, a coefficient is probably wrong."
)
EPS_GAMMA_NEAR_ONE = Real(
    0.1,
    "-",
    "Distance of eps_gamma from 1 below which turn-slip stiffness exceeds ten times that at 0; where zeros suggest it, the "
    "camber stiffness is wrong.",
)
NEGLIGIBLE_SHARE = Real(
    0.01, "-", "Share of a force within the accuracy of a rig and of rounded coefficients."
)
CREDIBLE_FRICTION = Real(4.0, "-", "Larger friction coefficients are extrapolation, not a tyre.")

SLIP_BEYOND_PEAK = Real(
    0.3,
    "-",
    "Longitudinal slip beyond the peak of every tyre: programs differ there, comparisons and conversions end.",
)
SIDESLIP_BEYOND_PEAK = Real(
    20.0,
    "deg",
    "Sideslip beyond the peak of every tyre: programs differ there; conversions and the range of written files end.",
)
SMALL_TURN_SLIP = Real(1e-3, "1/m", "Turn slip of a circle of 1 km: moments of spin are linear in it.")

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
LOWEST_SEARCHED_LOAD = Real(
    0.02, "-", "Lowest searched load over the nominal one; below it no force matters."
)
LARGEST_CAMBER = Real(60.0, "deg", "Largest camber searched and drawn, even if a file allows more.")

# Pictures
POINTS_PER_CURVE = Count(161, "-", "Points of a drawn curve: a smooth peak in a panel of a few centimetres.")
