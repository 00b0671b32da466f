"""The page of a comparison: plots and compare.html, and THE table of its pictures."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import numpy as np

from mffit.comparison import Comparison, CurveGap, wording
from mffit.constants import MOST_ROWS
from mffit.fit.plan import channels_of
from mffit.quantities import CHANNELS
from mffit.report import labels, page, style
from mffit.report.build_view import Overlay, channel_rows
from mffit.report.curves import curves, model_lines
from mffit.report.drawing.records import NOTHING, Axis, Bars, Look, Panel, Sheet, Trace, in_rows, listed
from mffit.report.figures import fit
from mffit.rounding import number

FIRST, SECOND = (
    Look(colour=style.ACCENT, line="-", width=1.2),
    Look(colour=style.CONTRAST, line="--", width=1.2),
)


def curves_of_both(found: Comparison, channel: str) -> Sheet:
    """Both curves with their 95 % bands over sideslip and camber, or over slip, a panel per load; nothing if all are equal."""
    gaps = sorted((gap for gap in found.curves if gap.channel == channel), key=lambda gap: gap.load)
    if not any(gap.rms for gap in gaps):
        return NOTHING
    groups = [[_panel(found, gap) for gap in gaps if gap.over == over] for over in labels.OTHER]
    banded = any(half is not None for gap in gaps for half in (gap.half_first, gap.half_second))
    return Sheet(
        rows=in_rows(*groups),
        height=1.9,
        key={found.first: FIRST, found.second: SECOND},
        remark="Shaded areas hold a reading of a further run with a probability of 95 %." if banded else "",
    )


def _panel(found: Comparison, gap: CurveGap) -> Panel:
    x = gap.x if gap.over == "kappa" else np.degrees(gap.x)
    series = [
        Trace(name=found.first, x=x, y=gap.first, half=gap.half_first, look=FIRST),
        Trace(name=found.second, x=x, y=gap.second, half=gap.half_second, look=SECOND),
    ]
    title = (
        f"{labels.LOAD.of(gap.load)}, apart by {number(gap.rms, digits=3)} {CHANNELS[gap.channel].unit} rms"
    )
    return labels.over_angle(gap.over, gap.channel, title, series)


def differences(found: Comparison) -> Sheet:
    """The largest differences of numbers over their standard uncertainties, and the curves that are farthest apart."""
    rows = [row for row in found.unequal if row.z is not None][:MOST_ROWS]
    if not rows:
        return NOTHING
    z, significant = np.array([float(row.z or 0.0) for row in rows]), found.significant
    colours = [style.CONTRAST if row in significant else style.FAINT for row in rows]
    panel = Panel(
        x=Axis(label="difference in standard uncertainties"),
        y=listed([f"{wording.quantity(found, row).word}, {wording.place(row)}" for row in rows]),
        series=[Bars(name="difference", lengths=z, colours=colours)],
    )
    height = 0.20 * len(rows) + 0.3
    apart = [gap for gap in found.curves if gap.rms]
    if not apart:
        return Sheet(rows=[[panel]], height=height)
    widest = max(apart, key=lambda gap: gap.rms / np.max(np.abs([gap.first, gap.second])))
    return Sheet(
        rows=[[panel, _panel(found, widest)]],
        height=height,
        key={found.first: FIRST, found.second: SECOND},
        remark="The curves are those that are farthest apart, for their size.",
    )


COMPARISON: Mapping[str, Callable[[Comparison], Sheet]] = {
    "differences": differences,
    **{f"curves_{name}": partial(curves_of_both, channel=name) for name in CHANNELS},
}
"""Pictures of two files."""


def write_comparison(found: Comparison, folder: Path) -> None:
    """Write the pictures and ``compare.html`` of a comparison to an existing folder."""
    drawn, overlay = dict(COMPARISON), _overlay(found)
    if overlay is not None:
        drawn |= {
            name: partial(_over_readings, overlay, sheet_of) for name, sheet_of in fit.OF_CHANNELS.items()
        }
    page.write(
        "compare.html.j2",
        folder / "compare.html",
        drawn,
        found,
        say=wording,
    )


def _over_readings(overlay: Overlay, sheet_of: Callable[[Overlay], Sheet], found: Comparison) -> Sheet:
    return sheet_of(overlay)


def _overlay(found: Comparison) -> Overlay | None:
    """The readings over the file, if there are any."""
    if found.points is None or found.simulation is None:
        return None
    points, members = found.points, curves(found.points)
    measured = [name for name in channels_of(points) if name in points.measured]
    return Overlay(
        points=points,
        curves=tuple(members),
        lines=model_lines(found.simulation, points, members, measured),
        channels=channel_rows(points, measured),
    )
