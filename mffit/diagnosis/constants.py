"""Numbers of judgement of the diagnosis, in the order of its steps."""

from __future__ import annotations

from tir.constant import Count, Real, Series

# Points and model that belong together
LOAD_RATIO_OF_ANOTHER_TYRE = Real(
    10.0, "-", "Load over FNOMIN, or its inverse, above which tyre or unit is wrong."
)
OPPOSED_CORRELATION = Real(
    -0.3, "-", "Correlation of measured and simulated readings below which signs differ."
)
MISFIT_OF_ANOTHER_TYRE = Real(30.0, "-", "Misfit over noise above which naming an effect would be a guess.")

# What the data must vary for an effect to be visible
VISIBLE_SPIN_CAMBER = Real(0.2, "rad", "Smallest range of camber that shows the spin by camber alone.")
VISIBLE_TIME = Real(60.0, "s", "Shortest test that shows a drift.")
DISTANCE_LIKE_TIME = Real(0.98, "-", "Correlation of distance and time above which wear looks like drift.")
VISIBLE_SENSE_SHARE = Real(0.1, "-", "Smallest share of points that each sense of a sweep must have.")

# Stated noise
LEAST_STATED_NOISE_SHARE = Real(0.05, "-", "Stated uncertainties are raised to this share of their median.")
NO_NOISE_SHARE = Real(
    2e-4,
    "-",
    "Scatter over the rms reading below which readings come from a simulation; rigs reach 0.001 at best.",
)

# Scatter as found
STATED_NOISE_FACTOR = Real(2.0, "-", "Usual factor (1 sigma) between true and stated uncertainties.")
SURPRISING_LOG_ODDS = Real(
    2.5,
    "-",
    "Log odds that offsets of runs need against a memory of the errors, and noise that grows with the reading or has heavy "
    "tails against plain noise: one programme in thirteen has such.",
    "diagnosis_study.py --correlated, docs/evidence-diagnosis.md",
)
USUAL_GROWTH = Real(0.004, "-", "Usual part of the noise that grows with the reading.")
USUAL_LOG_ODDS_OF_MEMORY = Real(
    2.0, "-", "Log odds of the correlation of neighbouring errors at which its search starts: 0.88."
)
LARGEST_MEMORY = Real(
    0.99,
    "-",
    "Largest correlation between neighbouring errors: beyond, misfit of a model would pass as noise.",
)
NEGLIGIBLE_CHANGE = Real(
    0.01, "-", "Expected chi-square of a direction of changes below which it is left out."
)
MEMORY_MODEL_PROBABILITIES = Series(
    (0.4, 0.4, 0.2),
    "-",
    "Prior of errors without memory, with one, and with both: the two simple descriptions are alike, both together rarer.",
)
TAIL_DEGREES_OF_FREEDOM = Series(
    (2.0, 2.5, 3.0, 4.0, 6.0, 10.0, 20.0), "-", "Degrees of freedom of Student's t that are tried."
)
MOST_READING_WEIGHT_ROUNDS = Count(4, "-", "Most rounds that estimate scatter and weights in turn.")
READINGS_FOR_SCATTER = Count(400, "-", "Readings of a channel that suffice to estimate its scatter.")
MOST_EXPLANATION_ROUNDS = Count(3, "-", "Most rounds of scatter, effects and coefficients in turn.")
SCATTER_SETTLED = Real(
    0.1, "-", "Relative change of the noise, of any reading or in the median, that ends the search."
)
GENEROUS_EFFECT_SIZE = Real(3.0, "-", "Size of effects over the usual one while the scatter is estimated.")
# Where the misfit is
MOST_REGION_BINS = Count(6, "-", "Most bins of one variable.")
REGION_OVERLAP = Real(0.6, "-", "Share of common readings that makes a region repeat a more significant one.")
REGION_LEVEL_WIDTH = Real(0.1, "-", "Width of a level over the range of the variable.")

# Fit of a hypothesis
HARDLY_MOVED = Real(
    0.01,
    "-",
    "Distance of a number from its prior mean, in standard deviations, below which an effect counts as absent.",
)
ZERO_COEFFICIENT_SCALE = Real(0.2, "-", "Scale of a coefficient at zero over the width of its range.")
RIGS_WORSE_THAN_DECLARED = Real(0.05, "-", "Share of rigs whose errors exceed their declaration.")

# Selection
EVIDENCE_MARGIN = Real(
    4.0, "-", "Log evidence that an effect must add beyond the price of choosing among all candidates.",
    "checked with diagnosis_study.py --seed 3: nothing hidden, nothing named 20 of 20, docs/evidence-diagnosis.md",
)  # fmt: skip
TIED_EVIDENCE = Real(1.5, "-", "Difference of log evidence below which effects count as tied.")
TIE_EXCLUDED_BY_CHANCE = Real(
    0.05,
    "-",
    "Probability with which readings of a rival's effect exclude it by chance; otherwise the two count as tied. Effects that the "
    "data are not expected to separate are tied up to odds of one over it.",
)
UNIDENTIFIED_LOG_ODDS = Real(
    1.0, "-", "Added to the log prior odds of a coefficient at zero, else subtracted."
)
STRUCTURE_EVIDENCE = Real(
    8.0, "-", "Log evidence beyond the price of the search that a bump or structure needs."
)
BUMP_WIDTHS_SIDESLIP = Series((0.7, 1.4, 3.0), "deg", "Widths of bumps over sideslip.")
BUMP_WIDTHS_CAMBER = Series((3.0, 8.0), "deg", "Widths of bumps over camber.")
BUMP_WIDTHS_SLIP = Series(
    (0.01, 0.03), "-", "Widths of bumps over longitudinal slip: a tenth and a third of the slip at the peak."
)
MOST_BUMP_CENTRES = Count(41, "-", "Most centres of bumps along one angle.")
CURVES = Count(300, "-", "Most curves of smooth structure that nobody named.")
SMOOTH_AMPLITUDES = Series(
    (0.001, 0.3), "-", "Smallest and largest smooth amplitude over the channel's size."
)
SMOOTH_AMPLITUDES_TRIED = Count(12, "-", "Smooth amplitudes that are tried, evenly in their logarithm.")
LEAST_CERTAINTY = Real(
    0.85, "-", "Certainty against the best unnamed structure in its place that an effect needs."
)
DIVISIONS_BESIDE_NOISE = Count(
    3,
    "-",
    "Shortest length of smooth structure over an angle while the noise is found, as a part of its range: shorter ones would take "
    "up errors with a memory.",
)
USUAL_MISS_OF_A_FORMULA = Real(
    0.03,
    "-",
    "Usual smooth structure or bump (1 sigma) over the channel's size: model error of real tyres.",
)
SEPARATING_CHI2 = Real(9.0, "-", "Expected chi2 between explanations at which a run is worthwhile: 3 sigma.")

# Confidence and answer
LOG_ODDS_DIVISOR = Real(
    1.35,
    "-",
    "Divides log odds: linearised coefficients, estimated noise and unknown distributions exaggerate evidence.",
    "diagnosis_study.py --doubtful --seed 21, by maximum likelihood; checked on other seeds, docs/evidence-diagnosis.md",
)
SAME_EFFECT_SHARE = Real(
    0.99, "-", "Share of an effect that another explains from which the two are one for these readings."
)
KNOWN_BESIDE_UNKNOWN = Real(
    0.5,
    "-",
    "Prior odds that a named effect acts as well where misfit proves a cause that the library lacks.",
    "diagnosis_study.py --outside --seed 100 and --mixed --seed 500: a third of them right, docs/evidence-diagnosis.md",
)

# Validation
PARTS_OF_A_RUN = Count(
    4, "-", "Parts of every run that are left out in turn, where numbers of single runs are checked."
)
