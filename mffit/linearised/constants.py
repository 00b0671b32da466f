"""Numbers of judgement of the linear model of what a fit leaves."""

from __future__ import annotations

from tir.constant import Count, Real

FUNCTIONS = Count(
    300, "-", "Most functions of what the formula misses of a channel: 450 predict no better on real tyres."
)
LEAST_SHARE = Real(
    0.01,
    "-",
    "Variance of a function, over that of a constant at the shortest lengths, below which it is left out.",
)
POINTS_EXAMINED = Count(
    4000, "-", "Most readings of a channel that are looked at: many more of one sweep tell nothing new."
)
DIVISIONS_OF_A_SWEEP = Count(
    12, "-", "Shortest length of a smooth function along what is swept, as a part of its range."
)
DIVISIONS_OF_WARMING = Count(4, "-", "The same along the temperature of the tyre.")
ROOM = Real(
    0.15, "-", "Range beyond the tested one over which the functions run, so that their slope is free there."
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
    "Variance of a coefficient beside what the formula misses, over that of the fit, which knows nothing of this.",
)
FITTED_ANEW = Real(
    100.0,
    "-",
    "The same over that, where a run is left out that may have bent the fit: at 1 a force scaled by 1.05 hides in a brush tyre.",
)
COMPONENT_STEPS = Count(60, "-", "Most steps of the search for the components.")
COMPONENT_TOLERANCE = Real(0.05, "-", "Gain of log evidence at which the search for the components ends.")
