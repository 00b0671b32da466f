"""Conditions that were held while something else was swept: what is left out together when a model is validated."""

from __future__ import annotations

import numpy as np

from mffit.points import Points

STEPS = {"load": 0.08, "camber": np.radians(0.4), "pressure": 0.04, "speed": 0.1}
"""Smallest step between two settings: relative, but for camber [rad]. Control errors are smaller and continuous."""
FEWEST_PER_LEVEL = 8
"""Fewer points at a setting make it a swept quantity, not a held one."""


def by_condition(points: Points) -> Points:
    """The points with sweeps cut where a held quantity steps.

    A file that holds a whole programme is no single sweep: load, camber, pressure and speed step between its parts.
    What moves nearly from point to point is what was swept, and is not cut.

    Parameters
    ----------
    points : (n,) with ``sweep`` as declared

    Returns
    -------
    The same points in the same order; ``sweep`` counts conditions, whose names are the sweep's with a number where
    one sweep held several.
    """
    held = {
        "load": np.log(points.Fz),
        "camber": points.gamma,
        "pressure": np.log(points.p),
        "speed": np.log(points.V),
    }
    sweep = np.zeros(len(points), dtype=int)
    names: list[str] = []
    for k in np.unique(points.sweep):
        rows = np.flatnonzero(points.sweep == k)
        labels = np.column_stack([_levels(values[rows], STEPS[name]) for name, values in held.items()])
        _, part = np.unique(labels, axis=0, return_inverse=True)
        part = part.ravel()
        sweep[rows] = len(names) + part
        name = points.sweep_names[k]
        names += [name] if part.max() == 0 else [f"{name} {i + 1}" for i in range(part.max() + 1)]
    return points.replace(sweep=sweep, sweep_names=tuple(names))


def _levels(values: np.ndarray, step: float) -> np.ndarray:
    """Number (n,) of the level at which each value was held; all 0 if the quantity was swept or never changed."""
    order = np.argsort(values, kind="stable")
    level = np.zeros(len(values), dtype=int)
    level[order] = np.concatenate([[0], np.cumsum(np.diff(values[order]) > step)])
    held = len(values) >= FEWEST_PER_LEVEL * (level.max() + 1)
    return level if held else np.zeros(len(values), dtype=int)
