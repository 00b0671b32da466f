"""The page of a comparison: plots and compare.html."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mffit.comparison import Comparison, wording
from mffit.quantities import CHANNELS
from mffit.report import page
from mffit.report.build_view import Channel
from mffit.report.curves import Curve, curves
from mffit.report.lines import Line, model_lines

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mffit.points import Points

MOST_ROWS = 30
"""Coefficients and sweeps listed at most; all numbers stand in compare.json."""


@dataclass(frozen=True, slots=True)
class Overlay:
    """Measured points and the file's curves, as the figure of a fit wants them."""

    points: Points
    curves: Sequence[Curve]
    lines: dict[tuple, Line]

    def marked(self, channel: str) -> tuple[np.ndarray, np.ndarray]:
        """No reading is singled out here."""
        return np.zeros(0, dtype=int), np.zeros(0, dtype=int)


def write_comparison(found: Comparison, folder: Path) -> None:
    """Write the pictures and ``compare.html`` of a comparison.

    Parameters
    ----------
    found : the record
    folder : existing folder to write to
    """
    page.render(
        "compare.html.j2",
        folder / "compare.html",
        found=found,
        say=wording,
        channels=CHANNELS,
        most=MOST_ROWS,
        pictures=page.draw(folder, _figures(found)),
    )


def _figures(found: Comparison) -> dict[str, Callable[[], Figure]]:
    from mffit.report.figures import compared, fit

    out: dict[str, Callable[[], Figure]] = {}
    for name in dict.fromkeys(gap.channel for gap in found.curves):
        out[f"curves_{name}"] = partial(compared.curves, found, name)
    if found.points is not None and found.simulation is not None:
        points = found.points
        members = curves(points)
        view = Overlay(points, members, model_lines(found.simulation, points, members))
        for name in CHANNELS:
            measured = getattr(points, name)
            if members and np.isfinite(measured).any():
                none = np.full(len(points), np.nan)
                channel = Channel(name, measured, getattr(points, f"u_{name}"), none, none, none, none)
                out[f"fit_{name}"] = partial(fit.model_against_points, view, channel)
    if any(row.z is not None for row in found.numbers):
        out["differences"] = partial(compared.differences, found)
    return out
