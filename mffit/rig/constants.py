"""Numbers of judgement of the forward model."""

from __future__ import annotations

from tir.constant import Count

POINTS_OF_A_BLOCK = Count(
    8192,
    "-",
    "Points simulated at once: their derivatives stay in the processor's cache.",
    "tests/benchmarks/scale.py",
)
