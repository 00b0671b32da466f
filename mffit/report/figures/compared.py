"""The curves of two files over each other, and the differences of their numbers in units of the uncertainty."""

from __future__ import annotations

import numpy as np

from mffit.comparison import Comparison, CurveGap, wording
from mffit.constants import COVERAGE_FACTOR_95
from mffit.quantities import CHANNELS
from mffit.report import constants, labels, style
from mffit.report.drawing.records import ZERO, Axis, Bars, Guide, Look, Panel, Sheet, Trace, in_rows, listed

FIRST, SECOND = (
    Look(colour=style.ACCENT, line="-", width=1.2),
    Look(colour=style.CONTRAST, line="--", width=1.2),
)


def curves(found: Comparison, channel: str) -> Sheet:
    """Both curves with their 95 % bands over sideslip and camber, or over slip, a panel per load."""
    gaps = sorted((gap for gap in found.curves if gap.channel == channel), key=lambda gap: gap.load)
    groups = [[_panel(found, gap) for gap in gaps if gap.over == over] for over in (*labels.ANGLES, "kappa")]
    rows = in_rows(*groups)
    return Sheet(rows=rows, height=1.9, key={found.first: FIRST, found.second: SECOND})


def _panel(found: Comparison, gap: CurveGap) -> Panel:
    x = gap.x if gap.over == "kappa" else np.degrees(gap.x)
    known = CHANNELS[gap.channel]
    return Panel(
        title=f"{labels.LOAD.of(gap.load)}, apart by {gap.rms:.3g} {known.unit} rms",
        x=labels.angle_axis(gap.over),
        y=Axis(label=known.short_axis),
        series=[
            Trace(name=found.first, x=x, y=gap.first, half=gap.half_first, look=FIRST),
            Trace(name=found.second, x=x, y=gap.second, half=gap.half_second, look=SECOND),
        ],
        guides=[ZERO],
    )


def differences(found: Comparison) -> Sheet:
    """The largest differences of numbers over their standard uncertainties."""
    rows = [row for row in found.numbers if row.z is not None][: constants.MOST_ROWS]
    z = np.array([float(row.z or 0.0) for row in rows])
    edge = Look(colour=style.MUTED, line="--", width=0.8)
    bars = Bars(
        name="difference",
        lengths=z,
        places=np.arange(len(rows)),
        colours=[style.CONTRAST if abs(value) > COVERAGE_FACTOR_95 else style.FAINT for value in z],
    )
    panel = Panel(
        x=Axis(label=f"{found.second} less {found.first}, in standard uncertainties"),
        y=listed([f"{wording.quantity(row).word}, {wording.place(row)}" for row in rows]),
        series=[bars],
        guides=[Guide(axis="x", at=side * COVERAGE_FACTOR_95, look=edge) for side in (-1.0, 1.0)],
    )
    return Sheet(rows=[[panel]], wide=True, height=0.20 * len(rows) + 0.3)
