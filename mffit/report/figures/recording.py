"""A recording over time: settings and forces, with the stretches that give points and those that give none."""

from collections.abc import Sequence

import numpy as np

from mffit.points.steady import gaps
from mffit.points.stretch import MOVE, StretchNote
from mffit.report import style
from mffit.report.drawing.records import Axis, Look, Panel, Sheet, Span, Trace
from mffit.sweeps import Sweep
from tir.errors import counted

KEPT = Look(colour=style.CALM, opacity=0.13)
DROPPED = Look(colour=style.CONTRAST, opacity=0.13)
LINE = Look(colour=style.INK, line="-", width=0.6)


def recording(runs: Sequence[Sweep], notes: Sequence[StretchNote]) -> Sheet:
    """One panel per channel of a file, with its runs one after the other; gaps in time are closed and the lines broken there."""

    def whole(name: str) -> np.ndarray:
        return np.concatenate([getattr(run, name) for run in runs])

    channels = {
        "sideslip [deg]": np.degrees(whole("alpha")),
        "camber [deg]": np.degrees(whole("gamma")),
        "load [N]": whole("Fz"),
        "pressure [kPa]": whole("p") / 1e3,
        "tread [degC]": whole("T"),
        "side force [N]": whole("Fy"),
        "moment [Nm]": whole("Mz"),
    }
    measured = {name: values for name, values in channels.items() if np.any(np.isfinite(values))}
    time = whole("time")
    begins = np.cumsum([len(run.time) for run in runs])[:-1]
    broken = np.union1d(gaps(time), begins)
    clock = _clock(time, broken)
    spans = _spans(whole("line"), clock, notes)
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
            f"points from {counted(sum(note.points > 0 for note in notes), 'stretch')}": KEPT,
            f"none from {counted(sum(note.points == 0 for note in notes), 'stretch')}": DROPPED,
        },
        wide=True,
    )


def _spans(line: np.ndarray, clock: np.ndarray, notes: Sequence[StretchNote]) -> list[Span]:
    """Every stretch that gives points or was dropped, over the clock without gaps."""
    found = []
    for note in notes:
        if note.kind == MOVE and not note.dropped:
            continue
        first, last = (int(np.argmax(line == one)) for one in (note.first_line, note.last_line))
        look = KEPT if note.points else DROPPED
        found.append(Span(first=float(clock[first]), last=float(clock[last]), look=look))
    return found


def _clock(time: np.ndarray, broken: np.ndarray) -> np.ndarray:
    """Time (n,) from zero with the gap before every ``broken`` sample closed to a step."""
    steps = np.diff(time)
    steps[broken - 1] = np.median(steps)
    return np.asarray(np.r_[0.0, np.cumsum(steps)])
