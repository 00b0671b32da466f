"""A recording over time: settings and forces, with the stretches that give points and those that give none."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mffit.points.steady import gaps
from mffit.points.stretch import MOVE, StretchNote
from mffit.report import style
from mffit.report.drawing.records import Axis, Look, Panel, Sheet, Span, Trace
from mffit.sweeps import Sweep

KEPT = Look(colour=style.CALM, opacity=0.13)
DROPPED = Look(colour=style.CONTRAST, opacity=0.13)
LINE = Look(colour=style.INK, line="-", width=0.6)


def recording(sweep: Sweep, notes: Sequence[StretchNote]) -> Sheet:
    """One panel per channel; gaps in time are closed and the lines broken there."""
    channels = {
        "sideslip [deg]": np.degrees(sweep.alpha),
        "camber [deg]": np.degrees(sweep.gamma),
        "load [N]": sweep.Fz,
        "pressure [kPa]": sweep.p / 1e3,
        "tread [degC]": sweep.T,
        "side force [N]": sweep.Fy,
        "moment [Nm]": sweep.Mz,
    }
    measured = {name: values for name, values in channels.items() if np.any(np.isfinite(values))}
    clock = _clock(sweep.time)
    spans = _spans(sweep.time, clock, notes)
    broken = gaps(sweep.time)
    x = np.insert(clock, broken, clock[broken])
    panels = [
        Panel(
            x=Axis(label="time, gaps closed [s]"),
            y=Axis(label=name),
            series=[Trace(name=name, x=x, y=np.insert(values.astype(float), broken, np.nan), look=LINE)],
            spans=spans,
        )
        for name, values in measured.items()
    ]
    return Sheet(
        rows=[[panel] for panel in panels],
        height=0.85,
        key={
            f"{sum(note.points > 0 for note in notes)} stretches give points": KEPT,
            f"{sum(note.points == 0 for note in notes)} stretches give none": DROPPED,
        },
        wide=True,
    )


def _spans(time: np.ndarray, clock: np.ndarray, notes: Sequence[StretchNote]) -> list[Span]:
    """Every stretch that gives points or was dropped, over the clock without gaps."""
    found = []
    for note in notes:
        if note.kind == MOVE and not note.dropped:
            continue
        first, last = np.searchsorted(time, [note.begin_s, note.end_s])
        end = clock[min(last, len(clock) - 1)]
        found.append(Span(first=float(clock[first]), last=float(end), look=KEPT if note.points else DROPPED))
    return found


def _clock(time: np.ndarray) -> np.ndarray:
    """Time (n,) from zero with every gap closed to a step."""
    steps = np.diff(time)
    steps[gaps(time) - 1] = np.median(steps)
    closed: np.ndarray = np.r_[0.0, np.cumsum(steps)]
    return closed
