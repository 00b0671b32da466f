"""Numbers of judgement about results."""

from __future__ import annotations

from tir.constant import Real

SAME_NUMBER = Real(
    1e-5,
    "-",
    "Relative change below which a number comes out again: processors and libraries round the last digits differently.",
)
SAME_IN_U = Real(
    1e-3,
    "-",
    "Change in standard uncertainties below which a number comes out again: no stated digit of it changes.",
)
