"""The picture of a recording over time: gaps closed, lines broken there, and stretches kept and dropped."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from mffit.points.stretch import MOVE, SWEEP, StretchNote
from mffit.report.figures.recording import DROPPED, KEPT, recording


def note(kind: str, first: int, last: int, points: int, dropped: str = "") -> StretchNote:
    texts = dict.fromkeys(StretchNote._fields, 0)
    return StretchNote(
        **texts | {"kind": kind, "first_line": first, "last_line": last, "points": points, "dropped": dropped}
    )


def run_of(time: np.ndarray, first_line: int) -> SimpleNamespace:
    """A run that measured no moment."""
    ramp, none = np.linspace(0.0, 1.0, len(time)), np.full(len(time), np.nan)
    return SimpleNamespace(
        time=time, alpha=np.radians(ramp), gamma=0.0 * ramp, kappa=none, Fz=1e3 + ramp, p=2e5 + ramp, T=none,
        Fy=-ramp, Mz=none, line=first_line + np.arange(len(time)),
    )  # fmt: skip


HALF = np.arange(50) / 10.0
GAP = [run_of(np.r_[HALF, 100.0 + HALF], 2)]
"""10 s at 10 Hz, with a gap of 100 s in the middle."""
RUNS = [run_of(HALF, 2), run_of(HALF, 52)]
"""The same as two runs of one file, each of which counts its time from zero."""


@pytest.fixture(params=[GAP, RUNS], ids=["gap", "two runs"])
def sheet(request):
    notes = [note(SWEEP, 2, 32, 20), note(MOVE, 32, 42, 0), note(SWEEP, 52, 92, 0, "drifting")]
    return recording(request.param, notes)


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
    assert list(sheet.key) == ["points from 1 stretch", "none from 2 stretches"]
