"""Numbers of judgement of the fit, of the derived files and of the warnings."""

from __future__ import annotations

from tir.constant import Count, Real, Series

# Weights
HUBER_THRESHOLD = Real(4.0, "-", "Residuals beyond this many robust standard deviations lose weight (Huber).")
FULL_WEIGHT = Real(
    0.99, "-", "Weights below this, over that of most readings, are listed as reduced; rounding is above it."
)
OUTLIER_FALSE_ALARM = Real(0.01, "-", "Probability that noise makes any reading of a channel an outlier.")
OUTLIER_NEIGHBOURS = Series((-2, -1, 1, 2), "-", "Offsets of the rows with which a reading is compared.")
NOMINAL_NOISE_SHARE = Real(0.01, "-", "Standard uncertainty over the range of a channel that states none.")

# What the points determine
ZERO_CAMBER_LIMIT = Real(1.0, "deg", "Points with less camber count as points without camber.")
COUPLED_ALPHA = Real(0.5, "deg", "Smallest sideslip of a point with sideslip and camber.")
FITTED_SHARE_OF_PRIOR = Real(
    0.5, "-", "Largest standard error over the prior's at which a coefficient is fitted, not regularised."
)
STRONG_CORRELATION = Real(0.95, "-", "Smallest absolute correlation of two coefficients that is stated.")

# Prior knowledge of coefficients
SIMILAR_TYRES_SPREAD = Real(0.3, "-", "Relative standard deviation of a coefficient among similar tyres.")
LEAST_SPREAD_BASE_FILE = Real(
    0.05, "-", "Smallest standard deviation around a base file's value, over the usual range."
)
LEAST_SPREAD_DEFAULT = Real(
    0.1, "-", "Smallest standard deviation around the table's default, over the usual range."
)
CAMBER_REDUCTION_SPREAD = Real(
    0.3, "-", "Standard deviation of PECP1 among tyres: near 0 for motorcycles, 0.5 to 0.7 for cars."
)
LARGEST_CAMBER_REDUCTION = Real(
    0.9,
    "-",
    "Largest PECP1 that zeros without camber sweeps may suggest; beyond it the camber stiffness is wrong.",
)
CONDITIONS_OF_A_MISFIT = Count(
    500, "-", "Drawn conditions at which a base at other nominal conditions is compared with itself."
)
EXACT_CONVERSION = Real(
    1e-6, "-", "Difference over the largest force up to which a converted base has the same forces: rounding."
)
SAME_NOMINAL_CONDITION = Real(
    0.01, "-", "Relative difference of nominal load or pressure up to which coefficients compare."
)
CONTRADICTED_PRIOR = Real(
    3.29,
    "-",
    "Standard deviations between a prior set by hand and the points that are reported: chance 0.001.",
)
LEAST_INFORMATION_OF_POINTS = Real(
    0.01,
    "-",
    "Smallest information of the points over that of a prior set by hand at which the two are compared.",
)

# Estimates of what a cornering test does not measure
ESTIMATED_STATIC_DEFLECTION = Real(0.05, "-", "Static deflection at nominal load over unloaded radius.")
ESTIMATED_DAMPING_TIME = Real(0.0005, "s", "Vertical damping over vertical stiffness.")
ESTIMATED_LONGITUDINAL_STIFFNESS = Real(1.5, "-", "Longitudinal over vertical stiffness.")
ESTIMATED_LATERAL_STIFFNESS = Real(0.7, "-", "Lateral over vertical stiffness.")
ESTIMATED_SLIP_STIFFNESS = Real(1.3, "-", "Longitudinal slip stiffness over cornering stiffness.")
ESTIMATED_OVERTURNING_ARM = Real(0.5, "-", "Lever arm of the load per radian of camber over the width.")

# Starting values
LEAST_STARTING_FRICTION = Real(0.5, "-", "Smallest lateral friction at the start of the fit.")
PKY2_STARTS = Series(
    (0.5, 5.0), "-", "Range of PKY2, the load of greatest stiffness, searched for the start."
)
PKY2_START_COUNT = Count(46, "-", "Values of PKY2 in this range: steps of 0.1.")

SLIP_OF_THE_SLOPE = Real(0.025, "-", "Longitudinal slip up to which Fx is a straight line for the start.")
PEAK_INSIDE = Real(0.9, "-", "Slip of the largest Fx over the largest slip below which it is a peak.")
STARTING_CURVATURES = Series((-5.0, 0.8), "-", "Range of PEX1 at the start.")
SAME_LOAD_OF_SWEEPS = Real(0.05, "-", "Range of loads over the nominal one that shows no dependence on load.")
READABLE_WEIGHTS = Series((0.1, 0.95), "-", "Weights of combined slip from which a slope factor is read.")
STARTING_SLOPES_OF_WEIGHT = Series((4.0, 30.0), "-", "Range of RBX1 and RBY1 at the start.")

LEAST_GAIN_OF_MORE_TERMS = Real(
    0.1,
    "-",
    "Share of the misfit of left-out sweeps that terms of Mx beyond QSX1-3 must remove: programs differ in their form.",
)

# A sister tyre
SISTER_LOADS = Count(9, "-", "Loads over the tested range at which two sister tyres are compared.")
SISTER_LOADS_AROUND_ONE = Real(
    0.2, "-", "Relative distance from a single tested load over which they are compared instead."
)
SISTER_SLIP = Real(
    0.1,
    "-",
    "Slip up to which the limits of Fx are checked for a drawn sister tyre: about the slip of the peak.",
)
SISTER_DRAWS = Count(
    20,
    "-",
    "Draws of borrowed shapes until the physical limits hold; half of them do, so that one to five are usual.",
)
SISTER_SHARES_OF_A_DRAW = Series(
    (0.5, 0.25, 0.125, 0.0),
    "-",
    "Shares of a draw of borrowed shapes, tried in turn if none of the whole draws keeps the physical limits.",
)

# Other campaigns of the same tyre
SAME_LOAD_OF_CAMPAIGNS = Real(0.05, "-", "Relative difference of loads at which friction is compared.")
SIDESLIP_THAT_SHOWS_GRIP = Real(
    4.0, "deg", "Sideslip to either side from which a sweep shows friction, not only stiffness."
)
UNKNOWN_RATIO_OF_GRIPS = Real(
    0.1, "-", "Relative uncertainty of the ratio of two surfaces' grips where nothing was run on both."
)

# Radii
LARGEST_CAMBER_OF_RADII = Real(
    6.0, "deg", "Camber up to which loaded and rolling radius change with its square."
)

USUAL_MISFIT_OF_RADIUS = Real(
    0.0003,
    "m",
    "Scatter of a loaded or rolling radius where as many coefficients as means leave none to see.",
)
RADIUS_GROWTH_OVER_SPEED = Real(
    0.0007, "-", "Standard deviation of Q_V1 where nothing states it; published files have 0.0005 to 0.0008."
)
STIFFENING_OVER_SPEED = Real(
    0.03, "-", "Standard deviation of Q_V2 where nothing states it; published files have 0.02 to 0.05."
)

# Rolling resistance: standard deviations among tyres, from published files
QSY1_SPREAD = Real(
    0.01, "-", "Standard deviation of QSY1, judged: rolling resistance over load is 0.007 to 0.02."
)
QSY2_SPREAD = Real(0.01, "-", "Standard deviation of QSY2 among tyres, judged.")
QSY3_SPREAD = Real(0.001, "-", "Standard deviation of QSY3, judged: public files have 0.0004 and more.")
QSY4_SPREAD = Real(0.00005, "-", "Standard deviation of QSY4, judged: of the size that public files have.")
QSY5_SPREAD = Real(0.02, "-", "Standard deviation of QSY5, judged.")
QSY6_SPREAD = Real(0.01, "-", "Standard deviation of QSY6, judged.")
QSY7_SPREAD = Real(0.15, "-", "Standard deviation of QSY7, judged: public files have 0.85 to 1.")
QSY8_SPREAD = Real(0.3, "-", "Standard deviation of QSY8, judged: public files have -0.4 to 0.")

# Physical limits
LIMIT_MARGIN = Real(0.02, "-", "Distance kept from a physical limit, in units of its violation.")
LEAST_FRICTION = Real(0.1, "-", "Physical limit: smallest lateral friction.")
LEAST_CORNERING_STIFFNESS = Real(0.5, "1/rad", "Physical limit: smallest cornering stiffness over load.")
LEAST_TRAIL_SLOPE_FACTOR = Real(0.3, "-", "Physical limit: smallest slope factor B_t of the trail.")
LEAST_TRAIL = Real(0.0005, "m", "Physical limit: smallest pneumatic trail at zero slip.")
LEAST_SLIP_STIFFNESS = Real(1.0, "-", "Physical limit: smallest longitudinal slip stiffness over load.")
LEAST_DRIVING_FORCE = Real(
    0.1,
    "-",
    "Physical limit: smallest longitudinal force over load at the largest slip, in the sense of the slip.",
)
LEAST_WEIGHT = Real(0.0, "-", "Physical limit: smallest weight of combined slip, G_xa or G_yk.")
LARGEST_WEIGHT = Real(
    1.1, "-", "Physical limit: largest weight of combined slip; a shift of its peak puts it slightly above 1."
)
LEAST_SLOPE_OF_WEIGHT = Real(0.5, "-", "Physical limit: smallest slope factor of these weights.")
LIMIT_REACH_OF_SLIP = Real(
    1.5,
    "-",
    "Slip at which the limits of longitudinal force and combined slip are tested, over the tested one.",
)
ELLIPSE_GRID = Series(
    (3, 2, 9),
    "-",
    "Loads, sideslips to either side and longitudinal slips of the test that the ellipse is convex.",
)
LARGEST_DENT = Real(
    0.002,
    "-",
    "Largest dent, in the same measure, that counts as convex; published tyres have none of this size.",
)
ELLIPSE_TURN = Real(
    1.0,
    "-",
    "Unit of a dent: product of two neighbouring steps of force over load and the sine of the angle between them; large, so that "
    "readings with a dent are followed part of the way.",
)
STIFFNESS_RATIOS = Series(
    (0.1, 10.0), "-", "Physical limit: range of the longitudinal slip stiffness over the cornering stiffness."
)
LIMIT_GRID = Series((3, 5, 2), "-", "Loads, camber angles and pressures at which the limits are tested.")
LIMIT_WEIGHT_OF_FIT = Real(
    3000.0, "-", "Residual per unit of violation (noise is 1): holds the limit, keeps the problem smooth."
)
LIMIT_WEIGHT_OF_DERIVED_FILE = Real(
    15.0, "-", "The same for a derived file, whose misfit is of the order of 1."
)

# Stages and polish
POINTS_OF_A_STAGE = Count(600, "-", "Most points of a stage or first pass; the polish uses all.")
STRIDE_DIVISOR = Count(8, "-", "Factor by which the points increase from pass to pass of the polish.")
RESTART_MISFIT = Real(1.3, "-", "Misfit over stated noise above which alternative starting values are tried.")
RESTART_GAIN = Real(0.97, "-", "A restart is kept if its sum of squares over the best one is below this.")
FEWEST_SIDESLIPS_OF_A_SHAPE = Count(
    5, "-", "Fewest levels of sideslip that show the shape of its curve, where Fx is fitted too."
)
STAGE_STEPS = Count(15, "-", "Most least-squares steps of a stage.")
STAGE_TOLERANCE = Real(1e-3, "-", "Relative gain that ends a stage or an early pass.")
POLISH_TOLERANCE = Real(1e-6, "-", "Relative gain that ends the joint polish.")
FREE_EPSILON_TOLERANCE = Real(1e-5, "-", "Relative gain that ends the refit with PECP1 free.")
REFIT_STEPS = Count(12, "-", "Most least-squares steps of a refit that starts near its solution.")
REFIT_TOLERANCE = Real(1e-4, "-", "Relative gain that ends such a refit.")
REFIT_STEPS_UNDER_SLIP = Count(
    60,
    "-",
    "The same steps where Fx is fitted: the weights of combined slip form a bent valley with its shape.",
)
REFIT_TOLERANCE_UNDER_SLIP = Real(1e-6, "-", "Relative gain that ends a refit there.")
STEPS_BACK_FROM_A_BOUND = Count(
    6,
    "-",
    "Most steps of a refit with a coefficient put back from its bound: left-out sweeps are then predicted as at its end.",
)

# Profiles of the sum of squares
PROBE_DISTANCE = Real(2.0, "-", "Standard errors from the best fit at which the quadratic form is tested.")
BENT_VALLEY_RATIO = Real(3.0, "-", "Ratio to the quadratic form above which the valley counts as bent.")
SOFT_VALLEY_RATIO = Real(
    2.0,
    "-",
    "Growth of a standard error, one standard error from the best fit, above which the valley counts as bent.",
)
PROBE_POINTS = Count(300, "-", "Points that suffice to show whether the valley is bent.")
PROBED_DIRECTIONS = Count(8, "-", "Directions that are probed, the least determined ones.")
PROFILE_STEPS = Count(7, "-", "Most steps along a bent valley to either side.")
PROFILE_STEP_GROWTH = Real(1.7, "-", "Growth of these steps.")
WIDER_INTERVAL = Real(
    1.01, "-", "A profile interval is stated if it is wider than the usual one by this factor."
)
BETTER_ON_PROFILE = Real(
    0.999, "-", "A fit met on a profile is better if its sum of squares is below this share."
)

# Other ends of a search
OTHER_CURVATURES = Series(
    (0.2, 0.75),
    "-",
    "Curvature factors near the two ends with equal slope and equal value at the largest slip.",
)
CURVATURE_BETWEEN_ENDS = Real(0.5, "-", "Curvature factor between these ends.")
SHAPES_OF_OTHER_ENDS = Series((0.6, 2.5), "-", "Range of shape factors in which the other end is searched.")
EXPONENTS_OF_OTHER_ENDS = Series((-2.0, 2.0), "-", "Range of PKX3 in which the other end is searched.")
STEPS_TO_OTHER_ENDS = Count(
    81, "-", "Values in each of these ranges; the fit that follows finds the end itself."
)
HOPELESS_END = Real(
    1.005,
    "-",
    "Ratio of sums of squares, after a step from where some of the points lead, above which an end is given up.",
)
CLEARLY_BETTER_END = Real(
    0.1, "-", "Fall of the sum of squares above which another end is taken: less decides nothing."
)

# Bands
WIDENING_SHARE = Real(
    0.5, "-", "Share of the variance above which one coefficient is named as what widens the bands."
)
WIDER_BANDS = Real(
    1.5, "-", "Ratio of bands between pressures to those at the usual one above which the report explains it."
)
BAND_GRID = Series(
    (3, 3, 9), "-", "Loads, camber angles and sideslip angles over which these widths are averaged."
)

MOST_SIDESLIPS_NAMED = Count(
    7,
    "-",
    "Most sideslips of combined slip that a sentence lists; more fill a line and are given by their ends.",
)

# Ensemble
DRAWS_PER_MEMBER = Count(3, "-", "Most draws per member of an ensemble; some break a physical limit.")
DRAWN_LIMIT_MARGINS = Real(2.0, "-", "Violation of a limit, over the margin, that a drawn tyre may have.")

# Ranges of the written file
SINGLE_PRESSURE_SPREAD = Real(0.05, "-", "Relative spread of pressures up to which they count as one.")
SINGLE_LOAD_SPREAD = Real(0.02, "-", "Relative spread of loads up to which they count as one in a sentence.")
SINGLE_PRESSURE_COVER = Real(
    0.1, "-", "Relative distance from a single pressure that the written range covers."
)
RANGE_SHARES = Series(
    (1.0, 0.75, 0.5, 0.25), "-", "Shares of the way to the intended end of a range that are tried in turn."
)
WRITTEN_ALPMAX = Real(20.0, "deg", "Intended sideslip range of a file.")
WRITTEN_CAMMAX = Real(45.0, "deg", "Camber up to which a file's range may exceed the tested one.")
WRITTEN_CAMMAX_GROWTH = Real(1.5, "-", "Largest camber range of a file over the tested one.")
WRITTEN_FZMIN_SHARE = Real(0.1, "-", "Intended smallest load of a file over the smallest tested one.")
WRITTEN_FZMAX_SHARE = Real(1.5, "-", "Intended largest load of a file over the largest tested one.")
WRITTEN_PRESSURE_SHARE = Real(0.2, "-", "Intended relative distance of pressures beyond the tested ones.")
UNVARIED_ANGLE = Real(0.5, "deg", "Largest angle of sweeps that do not vary it.")
UNTESTED_CAMBER = Real(
    2.0, "deg", "Camber range of a file whose sweeps are upright and whose base states none."
)
UNTESTED_SIDESLIP = Real(
    2.0, "deg", "Sideslip range of a file whose sweeps have none and whose base states none."
)
UNTESTED_SHARE = Real(
    0.1, "-", "Relative range of a single load or pressure that the model leaves no room for."
)
FASTEST_CHANGE = Real(
    3.0,
    "-",
    "Fastest change of the logarithm of grip or stiffness over load, per unit of the logarithm of load or pressure and per "
    "radian of camber, and fastest fall of the side force per radian of sideslip: just above what public tyres do.",
    "docs/fit.md",
)
STEPS_TO_AN_END = Count(9, "-", "Values from a tested to a written end of a range at which this is tested.")

# Conditions at which files are derived and compared
WEIGHT_OUTSIDE_TESTED = Real(
    0.02, "-", "Weight of untested conditions: keeps them plausible at little cost inside."
)
WEIGHT_IN_CORNER = Real(0.5, "-", "Weight of conditions with large sideslip and large camber.")
WEIGHT_IN_CORNER_OF_THE_ROAD = Real(
    0.02, "-", 'The same with [normal] weight = "road": who leans far slides little, so that this is a fall.'
)
ROAD_ALPHA_SCALE = Real(4.0, "deg", "Sideslip that counts as large together with large camber.")
ROAD_GAMMA_SCALE = Real(25.0, "deg", "Camber that counts as large together with large sideslip.")
CAMBER_LINE_GRID = Series(
    (3, 17), "-", "Lines, one per load, along which camber thrust is kept, and angles per line."
)
MODERATE_CAMBER = Real(30.5, "deg", "Camber up to which the misfit at moderate camber is stated.")
ROAD_RADII = Series((100.0, 30.0, 10.0), "m", "Roads for which the missing turn-slip force is stated.")

# Derived files
MISFIT_UNIT_FY = Real(0.01, "-", "Misfit of Fy over nominal load that no camber terms avoid.", "docs/fit.md")
MISFIT_UNIT_MZ = Real(0.001, "m", "Misfit of Mz over nominal load that no camber terms avoid.", "docs/fit.md")
CAMBER_STIFFNESS_TIE = Real(
    0.1, "-", "Relative standard deviation of PKY6 and PKY7 around the measured ones."
)
CAMBER_STIFFNESS_TIE_WEIGHT = Real(0.03, "-", "Weight of this prior beside the grid of conditions.")
LEAST_CAMBER_STIFFNESS = Real(0.1, "-", "Smallest PKY6 from which this standard deviation is taken.")
COARSE_GRID_STEPS = Count(25, "-", "Most least-squares steps on the coarse grid.")
COARSE_GRID_TOLERANCE = Real(1e-3, "-", "Relative gain that ends the search on the coarse grid.")
FINE_GRID_STEPS = Count(30, "-", "Most least-squares steps on the fine grid.")

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

LEAST_CONICITY = Real(
    1e-5, "-", "Smallest prior standard deviation of PVY1, where [rig] declares none: the fit divides by it."
)

SPIN_CORRECTION_OF_MODEL = Real(
    0.05,
    "-",
    "Standard uncertainty of the formula, over the difference of the cornering stiffnesses without and with spin.",
)

# Numbers of the tyre's state and of the rig
LEAST_TEMPERATURE_RANGE = Real(3.0, "K", "Temperatures that move by less say nothing beyond their noise.")
NUISANCE_SPREAD = Real(
    10.0, "-", "Prior of such a number over its usual size: keeps it finite and does not pull."
)
OVERLAPPING_SWEEPS = Count(
    2, "-", "Fewest sweeps through the same angles both up and down that show a sense."
)
OVERLAP_OF_SENSES = Real(0.5, "-", "Share of a sweep's range of sideslip that both senses cover.")
LEAST_SHARE_OF_A_SENSE = Real(0.25, "-", "Share of a sweep's points with the angle moving in either sense.")
USUAL_RUN_SCATTER = Real(
    0.02, "-", "Scatter of grip and stiffness among runs, from which the search for it starts."
)
LEAST_RUN_SCATTER = Real(1e-4, "-", "Smallest scatter of grip and stiffness among runs: less does not show.")
RUN_SCATTER_STEPS = Count(25, "-", "Most steps of the search for this scatter.")
RUN_SCATTER_TOLERANCE = Real(0.01, "-", "Relative change of the scatter that ends this search.")
FEWEST_RUNS = Count(3, "-", "Fewest runs whose grip and stiffness can differ from one another.")
MOVED_COEFFICIENT = Real(3.0, "-", "Standard errors by which a coefficient moves that is named.")
NAMED_COEFFICIENTS = Count(4, "-", "Most coefficients named that moved.")
RUNS_ALONG = Real(
    0.5,
    "-",
    "Correlation of temperature and a setting of the plan above which both run along with each other.",
)
GROWN_UNCERTAINTY = Real(
    1.5, "-", "Growth of a coefficient's uncertainty by temperature terms from which the order is criticised."
)

# Relaxation lengths from steps
MOST_KEPT_NOISE = Real(
    0.995,
    "-",
    "Largest share of the noise that the next sample keeps: beyond it, offset and gain of a run of steps are lost in it.",
)
LEAST_MOVE_OF_A_STEP = Real(
    0.02,
    "-",
    "Move between two samples, over the largest one of a run of steps, that is part of a step rather than noise of the setting.",
)
MEAN_OF_STEPS = Real(
    0.15,
    "-",
    "Distance over which samples of a run of steps are averaged, over the unloaded radius: half the shortest relaxation lengths.",
)
CARCASS_TERM_SPREAD = Series(
    (0.2, 0.1, 0.3),
    "-",
    "Standard deviations of PCFX1-3 and PCFY1-3 that no run shows: public files have 0.1 to 0.2, -0.02 to -0.05, and 0.1 to 0.4.",
)
LARGEST_CARCASS_TERM = Real(
    3.0, "-", "Size of PCFX1-3 and PCFY1-3 beyond which a carcass would be softer than none at tested loads."
)
