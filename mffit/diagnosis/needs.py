"""The effects that the data can reveal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from mffit.constants import FEWEST, VISIBLE_TEMPERATURE
from mffit.diagnosis import constants
from mffit.diagnosis.notes import NotVisible
from mffit.effects import OF_CHANNEL, Effect
from mffit.points import Points, levels
from mffit.points.clock import sense
from mffit.rig import Simulation, distance_km
from mffit.rig_errors import T_REF


def _spread(x: np.ndarray) -> float:
    x = x[np.isfinite(x)]
    return float(np.ptp(x)) if len(x) else 0.0


def _varies(x: np.ndarray, kind: levels.LevelKind) -> bool:
    """Whether values (n,) belong to more than one level."""
    return _spread(np.log(x[x > 0.0]) if kind.relative else x) > kind.tolerance


def _coupled(points: Points) -> np.ndarray:
    """Mask (n,) of points with both camber and sideslip."""
    leaned, steered = (np.abs(x) > kind.tolerance for x, kind in _angles(points))
    return leaned & steered


def _angles(points: Points) -> tuple[tuple[np.ndarray, levels.LevelKind], ...]:
    return (points.gamma, levels.CAMBER), (points.alpha, levels.SIDESLIP)


def _both_senses(points: Points) -> bool:
    way = sense(points)
    return bool(min(np.sum(way > 0), np.sum(way < 0)) > constants.VISIBLE_SENSE_SHARE * len(points))


def _distance_is_not_time(points: Points) -> bool:
    known = np.isfinite(points.t)
    if _spread(points.t) <= constants.VISIBLE_TIME or not _varies(points.V, levels.SPEED):
        return False
    likeness = float(np.corrcoef(points.t[known], distance_km(points)[known])[0, 1])
    return likeness < constants.DISTANCE_LIKE_TIME


MET: dict[str, Callable[[Points], bool]] = {
    "curved": lambda p: bool(np.any(p.phi_t)),
    "spin": lambda p: bool(np.any(p.phi_t)) or _spread(p.gamma) > constants.VISIBLE_SPIN_CAMBER,
    "camber": lambda p: _varies(p.gamma, levels.CAMBER),
    "coupled": lambda p: bool(np.any(_coupled(p))),
    "slip": lambda p: _varies(p.alpha, levels.SIDESLIP),
    "loads": lambda p: _varies(p.Fz, levels.LOAD),
    "pressures": lambda p: _varies(p.p, levels.PRESSURE),
    "moment": lambda p: bool(np.any(np.isfinite(p.Mz))),
    "temperatures": lambda p: _spread(p.T) > VISIBLE_TEMPERATURE,
    "speeds": lambda p: _varies(p.V, levels.SPEED),
    "times": lambda p: _spread(p.t) > constants.VISIBLE_TIME,
    "distances": _distance_is_not_time,
    "runs": lambda p: len(np.unique(p.file)) >= FEWEST,
    "directions": lambda p: _spread(p.direction) > 0.0,
    "senses": _both_senses,
    "continuous": lambda p: bool(np.any(p.continuous)),
    "drive": lambda p: "Fx" in p.measured and not np.all(p.free_rolling),
    "combined": lambda p: bool(np.any(~p.free_rolling & (np.abs(p.alpha) > levels.SIDESLIP.tolerance))),
    "combined_camber": lambda p: bool(np.any(~p.free_rolling & _coupled(p))),
    "overturning": lambda p: "Mx" in p.measured,
}
"""Whether points meet a need, by its key in ``mffit.effects.NEEDS``."""


def missing(effect: Effect, points: Points) -> tuple[str, ...]:
    """The needs of the effect that the data do not meet; empty if it is visible."""
    return tuple(need for need in effect.needs if not MET[need](points))


def without(effect: Effect, name: str) -> Effect:
    """The effect with one of its numbers held at the model's value."""
    return replace(effect, free=tuple(free for free in effect.free if free.name != name))


def _in_range(effect: Effect, points: Points) -> Effect:
    """The effect with the reference temperature bounded to the range of the data.

    A reference far outside would turn a temperature effect into a constant change of the tyre.
    """
    if T_REF not in effect.parameters:
        return effect
    T = points.T[np.isfinite(points.T)]
    spread, lower, upper = float(np.std(T)), float(T.min()), float(T.max())
    free = [
        replace(f, spread=spread, lower=lower, upper=upper) if f.name == T_REF else f for f in effect.free
    ]
    return replace(effect, free=tuple(free))


def possible(
    effects: Sequence[Effect], points: Points, start: Simulation
) -> tuple[list[Effect], list[NotVisible]]:
    """Effects that the data can reveal, and notes on the others except those of channels that were not measured."""
    out: list[Effect] = []
    lacking: dict[tuple[str, ...], list[Effect]] = {}
    files = sorted({points.files[k] for k in np.unique(points.file)})
    for effect in effects:
        if effect.switches and start.turn_slip:
            continue
        lack = missing(effect, points)
        if not OF_CHANNEL.isdisjoint(lack):
            continue
        if lack:
            lacking.setdefault(lack, []).append(effect)
        else:
            out.append(_in_range(effect.written_out(files, points.used_setups), points))
    return out, [NotVisible(needs=lack, effects=tuple(hidden)) for lack, hidden in lacking.items()]
