"""Numbers of judgement of the forward model."""

from __future__ import annotations

from tir.constant import Real

HELD_ANGLE = Real(0.02, "deg", "Change of sideslip from point to point below which the angle was held.")
