"""Numbers of judgement of the fit, of the derived files and of what is said about them."""

from __future__ import annotations

from tir.constant import Count, Real, Series

# Posterior
STRONG_CORRELATION = Real(
    0.95, "-", "Smallest absolute correlation of two fitted coefficients that a result states."
)

# Weights
HUBER_THRESHOLD = Real(4.0, "-", "Residuals beyond this many robust standard deviations lose weight (Huber).")
OUTLIER_FALSE_ALARM = Real(
    0.01, "-", "Probability that noise alone makes any reading of a channel an outlier (Bonferroni)."
)
OUTLIER_NEIGHBOURS = Series(
    (-2, -1, 1, 2),
    "-",
    "Offsets of the rows of a sweep whose residuals are compared with a reading's residual.",
)
NOMINAL_NOISE_SHARE = Real(
    0.01, "-", "Standard uncertainty over the range of the channel, where the points state none."
)

# What the points can show
ZERO_CAMBER_LIMIT = Real(1.0, "deg", "Points with less camber count as points without camber.")
COUPLED_ALPHA = Real(
    0.5, "deg", "Least sideslip of a camber point that counts as sideslip and camber combined."
)

# Prior knowledge of coefficients
SIMILAR_TYRES_SPREAD = Real(
    0.3, "-", "Relative standard deviation of a coefficient among similar tyres.", "docs/recovery.md"
)
LEAST_SPREAD_BASE_FILE = Real(
    0.05,
    "-",
    "Least standard deviation of a coefficient around a base file's value, over its plausible range.",
)
LEAST_SPREAD_DEFAULT = Real(
    0.1,
    "-",
    "Least standard deviation of a coefficient around the table's default, over its plausible range.",
)
SAME_NOMINAL_CONDITION = Real(
    0.01,
    "-",
    "Relative difference of nominal load or pressure up to which two tyres' coefficients are comparable.",
)

# Estimates of what a cornering test does not measure
ESTIMATED_STATIC_DEFLECTION = Real(
    0.05, "-", "Static deflection at nominal load over unloaded radius, where it was not measured."
)
ESTIMATED_DAMPING_TIME = Real(0.0005, "s", "Vertical damping over vertical stiffness, where not measured.")
ESTIMATED_LONGITUDINAL_STIFFNESS = Real(1.5, "-", "Longitudinal over vertical stiffness, where not measured.")
ESTIMATED_LATERAL_STIFFNESS = Real(0.7, "-", "Lateral over vertical stiffness, where not measured.")
ESTIMATED_SLIP_STIFFNESS = Real(
    1.3, "-", "Longitudinal slip stiffness over cornering stiffness, where not measured."
)
ESTIMATED_OVERTURNING_ARM = Real(
    0.5, "-", "Lever arm of the load per radian of camber over the width, where Mx was not measured."
)

# Starting values
LEAST_STARTING_FRICTION = Real(0.5, "-", "Lowest lateral friction at which the fit starts.")
LOAD_OF_PEAK_STIFFNESS = Series(
    (0.5, 5.0),
    "-",
    "Range of PKY2 that is searched for the starting value: load of greatest stiffness over FNOMIN.",
)
LOAD_OF_PEAK_STIFFNESS_STEPS = Count(46, "-", "Values of PKY2 that are tried for the start: steps of 0.1.")

# Physical limits
LIMIT_MARGIN = Real(
    0.02, "-", "Distance that the fit keeps from a physical limit, in units of its violation."
)
LEAST_FRICTION = Real(0.1, "-", "Physical limit: lowest lateral friction of a plausible tyre.")
LEAST_CORNERING_STIFFNESS = Real(
    0.5, "1/rad", "Physical limit: lowest cornering stiffness over load of a plausible tyre."
)
LEAST_TRAIL_SLOPE_FACTOR = Real(0.3, "-", "Physical limit: lowest slope factor B_t of the trail.")
LEAST_TRAIL = Real(0.0005, "m", "Physical limit: shortest pneumatic trail at zero slip.")
LIMIT_GRID_LOADS = Count(3, "-", "Loads at which the physical limits are tested.")
LIMIT_GRID_CAMBERS = Count(5, "-", "Camber angles at which the physical limits are tested.")
LIMIT_GRID_PRESSURES = Count(2, "-", "Pressures at which the physical limits are tested.")
LIMIT_WEIGHT_OF_FIT = Real(
    3000.0,
    "-",
    "Residual in units of the noise per unit of violation: it holds the limit and keeps the sum of squares smooth.",
)
LIMIT_WEIGHT_OF_DERIVED_FILE = Real(
    15.0,
    "-",
    "Residual per unit of violation in the fit of a derived file, whose misfit is of the order of 1.",
)

# Stages and polish
POINTS_OF_A_STAGE = Count(
    600,
    "-",
    "Points used in a stage and in the first pass of the polish; more cost time, and the last pass uses all.",
)
STRIDE_DIVISOR = Count(
    8, "-", "Factor by which the points of a large campaign increase from one pass of the polish to the next."
)
FITTED_SHARE_OF_PRIOR = Real(
    0.5,
    "-",
    "A coefficient is called fitted if its standard error is below this share of its prior's spread.",
)
RESTART_MISFIT = Real(
    1.3, "-", "Misfit over stated noise above which the fit is restarted from alternative starting values."
)
RESTART_GAIN = Real(
    0.97, "-", "A restart replaces the best fit if its sum of squares is below this share of the best one."
)
STAGE_TOLERANCE = Real(
    1e-3,
    "-",
    "Relative decrease of the sum of squares that ends a stage or a thinned pass before the last one.",
)
STAGE_STEPS = Count(15, "-", "Steps of the least squares of a stage at most.")
POLISH_TOLERANCE = Real(1e-6, "-", "Relative decrease of the sum of squares that ends the joint polish.")
REFIT_TOLERANCE = Real(
    1e-4, "-", "Relative decrease of the sum of squares that ends a refit that starts near its solution."
)
REFIT_STEPS = Count(12, "-", "Steps of a refit that starts near its solution, at most.")
FREE_EPSILON_TOLERANCE = Real(
    1e-5, "-", "Relative decrease of the sum of squares that ends the refit with PECP1 free."
)

# Profiles of the sum of squares
PROBE_DISTANCE = Real(
    2.0,
    "-",
    "Standard errors from the best fit at which the sum of squares is compared with its quadratic form.",
)
BENT_VALLEY_RATIO = Real(
    3.0, "-", "Ratio of the sum of squares to its quadratic form above which the valley counts as bent."
)
PROBE_POINTS = Count(300, "-", "Points that suffice to show whether a valley is bent.")
PROBED_DIRECTIONS = Count(8, "-", "Least determined directions along which the sum of squares is probed.")
PROFILE_STEPS = Count(7, "-", "Steps along a bent valley to either side at most.")
PROFILE_STEP_GROWTH = Real(1.7, "-", "Growth of the steps along a bent valley.")
WIDER_INTERVAL = Real(
    1.01, "-", "A profile interval is stated if it exceeds the one from the curvature by this factor."
)
BETTER_ON_PROFILE = Real(
    0.999,
    "-",
    "A fit met on a profile replaces the best one if its sum of squares is below this share of it.",
)

# Ensemble
DRAWS_PER_MEMBER = Count(3, "-", "Draws per member of an ensemble at most; some break a physical limit.")
DRAWN_LIMIT_MARGINS = Real(
    2.0, "-", "Violation of a limit that a drawn tyre may have, in units of the margin."
)

# Ranges of the written file
SINGLE_PRESSURE_SPREAD = Real(0.05, "-", "Relative spread of pressures up to which they count as one.")
SINGLE_PRESSURE_COVER = Real(
    0.1, "-", "Relative distance to either side of a single pressure that the limits cover."
)
RANGE_SHARES = Series(
    (1.0, 0.75, 0.5, 0.25),
    "-",
    "Shares of the way from the tested end of a range to the wished end; the first plausible one is written.",
)
WRITTEN_ALPMAX = Real(20.0, "deg", "Sideslip range that a written file should reach.")
WRITTEN_CAMMAX = Real(
    45.0, "deg", "Camber up to which the range of a written file may exceed the tested one."
)
WRITTEN_CAMMAX_GROWTH = Real(1.5, "-", "Written camber range over the tested one, at most.")
WRITTEN_FZMIN_SHARE = Real(
    0.1, "-", "Lowest load that a written file should allow, over the lowest tested one."
)
WRITTEN_FZMAX_SHARE = Real(
    1.5, "-", "Highest load that a written file should allow, over the highest tested one."
)
WRITTEN_PRESSURE_SHARE = Real(
    0.2, "-", "Pressure beyond the tested range that a written file should allow, relative."
)
LEAST_REMAINING_FORCE = Real(
    0.5, "-", "Share of its peak that the side force of a plausible tyre keeps up to the largest sideslip."
)
REMAINING_FORCE_ALPHA = Real(
    0.07, "rad", "Sideslip from which on the side force is tested, if so much was run."
)
REMAINING_FORCE_ANGLES = Count(13, "-", "Sideslip angles at which the side force is tested.")
REMAINING_FORCE_LOADS = Count(3, "-", "Loads at which the side force is tested.")
REMAINING_FORCE_CAMBERS = Series(
    (-0.5, 0.0, 0.5), "-", "Camber angles at which the side force is tested, over the largest camber."
)

# Conditions at which files are derived and compared
WEIGHT_OUTSIDE_TESTED = Real(
    0.02,
    "-",
    "Weight of a condition outside the tested ranges: it keeps the file plausible at little cost inside.",
)
WEIGHT_IN_CORNER = Real(0.5, "-", "Weight of a condition with both large sideslip and large camber.")
ROAD_ALPHA_SCALE = Real(4.0, "deg", "Sideslip that counts as large together with a large camber angle.")
ROAD_GAMMA_SCALE = Real(25.0, "deg", "Camber that counts as large together with a large sideslip angle.")
CAMBER_LINE_LOADS = Count(3, "-", "Loads of the lines along which camber thrust may not turn back.")
CAMBER_LINE_ANGLES = Count(17, "-", "Camber angles of such a line.")
MODERATE_CAMBER = Real(30.5, "deg", "Camber up to which the misfit at moderate camber (lean_30) is stated.")
ROAD_RADII = Series(
    (100.0, 30.0, 10.0), "m", "Radii of roads for which the turn-slip force is stated that a file lacks."
)

# Derived files
MISFIT_UNIT_FY = Real(
    0.01,
    "-",
    "Unit of the residual of Fy over nominal load: the misfit that no camber terms avoid.",
    "docs/fit.md",
)
MISFIT_UNIT_MZ = Real(
    0.001,
    "m",
    "Unit of the residual of Mz over nominal load: the misfit that no camber terms avoid.",
    "docs/fit.md",
)
CAMBER_STIFFNESS_TIE = Real(
    0.1,
    "-",
    "Relative spread of the prior of PKY6 and PKY7 around the measured camber stiffness in a derived file.",
)
CAMBER_STIFFNESS_TIE_WEIGHT = Real(0.03, "-", "Weight of that prior beside the grid of conditions.")
LEAST_CAMBER_STIFFNESS = Real(0.1, "-", "Least PKY6 from which the spread of that prior is taken.")
COARSE_GRID_STEPS = Count(25, "-", "Steps of the fit of a derived file on the coarse grid at most.")
FINE_GRID_STEPS = Count(30, "-", "Steps of the fit of a derived file on the fine grid at most.")
COARSE_GRID_TOLERANCE = Real(
    1e-3, "-", "Relative decrease of the sum of squares that ends the fit on the coarse grid."
)

# Remarks and warnings
TRUSTED_EXPLAINED_VARIANCE = Real(
    0.5, "-", "A file is not trusted if its model explains less of a channel's variance."
)
TRUSTED_MISFIT = Real(2.0, "-", "A file is not trusted if its misfit over the stated noise is larger.")
MISFITTING_SWEEP_RATIO = Real(
    1.5, "-", "A sweep is named with a large misfit if its own is this many times that of all points."
)
MISFITTING_SWEEPS_NAMED = Count(3, "-", "Sweeps that are named with a large misfit, at most.")
OUTLIERS_NAMED = Count(5, "-", "Outliers that the warning names, at most.")
COMMENT_LENGTH = Count(66, "-", "Characters of a comment that fit on a line of the property file.")
