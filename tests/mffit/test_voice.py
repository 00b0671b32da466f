"""Every command prints text for people, JSON for programs (--json), or nothing (--quiet)."""

from __future__ import annotations

import contextlib
import json
import shutil
import sys
import time
import types
from pathlib import Path

import click
import numpy as np
import pytest
from disc_project import disc_project
from small_plan import SMALL_PLAN

import tir
from mffit import __main__ as script
from mffit.cli import commands, main
from mffit.cli.console import progress
from mffit.constants import SHARES_OF_A_BUILD, SHARES_OF_A_DIAGNOSIS
from mffit.progress import FITTING, JUDGING, STEPS, STEPS_OF_A_DIAGNOSIS, ShownStep, remaining

SAMPLE = Path(__file__).parents[2] / "samples" / "front-120-70"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("voice")
    disc_project(folder / "rig").write()
    shutil.copyfile(SAMPLE / "true.tir", folder / "true.tir")
    (folder / "rig.toml").write_text(SMALL_PLAN)
    return folder


def said(capsys, *arguments: object) -> tuple[str, str]:
    main([str(argument) for argument in arguments])
    return capsys.readouterr()


COMMANDS = {
    "spin": lambda p: ["spin", p / "rig" / "tyre.toml"],
    "align": lambda p: ["align", p / "rig" / "tyre.toml"],
    "check": lambda p: ["check", p / "true.tir"],
    "simulate": lambda p: ["simulate", p / "rig.toml", "--out", p / "simulated"],
    "sniff": lambda p: ["sniff", p / "rig" / "sideslip_1500.csv"],
}
KEYS = {
    "spin": {"epsilon_gamma", "budget", "per_load"},
    "align": {"correction_deg", "steps"},
    "check": {"file", "problems"},
    "simulate": {"epsilon_gamma", "faults", "seed"},
    "sniff": {"recordings", "axes", "conditions", "points"},
}


@pytest.mark.parametrize("name", COMMANDS)
def test_output_is_text_or_json_or_nothing(place, capsys, name):
    arguments = COMMANDS[name](place)
    text, _ = said(capsys, *arguments)
    assert text.strip()
    document, _ = said(capsys, *arguments, "--json")
    assert KEYS[name] <= set(json.loads(document))
    assert said(capsys, *arguments, "--quiet")[0] == ""


@pytest.mark.parametrize("on_terminal", [True, False])
def test_progress_is_shown_on_a_terminal_beside_the_result(capsys, monkeypatch, on_terminal):
    """On stderr, so that it never mixes with a result that is piped on; nothing without a terminal."""
    for name in ("FORCE_COLOR", "TTY_COMPATIBLE"):
        monkeypatch.delenv(name, raising=False)
    if on_terminal:
        monkeypatch.setenv("FORCE_COLOR", "1")
    out, err, end = "", "", time.monotonic() + (600.0 if on_terminal else 0.2)
    with progress() as show:
        show("reading sweeps")
        while "reading sweeps" not in err and time.monotonic() < end:
            time.sleep(0.1)  # the spinner turns every 80 ms, later where the processor is busy
            found = capsys.readouterr()
            out, err = out + found.out, err + found.err
    assert out == ""
    assert ("reading sweeps" in err) == on_terminal


def test_the_time_left_is_that_of_the_usual_shares_and_counts_down():
    """A build whose steps take their usual shares of 100 s; no promise before the fit has shown how fast it is."""
    begins = dict(zip(STEPS, np.cumsum([0.0, *SHARES_OF_A_BUILD[:-1]]) * 100.0, strict=True))
    for step, at in begins.items():
        done, left = remaining(f"{step} and more", at)
        assert done == pytest.approx(at / 100.0)
        assert left == (pytest.approx(100.0 - at) if at > begins[FITTING] else None)
        if at:  # the share grows within a step, but not beyond its end
            assert remaining(step, at, 1.0)[0] == pytest.approx((at + 1.0) / 100.0)
            assert remaining(step, at, 200.0)[0] == pytest.approx(
                min(x for x in [*begins.values(), 100.0] if x > at) / 100.0
            )
    assert remaining(JUDGING, begins[JUDGING], writes=False)[0] == pytest.approx(0.58 / 0.67)
    assert sum(SHARES_OF_A_BUILD) == pytest.approx(1.0)
    assert remaining("trying 12 runs one by one", 30.0) == (None, None)


def test_a_step_tells_how_far_the_run_is(monkeypatch):
    now = [58.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    step = ShownStep(JUDGING, 0.0)
    assert step.text() == f"58 % done, about 42 s left: {JUDGING}"
    now[0] += 4.0
    assert step.text() == f"62 % done, about 38 s left: {JUDGING}"
    assert step.text(grain=5) == f"60 % done, about 40 s left: {JUDGING}"
    now[0] += 100.0
    assert step.text().startswith("67 % done, about 1 s left")
    assert ShownStep(JUDGING, now[0] - 58.0, writes=False).text().startswith("86 % done")
    now[0] += 100.0
    assert ShownStep(JUDGING, 0.0, writes=False).text(grain=5).startswith("85 % done")
    assert ShownStep("trying 12 runs", 0.0).text() == "trying 12 runs"
    assert sum(SHARES_OF_A_DIAGNOSIS) == pytest.approx(1.0)
    assert len(SHARES_OF_A_DIAGNOSIS) == len(STEPS_OF_A_DIAGNOSIS)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no device that is always full")
def test_a_full_disk_is_bad_input_with_its_remedy(place, capsys):
    with contextlib.suppress(OSError), open("/dev/full", "w") as full:  # closing it fails again
        with contextlib.redirect_stdout(full), pytest.raises(SystemExit) as end:
            main(["check", str(place / "true.tir")])
        assert end.value.code == 2
    assert (
        capsys.readouterr().err
        == "mffit: the disk is full (standard output); free some space and run again\n"
    )


def test_printed_and_written_json_are_the_same(place, capsys):
    document, _ = said(capsys, *COMMANDS["spin"](place), "--json")
    assert json.loads(document) == json.loads((place / "rig" / "out" / "spin.json").read_text())


def test_init_names_what_it_wrote(tmp_path, capsys):
    document, _ = said(capsys, "init", tmp_path / "new", "--json")
    written = json.loads(document)["written"]
    assert str(tmp_path / "new" / "tyre.toml") in written
    assert all(Path(path).is_file() for path in written)


def every_command(group: click.Group) -> list[click.Command]:
    """The commands of a group and of the groups below it."""
    return [
        each
        for command in group.commands.values()
        for each in (every_command(command) if isinstance(command, click.Group) else [command])
    ]


@pytest.mark.parametrize("command", every_command(commands), ids=lambda command: command.name)
def test_the_options_are_there(command):
    missing = {"json", "quiet"} - {option.name for option in command.params}
    assert not missing, f"decorate `{command.name}` with @voiced"


@pytest.mark.parametrize(
    ("file", "said"),
    [
        ("rig.toml", "so it is a rig.toml for the virtual rig: run `mffit simulate`"),
        ("true.tir", "is a property file, not a tyre.toml"),
        ("rig/sideslip_1500.csv", "mffit init --from sideslip_1500.csv DIR"),
        ("rig", "is a folder"),
    ],
)
@pytest.mark.parametrize("command", ["build", "spin", "diagnose"])
def test_a_file_of_another_kind_is_recognised(place, capsys, command, file, said):
    with pytest.raises(SystemExit) as end:
        main([command, str(place / file)])
    assert end.value.code == 2
    err = capsys.readouterr().err
    assert said in err
    assert len(err) < 400


def test_names_of_programs_may_have_blanks_and_counts_are_grammatical(tmp_path, capsys):
    sound, named = (SAMPLE / "true.tir", ("--for", "mftyre, mfeval,"))
    assert (
        said(capsys, "check", sound, *named)[0] == said(capsys, "check", sound, "--for", "mftyre,mfeval")[0]
    )
    wrong = tmp_path / "t.tir"
    tir.read(sound).replace(MASS=-1.0).write(wrong)
    with pytest.raises(SystemExit):
        main(["check", str(wrong)])
    assert "t.tir: 1 error, " in capsys.readouterr().out


def test_an_interruption_during_the_imports_ends_like_a_later_one(monkeypatch, capsys):
    class Interrupted(types.ModuleType):
        def __getattr__(self, name):
            raise KeyboardInterrupt

    monkeypatch.setitem(sys.modules, "mffit.cli", Interrupted("mffit.cli"))
    with pytest.raises(SystemExit) as ended:
        script.main()
    assert ended.value.code == 130
    assert capsys.readouterr().err == "mffit: interrupted; nothing was written\n"
