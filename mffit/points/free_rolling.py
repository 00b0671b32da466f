"""The points at which the wheel rolls freely, for a fit that has no longitudinal slip."""

from __future__ import annotations

import numpy as np

from mffit.points.faulty import DRIVEN_RULE
from mffit.points.left_out import LeftOut
from mffit.points.loading import Reading

ONLY_FREE = "driven or braked, and only free rolling is fitted"


def free_rolling(found: Reading) -> Reading:
    """The reading without driven and braked points, which it names."""
    free = found.points.free_rolling
    if np.all(free):
        return found
    left_out, warnings = [], []
    for index in np.unique(found.points.file[~free]).tolist():
        inside = found.points.file == index
        file, lost = found.points.files[index], int(np.sum(inside & ~free))
        left_out.append(LeftOut(file=file, lines="", count=lost, by="rule", rule=DRIVEN_RULE, why=ONLY_FREE))
        warnings.append(f"{file}: {lost} of {int(np.sum(inside))} points are {ONLY_FREE}; left out")
    return found._replace(
        points=found.points.select(free),
        warnings=(*found.warnings, *warnings),
        left_out=(*found.left_out, *left_out),
    )
