"""Numbers of judgement of a comparison."""

from tir.constant import Series

COMPARED_LOADS = Series(
    (0.6, 1.0, 1.4), "-", "Compared loads over the nominal one, within the ranges of both files."
)
