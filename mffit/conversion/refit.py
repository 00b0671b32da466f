"""Least squares of the new file's forces to the old ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from mffit.conversion import constants
from mffit.conversion.curvature_limits import CurvatureFactor, exceeding, excess
from mffit.conversion.grid import Conditions, Reach
from mffit.fit.written.normal import CAMBER_FORCE, CAMBER_MOMENT
from mffit.least_squares import FreeNumber, LeastSquaresProblem, Linear, of_model, solve
from tir.derivatives import traced
from tir.outputs import outputs_of

FREE: Mapping[str, Sequence[str]] = {
    "Fx": (),
    "Fy": CAMBER_FORCE,
    "Mz": CAMBER_MOMENT,
}
"""By channel, what is fitted in every file: the coefficients of camber. All others mean the same in both formulae, so that the
upright wheel keeps its forces."""
UNBOUNDED = (-np.inf, np.inf)
"""Of a converted coefficient: exact forces determine it, and what it multiplies may be tiny in the old file."""


def refit(
    values: Mapping[str, Any], at: Conditions, goal: Mapping[str, np.ndarray], reach: Reach
) -> dict[str, float]:
    """The coefficients with which the new formulae come nearest to the old forces: those of camber, and of too large curvature.

    The side force comes before the aligning moment, into which it enters.
    """
    found: dict[str, float] = {}
    curved = exceeding(SimpleNamespace(**values), reach)
    for channel, by_camber in FREE.items():
        limited = [factor for factor in curved if factor.channel == channel]
        names = (*by_camber, *(name for factor in limited for name in factor.names))
        if names:
            fit = _ChannelFit(channel, names, limited, reach)
            found.update(_of_channel(fit, {**values, **found}, at, goal[channel]))
    return found


class _ChannelFit(NamedTuple):
    """What is free in a channel, and which curvature factors are held to 1."""

    channel: str
    names: Sequence[str]
    limited: Sequence[CurvatureFactor]
    reach: Reach


def _of_channel(
    fit: _ChannelFit, values: Mapping[str, Any], at: Conditions, goal: np.ndarray
) -> Mapping[str, float]:
    unit = float(constants.GOOD_SHARE) * at.largest_alike(goal)
    u = unit / np.sqrt(at.weight / at.weight.sum())
    inputs = at._asdict()

    def force(numbers: Mapping[str, Any]) -> Any:
        return outputs_of((fit.channel,), SimpleNamespace(**{**values, **numbers}), inputs)[0]

    problem = of_model(force, fit.names, goal, u)
    if fit.limited:
        problem = _held_to_one(problem, fit, values)
    numbers = [FreeNumber(name, float(values[name]), *UNBOUNDED) for name in fit.names]
    return solve(problem, numbers).values


def _held_to_one(
    problem: LeastSquaresProblem, fit: _ChannelFit, values: Mapping[str, Any]
) -> LeastSquaresProblem:
    """The problem with a residual wherever a curvature factor exceeds 1."""
    weight, margin = float(constants.WEIGHT_OF_CURVATURE_LIMIT), float(constants.CURVATURE_MARGIN)

    def limits(numbers: Mapping[str, Any], by: Sequence[Any] = ()) -> tuple[np.ndarray, np.ndarray]:
        p = SimpleNamespace(**{**values, **numbers})
        over, slope = excess(p, fit.limited, fit.reach, by)
        return weight * (over + margin), weight * slope

    def residual(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return problem.residual(x)[0], limits(dict(zip(fit.names, x.tolist(), strict=True)))[0]

    def linear(x: np.ndarray) -> Linear:
        numbers = traced(dict(zip(fit.names, x.tolist(), strict=True)))
        over, slope = limits(numbers, list(numbers.values()))
        return replace(problem.linear(x), limits=over, limits_slope=slope)

    return LeastSquaresProblem(residual, linear)
