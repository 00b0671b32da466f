"""The page of a comparison: plots and compare.html."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from mffit.comparison import Comparison, wording
from mffit.fit.plan import channels_of
from mffit.points import Points
from mffit.quantities import CHANNELS
from mffit.report import constants, page
from mffit.report.build_view import ChannelRow
from mffit.report.curves import Curve, curves
from mffit.report.drawing.records import Sheet
from mffit.report.figures import compared, fit, slip
from mffit.report.lines import CurveLine, model_lines


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlay:
    """Measured points and the file's curves, as the figure of a fit needs them."""

    points: Points
    curves: Sequence[Curve]
    lines: dict[tuple, CurveLine]

    def marked(self, channel: str) -> tuple[np.ndarray, np.ndarray]:
        """No rows: a comparison weights all readings alike."""
        return np.zeros(0, dtype=int), np.zeros(0, dtype=int)


def write_comparison(found: Comparison, folder: Path) -> None:
    """Write the pictures and ``compare.html`` of a comparison to an existing folder."""
    page.write(
        "compare.html.j2",
        folder / "compare.html",
        _figures(found),
        found=found,
        say=wording,
        channels=CHANNELS,
        most=constants.MOST_ROWS_COMPARED,
    )


def _figures(found: Comparison) -> dict[str, Callable[[], Sheet]]:
    out: dict[str, Callable[[], Sheet]] = {}
    for name in dict.fromkeys(gap.channel for gap in found.curves):
        out[f"curves_{name}"] = partial(compared.curves, found, name)
    if found.points is not None and found.simulation is not None:
        members = curves(found.points)
        measured = [name for name in channels_of(found.points) if name in found.points.measured]
        lines = model_lines(found.simulation, found.points, members, measured)
        view = Overlay(points=found.points, curves=members, lines=lines)
        for name in measured:
            if members:
                channel = ChannelRow.of_readings(name, found.points.channel(name), found.points.u(name))
                if any(curve.over != "kappa" for curve in members):
                    out[f"fit_{name}"] = partial(fit.model_against_points, view, channel)
                if slip.slip_curves(members):
                    out[f"slip_{name}"] = partial(slip.over_slip, view, channel)
    if any(row.z is not None for row in found.numbers):
        out["differences"] = partial(compared.differences, found)
    return out
