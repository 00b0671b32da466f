"""The usual size of ply-steer, which looks like a misaligned sideslip axis."""

from __future__ import annotations

from tir.parameters import BY_NAME


def usual_ply_steer() -> float:
    """Prior standard deviation of ply-steer [rad]."""
    spread = BY_NAME["PHY1"].disc_spread
    assert spread is not None
    return float(spread)
