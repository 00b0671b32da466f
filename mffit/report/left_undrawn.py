"""What the pictures of a build leave out, in sentences for their captions; empty where they show everything."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mffit.points import Points
from mffit.report import constants
from mffit.report.build_view import BuildView, ChannelRow
from mffit.report.curves import Curve
from mffit.report.figures.decomposition import drawable, worth_drawing
from mffit.report.figures.fit import drawn_conditions


def of_fit(points: Points, curves: Sequence[Curve]) -> str:
    """Points and conditions that the picture of model and points does not show."""
    drawn = [c for members in drawn_conditions(curves).values() for c in members]
    lost = sorted({c.condition for c in curves if c not in drawn})
    alone = len(points) - _count(curves)
    said = []
    if alone:
        said.append(
            f"{alone} of {len(points)} points are not drawn here, because they belong to no series of "
            f"{constants.FEWEST_SET_POINTS_OF_CURVE:d} set-points over one angle; the maps of residuals have them"
        )
    if lost:
        said.append(
            f"{_count(curves) - _count(drawn)} points are left out for lack of room, at {', '.join(lost)}; points.csv has them"
        )
    return _sentences(said)


def of_parts(view: BuildView, channel: ChannelRow) -> str:
    """Sweeps without a panel of odd and even parts."""
    every, drawn = len(drawable(view.curves, channel)), len(worth_drawing(view.curves, channel))
    if every == drawn:
        return ""
    return _sentences(
        [
            f"{drawn} of {every} sweeps are drawn: the longer ones, evenly spread; points.csv has the parts of all"
        ]
    )


def _count(curves: Sequence[Curve]) -> int:
    return len(np.unique(np.concatenate([c.index for c in curves]))) if curves else 0


def _sentences(said: Sequence[str]) -> str:
    return " ".join(f"{sentence[0].upper()}{sentence[1:]}." for sentence in said)
