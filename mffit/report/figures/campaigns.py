"""Which campaign of a tyre was run where."""

from __future__ import annotations

from itertools import cycle

import numpy as np

from mffit.quantities import CONDITIONS
from mffit.report import style
from mffit.report.build_view import BuildView
from mffit.report.drawing.records import Axis, Look, Panel, Sheet, Trace

LOOKS = ((style.ACCENT, "o"), (style.CONTRAST, "s"), (style.CALM, "D"), (style.INK, "v"))
"""Colour and marker of each campaign."""


def where_run(view: BuildView) -> Sheet:
    """Every point of every campaign: load over each swept condition that any of them varied."""
    of = {"this project": view.points} | {other.name: other.build.points for other in view.campaigns}
    looks = {
        name: Look(colour=colour, marker=marker, size=2.6, hollow=True)
        for name, (colour, marker) in zip(of, cycle(LOOKS), strict=False)
    }
    load = CONDITIONS["Fz_N"]
    panels = []
    for column in ("alpha_deg", "gamma_deg", "kappa"):
        if all(np.ptp(points.condition(column)) == 0.0 for points in of.values()):
            continue
        series = [
            Trace(name=name, x=points.condition(column), y=points.Fz, look=looks[name])
            for name, points in of.items()
        ]
        panels.append(
            Panel(title="", x=Axis(label=CONDITIONS[column].axis), y=Axis(label=load.axis), series=series)
        )
    return Sheet(rows=[panels], height=2.0, key=looks)
