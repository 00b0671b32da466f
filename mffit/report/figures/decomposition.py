"""Raw readings with their odd and even parts, and the even part beside the model's."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mffit.report import constants, labels, left_undrawn, style
from mffit.report.build_view import BuildView, ChannelRow
from mffit.report.curves import Curve
from mffit.report.drawing.records import Axis, ErrorBars, Guide, Look, Panel, Sheet, Trace, in_rows

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


def decomposition(view: BuildView, channel: ChannelRow) -> Sheet:
    """Raw, odd and even curve of every sweep; of opposite cambers only the positive one."""
    chosen = worth_drawing(view.curves, channel)
    groups = [[_parts(view, channel, c) for c in chosen if c.over == over] for over in labels.ANGLES]
    columns = 5 if max(map(len, groups)) > 4 else 4
    left_out = left_undrawn.parts(drawable(view.curves, channel), chosen)
    return Sheet(rows=in_rows(*groups, columns=columns), height=1.40, key=PARTS, left_out=left_out)


def _parts(view: BuildView, channel: ChannelRow, curve: Curve) -> Panel:
    x = curve.varied(view.points)
    values = (channel.measured, channel.odd, channel.even)
    return Panel(
        title=f"{curve.condition}{labels.held_unless_zero(curve)}",
        x=labels.angle_axis(curve.over),
        y=Axis(label=channel.label),
        series=[
            Trace(name=name, x=x, y=part[curve.index], look=look)
            for (name, look), part in zip(PARTS.items(), values, strict=True)
        ],
        guides=[Guide(axis="y", at=0.0)],
    )


def even_parts(view: BuildView) -> Sheet:
    """Even part of the pure sweeps at nominal pressure, measured and of the model, one column per load."""
    pure = pure_curves(view)
    loads = sorted({c.load for c in pure})[: constants.MOST_LOADS_SIDE_BY_SIDE]
    varied = [over for over in labels.ANGLES if any(c.over == over for c in pure)]
    rows = []
    for channel in view.channels:
        for over in varied:
            members = [[c for c in pure if c.over == over and c.load == load] for load in loads]
            low, high = _common_range(view, channel, [c for curves in members for c in curves])
            rows.append(
                [
                    Panel(
                        title=f"{channel.symbol}, {labels.LOAD.of(load)}",
                        x=labels.angle_axis(over),
                        y=Axis(label=f"even {channel.label}", low=low, high=high, ticks=4),
                        series=[series for curve in curves for series in _even(view, channel, curve)],
                        guides=[Guide(axis="y", at=0.0)],
                    )
                    for load, curves in zip(loads, members, strict=True)
                ]
            )
    return Sheet(rows=rows, height=1.25, key={"measured, ± 1 u": MEASURED, "model": MODEL})


def _even(view: BuildView, channel: ChannelRow, curve: Curve) -> list[Trace | ErrorBars]:
    line, rows = view.lines[curve.key], curve.index
    return [
        ErrorBars(
            name="measured, ± 1 u",
            x=curve.varied(view.points),
            y=channel.even[rows],
            u=channel.u_odd[rows],
            look=MEASURED,
        ),
        Trace(name="model", x=line.x, y=line.even[channel.name], look=MODEL),
    ]


def _common_range(view: BuildView, channel: ChannelRow, curves: Sequence[Curve]) -> tuple[float, float]:
    """The range of a row of panels, so that their heights can be compared."""
    shown = [series.extent()[1] for curve in curves for series in _even(view, channel, curve)]
    values = np.concatenate([*shown, [0.0]])
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = constants.AXIS_ROOM * (high - low) or 1.0
    return low - room, high + room


def pure_curves(view: BuildView) -> list[Curve]:
    """Forward sweeps over one angle with the other at zero, at the pressure nearest to the nominal one."""
    if not view.curves:
        return []
    nominal = view.config.tyre.nominal_pressure
    pressure = min((c.pressure for c in view.curves), key=lambda value: abs(value - nominal))
    return [
        c
        for c in view.curves
        if c.forward and abs(c.held) < constants.UPRIGHT_ENOUGH_TO_DRAW and c.pressure == pressure
    ]


def drawable(curves: Sequence[Curve], channel: ChannelRow) -> list[Curve]:
    """Forward curves that have mirrors."""
    return [
        c
        for c in curves
        if c.forward
        and c.held > -constants.UPRIGHT_ENOUGH_TO_DRAW
        and np.isfinite(channel.odd[c.index]).sum() > 1
    ]


def worth_drawing(curves: Sequence[Curve], channel: ChannelRow) -> list[Curve]:
    """Those of :func:`drawable` that are long, thinned out evenly where there are too many for a page."""
    chosen = drawable(curves, channel)
    long_ones = [c for c in chosen if len(c.index) >= constants.FEWEST_POINTS_OF_PARTS] or chosen
    most = constants.MOST_PANELS_OF_PARTS
    if len(long_ones) <= most:
        return long_ones
    spread = np.linspace(0, len(long_ones) - 1, most).round().astype(int)
    return [long_ones[i] for i in spread]
