"""Play of the steering axis: at which sideslip the moment of the tyre holds a wheel that is free between two stops."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

STEPS, CLOSE = 12, 1e-10
"""Steps of the search for the angle without moment at most, and how close it comes [rad]."""

Moment = Callable[[np.ndarray], np.ndarray]
"""Aligning moment [Nm] at sideslip angles (m,) [rad]."""


class Settled(NamedTuple):
    """Where the wheel comes to rest; arrays (n,)."""

    side: np.ndarray  #: +1 where a positive moment holds it at the lower stop, -1 at the upper one
    floats: np.ndarray  #: bool: the moment vanishes between the stops, and the wheel rests there
    alpha: np.ndarray  #: the sideslip angle at which it floats [rad]; NaN where a stop holds it


def settled(moment_of: Callable[[np.ndarray], Moment], alpha: np.ndarray, half_play: float) -> Settled:
    """Rest of a wheel that may turn by ``half_play`` to either side of ``alpha``.

    Parameters
    ----------
    moment_of : indices (m,) of conditions -> their moment on the wheel; a positive one turns it towards smaller sideslip
    alpha : (n,) sideslip angle in the middle of the play [rad]
    half_play : [rad]
    """
    moment = moment_of(np.arange(len(alpha)))
    lower, upper = moment(alpha - half_play), moment(alpha + half_play)
    # Two stops that both hold it: it lies at the one to which the moment in the middle turns it.
    middle = moment(alpha) if np.any((lower > 0.0) & (upper < 0.0)) else lower + upper
    at_lower, at_upper = lower > 0.0, upper < 0.0
    side = np.where(at_lower & (~at_upper | (middle > 0.0)), 1.0, -1.0)
    floats = ~at_lower & ~at_upper
    rest = np.where(floats, alpha, np.nan)  # in the middle where no moment turns it at all
    which = np.flatnonzero(floats & (lower < upper))
    if len(which):
        rest[which] = _without_moment(
            moment_of(which),
            alpha[which] - half_play,
            alpha[which] + half_play,
            lower[which],
            upper[which],
        )
    return Settled(side, floats, rest)


def _without_moment(
    moment: Moment,
    a: np.ndarray,
    b: np.ndarray,
    at_a: np.ndarray,
    at_b: np.ndarray,
) -> np.ndarray:
    """Root (m,) between ``a`` and ``b`` with values of opposite sign: false position, the stale end halved (Illinois).

    The moment is nearly straight over so small an angle; scipy's root finder costs ten times as much here.
    """
    for _ in range(STEPS):
        middle = b - at_b * (b - a) / np.where(at_b == at_a, 1.0, at_b - at_a)
        value = moment(middle)
        crossed = value * at_b < 0.0
        a, at_a = np.where(crossed, b, a), np.where(crossed, at_b, 0.5 * at_a)
        moved = np.abs(middle - b)
        b, at_b = middle, value
        if np.all((moved < CLOSE) | (value == 0.0)):
            break
    return b
