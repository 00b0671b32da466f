"""Numbers of judgement of the workflows."""

from __future__ import annotations

from tir.constant import Count, Real

CLUSTER_BUILDS_IN_FLIGHT = Count(
    1000, "-", "Builds submitted to a Dask cluster at a time; more than any cluster works on at once."
)
SCHEDULER_TIMEOUT = Count(10, "s", "A Dask scheduler that does not answer within this time counts as absent.")
UNEDITED_TOLERANCE = Real(
    1e-6,
    "-",
    "Relative difference up to which a coefficient of a property file equals the one in result.json: rounding of the text.",
)
