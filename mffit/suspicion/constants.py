"""Limits of the suspicions, and what the checks behind them need."""

from tir.constant import Real, Series

# Slopes and forces whose sign all tyres share
SIDESLIP_OF_SLOPES = Real(
    3.0,
    "deg",
    "Sideslip up to which side force and aligning moment count as linear, and from which every tyre has a force.",
)
USUAL_CAMBER_THRUST = Series(
    (0.2, 1.5),
    "-",
    "Usual Fy over Fz tan(gamma) at large camber, which is 0.3 to 1.2; a wrong frame adds or removes 1.",
)

# Another tyre
DIFFERENCE_OF_ANOTHER_TYRE = Real(
    0.03,
    "-",
    "Relative difference of a dimension, of radii at one condition or of a nominal condition that means another tyre: a worn "
    "tread is 0.01 to 0.02 smaller, a warmer tyre 0.005 larger, and a tape measure or a repeated run differs by less.",
)
LARGEST_RADIUS = Real(
    1.1,
    "-",
    "Loaded or rolling over unloaded radius that growth with speed does not reach; a rim is the other end.",
)
BEYOND_NOMINAL = Real(
    3.0,
    "-",
    "Lowest level of load over the nominal one, or one load over all others of its file, that is asked for: a digit too few or "
    "too many is a factor of ten.",
)
USUAL_PRESSURE = Series(
    (1.0 / 3.0, 2.0),
    "-",
    "Pressure of a file over the nominal one, outside which it is asked for; psi read as kPa is a factor of seven.",
)

# Single files
STEEPEST_OVER_SIDESLIP = Real(
    120.0, "1/rad", "Slope over load that is asked for; radians read as degrees are 57 times as steep."
)
SMALLEST_FRICTION = Real(
    0.02, "-", "Side force per load, at angles that show a force, below which it is asked for."
)
USUAL_FRICTION = Real(
    0.3,
    "-",
    "Side force per load at large sideslip, below which it is asked for: on ice it is 0.1, on wet roads 0.4.",
)
SIDESLIP_OF_FRICTION = Real(6.0, "deg", "Sideslip from which tyres are near their largest side force.")
LARGEST_MOMENT_ARM = Real(
    0.5,
    "-",
    "|Mz| over load and unloaded radius that no contact allows: it is shorter than the wheel, and the trail a part of it. Side "
    "forces over load exceed it at usual angles.",
)

# Every sweep against all others; shares are errors of a prediction over the usual size of the channel
SHARE_OF_WORST_POINTS = Real(
    0.2,
    "-",
    "Share of worst points of a sweep that are ignored: outliers, and ends where a formula is extrapolated.",
)
LARGEST_ERROR_OF_FORMULA = Real(
    4.0,
    "-",
    "Reading over the prediction of a formula, fitted at other loads, that a sound tyre can have: a trail that does not depend "
    "on the load is 1.3 times too long halfway to the triple load, and 3 halfway to ten times the load.",
)

# The fitted model
DISTRUSTED_MISFIT = Real(1.5, "-", "Misfit over stated noise above which a file is not trusted.")
LEAST_SHARE_OF_A_LIMIT = Real(
    0.02, "-", "Share of the misfit that is due to a number at a limit from which it counts against a build."
)
DOUBTFUL_SIGMA = Real(
    3.5, "-", "Standard deviations beyond which chance does not explain a misfit that is in doubt."
)
LIMITS_IN_DOUBT = Real(
    0.1,
    "-",
    "Share of the fitted coefficients at limits above which a file is in doubt: a fit to all that a tyre does has one or two.",
)
LARGEST_PUBLISHED_EPSILON = Real(
    1.2,
    "-",
    "Largest camber reduction factor that is published: 0.7 of car tyres, slightly above 1 of truck tyres.",
    "Mottola and Massaro 2022, section 1",
)
MISFIT_OF_ANOTHER_UNIT = Real(
    0.1,
    "-",
    "Misfit over stated noise that only a noise stated in another unit explains: kN or percent are farther.",
)
