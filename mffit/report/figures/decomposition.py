"""Raw readings with their odd and even parts, and the even part beside the model's, of the pure sweeps."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from mffit.constants import UPRIGHT
from mffit.report import labels, style
from mffit.report.build_view import BuildView, ChannelRow
from mffit.report.curves import Curve
from mffit.report.drawing.records import ZERO, Axis, Look, Panel, Sheet, Trace, in_rows, of_one_range

RAW = Look(colour=style.MUTED, line=":", marker="o", size=3.0)
ODD = Look(colour=style.ACCENT, line="-")
EVEN = Look(colour=style.CONTRAST, line="--")
MEASURED = Look(colour=style.CONTRAST, marker="o", size=3.0, width=0.8)
MODEL = Look(colour=style.INK, line="-")
PARTS = {
    "raw reading": RAW,
    "odd part: response to sideslip and camber": ODD,
    "even part: turn slip, offsets, misalignment": EVEN,
}


def parts(view: BuildView) -> Sheet:
    """Raw, odd and even curve of every channel over each angle, at the load nearest to the nominal one."""
    nominal = view.config.tyre.nominal_load
    pure = pure_curves(view)
    load = min((c.load for c in pure), key=lambda value: abs(value - nominal))
    panels = []
    for channel in view.channels:

        def series(curve: Curve, channel: ChannelRow = channel) -> list[Trace]:
            x, values = curve.varied(view.points), (channel.measured, channel.odd, channel.even)
            return [
                Trace(name=name, x=x, y=part[curve.index], look=look)
                for (name, look), part in zip(PARTS.items(), values, strict=True)
            ]

        rows = _by_load([c for c in pure if c.load == load], channel, series, channel.label)
        panels += [panel for row in rows for panel in row]
    return Sheet(rows=in_rows(panels, columns=4), height=1.6, key=PARTS)


def even_parts(view: BuildView) -> Sheet:
    """Even part of the same sweeps, measured and of the model."""
    rows: list[list[Panel]] = []
    for channel in view.channels:

        def series(curve: Curve, channel: ChannelRow = channel) -> list[Trace]:
            line, index, x = view.lines[curve], curve.index, curve.varied(view.points)
            even, u = channel.even[index], channel.u_odd[index]
            return [
                Trace(name="measured, ± 1 u", x=x, y=even, half=u, look=MEASURED),
                Trace(name="model", x=line.x, y=line.even[channel.name], look=MODEL),
            ]

        rows += map(of_one_range, _by_load(pure_curves(view), channel, series, f"even {channel.label}"))
    return Sheet(rows=rows, height=1.25, key={"measured, ± 1 u": MEASURED, "model": MODEL})


def _by_load(
    pure: Sequence[Curve], channel: ChannelRow, series: Callable[[Curve], list[Trace]], label: str
) -> list[list[Panel]]:
    """A row of panels per varied angle, a column per load."""
    rows = [
        [
            Panel(
                title=f"{channel.symbol}, {labels.LOAD.of(load)}",
                x=labels.angle_axis(over),
                y=Axis(label=label),
                series=[s for c in pure if c.over == over and c.load == load for s in series(c)],
                guides=[ZERO],
            )
            for load in sorted({c.load for c in pure if c.over == over})
        ]
        for over in labels.ANGLES
    ]
    return [row for row in rows if row]


def pure_curves(view: BuildView) -> list[Curve]:
    """Forward sweeps over one angle with the other at zero, at the pressure nearest to the nominal one."""
    nominal = view.config.tyre.nominal_pressure
    pressure = min((c.pressure for c in view.curves), key=lambda value: abs(value - nominal), default=0.0)
    pure = [c for c in view.curves if c.forward and c.over != "kappa" and abs(c.held) < UPRIGHT]
    return [c for c in pure if c.pressure == pressure]
