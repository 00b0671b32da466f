"""Numbers of judgement of the conversion: over which conditions the old forces are reproduced."""

from tir.constant import Count, Real, Series

CONVERTED_LOADS = Series(
    (0.1, 2.5),
    "-",
    "Loads over the nominal one (times LFZO) at most, even if the old file allows more: no car tyre carries more.",
)
CONVERTED_CAMBER = Real(
    15.0,
    "deg",
    "Largest camber, even if the old file allows more: MF 5.2 is for cars, its camber force is linear in the angle.",
)
SMALL_CAMBER = Real(
    5.0, "deg", "Camber up to which cars use their tyres; the misfit is stated on both sides of it."
)
WEIGHT_OF_LARGE_CAMBER = Real(
    0.1,
    "-",
    "Weight of conditions beyond the small camber: they are kept in sight, but do not cost the others.",
)
LOADS_OF_THE_GRID = Count(6, "-", "Loads of the grid: the load terms are parabolas.")
CAMBERS_OF_THE_GRID = Count(
    3, "-", "Angles of camber of the grid to either side, within the small camber and beyond."
)
SLIPS_OF_THE_GRID = Series(
    (0.0, 0.08, 0.3, 1.0), "-", "Longitudinal slips of the grid to either side, over the largest."
)
GOOD_SHARE = Real(
    0.02,
    "-",
    "Misfit over the largest force of the same load and region up to which a condition, or the rms of a moment, is reproduced.",
)
WEIGHT_OF_CURVATURE_LIMIT = Real(
    150.0,
    "-",
    "Residual per unit by which a curvature factor exceeds 1, where a good share of the largest force is 1: holds the limit.",
)
CURVATURE_MARGIN = Real(
    0.005, "-", "Distance of a fitted curvature factor from 1, so that none exceeds it between the loads."
)
