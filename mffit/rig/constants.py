"""Numbers of judgement of the forward model."""

from __future__ import annotations

from tir.constant import Count, Real

LONGEST_ZERO_SEARCH = Count(12, "-", "Steps of the search for the angle without moment; two are usual.")
ZERO_SEARCH_STEP = Real(
    1e-7,
    "rad",
    "A step of the search for the angle without moment that ends it: the error left is its square.",
)
LONGEST_YIELDING = Count(12, "-", "Newton steps for the angle of a compliant steering; three are usual.")
YIELDING_STEP = Real(1e-7, "rad", "A Newton step of a compliant steering that ends the search.")
HELD_ANGLE = Real(0.02, "deg", "Change of sideslip from point to point below which the angle was held.")
