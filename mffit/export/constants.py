"""Numbers of judgement of lookup tables: how close they come to the tyre, and how large they may be."""

from tir.constant import Count, Real

TABLE_ERROR = Real(
    0.005,
    "-",
    "Largest error of interpolation in a table over the largest value of its channel: far below the misfit of good files.",
)
TABLE_RESERVE = Real(
    0.9,
    "-",
    "Share of that error at which a table is good: not every condition is tested. Below 3/4 of it fewer nodes are tried.",
)
TABLE_NODES = Count(1_000_000, "-", "Most nodes of a table: 8 MB of numbers, the rows of a spreadsheet.")
TABLE_TRIES = Count(8, "-", "Most grids that are tried for a table; two to four are usual.")
TABLE_POSITIONS = Count(
    201, "-", "Positions on each side of zero from which the nodes of an axis are chosen."
)
TABLE_PLACES = Count(
    400, "-", "Random values of the other conditions at which the curvature along an axis is seen."
)
TABLE_CONDITIONS = Count(
    20_000,
    "-",
    "Random conditions at which a table is tested; as many are in the middle of cells and in the worst cells.",
)
TABLE_WORST_CELLS = Count(100, "-", "Cells of a table that are tested again, because they miss most.")
