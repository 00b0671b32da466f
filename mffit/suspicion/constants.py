"""Limits of the suspicions, and what the checks behind them need."""

from __future__ import annotations

from tir.constant import Count, Real

# Slopes and forces whose sign and size all tyres share
SIDESLIP_OF_SLOPES = Real(4.0, "deg", "Sideslip up to which the side force counts as linear.")
CAMBER_OF_SLOPES = Real(25.0, "deg", "Camber up to which the camber force counts as linear.")
SIDESLIP_OF_MOMENT_SLOPE = Real(3.0, "deg", "Sideslip up to which the aligning moment counts as linear.")
UPRIGHT_FOR_SLOPES = Real(5.0, "deg", "Camber up to which a sweep of sideslip counts as upright.")
STRAIGHT_FOR_SLOPES = Real(1.5, "deg", "Sideslip up to which a sweep of camber counts as straight.")
CAMBER_OF_THRUST = Real(20.0, "deg", "Camber from which the camber force over tan(gamma) is compared.")
CHANCE_OF_OTHER_SIGN = Real(
    3e-5,
    "-",
    "Probability (Student's t) of the other sign below which a slope has a sign: 4 standard errors.",
)
SMALLEST_RANGE_OF_SLOPE = Real(0.02, "deg", "Angles with a smaller range determine no slope.")
FEWEST_POINTS_OF_SLOPE = Count(4, "-", "Fewer points give no slope with a standard error.")
WEAK_TURN_SLIP_FORCE = Real(0.01, "-", "A smaller turn-slip force over the load has no direction.")
STEEPEST_CAMBER_STIFFNESS = Real(
    -1.9, "1/rad", "Steepest camber stiffness over load of any tyre; a wrong frame changes it by 1."
)
WEAKEST_CAMBER_STIFFNESS = Real(
    -0.2, "1/rad", "Camber stiffness over load that the data must show under a proposed declaration."
)
SMALLEST_CAMBER_THRUST = Real(
    0.1, "-", "Smallest Fy over Fz tan(gamma) of any tyre; a wrong frame removes 1."
)
LARGEST_CAMBER_THRUST = Real(1.5, "-", "Largest Fy over Fz tan(gamma) of any tyre; a wrong frame adds 1.")
CONTRADICTIONS_IN_SENTENCE = Count(2, "-", "Most contradictions of a declaration that a sentence names.")
UPRIGHT_FOR_MOMENT_POINT = Real(2.0, "deg", "Camber up to which the lever arm of Mx over Fy is determined.")
FEWEST_POINTS_OF_MOMENT_POINT = Count(10, "-", "Fewest points that determine this lever arm.")
FORCE_RANGE_OF_MOMENT_POINT = Real(0.5, "-", "Smallest range of Fy over load that determines this lever arm.")
LEVER_OF_OTHER_MOMENT_POINT = Real(
    0.5, "-", "Lever arm over radius above which moments refer to another point."
)

# Another tyre
UPRIGHT_FOR_RADIUS = Real(1.0, "deg", "Camber up to which the radii do not change by more than a thousandth.")
STRAIGHT_FOR_RADIUS = Real(
    2.0, "deg", "Sideslip up to which the radii do not change by more than a hundredth."
)
RADIUS_OF_ANOTHER_TYRE = Real(
    0.03,
    "-",
    "Relative difference of the radii of two files at one condition that means two tyres: a worn tread is 0.01 to 0.02 "
    "smaller, a warmer tyre 0.005 larger, and a repeated run differs by less.",
)
SMALLEST_LOADED_RADIUS = Real(
    0.75, "-", "Loaded over unloaded radius below which a tyre would be flat: the rim is at 0.6 to 0.7."
)
LARGEST_LOADED_RADIUS = Real(1.01, "-", "Loaded over unloaded radius; no tyre is larger under load.")
SMALLEST_ROLLING_RADIUS = Real(0.85, "-", "Rolling over unloaded radius; tyres have 0.93 to 1.")
LARGEST_ROLLING_RADIUS = Real(
    1.03, "-", "Rolling over unloaded radius; leaves room for growth with speed and pressure."
)

NOMINAL_BEYOND_LOADS = Real(
    3.0,
    "-",
    "Nominal load over the highest level of load, or the lowest level over it, that no campaign has: loads reach from a fifth "
    "of the nominal one to twice it, and a digit too few or too many is a factor of ten.",
)

# Single files
STEEPEST_OVER_SIDESLIP = Real(
    120.0, "1/rad", "Slope over load that no tyre reaches; radians read as degrees are 57 times as steep."
)
STEEPEST_OVER_CAMBER = Real(
    12.0, "1/rad", "Slope over load that no tyre reaches; radians read as degrees are 57 times as steep."
)
SIDESLIP_THAT_SHOWS_FORCE = Real(2.0, "deg", "Sideslip beyond which every tyre has a side force.")
CAMBER_THAT_SHOWS_FORCE = Real(5.0, "deg", "Camber beyond which every tyre has a side force.")
FEWEST_POINTS_OF_FRICTION = Count(
    3, "-", "Fewer points with an implausible force per load are single outliers."
)
SMALLEST_FRICTION = Real(0.02, "-", "Side force per load that every tyre exceeds at those angles.")
LARGEST_FORCE_AT_ZERO = Real(
    1.0, "-", "Side force per load that turn slip and asymmetry never reach at zero angles."
)
LARGEST_FRICTION = Real(4.0, "-", "Side force per load that no tyre reaches.")
LARGEST_MOMENT_ARM = Real(
    0.15,
    "m",
    "|Mz| over load that no tyre exceeds: trail times friction. Side forces over load exceed it at usual angles.",
)
LONGEST_ARM = Real(1.0, "m", "|Mz| or |Mx| over load that no tyre reaches.")
LOWEST_TESTED_PRESSURE = Real(0.35, "-", "No tyre is tested below this share of its nominal pressure.")
FEWEST_ROWS_OF_A_DEAD_CHANNEL = Count(4, "-", "Equal readings that mean a dead channel.")
FEWEST_ROWS_OF_A_LONE_LOAD = Count(4, "-", "Fewest rows of which one load can be an outlier.")
LONE_LOAD = Real(5.0, "-", "A load this many times the largest other one of its file is an outlier.")

# All files together
FEWEST_ROWS_OF_A_COPY = Count(
    4, "-", "Equal rows that mean a copied file: two measurements scatter differently."
)
LEANING = Real(0.5, "deg", "Camber from which a wheel leans to one side.")
FEWEST_LEANING_SWEEPS = Count(4, "-", "Fewest sweeps with camber of which one can lean to the wrong side.")

# Every sweep against all others; shares are errors of a prediction over the usual size of the channel
FALSE_ALARM_OF_SWEEPS = Real(0.01, "-", "Chance of any significant sweep in a sound campaign (Bonferroni).")
SHARE_OF_WORST_POINTS = Real(
    0.2, "-", "Share of worst points of a sweep that are ignored, as they may be outliers."
)
SURE_ERRORS = Real(3.0, "-", "Standard errors of a prediction that are subtracted from its error.")
DOUBTFUL_SHARE = Real(0.05, "-", "Error that the repeatability of a rig does not explain.")
GROSS_SHARE = Real(0.1, "-", "Error from which known mistakes are tried.")
IMPLAUSIBLE_SHARE = Real(0.5, "-", "Error that is refused even if no known mistake explains it.")
MATCHED_SHARE = Real(
    0.5, "-", "Largest error, over predicted and measured size, of a sweep whose mistake was undone."
)
MOST_SUSPECTS = Count(6, "-", "Most suspected sweeps, worst first, without which the fit is repeated.")
FEWEST_POINTS_OF_A_SWEEP = Count(4, "-", "Fewest points of a sweep that is predicted from all others.")
LARGEST_SWEEP = Real(0.5, "-", "Larger shares of all points leave too few others to predict a sweep.")
FEWEST_SWEEPS_TO_COMPARE = Count(3, "-", "Fewest sweeps of which each is predicted from all others.")
INFORMATION_OF_OTHERS = Real(
    1e-3, "-", "Share of the information about a direction that the other sweeps must supply to predict it."
)
MOST_POINTS_SHOWN = Count(300, "-", "Most points at which a sweep is predicted; of more, evenly spaced ones.")
EXPLAINED_BY_ONE_NUMBER = Real(
    0.8, "-", "Remaining share of the sum of squares below which one number explains an error."
)

# The fitted model
DISTRUSTED_MISFIT = Real(1.5, "-", "Misfit over stated noise above which a file is not trusted.")
MISFIT_IN_DOUBT = Real(1.2, "-", "Misfit over stated noise above which a file is in doubt.")
CERTAIN_SIGMA = Real(
    5.0, "-", "Standard deviations beyond which chance explains neither a misfit nor a bound that is hit."
)
DOUBTFUL_SIGMA = Real(
    3.5, "-", "Standard deviations beyond which chance does not explain a misfit that is in doubt."
)
FEWEST_SWEEPS_OF_A_FORMULA = Count(5, "-", "Fewest sweeps whose prediction says what limits a model.")
SHARE_OF_A_BOUND = Real(0.05, "-", "Share of the misfit from which a bound matters that holds a coefficient.")
LEAST_PUBLISHED_EPSILON = Real(
    -0.4, "-", "Camber reduction factors below are outside everything published.", "docs/method.md"
)
MOST_PUBLISHED_EPSILON = Real(
    0.3, "-", "Camber reduction factors above are outside everything published.", "docs/method.md"
)
USUAL_PUBLISHED_EPSILON = Real(
    -0.06, "-", "Mean camber reduction factor of six published tyres.", "Mottola and Massaro 2022, Table 2"
)
LARGEST_FALL_LEFT = Real(
    10.0,
    "-",
    "Fall of the sum of squares that a step still promises beyond which a search is stuck: the step moves numbers by three "
    "standard uncertainties. Edges of the model, as play has, leave up to 2.2 at a minimum; a stuck search left 800.",
    "tests/studies/solver_study.py",
)
EXPLAINED_VARIANCE = Real(0.5, "-", "Share of a channel's variance that a trusted model explains.")
MISFIT_OF_ANOTHER_UNIT = Real(
    0.1,
    "-",
    "Misfit over stated noise, of many readings, that only a noise stated in another unit explains: kN or percent are farther.",
)
FEWEST_READINGS_OF_A_UNIT = Count(
    50, "-", "Fewest readings with a stated noise; a fit passes closer to fewer of them."
)
LEAST_MISFIT_OF_NOISE = Real(
    0.5,
    "-",
    "Misfit over stated noise below which readings that the model does not explain are in another unit than their noise.",
)
CARRIED_MISFIT = Real(1.5, "-", "Misfit over that of all points above which a sweep is named.")
SWEEPS_NAMED_WITH_MISFIT = Count(3, "-", "Most sweeps that are named with a misfit.")
OUTLIERS_IN_SENTENCE = Count(5, "-", "Most outliers that a sentence names.")

# One sweep against a simulation; shares are median errors over the usual size of the channel
MISREAD_SHARE = Real(0.15, "-", "Error above which a diagnosis examines a sweep.")
MISREAD_OVER_USUAL = Real(3.0, "-", "Smallest error of a misread sweep over the median error of all sweeps.")
MISREAD_OVER_WORST = Real(
    2.0, "-", "Smallest error of a misread sweep over any other's: a wrong model misses several."
)
CORRECTED_OVER_USUAL = Real(
    1.5, "-", "Largest error of a misread sweep over the median once its mistake is undone."
)
FEWEST_SWEEPS_FOR_MISREAD = Count(4, "-", "Fewest sweeps of which one can be misread.")
FEWEST_POINTS_OF_A_MISREAD_SWEEP = Count(
    3, "-", "Fewest points of a sweep that is compared with a simulation."
)
