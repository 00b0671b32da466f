"""Numbers of judgement of the linear model of what a fit leaves."""

from __future__ import annotations

from tir.constant import Count, Real, Series

FUNCTIONS = Count(600, "-", "Most functions of the model error of a channel.")
READINGS_AT_FIRST = Count(300, "-", "Most readings that are looked at while its lengths are not known.")
LEFT_OUT = Real(
    0.3,
    "-",
    "Standard deviation of what further functions would add, over the noise, below which they are left out.",
)
POINTS_EXAMINED = Count(
    4000, "-", "Most readings of a channel that are looked at: many more of one sweep tell nothing new."
)
DIVISIONS_OF_A_SWEEP = Count(
    12, "-", "Shortest length of a smooth function along what is swept, as a part of its range."
)
STEPS_OF_A_SWEEP = Real(
    1.5,
    "-",
    "Steps between settings from which a run that moves through them sweeps the condition; it may wander by half of one.",
)
DIVISIONS_OF_WARMING = Count(4, "-", "The same along the temperature of the tyre.")
USUAL_TEMPERATURES = Series(
    (10.0, 50.0, 90.0),
    "%",
    "Percentiles of the temperature over which a prediction averages that does not state it.",
)
SPACINGS_OF_AN_END = Real(
    3.0,
    "-",
    "Depth of an end of a swept range that is predicted from the rest, in shortest lengths: a quarter of the range.",
)
FREE_OVER_KNOWN = Real(
    100.0,
    "-",
    "Standard deviation of a number without a prior over that which all readings leave, if some are left out.",
)
FUNCTIONS_OF_A_RUN = Count(10, "-", "Smooth functions along its swept setting that each run has of its own.")
LARGEST_RUN_SCALE = Real(
    0.03, "-", "Largest standard deviation of a run's own scale: rigs repeat a force better than this."
)
USUAL_RATIO = Real(
    3.0,
    "-",
    "Standard deviation of the logarithm of a component around its first guess, so that few runs move it little.",
)
WIDER_THAN_THE_FIT = Real(
    10.0,
    "-",
    "Variance of a coefficient where there is model error, over that of the fit, which assumes none.",
)
LONGEST_LENGTH = Real(
    20.0, "-", "Largest length of smooth functions over the tested range: along it they are constant."
)
SEARCH_STEPS = Count(60, "-", "Most steps of a search for the most probable parameters.")
PROBES = Count(10, "-", "Random directions by which a search estimates how well its parameters are known.")
SEARCH_TOLERANCE = Real(0.05, "-", "Gain of log evidence by a step at which such a search ends.")
EVIDENCE_STEP = Real(
    0.1, "-", "Step of a logarithm for the differences of slopes that give the width of its distribution."
)
LEAST_CURVATURE = Real(0.05, "-", "Smallest curvature that counts: a prior alone has more than 0.2.")
LONGEST_CHAIN = Count(
    200, "-", "Readings after which a chain of errors with a memory is cut: many memories of any rig."
)
LEAST_KNOWN = Real(
    1e-3,
    "-",
    "Smallest share of the information of a reading or an effect that other columns leave to it; below, residuals say nothing.",
)
