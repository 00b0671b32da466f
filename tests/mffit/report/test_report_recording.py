"""The picture of a recording over time: gaps closed, lines broken there, and stretches kept and dropped."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from mffit.points.stretch import MOVE, SWEEP, StretchNote
from mffit.report.figures.recording import DROPPED, KEPT, recording


def note(kind: str, begin: float, end: float, points: int, dropped: str = "") -> StretchNote:
    texts = dict.fromkeys(StretchNote._fields, 0)
    return StretchNote(
        **texts | {"kind": kind, "begin_s": begin, "end_s": end, "points": points, "dropped": dropped}
    )


@pytest.fixture
def sheet():
    """10 s at 10 Hz, with a gap of 100 s in the middle; nothing measured the moment."""
    time = np.r_[np.arange(50), 1000 + np.arange(50)] / 10.0
    ramp, none = np.linspace(0.0, 1.0, 100), np.full(100, np.nan)
    sweep = SimpleNamespace(
        time=time, alpha=np.radians(ramp), gamma=0.0 * ramp, kappa=none, Fz=1e3 + ramp, p=2e5 + ramp, T=none,
        Fy=-ramp, Mz=none,
    )  # fmt: skip
    notes = [
        note(SWEEP, 0.0, 3.0, 20),
        note(MOVE, 3.0, 4.0, 0),
        note(SWEEP, 100.0, 104.0, 0, "drifting"),
    ]
    return recording(sweep, notes)


def test_every_measured_channel_has_a_panel_of_a_readable_height(sheet):
    names = [panel.y.label for panel in sheet.panels]
    assert "side force [N]" in names
    assert "moment [Nm]" not in names
    assert 0.5 < sheet.height < 2.0  # inch


def test_a_gap_is_closed_and_breaks_the_line(sheet):
    for panel in sheet.panels:
        (line,) = panel.series
        assert np.flatnonzero(np.isnan(line.y)).tolist() == [50]
        assert np.all(np.diff(line.x) >= 0.0)
        assert line.x[-1] == pytest.approx(9.9)


def test_what_gives_points_and_what_was_dropped_is_coloured(sheet):
    spans = sheet.panels[0].spans
    assert [span.look for span in spans] == [KEPT, DROPPED]  # a mere move is not coloured
    assert [(span.first, span.last) for span in spans] == [
        (0.0, 3.0),
        (pytest.approx(5.0), pytest.approx(9.0)),
    ]
    assert list(sheet.key) == ["1 stretches give points", "2 stretches give none"]
