"""Property files for other programs, by the command."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import tir
from mffit.cli import main

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
