"""Numbers of judgement of the fit, of the derived files and of the warnings."""

from tir.constant import Count, Real, Series

# Weights
HUBER_THRESHOLD = Real(4.0, "-", "Residuals beyond this many robust standard deviations lose weight (Huber).")
NOMINAL_NOISE_SHARE = Real(0.01, "-", "Standard uncertainty over the range of a channel that states none.")

# What the points determine
STRONG_CORRELATION = Real(0.95, "-", "Smallest absolute correlation of two coefficients that is stated.")

# Prior knowledge of coefficients
SIMILAR_TYRES_SPREAD = Real(0.3, "-", "Relative standard deviation of a coefficient among similar tyres.")
LEAST_SPREAD_BASE_FILE = Real(
    0.05, "-", "Smallest standard deviation around a base file's value, over the usual range."
)
LEAST_SPREAD_DEFAULT = Real(
    0.1,
    "-",
    "Smallest standard deviation around the table's default, over the usual range, where published files say none.",
)
CONDITIONS_OF_A_MISFIT = Count(
    500, "-", "Drawn conditions at which a base at other nominal conditions is compared with itself."
)

# Radii
USUAL_MISFIT_OF_RADIUS = Real(
    0.0003,
    "m",
    "Scatter of a loaded or rolling radius where as many coefficients as means leave none to see.",
)

# Estimates of what was not measured
SLIP_OVER_CORNERING_STIFFNESS = Real(
    1.3,
    "-",
    "Longitudinal slip stiffness over cornering stiffness, at nominal load; published tyres have 0.8 to 1.8.",
)

# Physical limits
LIMIT_MARGIN = Real(0.02, "-", "Distance kept from a physical limit, in units of its violation.")
LEAST_FRICTION = Real(
    0.1, "-", "Physical limit: smallest friction, and smallest force over load of a driven wheel."
)
LEAST_STIFFNESS = Real(0.5, "-", "Physical limit: smallest cornering or slip stiffness over load.")
LEAST_SLOPE_FACTOR = Real(
    0.3, "-", "Physical limit: smallest slope factor of the trail and of the weights of combined slip."
)
LEAST_TRAIL = Real(0.0005, "m", "Physical limit: smallest pneumatic trail at zero slip.")
LARGEST_WEIGHT = Real(
    1.1, "-", "Physical limit: largest weight of combined slip; a shift of its peak puts it slightly above 1."
)
LARGEST_DENT = Real(
    0.002,
    "-",
    "Largest dent, in the same measure, that counts as convex; published tyres have none of this size.",
)
LOADS_OF_A_GRID = Count(3, "-", "Loads at which limits, bands and files are looked at over a range.")
CAMBERS_OF_A_GRID = Count(5, "-", "Cambers of such a grid.")
STEPS_OF_A_GRID = Count(9, "-", "Values of such a grid along which a curve is followed.")
LIMIT_WEIGHT_OF_FIT = Real(
    3000.0, "-", "Residual per unit of violation (noise is 1): holds the limit, keeps the problem smooth."
)
LIMIT_WEIGHT_OF_DERIVED_FILE = Real(
    15.0, "-", "The same for a derived file, whose misfit is of the order of 1."
)

# Passes of the fit
POINTS_OF_A_STAGE = Count(600, "-", "Most points of a first pass; the polish uses all.")
STRIDE_DIVISOR = Count(8, "-", "Factor by which the points increase from pass to pass of the polish.")
STAGE_TOLERANCE = Real(
    1e-3,
    "-",
    "Relative gain that ends an early pass of a search, the fit of an explanation or that of a conversion.",
)
REFIT_STEPS = Count(12, "-", "Most least-squares steps of a refit that starts near its solution.")
REFIT_TOLERANCE = Real(1e-4, "-", "Relative gain that ends such a refit.")

# Bands
WIDER_BANDS = Real(
    1.5, "-", "Ratio of a band or an uncertainty to the usual one above which the report explains it."
)

# Ensemble
MOST_DRAWS = Count(20, "-", "Most draws of a tyre until the physical limits hold: half of them do, or more.")

# Ranges of the written file
RANGE_SHARES = Series(
    (1.0, 0.75, 0.5, 0.25), "-", "Shares of the way to the intended end of a range that are tried in turn."
)
WRITTEN_CAMMAX = Real(45.0, "deg", "Camber up to which a file's range may exceed the tested one.")
BEYOND_TESTED = Real(
    1.5, "-", "End of the range of load, camber and slip that a file may be used in, over the tested one."
)
AROUND_A_SINGLE_VALUE = Real(0.1, "-", "Relative range to either side of a single load or pressure.")
UNTESTED_ANGLE = Real(
    2.0, "deg", "Range of sideslip or camber that sweeps do not vary and the base does not state."
)
WRITTEN_FZMIN_SHARE = Real(0.1, "-", "Intended smallest load of a file over the smallest tested one.")
WRITTEN_PRESSURE_SHARE = Real(0.2, "-", "Intended relative distance of pressures beyond the tested ones.")
OFF_THE_TESTED_SLOPE = Real(
    0.05,
    "-",
    "Largest change of grip or stiffness over load beyond the tested loads and pressures that their slope over these does not "
    "allow, over the value at the tested end.",
    "docs/fit.md",
)
FASTEST_CHANGE = Real(
    3.0,
    "-",
    "Fastest change of the logarithm of grip or stiffness over load, per unit of the logarithm of load or pressure and per "
    "radian of camber, and fastest fall of the side force per radian of sideslip: just above what public tyres do.",
    "docs/fit.md",
)

# Conditions at which files are derived and compared
LITTLE_WEIGHT = Real(
    0.02,
    "-",
    'Weight of what is kept plausible at little cost: untested conditions, and with [normal] weight = "road" a fall.',
)
WEIGHT_IN_CORNER = Real(0.5, "-", "Weight of conditions with large sideslip and large camber.")
LARGE_SIDESLIP = Real(4.0, "deg", "Sideslip that counts as large: it shows friction, not only stiffness.")
LARGE_CAMBER = Real(25.0, "deg", "Camber that counts as large together with large sideslip.")
ROAD_RADII = Series((100.0, 30.0, 10.0), "m", "Roads for which the missing turn-slip force is stated.")

# Derived files
MISFIT_UNIT_FY = Real(0.01, "-", "Misfit of Fy over nominal load that no camber terms avoid.", "docs/fit.md")
MISFIT_UNIT_MZ = Real(0.001, "m", "Misfit of Mz over nominal load that no camber terms avoid.", "docs/fit.md")

# Comments
COMMENT_LENGTH = Count(66, "-", "Characters of a comment that fit on a line of the property file.")

# Rig errors
RIG_ERROR_REACH = Real(
    8.0, "-", "Standard uncertainties that a rig error may move; beyond them the declaration is wrong."
)

FLAT_TRACK_ZERO_REACH = Real(
    3.0,
    "-",
    "Standard uncertainties that a zero of a flat track with one set-up may move. Ply-steer and conicity take up a larger one; "
    "beyond it, what looks like a zero is misfit of the formula that follows the sweeps.",
)

SPIN_CORRECTION_OF_MODEL = Real(
    0.05,
    "-",
    "Standard uncertainty of the formula, over the difference of the cornering stiffnesses without and with spin.",
)

# Relaxation lengths from steps
LEAST_MOVE_OF_A_STEP = Real(
    0.02,
    "-",
    "Move between two samples, over the largest one of a run of steps, that is part of a step rather than noise of the setting.",
)
