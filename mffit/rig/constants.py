"""Numbers of judgement of the forward model."""

from __future__ import annotations

from tir.constant import Count, Real

LONGEST_ZERO_SEARCH = Count(12, "-", "Most Newton steps for the angle without moment; two are usual.")
ZERO_SEARCH_STEP = Real(1e-7, "rad", "Newton step that ends this search; the remaining error is its square.")
LONGEST_YIELDING = Count(12, "-", "Most Newton steps for the angle of a compliant steering; three are usual.")
YIELDING_STEP = Real(1e-7, "rad", "Newton step that ends this search.")
HELD_ANGLE = Real(0.02, "deg", "Change of sideslip from point to point below which the angle was held.")
