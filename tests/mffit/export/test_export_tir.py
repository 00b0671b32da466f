"""Property files for other programs, by the command."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import tir
from mffit.cli import main
from tir.targets import TARGETS

FILE = Path(__file__).parents[2] / "tir/vectors/moto_front.tir"


def test_the_file_of_another_program_is_written_with_its_warnings(tmp_path, capsys):
    tir.read(FILE).replace(USE_MODE=225).write(tmp_path / "front.tir")
    main(
        [
            "export",
            "tir",
            str(tmp_path / "front.tir"),
            "--for",
            "mfeval, mf61",
            "--out",
            str(tmp_path / "out"),
        ]
    )
    said = capsys.readouterr()
    assert "reverses camber thrust" in said.out + said.err
    made = (tmp_path / "out" / "front-mfeval.tir").read_bytes()
    assert made == tir.read(tmp_path / "front.tir").text("mfeval").encode().replace(b"\r\n", b"\n").replace(
        b"\n", b"\r\n"
    )
    assert tir.read(tmp_path / "out" / "front-mf61.tir")["FITTYP"] == 61.0
    with pytest.raises(SystemExit):
        main(["export", "tir", str(tmp_path / "front.tir"), "--for", "chrono"])
    assert "PAC2002" in capsys.readouterr().err


MEAGRE = re.sub(
    r"(?s:\[TURNSLIP.*)|(?m:^(?:QSX1[234]|MC_CONTOUR_.|BELT_MASS|QSY1|PCFX1) .*\n)",
    "",
    FILE.read_text(encoding="ascii"),
)


def without_lines(sentences: list[str]) -> set[str]:
    return {re.sub(r"^(warning: )?(line \d+: )?", "", sentence) for sentence in sentences}


@pytest.mark.parametrize("name", [name for name, target in TARGETS.items() if not target.refusal])
@pytest.mark.parametrize("text", [FILE.read_text(encoding="ascii"), MEAGRE], ids=["whole", "meagre"])
def test_what_an_export_has_mended_is_not_warned_of(tmp_path, capsys, text, name):
    """Neither by the export nor by a check of its file, which finds what the tyre has itself and what was told."""
    (tmp_path / "a.tir").write_text(text)
    main(["export", "tir", str(tmp_path / "a.tir"), "--for", name, "--out", str(tmp_path)])
    told = capsys.readouterr()
    assert not re.search(r"write it for|counts lines|lacks|is ignored|characters|expand\(\)", told.err)
    assert ("lacks got the default" in told.out) is (text is MEAGRE)
    main(["check", str(tmp_path / f"a-{name}.tir"), "--for", name, "--json"])
    found = [p["sentence"] for p in json.loads(capsys.readouterr().out)["problems"]]
    of_tyre = [p.sentence for p in tir.check(tir.read(tmp_path / "a.tir"))]
    assert without_lines(found) <= without_lines([*of_tyre, *told.err.splitlines()])


def test_defaults_stay_warned_of_where_turn_slip_is_on(tmp_path):
    tir.read(FILE).replace(USE_MODE=225).write(tmp_path / "on.tir")
    text = re.sub(r"(?s)\[TURNSLIP.*", "", (tmp_path / "on.tir").read_text())
    (tmp_path / "on.tir").write_text(text)
    main(["export", "tir", str(tmp_path / "on.tir"), "--for", "mftyre", "--out", str(tmp_path)])
    sentences = [p.sentence for p in tir.check(tir.read(tmp_path / "on-mftyre.tir"))]
    assert any("common defaults" in sentence for sentence in sentences)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--for", "mfeval", "--out", "new.tir"], r"--out names the folder: write --out \.$"),
        (["--for", ","], "names no program"),
        (["--for", "matlab"], "unknown program"),
    ],
)
def test_a_wrong_request_is_one_sentence(capsys, arguments, said):
    with pytest.raises(SystemExit) as end:
        main(["export", "tir", str(FILE), *arguments])
    assert end.value.code == 2
    assert re.search(said, capsys.readouterr().err.strip())
