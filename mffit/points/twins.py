"""Sweeps that were handed over twice."""

from __future__ import annotations

import numpy as np

from mffit.errors import InputError
from mffit.points.points import Points

FEWEST = 4
"""Equal rows that are no chance: two measurements never scatter alike."""


def check_twins(points: Points) -> None:
    """Refuse a sweep whose every reading stands in another one too: its points would count twice.

    Raises
    ------
    InputError
        Names both files.
    """
    readings = np.column_stack(
        [points.alpha, points.gamma, points.Fz, points.Fy, np.nan_to_num(points.Mz), points.direction]
    )
    seen: dict[bytes, int] = {}
    for k in np.unique(points.sweep):
        rows = np.flatnonzero(points.sweep == k)
        if len(rows) < FEWEST or np.ptp(points.Fy[rows]) == 0.0:
            continue
        own = readings[rows]
        key = own[np.lexsort(own.T)].tobytes()
        if key in seen:
            first = points.sweep_names[seen[key]]
            raise InputError(
                f"holds the very readings of {first}, row for row; remove one of the two, or correct the one that was copied "
                "by mistake",
                file=points.files[points.file[rows[0]]],
            )
        seen[key] = int(k)
