"""Numbers of judgement of the reports: how much a picture, a page and a terminal show, and at which scale."""

from tir.constant import Count, Real, Series

POINTS_PER_SERIES = Count(
    4000, "-", "Most points of a series in the table behind a picture; points.csv has all."
)
MOST_MARKS = Count(150, "-", "Panels with more marks show them small, so that they cover each other less.")
MOST_PANELS = Count(60, "-", "Most panels of a picture: three pages. The caption says what is left out.")

HELD_SHARES = Series(
    (0.0, 0.4, 0.8), "-", "What curves hold, as shares of the tested camber, sideslip and slip."
)
RESIDUAL_SCALE = Real(4.0, "-", "End of the colour scale of residual maps, in units of noise.")
LARGEST_GAP_SCALE = Real(
    20.0, "-", "Longest colour scale of a diagnosis in units of noise, so that structure stays visible."
)
MOST_REASONS = Count(
    2, "-", "Sentences against a result, or of warnings, for which one screen has room; --explain has all."
)
