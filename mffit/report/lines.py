"""The model as a smooth line at each curve's conditions, for the pictures only."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.points import Points
from mffit.quantities import SIDEWAYS
from mffit.report import constants
from mffit.report.curves import Curve, CurveKey, shown_values
from mffit.rig import Simulation

VARIED = ("alpha", "gamma", "kappa", "Fz", "p", "V")
"""Conditions that a line holds at their median, or lets vary."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveLine:
    """Readings that the rig would give along a curve if the tyre were the model; arrays (m,)."""

    x: np.ndarray  #: what varies: an angle [deg] or longitudinal slip [-]
    raw: Mapping[str, np.ndarray]  #: by channel
    even: Mapping[str, np.ndarray]  #: its even part


def model_lines(
    simulation: Simulation, points: Points, curves: Sequence[Curve], channels: Iterable[str] = SIDEWAYS
) -> dict[CurveKey, CurveLine]:
    """A line per curve, by ``curve.key``, at the curve's median load, pressure, speed and held angle.

    Parameters
    ----------
    simulation : the model on the rig, with the errors of the rig
    points : the measured points (n,), angles as read
    curves : rows of the points that belong together
    channels : those to compute
    """
    if not curves:
        return {}
    grid = _along(points, curves)
    mirrored = grid.replace(alpha=-grid.alpha, gamma=-grid.gamma)
    here, there = (simulation.readings(p, channels) for p in (grid, mirrored))
    steps = constants.STEPS_OF_LINE
    lines = {}
    for i, curve in enumerate(curves):
        rows = slice(i * steps, (i + 1) * steps)
        lines[curve.key] = CurveLine(
            x=shown_values(grid, curve.over)[rows],
            raw={name: values[rows] for name, values in here.items()},
            even={name: 0.5 * (values + there[name])[rows] for name, values in here.items()},
        )
    return lines


def _along(points: Points, curves: Sequence[Curve]) -> Points:
    """Points at equal distances along each curve's range."""
    steps = constants.STEPS_OF_LINE
    columns: dict[str, list[np.ndarray]] = {name: [] for name in VARIED}
    for curve in curves:
        for name, values in columns.items():
            here = getattr(points, name)[curve.index]
            values.append(
                np.linspace(here.min(), here.max(), steps)
                if name == curve.over
                else np.full(steps, np.median(here))
            )
    rows = np.repeat([curve.index[0] for curve in curves], steps)
    return points.select(rows).replace(**{name: np.concatenate(values) for name, values in columns.items()})
