"""The tyre on a straight path over sideslip: the best estimate with its bands, and the file for turn slip off."""

import math

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95
from mffit.quantities import CHANNELS
from mffit.report import labels, style
from mffit.report.build_view import BuildView
from mffit.report.drawing.records import NOTHING, ZERO, Look, Panel, Sheet, Trace

COLOURS = {"upright": style.ACCENT, "leaned": style.CALM}
OFF = Look(colour=style.CONTRAST, line="--", width=1.2)


def road(view: BuildView) -> Sheet:
    """A panel per channel, at nominal load and pressure, upright and leaned."""
    found = view.build.road
    if found is None:
        return NOTHING
    names = {
        posture: posture if posture == "upright" else labels.angle("gamma", math.degrees(curve.camber))
        for posture, curve in found.curves.items()
    }
    panels = []
    for channel in found.upright.best:
        series = []
        for posture, curve in found.curves.items():
            x, best = np.degrees(curve.sideslip), curve.best[channel]
            look = Look(colour=COLOURS[posture], line="-", width=1.4)
            half = COVERAGE_FACTOR_95 * curve.u[channel]
            series.append(Trace(name=names[posture], x=x, y=best, half=half, look=look))
            if channel in curve.off:
                off = f"{view.normal_file}, {names[posture]}"
                series.append(Trace(name=off, x=x, y=best + curve.off[channel], look=OFF))
        title = f"{CHANNELS[channel].short_axis}, {labels.LOAD.of(found.load)}"
        panels.append(Panel(title=title, x=labels.angle_axis("alpha"), series=series, guides=[ZERO]))
    key = {names[posture]: Look(colour=COLOURS[posture], line="-") for posture in found.curves}
    if found.missed:
        key[view.normal_file] = OFF
    return Sheet(rows=[panels], height=2.5, key=key, wide=True)
