"""Play of the steering axis: the sideslip at which the tyre's moment holds a wheel that can turn between two stops."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

Moment = Callable[[np.ndarray], np.ndarray]
"""Aligning moment [Nm] at sideslip angles (m,) [rad]."""


class Settled(NamedTuple):
    """Rest positions of the wheel; arrays (n,)."""

    side: np.ndarray  #: +1 where a positive moment holds it at the lower stop, -1 at the upper one
    floats: np.ndarray  #: bool: whether the moment vanishes between the stops, where the wheel then rests
    alpha: np.ndarray  #: sideslip angle at which it floats [rad]; NaN where a stop holds it


def settled(moment_of: Callable[[np.ndarray], Moment], alpha: np.ndarray, half_play: float) -> Settled:
    """The rest positions of a wheel that can turn by ``half_play`` [rad] to either side of ``alpha`` (n,) [rad].

    ``moment_of`` returns the moment of conditions by their indices (m,); a positive one turns the wheel to smaller sideslip.
    """
    n = len(alpha)
    both = moment_of(np.tile(np.arange(n), 2))  # both stops in one call, because calls are expensive
    lower, upper = np.split(both(np.concatenate([alpha - half_play, alpha + half_play])), 2)
    # If both stops would hold the wheel, the moment in the middle decides to which one it turns.
    middle = moment_of(np.arange(n))(alpha) if np.any((lower > 0.0) & (upper < 0.0)) else lower + upper
    at_lower, at_upper = lower > 0.0, upper < 0.0
    side = np.where(at_lower & (~at_upper | (middle > 0.0)), 1.0, -1.0)
    floats = ~at_lower & ~at_upper
    rest = np.where(floats, alpha, np.nan)  # the middle, if there is no moment at all
    which = np.flatnonzero(floats & (lower < upper))
    if len(which):
        rest[which] = _without_moment(
            moment_of(which), alpha[which] - half_play, alpha[which] + half_play, lower[which], upper[which]
        )
    return Settled(side, floats, rest)


def _without_moment(
    moment: Moment, a: np.ndarray, b: np.ndarray, at_a: np.ndarray, at_b: np.ndarray
) -> np.ndarray:
    """Root (m,) of the moment between ``a`` and ``b``, where it has opposite signs: a secant, then inverse quadratic steps.

    The moment is nearly linear over such small angles, so two evaluations suffice; scipy's root finder takes ten times as long.
    """
    x = a - at_a * (b - a) / (at_b - at_a)
    for _ in range(12):  # two are usual
        value = moment(x)
        proposed = _inverse_quadratic((a, b, x), (at_a, at_b, value))
        below = value < 0.0  # as at ``a``
        a, at_a = np.where(below, x, a), np.where(below, value, at_a)
        b, at_b = np.where(below, b, x), np.where(below, at_b, value)
        inside = (proposed > a) & (proposed < b)  # false for NaN, too
        following = np.where(value == 0.0, x, np.where(inside, proposed, 0.5 * (a + b)))
        moved, x = np.abs(following - x), following
        if np.all(moved < 1e-7):  # [rad]; the remaining error is about the square of this step
            break
    return np.asarray(x)


def _inverse_quadratic(x: tuple[np.ndarray, ...], y: tuple[np.ndarray, ...]) -> np.ndarray:
    """Zero (m,) of the parabola x(y) through three points (m,) each."""
    (x0, x1, x2), (y0, y1, y2) = x, y
    with np.errstate(divide="ignore", invalid="ignore"):
        root: np.ndarray = (
            x0 * y1 * y2 / ((y0 - y1) * (y0 - y2))
            + x1 * y0 * y2 / ((y1 - y0) * (y1 - y2))
            + x2 * y0 * y1 / ((y2 - y0) * (y2 - y1))
        )
    return root
