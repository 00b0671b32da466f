"""What other systems lack or do otherwise: each is taken away here, and the work is still done or ends with a sentence."""

from __future__ import annotations

import ast
import io
import json
import os
import sys
import types
from pathlib import Path

import pytest

import tir
from mffit.cli.console import PipeTolerant
from mffit.config.models import TyreTable
from mffit.errors import InputError
from mffit.output import output_folder, save_over
from mffit.pipeline import workers
from mffit.results import BuildOutcome
from tir.codegen.cpython import kernel

ROOT = Path(__file__).parents[2]
OF_ONE_SYSTEM = {"curses", "fcntl", "grp", "msvcrt", "pwd", "resource", "termios", "winreg"}


def test_no_module_needs_one_system_to_be_imported():
    files = [path for name in ("mffit", "tir") for path in (ROOT / name).rglob("*.py")]
    found = [
        f"{path.relative_to(ROOT)}: {alias.name}"
        for path in files
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        if isinstance(node, ast.Import | ast.ImportFrom)
        for alias in (node.names if isinstance(node, ast.Import) else [ast.alias(node.module or "")])
        if alias.name in OF_ONE_SYSTEM
    ]
    assert not found


@pytest.fixture
def bare(tmp_path, monkeypatch):
    """Windows, as far as Python shows it: neither owners nor POSIX's locks and calls of the system."""
    locked: list[int] = []
    msvcrt = types.SimpleNamespace(LK_LOCK=1, locking=lambda handle, mode, size: locked.append(mode))
    monkeypatch.setitem(sys.modules, "fcntl", None)
    monkeypatch.setitem(sys.modules, "msvcrt", msvcrt)
    monkeypatch.setattr(sys, "platform", "win32")
    for name in ("chown", "geteuid", "kill", "listxattr"):
        monkeypatch.delattr(os, name, raising=False)
    monkeypatch.setattr(
        "shutil._copyxattr", lambda *given, **more: None
    )  # shutil has decided when it was imported
    return locked


def test_files_are_written_on_a_bare_system(bare, tmp_path):
    path, out = tmp_path / "tyre.toml", tmp_path / "out"
    path.write_bytes(b"old")
    save_over(path, b"old", b"new")
    for text in ("a", "b"):
        with output_folder(out) as folder:
            (folder / "result.json").write_text(text, encoding="utf-8")
    tyre = tir.read(ROOT / "samples" / "front-120-70" / "true.tir")
    tyre.write(out / "x.tir")
    assert (path.read_bytes(), (out / "result.json").read_text(encoding="utf-8"), bare) == (
        b"new",
        "b",
        [1],
    )
    assert tir.read(out / "x.tir").values == tyre.values
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["out", "tyre.toml"]


def test_a_file_that_another_program_has_open_is_a_sentence(bare, tmp_path, monkeypatch):
    """Windows replaces no open file."""

    def refused(source: object, target: object) -> None:
        raise PermissionError(13, "in use", str(target))

    out = tmp_path / "out"
    monkeypatch.setattr(os, "replace", refused)
    with pytest.raises(InputError, match="close the program that uses it"), output_folder(out) as folder:
        (folder / "points.csv").write_text("a", encoding="utf-8")
    kernel._write(tmp_path / "one.o", b"code")  # the process goes on with what it has compiled
    assert [*(entry.name for entry in tmp_path.iterdir() if entry.name != "out"), *out.iterdir()] == []


@pytest.mark.parametrize("encoding", ["cp1252", "cp850", "ascii"])
def test_a_console_with_few_characters_prints_what_can_be_read_back(encoding):
    name = {"name": 'Reifen "ü" 轮胎 \N{WHEEL}'}
    written = io.BytesIO()
    stream = PipeTolerant(io.TextIOWrapper(written, encoding=encoding))
    stream.write(json.dumps(name, ensure_ascii=False))
    stream.flush()
    assert json.loads(written.getvalue().decode(encoding)) == name


@pytest.mark.parametrize("name", ["AUX", "nul.2", "com1", "a:b", "a/b", "a\\b"])
def test_a_name_that_no_file_of_windows_can_have_is_refused(name):
    with pytest.raises(ValueError, match="cannot name the output files"):
        TyreTable(name=name)


def answered(job: workers.Job) -> BuildOutcome:
    return BuildOutcome(job.source, job.name, job.out, "built")


def test_builds_run_where_processes_are_not_copied(tmp_path, monkeypatch):
    """On Windows and macOS every process is begun anew."""
    monkeypatch.setattr(workers, "START_METHOD", "spawn")
    (outcome,) = workers.in_processes([workers.Job(tmp_path, "a", tmp_path)], 2, answered)
    assert (outcome.name, outcome.state) == ("a", "built")
