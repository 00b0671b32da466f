"""Numbers of judgement of predictions."""

from __future__ import annotations

from tir.constant import Count, Real

INTERPOLATION_ADDS = Real(
    0.08,
    "-",
    "Error of lines between the nodes of the table over the model error, which is known to a fifth at best.",
)
MOST_NODES = Count(
    8000, "-", "Most nodes of the table of the model error: with four channels they are a file of 0.8 MB."
)
LARGE_FORCE = Real(
    0.9, "-", "Force over the largest of its sweep from which it counts as grip, where the curve is flat."
)
USUAL_SHARE = Real(
    0.5,
    "-",
    "Sideslip and camber, over the largest tested ones, at which the road's numbers are stated: a tyre in fast use.",
)
