"""Whether the data can show an effect at all."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mffit.effects import Effect
from mffit.points import Points


def _spread(x: np.ndarray) -> float:
    x = x[np.isfinite(x)]
    return float(np.ptp(x)) if len(x) else 0.0


NEEDS: dict[str, tuple[Callable[[Points], bool], str]] = {
    "curved": (lambda p: bool(np.any(p.phi_t)), "a curved path"),
    "spin": (lambda p: bool(np.any(p.phi_t)) or _spread(p.gamma) > 0.2, "a curved path or large camber"),
    "camber": (lambda p: _spread(p.gamma) > 0.03, "camber"),
    "coupled": (
        lambda p: bool(np.any((np.abs(p.gamma) > 0.02) & (np.abs(p.alpha) > 0.01))), "sideslip and camber together"
    ),
    "slip": (lambda p: _spread(p.alpha) > 0.05, "a sideslip sweep"),
    "loads": (lambda p: _spread(np.log(p.Fz)) > 0.1, "two loads"),
    "pressures": (lambda p: _spread(p.p) > 10e3, "two pressures"),
    "moment": (lambda p: bool(np.any(np.isfinite(p.Mz))), "Mz"),
    "temperatures": (lambda p: _spread(p.T) > 3.0, "temperatures that differ (T_degC)"),
    "speeds": (lambda p: _spread(p.V) > 0.5, "two speeds"),
    "times": (lambda p: _spread(p.t) > 60.0, "the time of every point (t_s)"),
    "continuous": (lambda p: bool(np.any(p.continuous)), "a continuous sweep (time_s, moving alpha)"),
}  # fmt: skip


def missing(effect: Effect, points: Points) -> list[str]:
    """What the data lack for the effect to be seen; empty if nothing."""
    return [text for need in effect.needs for test, text in [NEEDS[need]] if not test(points)]
