"""Numbers of judgement of the fit, of the derived files and of the warnings."""

from __future__ import annotations

from tir.constant import Count, Real, Series

# Weights
HUBER_THRESHOLD = Real(4.0, "-", "Residuals beyond this many robust standard deviations lose weight (Huber).")
OUTLIER_FALSE_ALARM = Real(0.01, "-", "Probability that noise makes any reading of a channel an outlier.")
OUTLIER_NEIGHBOURS = Series((-2, -1, 1, 2), "-", "Offsets of the rows that a reading is compared with.")
NOMINAL_NOISE_SHARE = Real(0.01, "-", "Uncertainty over the range of a channel that states none.")

# What the points determine
ZERO_CAMBER_LIMIT = Real(1.0, "deg", "Points with less camber count as points without camber.")
COUPLED_ALPHA = Real(0.5, "deg", "Least sideslip of a camber point that counts as sideslip with camber.")
FITTED_SHARE_OF_PRIOR = Real(
    0.5,
    "-",
    "A coefficient is fitted, not regularised, if its standard error is below this share of its prior's.",
)
STRONG_CORRELATION = Real(0.95, "-", "Least absolute correlation of two coefficients that is stated.")

# Prior knowledge of coefficients
SIMILAR_TYRES_SPREAD = Real(0.3, "-", "Relative standard deviation of a coefficient among similar tyres.")
LEAST_SPREAD_BASE_FILE = Real(
    0.05, "-", "Least prior spread around a base file's value, per plausible width."
)
LEAST_SPREAD_DEFAULT = Real(0.1, "-", "Least prior spread around the table's default, per plausible width.")
SAME_NOMINAL_CONDITION = Real(0.01, "-", "Relative difference of nominal conditions that are comparable.")

# Estimates of what a cornering test does not measure
ESTIMATED_STATIC_DEFLECTION = Real(0.05, "-", "Static deflection at nominal load over unloaded radius.")
ESTIMATED_DAMPING_TIME = Real(0.0005, "s", "Vertical damping over vertical stiffness.")
ESTIMATED_LONGITUDINAL_STIFFNESS = Real(1.5, "-", "Longitudinal over vertical stiffness.")
ESTIMATED_LATERAL_STIFFNESS = Real(0.7, "-", "Lateral over vertical stiffness.")
ESTIMATED_SLIP_STIFFNESS = Real(1.3, "-", "Longitudinal slip stiffness over cornering stiffness.")
ESTIMATED_OVERTURNING_ARM = Real(0.5, "-", "Lever arm of the load per radian of camber over the width.")

# Starting values
LEAST_STARTING_FRICTION = Real(0.5, "-", "Least lateral friction at which the fit starts.")
PKY2_STARTS = Series((0.5, 5.0), "-", "Range of PKY2, the load of greatest stiffness, that is searched.")
PKY2_START_COUNT = Count(46, "-", "Values of PKY2 that are tried for the start: steps of 0.1.")

# Physical limits
LIMIT_MARGIN = Real(0.02, "-", "Distance kept from a physical limit, in units of its violation.")
LEAST_FRICTION = Real(0.1, "-", "Physical limit: least lateral friction.")
LEAST_CORNERING_STIFFNESS = Real(0.5, "1/rad", "Physical limit: least cornering stiffness over load.")
LEAST_TRAIL_SLOPE_FACTOR = Real(0.3, "-", "Physical limit: least slope factor B_t of the trail.")
LEAST_TRAIL = Real(0.0005, "m", "Physical limit: least pneumatic trail at zero slip.")
LIMIT_GRID = Series((3, 5, 2), "-", "Loads, camber angles and pressures at which the limits are tested.")
LIMIT_WEIGHT_OF_FIT = Real(
    3000.0,
    "-",
    "Residual per unit of violation, the noise being 1: holds the limit, keeps the problem smooth.",
)
LIMIT_WEIGHT_OF_DERIVED_FILE = Real(
    15.0, "-", "Residual per unit of violation in a derived file, the misfit being of the order of 1."
)

# Stages and polish
POINTS_OF_A_STAGE = Count(600, "-", "Points of a stage or first pass; the polish uses all points.")
STRIDE_DIVISOR = Count(8, "-", "Factor by which the points increase from one pass of the polish to the next.")
RESTART_MISFIT = Real(1.3, "-", "Misfit over stated noise above which alternative starting values are tried.")
RESTART_GAIN = Real(0.97, "-", "A restart is kept if its sum of squares is below this share of the best one.")
STAGE_STEPS = Count(15, "-", "Least-squares steps of a stage at most.")
STAGE_TOLERANCE = Real(1e-3, "-", "Relative gain that ends the search of a stage or of an early pass.")
POLISH_TOLERANCE = Real(1e-6, "-", "Relative gain that ends the search of the joint polish.")
FREE_EPSILON_TOLERANCE = Real(1e-5, "-", "Relative gain that ends the refit with PECP1 free.")
REFIT_STEPS = Count(12, "-", "Least-squares steps of a refit that starts near its solution, at most.")
REFIT_TOLERANCE = Real(1e-4, "-", "Relative gain that ends a refit that starts near its solution.")

# Profiles of the sum of squares
PROBE_DISTANCE = Real(2.0, "-", "Standard errors from the best fit at which the quadratic form is tested.")
BENT_VALLEY_RATIO = Real(3.0, "-", "Ratio to the quadratic form above which a valley counts as bent.")
PROBE_POINTS = Count(300, "-", "Points that suffice to show whether a valley is bent.")
PROBED_DIRECTIONS = Count(8, "-", "Least determined directions that are probed.")
PROFILE_STEPS = Count(7, "-", "Steps along a bent valley to either side at most.")
PROFILE_STEP_GROWTH = Real(1.7, "-", "Growth of the steps along a bent valley.")
WIDER_INTERVAL = Real(1.01, "-", "A profile interval is stated if it is wider than usual by this factor.")
BETTER_ON_PROFILE = Real(0.999, "-", "A fit met on a profile is better if its sum is below this share.")

# Ensemble
DRAWS_PER_MEMBER = Count(3, "-", "Draws per member of an ensemble at most; some break a physical limit.")
DRAWN_LIMIT_MARGINS = Real(2.0, "-", "Violation of a limit that a drawn tyre may have, over the margin.")

# Ranges of the written file
SINGLE_PRESSURE_SPREAD = Real(0.05, "-", "Relative spread of pressures up to which they count as one.")
SINGLE_PRESSURE_COVER = Real(0.1, "-", "Relative distance from a single pressure that the limits cover.")
RANGE_SHARES = Series((1.0, 0.75, 0.5, 0.25), "-", "Shares of the way to a wished end, tried in turn.")
WRITTEN_ALPMAX = Real(20.0, "deg", "Wished sideslip range of a file.")
WRITTEN_CAMMAX = Real(45.0, "deg", "Camber up to which a file's range may exceed the tested one.")
WRITTEN_CAMMAX_GROWTH = Real(1.5, "-", "Largest camber range of a file over the tested one.")
WRITTEN_FZMIN_SHARE = Real(0.1, "-", "Wished least load of a file over the least tested one.")
WRITTEN_FZMAX_SHARE = Real(1.5, "-", "Wished largest load of a file over the largest tested one.")
WRITTEN_PRESSURE_SHARE = Real(0.2, "-", "Wished relative distance of pressures beyond the tested ones.")
LEAST_REMAINING_FORCE = Real(0.5, "-", "Share of its peak that the side force keeps over the sideslip range.")
REMAINING_FORCE_ALPHA = Real(0.07, "rad", "Sideslip from which the side force is tested, if that was run.")
REMAINING_FORCE_GRID = Series((13, 3), "-", "Sideslip angles and loads at which the side force is tested.")
REMAINING_FORCE_CAMBERS = Series((-0.5, 0.0, 0.5), "-", "Camber of that test over the largest camber.")

# Conditions at which files are derived and compared
WEIGHT_OUTSIDE_TESTED = Real(0.02, "-", "Weight of conditions not tested: plausible, at little cost inside.")
WEIGHT_IN_CORNER = Real(0.5, "-", "Weight of conditions with both large sideslip and large camber.")
ROAD_ALPHA_SCALE = Real(4.0, "deg", "Sideslip that counts as large together with large camber.")
ROAD_GAMMA_SCALE = Real(25.0, "deg", "Camber that counts as large together with large sideslip.")
CAMBER_LINE_GRID = Series((3, 17), "-", "Lines, one per load, that keep camber thrust; their angles.")
MODERATE_CAMBER = Real(30.5, "deg", "Camber up to which the misfit at moderate camber is stated.")
ROAD_RADII = Series((100.0, 30.0, 10.0), "m", "Roads for which the missing turn-slip force is stated.")

# Derived files
MISFIT_UNIT_FY = Real(0.01, "-", "Misfit of Fy over nominal load that no camber terms avoid.", "docs/fit.md")
MISFIT_UNIT_MZ = Real(0.001, "m", "Misfit of Mz over nominal load that no camber terms avoid.", "docs/fit.md")
CAMBER_STIFFNESS_TIE = Real(0.1, "-", "Relative spread of PKY6 and PKY7 around the measured ones.")
CAMBER_STIFFNESS_TIE_WEIGHT = Real(0.03, "-", "Weight of that prior beside the grid of conditions.")
LEAST_CAMBER_STIFFNESS = Real(0.1, "-", "Least PKY6 from which the spread of that prior is taken.")
COARSE_GRID_STEPS = Count(25, "-", "Least-squares steps on the coarse grid at most.")
COARSE_GRID_TOLERANCE = Real(1e-3, "-", "Relative gain that ends the search on the coarse grid.")
FINE_GRID_STEPS = Count(30, "-", "Least-squares steps on the fine grid at most.")

# Comments
COMMENT_LENGTH = Count(66, "-", "Characters of a comment that fit on a line of the property file.")

# Rig errors
RIG_ERROR_REACH = Real(
    8.0,
    "-",
    "Standard uncertainties that a rig error may move; beyond that the declaration is wrong, not the reading.",
)
