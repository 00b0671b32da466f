"""The summary of a test beside its recordings: what it says of the runs is compared, written to the project, or refused."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from mffit import config as configuration
from mffit.errors import InputError
from mffit.pipeline import init_from
from mffit.points.loading import read
from mffit.recordings import sniff
from mffit.recordings.summary import apart

SAMPLES = Path(__file__).parents[3] / "samples" / "flat-track"
RUNS = {14: "sideslip_900N_0deg", 15: "sideslip_1400N_0deg", 16: "sideslip_1400N_10deg"}
HEAD = "Run;Tire ID;Load [lb];Camber;Pressure (psi);Quality;Comment\n"
GOOD = [
    "14;H 17;202;0;36.3;good;",
    "15;H 17;315;0;36.3;good;",
    "16;H 17;315;10;36.3;good;second try",
    "17;H 18;472;0;36.3;bad;another day",
]
"""Set-points of the samples in American units (1400 N is 315 lbf), and a run that is not there."""


@pytest.fixture
def recordings(tmp_path):
    """Three runs under the names of a test machine."""
    return [
        Path(shutil.copy(SAMPLES / f"{name}.csv", tmp_path / f"B1320run{number}.csv"))
        for number, name in RUNS.items()
    ]


def summarised(recordings: list[Path], lines: list[str], name: str = "summary.csv") -> Path:
    path = recordings[0].parent / name
    path.write_text("Round 5\n" + HEAD + "\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_a_summary_that_agrees_changes_nothing(recordings):
    alone = sniff(recordings)
    summarised(recordings, GOOD)
    assert sniff(recordings).reading.warnings == alone.reading.warnings


def test_a_bad_run_is_excluded_in_the_project_with_the_reason(recordings, tmp_path):
    summarised(recordings, [*GOOD[:2], "16;H 17;315;10;36.3;n.i.O.;belt slipped"])
    sniffed, (toml, *_) = init_from(
        recordings, tmp_path / "p", unloaded_radius=0.2992, nominal_load=1400.0, nominal_pressure=250.0
    )
    (entry,) = configuration.load(toml).fit.exclude
    assert entry.file.endswith("B1320run16.csv")
    assert entry.why == "summary.csv, line 5: n.i.O., belt slipped"
    assert any("B1320run16.csv is left out" in warning for warning in sniffed.reading.warnings)
    kept = read(configuration.load(toml))
    assert np.degrees(kept.points.gamma).max() < 1.0
    assert [one.count for one in kept.left_out if one.by == "hand"] == [_rows(recordings[2])]


def _rows(path: Path) -> int:
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if line and line[0] != "#"]
    return len(lines) - 1


def test_two_specimens_are_two_tyres(recordings, tmp_path):
    summarised(recordings, [*GOOD[:2], "16;H 19;315;10;36.3;good;"])
    with pytest.raises(InputError) as error:
        init_from(
            recordings, tmp_path / "p", unloaded_radius=0.2992, nominal_load=1400.0, nominal_pressure=250.0
        )
    two = 'are of two tyres: specimens "H 17" (summary.csv, line 3) and "H 19" (summary.csv, line 5)'
    assert two in str(error.value)
    assert not (tmp_path / "p").exists()


def test_a_summary_among_the_files_is_no_recording(recordings):
    summary = summarised(recordings, GOOD, "a list of runs.csv")
    files, found = apart([*recordings, summary])
    assert files == recordings
    assert [(row.recording.name, row.place) for row in found] == [
        ("B1320run14.csv", "a list of runs.csv, line 3"),
        ("B1320run15.csv", "a list of runs.csv, line 4"),
        ("B1320run16.csv", "a list of runs.csv, line 5"),
    ]


@pytest.mark.parametrize(
    "text",
    [
        "Run;Operator\n14;Mueller\n",
        "Run;Quality\n99;bad\n",
        "shopping list\nmilk\n",
        "\x00\x01",
        "alpha_deg;gamma_deg;Fz_N;Fy_N;run;status\n0;0;900;1;14;bad\n",
    ],
)
def test_other_files_beside_the_recordings_are_ignored(recordings, text):
    (recordings[0].parent / "other.csv").write_text(text, encoding="latin-1")
    assert apart(recordings) == (recordings, ())


def test_a_workbook_with_runs_by_file_name(recordings):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in (["Datei", "Radlast", "gültig"], ["B1320run14", 900, "ja"], ["B1320run15.csv", 1400, "nein"]):
        book.active.append(row)
    book.save(recordings[0].parent / "Protokoll.xlsx")
    (bad,) = sniff(recordings).bad_runs
    assert (bad.recording.name, bad.why) == ("B1320run15.csv", "Protokoll.xlsx, line 3: not valid (nein)")
