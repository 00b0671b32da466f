"""Numbers of judgement of a comparison."""

from __future__ import annotations

from tir.constant import Real, Series

COMPARED_LOADS = Series(
    (0.6, 1.0, 1.4), "-", "Compared loads over the nominal one, within the ranges of both files."
)
COMPARED_SAME_LOAD = Real(0.02, "-", "Relative difference up to which two loads count as one.")
SIGNIFICANT_DIFFERENCE = Real(2.0, "-", "Standard uncertainties above which a difference is significant.")
