"""Whether the data can show an effect at all."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mffit.effects import Effect
from mffit.points import Points
from mffit.rig import distance_km, sense


def _spread(x: np.ndarray) -> float:
    x = x[np.isfinite(x)]
    return float(np.ptp(x)) if len(x) else 0.0


def _both_senses(points: Points) -> bool:
    way = sense(points)
    return bool(min(np.sum(way > 0), np.sum(way < 0)) > 0.1 * len(points))


def _distance_is_not_time(points: Points) -> bool:
    known = np.isfinite(points.t)
    if _spread(points.t) <= 60.0 or _spread(points.V) <= 0.5:
        return False
    return float(np.corrcoef(points.t[known], distance_km(points)[known])[0, 1]) < 0.98


MET: dict[str, Callable[[Points], bool]] = {
    "curved": lambda p: bool(np.any(p.phi_t)),
    "spin": lambda p: bool(np.any(p.phi_t)) or _spread(p.gamma) > 0.2,
    "camber": lambda p: _spread(p.gamma) > 0.03,
    "coupled": lambda p: bool(np.any((np.abs(p.gamma) > 0.02) & (np.abs(p.alpha) > 0.01))),
    "slip": lambda p: _spread(p.alpha) > 0.05,
    "loads": lambda p: _spread(np.log(p.Fz)) > 0.1,
    "pressures": lambda p: _spread(p.p) > 10e3,
    "moment": lambda p: bool(np.any(np.isfinite(p.Mz))),
    "temperatures": lambda p: _spread(p.T) > 3.0,
    "speeds": lambda p: _spread(p.V) > 0.5,
    "times": lambda p: _spread(p.t) > 60.0,
    "distances": _distance_is_not_time,
    "runs": lambda p: len(np.unique(p.file)) > 2,
    "senses": _both_senses,
    "continuous": lambda p: bool(np.any(p.continuous)),
}
"""Whether points meet a need, by its key in ``mffit.effects.NEEDS``."""


def missing(effect: Effect, points: Points) -> tuple[str, ...]:
    """The needs of the effect that the data do not meet; empty if it can be seen."""
    return tuple(need for need in effect.needs if not MET[need](points))
