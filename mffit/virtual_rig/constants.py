"""Numbers of judgement of the virtual rig."""

from __future__ import annotations

from tir.constant import Real

SENSE_STEP = Real(
    1e-6,
    "deg",
    "Change of sideslip from point to point, or from sample to sample, below which the wheel was held.",
)
