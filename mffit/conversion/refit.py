"""Least squares of the new file's side force and aligning moment to the old ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.conversion import constants
from mffit.conversion.grid import Conditions
from mffit.fit.written.normal import CAMBER_FORCE, CAMBER_MOMENT, STARTS
from mffit.least_squares import FreeNumber, of_model, solve
from tir.outputs import outputs_of
from tir.parameters import BY_NAME

FREE: Mapping[str, Sequence[str]] = {
    "Fy": CAMBER_FORCE,
    "Mz": (*CAMBER_MOMENT, "QBZ9", "QBZ10", "QDZ6", "QDZ7"),
}
"""By channel, what is fitted: the coefficients of camber. All others mean the same in both formulae."""


def refit(values: Mapping[str, Any], at: Conditions, goal: Mapping[str, np.ndarray]) -> dict[str, float]:
    """The coefficients of camber with which the new formulae come nearest to the old forces; Fy first, as it enters Mz."""
    found: dict[str, float] = {}
    for channel, names in FREE.items():
        found.update(_of_channel(channel, names, {**values, **found}, at, goal[channel]))
    return found


def _of_channel(
    channel: str, names: Sequence[str], values: Mapping[str, Any], at: Conditions, goal: np.ndarray
) -> Mapping[str, float]:
    unit = float(constants.MISFIT_UNIT_OF_CONVERSION) * float(np.max(np.abs(goal)))
    u = unit / np.sqrt(at.weight / at.weight.sum())
    inputs = at._asdict()

    def force(numbers: Mapping[str, Any]) -> Any:
        return outputs_of((channel,), SimpleNamespace(**{**values, **numbers}), inputs)[0]

    ends = [
        solve(
            of_model(force, names, goal, u),
            [_number(name, float(start.get(name, values[name]))) for name in names],
            max_steps=int(constants.STEPS_OF_THE_CONVERSION),
            tolerance=float(constants.END_OF_THE_CONVERSION),
        )
        for start in STARTS[channel]
    ]
    return min(ends, key=lambda end: end.cost).values


def _number(name: str, start: float) -> FreeNumber:
    """A coefficient within its plausible range, and within twice the old value where that lies outside."""
    lower, upper = BY_NAME[name].bounds
    return FreeNumber(name, start, min(lower, 2.0 * start), max(upper, 2.0 * start))
