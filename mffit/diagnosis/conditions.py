"""Points grouped by held conditions; validation leaves these groups out one by one."""

from __future__ import annotations

import numpy as np

from mffit.points import Points, levels
from mffit.points.constants import FEWEST_POINTS


def by_condition(points: Points) -> Points:
    """The points with sweeps cut where load, camber, pressure, speed or slip steps.

    A file may contain a whole programme. A quantity that changes from point to point was swept and causes no cut. In the result
    ``sweep`` is the index of the condition; conditions are named after their sweep, with a number if it has several.
    """
    held = [(getattr(points, name), kind) for name, kind in levels.KINDS.items() if name != "alpha"]
    sweep = np.zeros(len(points), dtype=int)
    names: list[str] = []
    for k, rows in points.rows_of_sweeps.items():
        labels = np.column_stack([_held(values[rows], quantity) for values, quantity in held])
        _, part = np.unique(labels, axis=0, return_inverse=True)
        part = part.ravel()
        sweep[rows] = len(names) + part
        name = points.sweep_names[k]
        names += [name] if part.max() == 0 else [f"{name} {i + 1}" for i in range(part.max() + 1)]
    return points.replace(sweep=sweep, sweep_names=tuple(names))


def _held(values: np.ndarray, quantity: levels.LevelKind) -> np.ndarray:
    """Index (n,) of the level at which each value was held; all 0 if the quantity was swept or never changed."""
    level = levels.nearest_labels(values, quantity)
    many = len(values) < FEWEST_POINTS * (level.max() + 1)
    return np.zeros_like(level) if many or levels.spread(values, quantity) else level
