"""Files that mffit did not write are never replaced or deleted; the error names the file."""

from __future__ import annotations

import errno
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from small_plan import SMALL_PLAN
from test_bad_input import run, snapshot

import mffit
from mffit import config
from mffit.cli import commands
from mffit.errors import InputError
from mffit.output import RECORD, UNKNOWN, Project, output_folder, refuse_early
from mffit.pipeline.inputs import input_hashes, read_base
from mffit.virtual_rig import load_plan, simulate

SAMPLE = Path(__file__).parents[2] / "samples" / "front-120-70"


def write(out: Path, by: str = "build", protected=(), of: Project = UNKNOWN, **contents: str) -> None:
    """A run that writes ``plots__a=...`` to plots/a."""
    with output_folder(out, by=by, of=of, protected=protected) as folder:
        for name, text in contents.items():
            path = folder / name.replace("__", "/")
            path.parent.mkdir(exist_ok=True)
            path.write_text(text)


def assert_kept(out: Path, said: str, **keys) -> None:
    """The run is refused, and the folder and its neighbours are unchanged."""
    before = snapshot(out.parent)
    with pytest.raises(InputError, match=said):
        write(out, **keys)
    assert snapshot(out.parent) == before
    assert not list(out.parent.glob(".out-*"))


def test_a_later_run_replaces_what_an_earlier_one_wrote(tmp_path):
    out = tmp_path / "out"
    write(out, a="1", plots__p="1")
    write(out, a="2", plots__p="2")
    assert (out / "a").read_text() == "2"
    assert (out / "plots" / "p").read_text() == "2"


@pytest.mark.parametrize("name", ["a", "plots/p"])
def test_a_foreign_file_is_not_replaced(tmp_path, name):
    out = tmp_path / "out"
    (out / "plots").mkdir(parents=True)
    (out / name).write_text("mine")
    assert_kept(out, f"{name}: .*no run of mffit", a="1", plots__p="1")


def test_a_file_changed_since_is_not_replaced(tmp_path):
    out = tmp_path / "out"
    write(out, a="1")
    (out / "a").write_text("edited")
    assert_kept(out, "a: .*changed since", a="2")


def test_a_file_that_the_run_reads_is_not_replaced_whoever_wrote_it(tmp_path):
    out = tmp_path / "out"
    write(out, a="1")
    assert_kept(out, "a: is an input", a="2", protected=[tmp_path / "out" / ".." / "out" / "a"])


def test_a_file_may_be_replaced_by_the_same_bytes(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "a").write_text("1")
    write(out, a="1", protected=[out / "a"])
    assert (out / "a").read_text() == "1"


def test_only_stale_pictures_are_removed(tmp_path):
    out = tmp_path / "out"
    write(out, a="1", plots__old="1", plots__edited="1", plots__kept="1")
    write(out, by="diagnose", plots__other="1")
    (out / "plots" / "edited").write_text("mine")
    (out / "plots" / "foreign").write_text("mine")
    write(out, b="1", plots__kept="2")
    assert set(snapshot(out)) == {
        RECORD, "a", "b", "plots/edited", "plots/foreign", "plots/kept", "plots/other",
    }  # fmt: skip


def project_in(tmp_path: Path, file: str, name: str = "front") -> Project:
    (tmp_path / file).parent.mkdir(exist_ok=True)
    (tmp_path / file).touch()
    return Project(name, str(tmp_path / file))


def test_a_run_replaces_all_that_an_earlier_one_of_its_project_wrote(tmp_path):
    out, of = tmp_path / "out", project_in(tmp_path, "tyre.toml")
    write(out, of=of, old="1", edited="1", read="1", drawn__a="1", kept="1")
    write(out, by="diagnose", of=of, diagnosis="1")
    write(out, by="export", code="1")
    (out / "edited").write_text("mine")
    write(out, of=of._replace(name="renamed"), protected=[out / "read"], kept="2")
    assert set(snapshot(out)) == {RECORD, "edited", "read", "kept", "diagnosis", "code"}
    assert (out / "kept").read_text() == "2"


@pytest.mark.parametrize("by", ["build", "diagnose"])
@pytest.mark.parametrize("other", [("b/tyre.toml", "front"), ("a/other.toml", "front"), ("", "rear")])
def test_the_folder_of_another_project_is_refused(tmp_path, by, other):
    out, (file, name) = tmp_path / "a" / "out", other
    write(out, of=project_in(tmp_path, "a/tyre.toml"), a="1")
    write(out, by="export", code="1")
    foreign = project_in(tmp_path, file, name) if file else Project(name)
    assert_kept(out, r"out: holds results of front \(\.\./tyre\.toml\)", by=by, of=foreign, b="1")
    with pytest.raises(InputError, match="name another folder with --out"):
        refuse_early(out, ["b"], of=foreign)


def test_a_project_that_was_renamed_or_moved_is_known_by_its_tyre(tmp_path):
    out = tmp_path / "out"
    of = project_in(tmp_path, "tyre.toml")
    write(out, of=of, a="1")
    Path(of.file).rename(tmp_path / "front.toml")
    write(out, of=project_in(tmp_path, "front.toml"), b="1")
    assert set(snapshot(out)) == {RECORD, "b"}
    write(out, of=Project("front"), c="1")
    assert set(snapshot(out)) == {RECORD, "c"}


@pytest.mark.parametrize("made", ["a/", "plots"])
def test_a_folder_and_a_file_are_not_exchanged(tmp_path, made):
    out = tmp_path / "out"
    (out / made).mkdir(parents=True) if made.endswith("/") else (out.mkdir(), (out / made).write_text("mine"))
    assert_kept(out, "move it away", a="1", plots__p="1")


def test_a_foreign_file_with_the_name_of_the_record_is_refused(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / RECORD).write_text("[]")
    assert_kept(out, "move it away", a="1")


def test_the_folder_of_a_dead_run_is_removed_and_that_of_a_live_one_stays(tmp_path):
    code = (
        "import os, sys; from pathlib import Path; from mffit.output import output_folder\n"
        "with output_folder(Path(sys.argv[1])) as folder:\n"
        "    (folder / 'half').write_text('x'); os._exit(9)\n"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "out")], check=False)
    (dead,) = tmp_path.glob(".out-*")
    living = dead.with_name(dead.name.replace(f"-{dead.name.split('-')[-2]}-", f"-{os.getpid()}-"))
    living.mkdir()
    (tmp_path / ".out-mine").mkdir()
    write(tmp_path / "out", a="1")
    assert {path.name for path in tmp_path.glob(".out-*")} == {living.name, ".out-mine"}


KILLED_WHILE_MOVING = """
import os, sys
from pathlib import Path
from mffit import output
moved = os.replace
def replace(source, target):
    moved(source, target)
    if target.name == "a":
        os._exit(9)
output.os.replace = replace
with output.output_folder(Path(sys.argv[1]), by="build") as folder:
    (folder / "plots").mkdir()
    for name in ("a", "b", "plots/p"):
        (folder / name).write_text("2")
"""


@pytest.fixture
def half_moved(tmp_path):
    """A folder with one of the three files of a later run that was killed while its files were moving."""
    out = tmp_path / "out"
    write(out, a="1", b="1", plots__old="1")
    ended = subprocess.run([sys.executable, "-c", KILLED_WHILE_MOVING, str(out)], check=False)
    assert ended.returncode == 9
    assert [(out / name).read_text() for name in ("a", "b")] == ["2", "1"]
    return out


def test_the_next_run_replaces_what_a_run_left_that_was_killed_while_moving_files(half_moved):
    write(half_moved, a="3", b="3", plots__p="3")
    assert {name: text for name, text in snapshot(half_moved).items() if name != RECORD} == {
        "a": b"3", "b": b"3", "plots/p": b"3",
    }  # fmt: skip
    assert not list(half_moved.parent.glob(".out-*"))


def test_but_not_a_file_that_was_changed_since(half_moved):
    (half_moved / "b").write_text("mine")
    with pytest.raises(InputError, match="changed since"):
        write(half_moved, a="3", b="3")
    assert [(half_moved / name).read_text() for name in ("a", "b")] == ["2", "mine"]


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EROFS])
@pytest.mark.parametrize("where", ["write", "mkdtemp", "replace"])
def test_a_full_or_read_only_disk_gives_one_sentence(tmp_path, monkeypatch, code, where):
    out = tmp_path / "out"
    write(out, a="1")

    def refused(*given, **keys):
        raise OSError(code, os.strerror(code), "a")

    if where == "mkdtemp":
        monkeypatch.setattr("mffit.output.tempfile.mkdtemp", refused)
    elif where == "replace":
        monkeypatch.setattr("mffit.output.os.replace", refused)

    def run_into_it() -> None:
        with output_folder(out, by="build") as folder:
            (folder / "a").write_text("2")
            if where == "write":
                refused()

    with pytest.raises(InputError, match=re.escape(os.strerror(code))) as told:
        run_into_it()
    assert "--out" in str(told.value)
    assert (out / "a").read_text() == "1"
    assert not list(tmp_path.glob(".out-*"))


def test_a_file_that_may_not_be_replaced_is_refused_before_the_work(tmp_path):
    (tmp_path / "a").write_text("mine")
    refuse_early(tmp_path, ["b"])
    with pytest.raises(InputError, match="no run of mffit"):
        refuse_early(tmp_path, ["a"])


def assert_command_refused(capsys, folder: Path, name: str, *arguments: object) -> None:
    before = snapshot(folder)
    code, err = run(capsys, *arguments)
    assert code == 2, err
    assert name in err
    assert err.count("\n") == 1
    assert snapshot(folder) == before


def sweep_called_points(project):
    project.tables["points.csv"] = project.tables.pop("camber_1500.csv")
    for entry in project.config["sweep"]:
        entry["file"] = entry["file"].replace("camber_1500.csv", "points.csv")
    return "points.csv"


def base_of_the_tyres_name(project):
    project.config["tyre"]["base"] = "toy.tir"
    project.folder.mkdir()
    (project.folder / "toy.tir").write_bytes((SAMPLE / "base.tir").read_bytes())
    return "toy.tir"


def report_of_somebody_else(project):
    project.folder.mkdir()
    (project.folder / "report.html").write_text("mine")
    return "report.html"


def sibling_of_somebody_else(project):
    project.folder.mkdir()
    (project.folder / "toy-normal.tir").write_text("mine")
    return "toy-normal.tir"


@pytest.mark.parametrize(
    "make",
    [sweep_called_points, base_of_the_tyres_name, report_of_somebody_else, sibling_of_somebody_else],
)
def test_build_into_the_project_does_not_replace(project, capsys, make):
    name = make(project)
    assert_command_refused(capsys, project.folder, name, "build", project.write(), "--out", project.folder)


def test_build_checks_all_its_property_files_before_the_fit(project, monkeypatch):
    sibling_of_somebody_else(project)
    monkeypatch.setattr("mffit.fit.fit", lambda *given: pytest.fail("fitted before it was refused"))
    with pytest.raises(InputError, match="toy-normal"):
        mffit.build(project.write(), project.folder)


@pytest.mark.parametrize("command", ["build", "diagnose", "plan", "spin"])
def test_no_command_mixes_two_projects_in_a_folder(project, capsys, tmp_path, command):
    path, out = project.write(), tmp_path / "out"
    write(out, of=project_in(tmp_path, "rear.toml", "rear"), **{"rear.tir": "1"})
    model = ["--model", SAMPLE / "true.tir"] if command == "diagnose" else []
    assert_command_refused(capsys, tmp_path, "holds results of rear", command, path, *model, "--out", out)


def test_diagnose_does_not_replace_its_model(project, capsys):
    path, out = project.write(), project.folder / "out"
    write(out, **{"toy.tir": (SAMPLE / "true.tir").read_text()})
    for model in (["--model", out / "toy.tir"], []):
        assert_command_refused(capsys, project.folder, "toy.tir", "diagnose", path, *model, "--out", out)


def test_spin_does_not_replace_a_foreign_file(project, capsys):
    path = project.write()
    (project.folder / "spin.json").write_text("mine")
    assert_command_refused(capsys, project.folder, "spin.json", "spin", path, "--out", project.folder)


PLAN = SMALL_PLAN.replace("[rig]", 'base = "base.tir"\n\n[rig]') + "\n[noise]\nFy_N = 6.0\n"


@pytest.fixture
def campaign(tmp_path):
    """A rig.toml in a folder of its own, with its tyres."""
    folder = tmp_path / "plan"
    folder.mkdir()
    for name in ("true.tir", "base.tir"):
        (folder / name).write_bytes((SAMPLE / name).read_bytes())
    (folder / "rig.toml").write_text(PLAN)
    return folder


@pytest.mark.parametrize("name", ["tyre.toml", "sideslip.csv", "truth.json", "base.tir"])
def test_simulate_does_not_replace_files_written_by_hand(campaign, tmp_path, capsys, name):
    out = tmp_path / "mine"
    out.mkdir()
    (out / name).write_text("mine")
    assert_command_refused(capsys, tmp_path, name, "simulate", campaign / "rig.toml", "--out", out)


def test_simulate_replaces_its_own_files_until_they_are_edited(campaign, capsys):
    command = ("simulate", campaign / "rig.toml", "--out", campaign)
    assert run(capsys, *command) == (0, "")
    before = snapshot(campaign)
    assert run(capsys, *command, "--seed", "5") == (0, "")
    after = snapshot(campaign)
    changed = {name for name in after if after[name] != before[name]}
    assert changed == {"sideslip.csv", "truth.json", RECORD}
    assert json.loads(after["truth.json"])["seed"] == 5
    (campaign / "tyre.toml").write_text((campaign / "tyre.toml").read_text() + "# mine\n")
    assert_command_refused(capsys, campaign, "tyre.toml", *command, "--seed", "6")


def test_simulate_copies_a_base_file_from_another_folder(campaign, tmp_path):
    (campaign / "tyres").mkdir()
    (campaign / "base.tir").rename(campaign / "tyres" / "base.tir")
    (campaign / "rig.toml").write_text(PLAN.replace('"base.tir"', '"tyres/base.tir"'))
    simulate(load_plan(campaign / "rig.toml"), tmp_path / "out")
    assert read_base(config.load(tmp_path / "out" / "tyre.toml")) is not None


def test_inputs_of_the_same_name_in_two_folders_both_count(project):
    for k, name in enumerate(("sideslip_1000.csv", "sideslip_1500.csv")):
        folder = project.folder / str(k)
        folder.mkdir(parents=True)
        project.tables[f"{k}/sideslip.csv"] = project.tables.pop(name)
        project.config["sweep"] = [
            entry | {"file": entry["file"].replace(name, f"{k}/sideslip.csv")}
            for entry in project.config["sweep"]
        ]
    hashes = input_hashes(config.load(project.write()))
    assert len(hashes) == len(project.tables)
    assert {"0/sideslip.csv", "1/sideslip.csv"} <= set(hashes)
    assert hashes["0/sideslip.csv"] != hashes["1/sideslip.csv"]


def test_new_files_leave_nothing_behind_where_the_disk_fills_up(tmp_path, monkeypatch):
    """The second file finds no space: neither the first nor the folder stays."""
    from mffit.output import new_files

    write = Path.write_bytes

    def until_full(path, content):
        if path.name == "b.csv":
            write(path, content[:1])
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return write(path, content)

    monkeypatch.setattr(Path, "write_bytes", until_full)
    with pytest.raises(InputError, match="No space left"):
        new_files(tmp_path / "new", {"a.csv": "a", "b.csv": "bb"})
    assert not (tmp_path / "new").exists()


def _with_out(group: click.Group, *path: str) -> Iterator[tuple[str, ...]]:
    """Every command that has --out, with the groups before it."""
    for name, command in group.commands.items():
        if isinstance(command, click.Group):
            yield from _with_out(command, *path, name)
        elif any("--out" in option.opts for option in command.params):
            yield (*path, name)


OUT_COMMANDS = list(_with_out(commands))


@pytest.mark.parametrize("command", OUT_COMMANDS, ids=" ".join)
@pytest.mark.parametrize("out", ["taken", "taken/deeper/out"])
def test_an_unusable_out_shows_before_any_work(command, out, tmp_path, capsys):
    """The inputs do not exist, which any work would notice first."""
    (tmp_path / "taken").write_text("a note")
    target = tmp_path / out
    if command in (("show",), ("convert",), ("predict",)) and out == "taken":  # they write a file
        target = tmp_path
    inputs = [tmp_path / "missing.tir"] * (2 if command in (("compare",), ("predict",)) else 1)
    code, said = run(capsys, *command, *inputs, "--out", target)
    assert code == 2
    assert re.search("is a file, but the output needs a folder|is a folder, but the output is a file", said)
    assert "missing.tir" not in said
    assert {path.name for path in tmp_path.iterdir()} == {"taken"}


@pytest.mark.skipif(
    os.name == "nt" or not Path("/proc/version").exists(), reason="needs /proc, in which nobody writes"
)
def test_a_place_where_nothing_can_be_written_shows_before_any_work(capsys):
    code, said = run(capsys, "build", "missing.toml", "--out", "/proc/out")
    assert code == 2
    assert "/proc: cannot be written to" in said
