"""Numbers of judgement of the virtual rig."""

from __future__ import annotations

from tir.constant import Count, Real

PLAY_HALVINGS = Count(
    20, "-", "Bisections of the play for the angle without moment; they leave a millionth of it."
)
YIELDING_ROUNDS = Count(
    60, "-", "Rounds of a compliant steering until moment and angle agree; each leaves a tenth or less."
)
SENSE_STEP = Real(0.02, "deg", "Change of sideslip between points below which the wheel was held.")
TRUTH_STEP = Real(
    1e-6,
    "rad",
    "Step for slopes of the true tyre, or in 1/m: rounding and curvature stay below 1e-6 of the slope.",
)
