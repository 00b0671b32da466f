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
from tir.equations import longitudinal, normalise
from tir.outputs import outputs_of
from tir.parameters import BY_NAME

FREE: Mapping[str, Sequence[str]] = {
    "Fy": CAMBER_FORCE,
    "Mz": (*CAMBER_MOMENT, "QBZ9", "QBZ10", "QDZ6", "QDZ7"),
}
"""By channel, what is always fitted: the coefficients of camber. All others mean the same in both formulae."""
PURE_CURVATURE = ("PEX1", "PEX2", "PEX3", "PEX4")
COMBINED_CURVATURE = ("REX1", "REX2")
"""What is fitted where MF 5.2 limits the curvature of Fx, which programs of MF 6.2 do not."""


def refit(values: Mapping[str, Any], at: Conditions, goal: Mapping[str, np.ndarray]) -> dict[str, float]:
    """The coefficients with which the new formulae come nearest to the old forces; Fx and Fy first, as they enter Mz.

    Those of camber, and those of the curvature of Fx where the old formula holds it to 1.
    """
    found = _curvature_within_one(values, at)
    channels = {"Fx": tuple(found), **FREE} if found else FREE
    for channel, names in channels.items():
        found.update(_of_channel(channel, names, {**values, **found}, at, goal[channel]))
    return found


def _curvature_within_one(values: Mapping[str, Any], at: Conditions) -> dict[str, float]:
    """Starting values nearest to the curvature of Fx held to 1; empty if the old file never exceeds it.

    Parameters
    ----------
    values : coefficients under the names of MF 6.2
    """
    p, Fz = SimpleNamespace(**values), np.unique(at.Fz)
    q = normalise.inputs(p, Fz, Fz, 0.0, 0.0, 0.0, 0.0, p.INFLPRES, False, False)
    by_load = np.column_stack([np.ones_like(Fz), q.dfz, q.dfz**2])
    found: dict[str, float] = {}
    driven, braked = (longitudinal.curvature(p, q, side) for side in (1.0, -1.0))
    if max(np.max(driven), np.max(braked)) > 1.0:
        driven, braked = np.minimum(driven, 1.0), np.minimum(braked, 1.0)
        mean = np.linalg.lstsq(by_load, (driven + braked) / 2.0, rcond=None)[0]
        even = by_load @ mean
        uneven = even @ (braked - driven) / 2.0 / max(even @ even, np.finfo(float).tiny)
        found |= dict(zip(PURE_CURVATURE, (*(mean / p.LEX), uneven), strict=True))
    combined = longitudinal.weight_factors(p, q).E
    if np.max(combined) > 1.0:
        terms = np.linalg.lstsq(by_load[:, :2], np.minimum(combined, 1.0), rcond=None)[0]
        found |= dict(zip(COMBINED_CURVATURE, terms, strict=True))
    return {name: float(value) for name, value in found.items()}


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
        for start in STARTS.get(channel, ({},))
    ]
    return min(ends, key=lambda end: end.cost).values


def _number(name: str, start: float) -> FreeNumber:
    """A coefficient within its plausible range, and within twice the old value where that lies outside."""
    lower, upper = BY_NAME[name].bounds
    return FreeNumber(name, start, min(lower, 2.0 * start), max(upper, 2.0 * start))
