"""Numbers of judgement of the pages with curves and points."""

from tir.constant import Count, Real

SLIDER_LEAST = Real(
    0.2,
    "-",
    "Least reach of a coefficient's slider, over 1 plus the size of its value: a change that the eye sees.",
)
MOST_CHIPS = Count(
    24, "-", "Most levels of a condition with a button each: three lines; above it, the filter is a range."
)
POINTS_OF_BANDS = Count(
    1500,
    "-",
    "Most points of a page at which bands are computed: fifty curves have thirty each, two for each of their knots.",
)
