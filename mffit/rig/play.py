"""Play of the steering axis: at which sideslip the moment of the tyre holds a wheel that is free between two stops."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.optimize.elementwise import find_root

Moment = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Aligning moment [Nm] at the sideslip angles (m,) [rad] of the conditions with the indices (m,)."""


class Settled(NamedTuple):
    """Where the wheel comes to rest; arrays (n,)."""

    side: np.ndarray  #: +1 where a positive moment holds it at the lower stop, -1 at the upper one
    floats: np.ndarray  #: bool: the moment vanishes between the stops, and the wheel rests there
    alpha: np.ndarray  #: the sideslip angle at which it floats [rad]; NaN where a stop holds it


def settled(moment: Moment, alpha: np.ndarray, half_play: float) -> Settled:
    """Rest of a wheel that may turn by ``half_play`` to either side of ``alpha``.

    Parameters
    ----------
    moment : of the tyre on the wheel; a positive one turns the wheel towards smaller sideslip
    alpha : (n,) sideslip angle in the middle of the play [rad]
    half_play : [rad]
    """
    everywhere = np.arange(len(alpha))
    lower, upper = moment(alpha - half_play, everywhere), moment(alpha + half_play, everywhere)
    # Two stops that both hold it: it lies at the one to which the moment in the middle turns it.
    middle = moment(alpha, everywhere) if np.any((lower > 0.0) & (upper < 0.0)) else lower + upper
    at_lower, at_upper = lower > 0.0, upper < 0.0
    side = np.where(at_lower & (~at_upper | (middle > 0.0)), 1.0, -1.0)
    floats = ~at_lower & ~at_upper
    rest = np.where(floats, alpha, np.nan)  # in the middle where no moment turns it at all
    which = np.flatnonzero(floats & (lower < upper))
    if len(which):
        ends = alpha[which] - half_play, alpha[which] + half_play
        rest[which] = find_root(moment, ends, args=(which,)).x
    return Settled(side, floats, rest)
