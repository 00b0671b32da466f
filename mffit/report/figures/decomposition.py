"""Raw readings with their odd and even parts, and the even part with the model's, of the pure sweeps."""

from collections.abc import Sequence

import numpy as np

from mffit.constants import UPRIGHT
from mffit.report import labels, style
from mffit.report.build_view import BuildView, ChannelRow
from mffit.report.curves import Curve
from mffit.report.drawing.records import NOTHING, Look, Panel, Sheet, Trace, of_one_range

RAW = "raw reading"
ODD = "odd part: response to sideslip and camber"
EVEN = "even part: turn slip, offsets, misalignment"
MODEL = "even part of the model"
LOOKS = {
    RAW: Look(colour=style.MUTED, line=":", marker="o", size=3.0),
    ODD: Look(colour=style.ACCENT, line="-"),
    EVEN: Look(colour=style.CONTRAST, marker="o", size=3.0, width=0.8),
    MODEL: Look(colour=style.INK, line="-"),
}


def parts(view: BuildView) -> Sheet:
    """A row per channel and angle: raw, odd and even part at nominal load, then even parts at every load."""
    pure = pure_curves(view)
    if not view.on_disc or not pure:
        return NOTHING
    rows = []
    for channel in view.channels:
        for over in labels.ANGLES:
            curves = [c for c in pure if c.over == over]
            if curves:
                rows.append(_row(view, channel, curves))
    return Sheet(rows=rows, height=1.3, key=LOOKS)


def _row(view: BuildView, channel: ChannelRow, curves: Sequence[Curve]) -> list[Panel]:
    symbol = channel.known.mathtext

    def panel(load: float, label: str, names: Sequence[str]) -> Panel:
        series = [_trace(view, channel, c, name) for c in curves if c.load == load for name in names]
        title = f"{label}, {labels.LOAD.of(load)}"
        return labels.over_angle(curves[0].over, channel.name, title, series)

    even = [panel(load, f"{symbol}, even", (EVEN, MODEL)) for load in sorted({c.load for c in curves})]
    nearest = min(c.load for c in view.nearest(curves, "load"))
    return [panel(nearest, symbol, (RAW, ODD, EVEN)), *of_one_range(even)]


def _trace(view: BuildView, channel: ChannelRow, curve: Curve, name: str) -> Trace:
    if name == MODEL:
        line = view.lines[curve]
        return Trace(name=name, x=line.x, y=line.even[channel.name], look=LOOKS[name])

    def part(of: str) -> np.ndarray:
        unknown = np.full(len(view.points), np.nan)
        return np.asarray(getattr(view.build.parts, of.format(channel.name), unknown)[curve.index])

    values = channel.measured[curve.index] if name == RAW else part("{}_odd" if name == ODD else "{}_even")
    half = part("u_{}_odd") if name == EVEN else None
    return Trace(name=name, x=curve.varied(view.points), y=values, half=half, look=LOOKS[name])


def pure_curves(view: BuildView) -> list[Curve]:
    """Forward sweeps over one angle with the other at zero, at the pressure nearest to the nominal one."""
    free = view.nearest((c for c in view.curves if c.over != "kappa"), "pressure")
    return [c for c in free if c.forward and abs(c.held) < UPRIGHT]
