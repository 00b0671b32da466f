"""Numbers of judgement that several folders share; each folder's own are in its ``constants.py``."""

from tir.constant import Count, Real, Series

USUAL_CORNERING_STIFFNESS = Real(
    10.0,
    "1/rad",
    "Cornering stiffness over load, assumed until one is measured.",
    "Mottola and Massaro 2022, section 3: first step of the alignment",
)
USUAL_U_FORCE = Real(6.0, "N", "Standard uncertainty of Fy of a finished point that states none.")
USUAL_U_MOMENT = Real(0.6, "Nm", "Standard uncertainty of Mz of a finished point that states none.")
MISFIT_AT_NOISE = Real(
    1.2,
    "-",
    "Misfit over the noise up to which residuals count as noise; beyond it a significant one is in doubt.",
)
EXPLAINED_SHARE = Real(
    1.0 / 3.0, "-", "A known mistake explains an error if undoing it leaves less than this share."
)
MOST = Real(
    0.5,
    "-",
    "Share from which it is most of a range, a misfit, a gain, a reading or an uncertainty, or likelier than not.",
)
LIKENESS_OF_MISSPELT = Real(0.6, "-", "Similarity (difflib) from which a key or heading counts as misspelt.")
LONGEST_QUOTE = Count(60, "characters", "Longest quotation of a file in a message.")
COVERAGE_FACTOR_95 = Real(1.959964, "-", "Coverage factor of a 95 % interval of a normal distribution.")
TWO_SIGMA = Real(
    2.0,
    "-",
    "Standard deviations within which a size lies, beyond which a number of an effect has changed, and a channel is worse.",
)
CERTAIN_SIGMA = Real(
    5.0,
    "-",
    "Standard deviations beyond which chance explains neither a misfit nor a bound that is hit. Half its square is the log "
    "evidence that proves a model error.",
)
FALSE_ALARM = Real(
    1e-3, "-", "Probability that chance alone makes a sound reading or rig conspicuous, per question."
)
FEWEST = Count(
    4,
    "-",
    "Fewest readings, set-points, sweeps or tyres that show something: a slope, a curve, a copy, a scatter, which one is odd.",
)
AT_BOUND_SHARE = Real(
    1e-4, "-", "Distance from a bound, over the width of the bounds, that counts as at the bound."
)
HELD_BY_LIMIT_SHARE = Real(
    0.1, "-", "Share of the information about a number that physical limits supply if they hold it."
)
ROWS_AT_ONCE = Count(
    20_000,
    "-",
    "Residuals with derivatives beyond which only their sums of products are kept.",
    "tests/benchmarks/scale.py",
)
LOOKS_AT_LIMITS = Count(
    200, "-", "Most times a step is computed again because it meets a limit or a bound; 5 to 50 are usual."
)
WEAKEST_DIRECTION = Real(
    1e-3,
    "-",
    "Singular value over the largest below which readings do not determine a combination of numbers.",
)
STRAIGHT = Real(
    0.4,
    "deg",
    "Sideslip as read within which a wheel runs straight, and within which two angles are one level of a programme.",
)
VISIBLE_TEMPERATURE = Real(
    3.0, "K", "Smallest difference of temperature whose effect exceeds the noise: grip changes by 1 %."
)
STEPS_OF_LINE = Count(61, "-", "Points of a drawn or compared curve; it looks smooth.")
ANGLES_OF_A_CURVE = Count(21, "-", "Angles of a curve over which a misfit or a band is averaged.")
UPRIGHT = Real(
    0.8,
    "deg",
    "Camber as read within which a wheel is upright, and within which two angles are one level of a programme.",
)
CAMBER_OF_SLOPES = Real(
    20.0,
    "deg",
    "Camber up to which a cubic describes the odd camber force and a line its sign; up to 50 deg a cubic is as biased as the "
    "secant.",
    "docs/method.md",
)
LEAST_SHARE_OF_A_SENSE = Real(
    0.25,
    "-",
    "Share of a sweep's points with the angle moving in one sense below which it has not this sense.",
)
SAME_SIDESLIP = Real(0.05, "deg", "Sideslip angles within this are one set-point: zeros, mirrored points.")
NAMED_IN_SENTENCE = Count(3, "-", "Most places of a kind that a sentence names; it counts the others.")
MOST_ROWS = Count(
    12,
    "-",
    "Most bars of a picture, regions of a misfit, and rows of a table in a terminal where a file or page has all.",
)
LARGEST_PLAIN_NUMBER = Real(1e7, "-", "Larger numbers are written with a power of ten.")
SMALLEST_PLAIN_U = Real(1e-6, "-", "A number with a smaller uncertainty is written with a power of ten.")
TERMINAL_WIDTH = Count(100, "-", "Characters per line in a terminal; two windows fit side by side.")
TERMINAL_LINES = Count(
    25, "-", "Lines that a terminal shows whole: of a record's repr, or what a command says."
)
NEARLY_CERTAIN = Real(0.99, "-", "Confidences above this are written as more than this: no model is certain.")

# Judged by prediction
PREDICTION_FALSE_ALARM = Real(
    0.01, "-", "Probability that chance lets any of several candidates, readings or sweeps pass (Bonferroni)."
)
FEWEST_SWEEPS_TO_PREDICT = Count(8, "-", "With fewer sweeps a gain cannot be separated from chance.")
CANDIDATES_FITTED = Count(
    6,
    "-",
    "Best candidates to first order, effects or suspected sweeps, for which a fit is repeated in full.",
)
ODD_SWEEP_RATIO = Real(
    5.0, "-", "Rms misfit of a sweep over the median of all sweeps above which it is said to be the odd one."
)
ASSUMED_NOISE_SHARE = Real(
    1e-3, "-", "Assumed ratio of noise to rms reading where readings have no noise. The best rigs reach it."
)
HOTTEST_TREAD = Real(
    110.0, "degC", "Median of a tread's temperature that no tread keeps; in degF it is usual, 43 degC."
)

SHARES_OF_A_BUILD = Series(
    (0.05, 0.03, 0.34, 0.03, 0.10, 0.03, 0.09, 0.33),
    "-",
    "Usual shares of the steps of a build in its time, for the share done and the time left that a terminal shows.",
    "the samples and two measured flat-track runs, 5 to 57 s: fitting takes 8 to 41 %, writing 25 to 48 %",
)
SHARES_OF_A_DIAGNOSIS = Series(
    (0.05, 0.02, 0.09, 0.17, 0.19, 0.08, 0.05, 0.06, 0.06, 0.01, 0.08, 0.07, 0.07),
    "-",
    "The same of a diagnosis.",
    "two campaigns on a disc and three moving recordings, 4 to 100 s: choosing takes 9 to 36 %, weighing 2 to 24 %",
)
