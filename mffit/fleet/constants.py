"""Numbers of judgement of the estimate of a fleet."""

from __future__ import annotations

from tir.constant import Count, Real

FEWEST_TYRES_FOR_SCATTER = Count(
    4, "-", "Fewest tyres whose own scatter is estimated; fewer have that of tyres in general."
)
FEWEST_TYRES_OF_A_POPULATION = Count(2, "-", "Fewest tyres that must inform a coefficient with a population.")
INFORMED_VARIANCE_SHARE = Real(
    0.8, "-", "A tyre's points inform a number if the variance falls below this share of the prior's."
)
STRAINED_RIG = Real(
    4.0,
    "-",
    "Standard uncertainties between a rig error of one tyre's build and that of the others from which it is reported.",
)
RIG_FAR_FROM_DECLARED = Real(
    3.0, "-", "Standard deviations above which the common rig contradicts its declaration."
)
