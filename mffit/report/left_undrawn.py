"""What the pictures leave out, in sentences for their captions; empty where they show everything."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mffit.report import constants
from mffit.report.curves import Curve


def panels(count: int) -> str:
    """Panels for which there is no room."""
    if not count:
        return ""
    return "1 more panel is not drawn." if count == 1 else f"{count} more panels are not drawn."


def points(total: int, curves: Sequence[Curve], drawn: Sequence[Curve]) -> str:
    """Points outside every one of ``curves``, and conditions of curves that are not ``drawn``."""
    alone = total - _count(curves)
    said = []
    if alone:
        said.append(
            f"{alone} of {total} points are not drawn here, because they belong to no series of "
            f"{constants.FEWEST_SET_POINTS_OF_CURVE:d} set-points over one angle."
        )
    lost = sorted({c.condition for c in curves if c not in drawn})
    if lost:
        said.append(
            f"{_count(curves) - _count(drawn)} points are left out for lack of room, at {', '.join(lost)}."
        )
    return " ".join(said)


def parts(every: Sequence[Curve], drawn: Sequence[Curve]) -> str:
    """Sweeps without a panel of odd and even parts."""
    if len(every) == len(drawn):
        return ""
    return f"{len(drawn)} of {len(every)} sweeps are drawn: the longer ones, evenly spread."


def _count(curves: Sequence[Curve]) -> int:
    """Number of points on some curves."""
    return int(np.sum(np.bincount(np.concatenate([c.index for c in curves])) > 0)) if curves else 0


def long_series(most: int) -> str:
    """That at most so many points of a series are drawn."""
    return f"Of longer series at most {most} points, evenly spaced, are drawn."
