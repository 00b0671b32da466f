"""Numbers of judgement of the forward model."""

from __future__ import annotations

from tir.constant import Count, Real

HELD_ANGLE = Real(0.02, "deg", "Change of sideslip from point to point below which the angle was held.")
POINTS_OF_A_BLOCK = Count(
    8192,
    "-",
    "Points simulated at once: their derivatives stay in the processor's cache.",
    "tests/benchmarks/scale.py",
)
