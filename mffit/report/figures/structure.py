"""Whether residuals are random: their means over every condition, beside what a sound fit leaves."""

from __future__ import annotations

import numpy as np

from mffit.diagnosis.structure import DIRECTION, Bin, ResidualComparison, Structure
from mffit.quantities import CHANNELS, CONDITIONS
from mffit.report import constants, style
from mffit.report.drawing.records import Axis, ErrorBars, Guide, Look, Panel, Sheet, in_rows

SIDES = {
    -1: Look(colour=style.ACCENT, marker="o", size=3.2),
    0: Look(colour=style.MUTED, marker="s", size=3.0),
    1: Look(colour=style.CONTRAST, marker="D", size=3.0),
}
WORDS = {
    -1: "other angle or force negative",
    0: "other angle zero",
    1: "other angle or force positive",
}
ZERO = Guide(axis="y", at=0.0, look=Look(colour=style.FAINT, line="-", width=0.8))


def residual_means(found: Structure) -> Sheet:
    """A panel per channel and condition, the least likely first; of random residuals only one row per channel."""
    columns = int(constants.PANELS_PER_ROW_OF_MEANS)
    most = None if found.found else columns
    groups = [[c for c in found.comparisons if c.channel == name and c.bins][:most] for name in CHANNELS]
    sides = sorted({b.side for group in groups for c in group for b in c.bins})
    panels = [[_panel(c, c in found.found) for c in group] for group in groups if group]
    return Sheet(
        rows=in_rows(*panels, columns=columns),
        height=1.2,
        key={WORDS[side]: SIDES[side] for side in sides},
    )


def _panel(comparison: ResidualComparison, significant: bool) -> Panel:
    over = CONDITIONS.get(comparison.over)
    ways = {-1.0: "backward", 1.0: "forward"} if comparison.over == DIRECTION else None
    title = f"{comparison.channel} over {comparison.word}"
    return Panel(
        title=title + (": not random" if significant else ""),
        x=Axis(label=over.short_axis if over else "", words=ways),
        y=Axis(label="mean residual [u]", ticks=4),
        series=[_bars([b for b in comparison.bins if b.side == side], side) for side in _sides(comparison)],
        guides=[ZERO],
    )


def _sides(comparison: ResidualComparison) -> list[int]:
    return sorted({b.side for b in comparison.bins})


def _bars(bins: list[Bin], side: int) -> ErrorBars:
    return ErrorBars(
        name=WORDS[side],
        x=np.array([b.middle for b in bins]),
        y=np.array([b.mean for b in bins]),
        u=np.array([b.error for b in bins]),
        look=SIDES[side],
    )
