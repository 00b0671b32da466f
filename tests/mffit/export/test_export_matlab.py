"""`mffit export matlab`: names, switches, mistakes, and the files in Octave."""

from __future__ import annotations

import hashlib
import shutil
from pathlib import Path

import pytest

import tir
from mffit.cli import main
from mffit.export import write_matlab
from tests.octave import needs_octave, run

FILE = Path(__file__).parents[2] / "tir" / "vectors" / "moto_front.tir"
pytestmark = pytest.mark.filterwarnings("ignore:turn slip is on")


@needs_octave
@pytest.mark.parametrize(("stem", "name"), [("true", "tyre_true"), ("1 front é", "tyre_1_front__")])
def test_a_file_name_may_be_a_word_of_matlab(tmp_path, stem, name):
    shutil.copyfile(FILE, tmp_path / f"{stem}.tir")
    written = write_matlab(tmp_path / f"{stem}.tir", tmp_path)
    assert [path.name for path in written] == [f"{name}.m", f"{name}_mfeval.m"]
    assert hashlib.sha256(FILE.read_bytes()).hexdigest() in written[0].read_text("ascii")
    found = run(
        tmp_path,
        f"r = {name}(1400, 0, 0.05); out = {name}_mfeval([1400 0 0.05 0 0 10]); text = get_help_text('{name}');",
    )
    assert "sideslip angle atan(Vsy/Vx) [rad]" in found["text"][0]
    right = tir.read(FILE)(1400.0, alpha=0.05, Vx=10.0).Fy
    assert found["out"][0, 1] == pytest.approx(float(right))
    assert found["r"]["Fy"].item() == pytest.approx(float(tir.read(FILE)(1400.0, alpha=0.05).Fy))


def test_the_command_writes_both_functions_where_it_is_told(tmp_path, capsys):
    main(
        [
            "export",
            "matlab",
            str(FILE),
            "--out",
            str(tmp_path),
            "--name",
            "front",
            "--no-turn-slip",
            "--limits",
        ]
    )
    text = (tmp_path / "front.m").read_text("ascii")
    assert "turn slip off" in text
    assert "inputs held to the file's ranges" in text
    assert "useMode ~= 111" in (tmp_path / "front_mfeval.m").read_text("ascii")
    assert "front_mfeval.m" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--name", "3x"], "not a valid name in MATLAB"),
        (["--name", "sqrt"], "for example tyre_sqrt"),
        (["--out", "there/front.m"], "write --out there --name front"),
        (["--transient"], "No such option"),
    ],
)
def test_bad_choices_end_in_one_sentence(tmp_path, capsys, arguments, said):
    with pytest.raises(SystemExit) as end:
        main(["export", "matlab", str(FILE), "--out", str(tmp_path), *arguments])
    assert end.value.code == 2
    assert said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
