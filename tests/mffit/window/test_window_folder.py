"""A folder of recordings in the window: what is recognised, what is corrected, and the project made of it."""

from __future__ import annotations

import threading
import time
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from flat_belt import drive_recording, recording, write_mat
from inside import DISC, client_of, of_disc_beside_a_foreign_table

from mffit import config, points
from mffit.errors import InputError
from mffit.pipeline import init_from
from mffit.recordings import DiscPath, Stated
from mffit.window.app import Opened
from mffit.window.edits import add_recordings
from mffit.window.reading import ReadingProcess
from mffit.window.recordings_folder import RecordingsFolder
from mffit.window.session import Session

TYRE = {"name": "t", "unloaded_radius": 0.2992, "nominal_load": 1400, "nominal_pressure": 250}
BELT = {"type": "flat-track", "axes": "iso", "path_radius": None, "path_centre": "left"}


@pytest.fixture
def folder(original: Path, tmp_path: Path) -> Path:
    """Two recordings of the small project whose side force has a heading that nobody knows, in kN and with the other sign."""
    out = tmp_path / "recordings"
    out.mkdir()
    for name in ("sideslip_1400.csv", "camber_1400.csv"):
        table = pd.read_csv(original.parent / name, comment="#").drop(columns=["u_Fy_N"], errors="ignore")
        table["Kraft quer"] = -1e-3 * table.pop("Fy_N")
        table.to_csv(out / name, index=False)
    return out


def corrected(table: dict[str, Any], **change: Any) -> dict[str, Any]:
    """The choice of an engineer who knows the heading."""
    for group in table["groups"]:
        for row in group["columns"]:
            if row["heading"] == "Kraft quer":
                row |= {"channel": "Fy_N", "unit": "kN", "minus": True}
    return {"tyre": TYRE, "rig": BELT, "groups": table["groups"]} | change


def test_what_is_recognised_and_what_is_missing(folder):
    table = RecordingsFolder(folder).table()
    (group,) = table["groups"]
    rows = {row["heading"]: row for row in group["columns"]}
    assert rows["alpha_deg"]["channel"] == "alpha_deg"
    assert rows["alpha_deg"]["range"] == [-8.0, 8.0]  # of both files
    assert rows["Kraft quer"]["channel"] == ""
    assert "no heading is known to be Fy_N" in table["problems"][0]
    assert [file["name"] for file in group["files"]] == ["camber_1400.csv", "sideslip_1400.csv"]


def test_the_corrected_project_reads_the_true_points(folder, original):
    found = RecordingsFolder(folder)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    choice = corrected(found.table())
    checked = found.check(choice)
    assert checked["axes"] == ["iso"]
    assert {one["word"]: one["labels"] for one in checked["conditions"]}["load"] == ["1400 N"]
    path = found.make(choice)
    after = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert set(after) - set(before) == {"tyre.toml"}
    assert {name: after[name] for name in before} == before
    ours = points.read(config.load(path)).points
    theirs = points.read(config.load(original)).points
    for name in before:
        mine, true = (x.Fy[np.array(x.files)[x.file] == name] for x in (ours, theirs))
        assert len(mine) >= len(true) > 10  # the original leaves one out
        assert np.max(np.min(np.abs(true[:, None] - mine), axis=1)) < 1e-6


def untouched(found: RecordingsFolder, rig: dict[str, Any]) -> dict[str, Any]:
    """What the form sends if nothing is changed but what it cannot know."""
    table = found.table()
    tyre = table["tyre"] | {"unloaded_radius": 0.2057, "nominal_load": 1500, "side": "left"}
    return {"tyre": tyre, "rig": rig | {"axes": table["axes"][0]}, "groups": table["groups"]}


@pytest.mark.parametrize("kind", ["belt", "disc", "slip"])
def test_the_window_and_the_command_make_the_same_project(tmp_path, kind):
    """Size, width, rim, speed and pressure come from the recordings in both, and so do units, signs and remarks."""
    path = {"path_radius": None, "path_centre": "left"}
    options: dict[str, Any] = {"belt": True}
    if kind == "belt":
        write_mat(recording(pressures=(83.0, 97.0)), tmp_path / "cornering.mat")
    elif kind == "slip":
        table = drive_recording()
        table.assign(SR=-100.0 * table["SR"]).drop(columns="SL").to_csv(tmp_path / "drive.csv", index=False)
    else:
        path, options = {"path_radius": 1.3, "path_centre": "left"}, {"disc": DiscPath(1.3, "left")}
        (tmp_path / "rueck.csv").write_bytes((DISC / "zero_1400N_backward.csv").read_bytes())
        for name in ("sideslip_1400N.csv", "camber_1400N.csv", "zero_1400N_forward.csv"):
            (tmp_path / name).write_bytes((DISC / name).read_bytes())
    given = sorted(path for path in tmp_path.iterdir() if path.name != "tyre.toml")
    type_ = "rotating-disk" if kind == "disc" else "flat-track"
    found = RecordingsFolder(tmp_path)
    made = found.make(untouched(found, {"type": type_, **path}))
    new = [path for path in tmp_path.iterdir() if path not in given]
    content = {path: path.read_bytes() for path in new}
    for one in new:
        one.unlink()
    _, by_command = init_from(given, tmp_path, unloaded_radius=0.2057, nominal_load=1500.0, **options)
    assert {path: path.read_bytes() for path in by_command} == content
    in_window, written = content[made].decode(), by_command[0]
    if kind == "belt":
        assert {path.name for path in new} == {"tyre.toml", "stretches.csv", "cornering.png"}
    if kind == "belt":
        tyre = config.load(written).tyre
        assert (tyre.nominal_speed, tyre.nominal_pressure) == (11.0, pytest.approx(83.0, abs=15.0))
    if kind == "disc":
        assert 'file = "rueck.csv"\ndirection = "backward"' in in_window
    if kind == "slip":
        assert "scale = -1" in in_window


def test_the_form_has_every_field_that_a_project_is_made_of():
    script = files("mffit.viewer").joinpath("scripts", "recordings.js").read_text(encoding="utf-8")
    path = {"disc": ("path_radius", "path_centre"), "belt": ("type",)}
    names = [name for field in Stated._fields for name in path.get(field, (field,))]
    assert [name for name in names if f'"{name}"' not in script] == []


def test_a_correction_changes_its_line_alone(folder, original):
    for name in ("sideslip_1400.csv", "camber_1400.csv"):
        (folder / name).write_bytes((original.parent / name).read_bytes())
    found = RecordingsFolder(folder)
    before = found.make(untouched(found, BELT))
    text = before.read_text().splitlines()
    before.unlink()
    choice = untouched(found, BELT)
    choice["tyre"] |= {"width": 0.2, "side": "right"}
    after = found.make(choice).read_text().splitlines()
    assert sorted(set(after) - set(text)) == [
        'side = "right"',
        "width = 0.2  # m",
    ]
    assert not set(text) - set(after)


def test_the_summary_of_the_test_is_no_recording_and_leaves_its_bad_run_out(folder):
    (folder / "runs.csv").write_text("File;Quality\nsideslip_1400.csv;good\ncamber_1400;bad\n")
    found = RecordingsFolder(folder)
    table = found.table()
    assert [file["name"] for group in table["groups"] for file in group["files"]] == [
        "camber_1400.csv",
        "sideslip_1400.csv",
    ]
    assert "camber_1400.csv is left out: runs.csv, line 3: bad" in table["problems"]
    (entry,) = config.load(found.make(corrected(table))).fit.exclude
    assert (entry.file, entry.why) == ("camber_1400.csv", "runs.csv, line 3: bad")


def test_a_wrong_sign_is_seen_when_checked(folder):
    found = RecordingsFolder(folder)
    choice = corrected(found.table())
    next(row for row in choice["groups"][0]["columns"] if row["heading"] == "Kraft quer")["minus"] = False
    with pytest.raises(InputError, match="check the signs"):
        found.check(choice)


def test_backward_files_are_marked_and_speak_for_a_disc(folder, original):
    (folder / "sideslip_1400.csv").rename(folder / "zero_backward.csv")
    (folder / "camber_1400.csv").write_bytes((original.parent / "camber_1400.csv").read_bytes())
    found = RecordingsFolder(folder)
    files = [file for group in found.table()["groups"] for file in group["files"]]
    assert {file["name"]: file["backward"] for file in files} == {
        "camber_1400.csv": False,
        "zero_backward.csv": True,
    }
    disc = {"type": "rotating-disk", "axes": "iso", "path_radius": 1.3, "path_centre": "right"}
    path = found.make(corrected(found.table(), rig=disc))
    loaded = config.load(path)
    assert loaded.rig.on_disc
    assert loaded.rig.path_centre == "right"
    assert {sweep.file: sweep.direction for sweep in loaded.sweep} == {
        "camber_1400.csv": None,
        "zero_backward.csv": "backward",
    }


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"rig": {"type": "rotating-disk", "axes": "iso"}}, "path_radius"),
        ({"tyre": {"name": "t"}}, "unloaded_radius"),
        ({"groups": []}, "sweep"),
        ({"groups": None}, "incomplete"),
    ],
)
def test_an_incomplete_choice_is_refused_and_nothing_written(folder, change, sentence):
    found = RecordingsFolder(folder)
    with pytest.raises(InputError, match=sentence):
        found.make(corrected(found.table(), **change))
    assert not (folder / "tyre.toml").exists()


def test_files_elsewhere_are_not_named(folder, tmp_path):
    (tmp_path / "secret.csv").write_text("alpha_deg\n1\n", encoding="utf-8")
    found = RecordingsFolder(folder)
    choice = corrected(found.table())
    choice["groups"][0]["files"].append({"name": "../secret.csv"})
    assert "secret" not in found.make(choice).read_text(encoding="utf-8")


def test_a_link_to_a_file_elsewhere_is_not_read(folder, tmp_path):
    (tmp_path / "secret.csv").write_text("secret\n1\n", encoding="utf-8")
    (folder / "link.csv").symlink_to(tmp_path / "secret.csv")
    table = RecordingsFolder(folder).table()
    assert "link.csv: is a link to a file elsewhere" in table["unreadable"][0]
    assert "secret" not in str(table)


def test_one_file_that_is_no_recording_leaves_the_others_recognised(folder, original):
    for name in ("sideslip_1400.csv", "camber_1400.csv"):
        (folder / name).write_bytes((original.parent / name).read_bytes())
    (folder / "notes.txt").write_text("hi\n", encoding="utf-8")
    table = RecordingsFolder(folder).table()
    assert table["axes"] == ["iso"]
    assert "notes.txt" in table["unreadable"][0]


@pytest.fixture
def client(folder):
    with client_of(Opened(folder=RecordingsFolder(folder))) as found:
        yield found


def test_a_dropped_recording_is_stored_and_recognised(client, folder, original):
    content = (original.parent / "sideslip_900.csv").read_bytes()
    assert client.post(f"{client.home}store/added%20one.csv", content=content).json() == {
        "name": "added one.csv"
    }
    assert (folder / "added one.csv").read_bytes() == content
    names = [f["name"] for g in client.get(f"{client.home}recordings").json()["groups"] for f in g["files"]]
    assert sorted(names) == ["added one.csv", "camber_1400.csv", "sideslip_1400.csv"]


@pytest.mark.parametrize(
    "name",
    [
        "sideslip_1400.csv",
        "..%2Fout.csv",
        "%2e%2e%5cout.csv",
        "a%00.csv",
        ".hidden.csv",
        "tyre.toml",
        "run.sh",
        "C:a.csv",
    ],
)
def test_nothing_is_overwritten_and_nothing_else_is_stored(client, folder, name):
    before = {path: path.read_bytes() for path in folder.parent.rglob("*") if path.is_file()}
    answer = client.post(f"{client.home}store/{name}", content=b"x")
    assert answer.status_code in (404, 422)
    assert {path: path.read_bytes() for path in folder.parent.rglob("*") if path.is_file()} == before


def test_a_recording_that_is_too_large_or_from_elsewhere_is_refused(client, folder, monkeypatch):
    monkeypatch.setattr("mffit.window.app.LARGEST_UNPACKED", 10)
    assert "larger than" in client.post(f"{client.home}store/a.csv", content=b"x" * 11).json()["error"]
    for headers in ({"origin": "http://tyres.example"}, {"origin": "null"}, {"sec-fetch-site": "cross-site"}):
        assert client.post(f"{client.home}store/a.csv", content=b"x", headers=headers).status_code == 403
    assert not (folder / "a.csv").exists()


def test_a_folder_without_recordings_waits_for_them(tmp_path):
    table = RecordingsFolder(tmp_path).table()
    assert (table["groups"], table["problems"], table["axes"]) == ([], [], [])


def test_the_server_shows_the_table_and_refuses_with_sentences(folder):
    with client_of(Opened(folder=RecordingsFolder(folder))) as client:
        page = client.get(f"{client.home}").text
        assert "Make the project" in page
        assert [word for word in ("http://", "https://", " src=") if word in page] == []
        assert client.get(f"{client.home}recordings").json()["folder"] == "recordings"
        assert "incomplete" in client.post(f"{client.home}check", json={}).json()["error"]
        assert "no project is open" in client.get(f"{client.home}state").json()["error"]
        assert client.get(f"{client.home}out/report.html").status_code == 422


ENTRY = '[[sweep]]\nfile = "{}"\n'


@pytest.fixture
def growing(tyre_toml: Path) -> Path:
    """A project whose last recording is not in its tyre.toml, with a heading that nobody knows."""
    text = tyre_toml.read_text(encoding="utf-8")
    tyre_toml.write_text(text.replace(ENTRY.format("camber_900.csv"), ""), encoding="utf-8")
    other = tyre_toml.with_name("camber_900.csv")
    table = pd.read_csv(other, comment="#").drop(columns=["u_Fy_N"], errors="ignore")
    table["Kraft quer"] = -1e-3 * table.pop("Fy_N")
    table.to_csv(other, index=False)
    return tyre_toml


def as_list(path: Path) -> None:
    """The sweeps as a list of tables on their lines, as programs write them."""
    text, names = path.read_text(encoding="utf-8"), [entry.file for entry in config.load(path).sweep]
    for name in names:
        text = text.replace(ENTRY.format(name), "")
    entries = "".join(f'    {{ file = "{name}" }},  # {name}\n' for name in names)
    path.write_text(f"sweep = [  # all of them\n{entries}]\n\n{text}", encoding="utf-8")


def as_windows(path: Path) -> None:
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))


@pytest.mark.parametrize(
    "written", [None, as_list, as_windows], ids=lambda one: getattr(one, "__name__", "plain")
)
def test_a_recording_is_added_to_an_open_project(growing, original, written):
    """What the page shows is corrected first; the points are then those of the whole project, and one undo takes it back."""
    if written:
        written(growing)
    before = growing.read_bytes()
    opened = Opened(Session(growing))
    with client_of(opened) as client:
        assert "Add them to tyre.toml" in client.get(f"{client.home}add").text
        table = client.get(f"{client.home}recordings").json()
        (group,) = table["groups"]
        assert [file["name"] for file in group["files"]] == ["camber_900.csv"]
        assert "no heading is known to be Fy_N" in table["problems"][0]
        choice = {"groups": corrected(table)["groups"], "seen": table["seen"]}
        checked = client.post(f"{client.home}check", json=choice).json()
        assert (checked["axes"], checked["points"] > 5) == (["iso"], True)
        assert growing.read_bytes() == before
        assert client.post(f"{client.home}add", json=choice).status_code == 200
        ours, theirs = (points.read(config.load(path)).points for path in (growing, original))
        mine, true = (x.Fy[np.array(x.files)[x.file] == "camber_900.csv"] for x in (ours, theirs))
        np.testing.assert_allclose(np.sort(mine), np.sort(true), atol=1e-6)
        added = [line for line in growing.read_bytes().splitlines() if line not in before.splitlines()]
        assert 1 <= len(added) <= 4
        assert client.get(f"{client.home}recordings").json()["groups"] == []
        assert client.post(f"{client.home}add", json=choice).status_code == 422
        client.post(f"{client.home}undo")
    assert growing.read_bytes() == before


def test_a_bad_run_of_a_summary_is_added_and_left_out(growing):
    choice_of = RecordingsFolder(growing.parent, growing)
    (growing.parent / "runs.csv").write_text("File;Quality\nsideslip_900.csv;good\ncamber_900;bad\n")
    text = growing.read_text(encoding="utf-8")
    growing.write_text(text.replace(ENTRY.format("sideslip_900.csv"), ""), encoding="utf-8")
    added = choice_of.added(corrected(choice_of.table()))
    found = config.load(tomllib.loads(add_recordings(growing.read_text(encoding="utf-8"), **added)))
    assert {entry.file: entry.why for entry in found.fit.exclude}["camber_900.csv"] == "runs.csv, line 3: bad"
    assert "sideslip_900.csv" in {entry.file for entry in found.sweep}


def test_a_single_sweep_becomes_one_of_several():
    text = '[tyre]\nname = "a"\n\n[sweep]  # the only one\nfile = "a.csv"\n[sweep.columns]\nkappa = "SR"\n'
    found = add_recordings(text, sweeps='[[sweep]]\nfile = "b.csv"\n')
    assert [entry["file"] for entry in tomllib.loads(found)["sweep"]] == ["a.csv", "b.csv"]
    assert tomllib.loads(found)["sweep"][0]["columns"] == {"kappa": "SR"}
    assert "# the only one" in found


def test_reading_goes_on_in_a_process_that_can_be_stopped(folder, monkeypatch):
    """Here it would take a minute; the next question begins a new one."""
    reading, found = ReadingProcess(), RecordingsFolder(folder)
    try:
        assert reading.ask(found, "table") == found.table()
        with pytest.raises(InputError, match="incomplete") as caught:
            reading.ask(found, "make", {})
        assert caught.value.sentence.startswith("the choice")
        timer = threading.Timer(0.5, reading.stop)
        timer.start()
        with pytest.raises(InputError, match="was stopped"):
            reading.ask(found, "__init__", Endless())
        timer.join()
        monkeypatch.setattr("mffit.window.reading.TIME_TO_READ", 0.5)
        with pytest.raises(InputError, match="was stopped"):
            reading.ask(found, "__init__", Endless())
    finally:
        reading.stop()


class Endless:
    """Takes for ever to arrive in another process."""

    def __reduce__(self) -> Any:
        return time.sleep, (60.0,)


def test_a_foreign_table_leaves_rig_and_axes_open_until_its_tick_is_taken_away(tmp_path):
    found = of_disc_beside_a_foreign_table(tmp_path)
    table = found.table()
    assert (table["known"], table["axes"], table["disc"]) == (False, [], [])
    assert "costs.csv:1: no heading is known to be" in table["problems"][0]
    assert "take its tick away" in table["problems"][0]
    (foreign,) = [group for group in table["groups"] if group["files"][0]["name"] == "costs.csv"]
    foreign["files"][0]["used"] = False
    seen = found.recognised({"groups": table["groups"]})
    assert (seen["known"], seen["axes"][:1], seen["problems"]) == (True, ["iso"], [])
    assert any("backward" in sign for sign in seen["disc"])


def test_a_turned_moment_is_cured_by_the_box_of_its_own_heading(tmp_path):
    found = of_disc_beside_a_foreign_table(tmp_path)
    (tmp_path / "costs.csv").unlink()
    for path in tmp_path.iterdir():
        table = pd.read_csv(path, comment="#")
        table["MZ"] = -table.pop("Mz_Nm")
        table.to_csv(path, index=False)
    rig = {"type": "rotating-disk", "axes": "iso", "path_radius": 1.323, "path_centre": "left"}
    choice = {"tyre": TYRE, "rig": rig, "groups": found.table()["groups"]}
    rows = [row for group in choice["groups"] for row in group["columns"] if row["heading"] == "MZ"]
    for row in rows:
        row |= {"channel": "Mz_Nm", "unit": "N m", "minus": False}
    with pytest.raises(InputError, match='change "turn sign" of MZ') as refused:
        found.check(choice)
    assert "[sweep.columns]" not in str(refused.value)
    for row in rows:
        row["minus"] = True
    assert found.check(choice)["axes"] == ["iso"]


def test_nobody_s_choice_makes_no_belt_of_a_disc_and_is_not_called_a_choice(tmp_path, original):
    found = of_disc_beside_a_foreign_table(tmp_path)
    (tmp_path / "costs.csv").unlink()
    choice = {"tyre": TYRE, "rig": {"type": "", "axes": ""}, "groups": found.table()["groups"]}
    for question in (found.make, found.check):
        with pytest.raises(InputError, match=r"recordings of a disc \(.*\): choose disc or belt"):
            question(choice)
    (tmp_path / "belt").mkdir()
    (tmp_path / "belt" / "a.csv").write_bytes((original.parent / "sideslip_1400.csv").read_bytes())
    belt = RecordingsFolder(tmp_path / "belt")
    text = belt.make(choice | {"groups": belt.table()["groups"]}).read_text(encoding="utf-8")
    assert 'type = "flat-track"' in text
    assert 'axes = "iso"  # from the slope' in text
    assert "as chosen" not in text


def test_what_the_choice_answers_is_asked_no_more(folder):
    for path in folder.iterdir():
        table = pd.read_csv(path)
        table["u lat [N]"] = 20.0
        table["Druck"] = 250.0
        table.to_csv(path, index=False)
    found = RecordingsFolder(folder)
    table = found.table()
    choice = corrected(table)
    ((asked, *_),) = found.recognised(choice)["remarks"]
    assert "u lat" in asked
    assert "--column" not in str(table) + str(found.recognised(choice))
    assert "[columns]" not in str(table)
    next(row for row in table["groups"][0]["columns"] if "u lat" in row["heading"])["channel"] = "u_Fy_N"
    assert not any("u lat" in one for one in found.recognised(choice)["remarks"][0])
    assert "is it one of them" not in found.make(choice).read_text(encoding="utf-8")


def test_a_recording_to_add_is_shown_as_columns_of_the_project_read_it(growing):
    text = growing.read_text(encoding="utf-8")
    declared = 'Fy_N = { column = "Kraft quer", unit = "kN", scale = -1 }\ngamma_deg = 0.0\n'
    growing.write_text(f"{text}\n[columns]\n{declared}", encoding="utf-8")
    table = pd.read_csv(growing.with_name("camber_900.csv"))
    table.drop(columns="gamma_deg").to_csv(growing.with_name("camber_900.csv"), index=False)
    found = RecordingsFolder(growing.parent, growing)
    shown = found.table()
    (group,) = shown["groups"]
    (row,) = [row for row in group["columns"] if row["heading"] == "Kraft quer"]
    assert (row["channel"], row["unit"], row["minus"]) == ("Fy_N", "kN", True)
    assert (shown["known"], shown["problems"]) == (True, [])
    added = found.added({"groups": shown["groups"]})
    lines = [line for line in added["sweeps"].splitlines() if line and not line.startswith("#")]
    assert lines == ["[[sweep]]", 'file = "camber_900.csv"']
    row["channel"] = ""
    with pytest.raises(
        InputError, match=r"Fy_N may be Kraft quer.*: choose its columns below, or take its tick away"
    ):
        found.added({"groups": shown["groups"]})
    row["channel"] = "Fy_N"
    growing.write_text(growing.read_text(encoding="utf-8") + 'T_degC = "T_degC"\n', encoding="utf-8")
    next(row for row in group["columns"] if row["heading"] == "T_degC")["channel"] = ""
    with pytest.raises(
        InputError, match=r'\[columns\] of the project reads "T_degC" as T_degC in every file'
    ):
        found.added({"groups": shown["groups"]})
