"""Where residuals are not random: their means over every condition, beside what a sound fit leaves."""

from __future__ import annotations

import numpy as np

from mffit.diagnosis.structure import DIRECTION, ResidualComparison, Structure
from mffit.quantities import CHANNELS, CONDITIONS
from mffit.report import style
from mffit.report.drawing.records import ZERO, Axis, Look, Panel, Sheet, Trace, in_rows

SIDES = {
    -1: ("other angle or force negative", Look(colour=style.ACCENT, marker="o", size=3.2)),
    0: ("other angle zero", Look(colour=style.MUTED, marker="s", size=3.0)),
    1: ("other angle or force positive", Look(colour=style.CONTRAST, marker="D", size=3.0)),
}


def residual_means(found: Structure) -> Sheet:
    """A panel per channel and condition over which the residuals are not random, the least likely first."""
    groups = [[_panel(c) for c in found.found if c.channel == name and c.bins] for name in CHANNELS]
    sides = sorted({b.side for c in found.found for b in c.bins})
    return Sheet(rows=in_rows(*groups, columns=4), height=1.3, key=dict(SIDES[side] for side in sides))


def _panel(comparison: ResidualComparison) -> Panel:
    over = CONDITIONS.get(comparison.over)
    ways = {-1.0: "backward", 1.0: "forward"} if comparison.over == DIRECTION else None
    series = []
    for side in sorted({b.side for b in comparison.bins}):
        x, y, u = np.array([(b.middle, b.mean, b.error) for b in comparison.bins if b.side == side]).T
        series.append(Trace(name=SIDES[side][0], x=x, y=y, half=u, look=SIDES[side][1]))
    return Panel(
        title=f"{comparison.channel} over {comparison.word}",
        x=Axis(label=over.short_axis if over else "", words=ways),
        y=Axis(label="mean residual [u]"),
        series=series,
        guides=[ZERO],
    )
