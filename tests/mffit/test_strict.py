"""`mffit build --strict --no-report`: for automatic runs."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from plain_pages import without_pictures
from small_rigs import flat, simulated

from mffit.cli import main


def test_a_result_in_doubt_ends_with_3_and_no_page_is_written(tmp_path: Path, capsys):
    """Half the uncertainty of Fy is stated: the file is sound, yet its misfit is above the noise."""
    simulated(flat(loads=(900, 1400)), tmp_path / "p")
    path = tmp_path / "p" / "tyre.toml"
    column = '[columns]\nu_Fy_N = { column = "u_Fy_N", scale = 0.5 }\n\n'
    path.write_text(
        path.read_text(encoding="utf-8").replace("[[sweep]]", f"{column}[[sweep]]", 1), encoding="utf-8"
    )
    code = exit_code("build", path, "--strict", "--no-report")
    out = tmp_path / "p" / "out"
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert result["trusted"]
    assert result["in_doubt"]
    assert code == 3
    assert "--strict" in capsys.readouterr().err
    assert (out / "small.tir").is_file()
    assert not (out / "report.html").exists()
    assert not (out / "plots").exists()
    shutil.copytree(tmp_path / "p", tmp_path / "q")
    both = (path, tmp_path / "q" / "tyre.toml")
    assert exit_code("build", *both, "--no-report") == 0
    assert exit_code("build", *both, "--no-report", "--strict") == 3
    captured = capsys.readouterr()
    assert captured.out.count("(unchanged)") == 4
    assert "in doubt, and --strict asks for more: small, small: " in captured.err
    assert not (out / "report.html").exists()


def exit_code(*arguments: object) -> int:
    try:
        main([str(argument) for argument in arguments])
    except SystemExit as end:
        return end.code
    return 0


def test_a_reason_in_another_alphabet_is_said_in_every_file(tmp_path: Path, capsys):
    simulated(flat(), tmp_path / "p")
    path, out = tmp_path / "p" / "tyre.toml", tmp_path / "p" / "out"
    left = '[fit]\nexclude = [ { file = "camber_1400.csv", lines = "4", why = "Öl μ 油" } ]\n\n[[sweep]]'
    path.write_text(path.read_text(encoding="utf-8").replace("[[sweep]]", left, 1), encoding="utf-8")
    with without_pictures():
        assert exit_code("build", path) == 0
    assert "Öl μ 油" in (out / "explained.txt").read_text(encoding="utf-8")
    assert "Öl μ 油" in (out / "report.html").read_text(encoding="utf-8")
    capsys.readouterr()
    assert exit_code("build", path, "--explain") == 0
    assert "Öl μ 油" in capsys.readouterr().out
