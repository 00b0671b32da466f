"""Numbers of judgement of the estimate of a fleet."""

from __future__ import annotations

from tir.constant import Count, Real

FEWEST_TYRES_FOR_SCATTER = Count(
    4, "-", "Tyres from which their own scatter is estimated; fewer are held to that of tyres in general."
)
FEWEST_TYRES_OF_A_POPULATION = Count(
    2, "-", "Tyres that must inform a coefficient for it to have a population."
)
INFORMED_VARIANCE_SHARE = Real(
    0.8, "-", "Share of the prior variance below which a tyre's own points count as informing a number."
)
MOST_SCATTER_ROUNDS = Count(200, "-", "Rounds of the search for the scatter of the population.")
SCATTER_CONVERGED = Real(1e-3, "-", "Relative change of the scatter at which this search ends.")
SMALLEST_SCATTER_SHARE = Real(
    1e-3, "-", "Scatter of a population over that of tyres in general, below which it is held there."
)
PINNED_MEAN_SHARE = Real(
    1e-6,
    "-",
    "Prior spread of the mean of a population of one, over its usual one: only the tyre varies around it.",
)
STRAINED_RIG = Real(
    4.0, "-", "Standard deviations beyond which the rig of one tyre differs from that of the others."
)
RIG_FAR_FROM_DECLARED = Real(
    3.0, "-", "Standard deviations beyond which the common rig contradicts its declaration."
)
