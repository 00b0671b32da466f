"""Numbers of judgement of the virtual rig."""

from __future__ import annotations

from tir.constant import Real

SENSE_STEP = Real(0.02, "deg", "Change of sideslip between points below which the wheel was held.")
