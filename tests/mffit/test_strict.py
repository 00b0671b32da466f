"""`mffit build --strict --no-report`: for automatic runs."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from small_rigs import flat, simulated

from mffit.cli import main


def test_a_result_in_doubt_ends_with_3_and_no_page_is_written(tmp_path: Path, capsys):
    """The stated uncertainty of Fy is too small by 0.58: the file is sound, yet its misfit is above the noise."""
    simulated(flat(loads=(900, 1400)), tmp_path / "p")
    path = tmp_path / "p" / "tyre.toml"
    column = '[columns]\nu_Fy_N = { column = "u_Fy_N", scale = 0.58 }\n\n'
    path.write_text(
        path.read_text(encoding="utf-8").replace("[[sweep]]", f"{column}[[sweep]]", 1), encoding="utf-8"
    )
    try:
        main(["build", str(path), "--strict", "--no-report"])
        code = 0
    except SystemExit as end:
        code = end.code
    out = tmp_path / "p" / "out"
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert result["trusted"]
    assert code == 3
    assert "--strict" in capsys.readouterr().err
    assert (out / "small.tir").is_file()
    assert not (out / "report.html").exists()
    assert not (out / "plots").exists()


def test_several_tyres_are_refused(capsys):
    for option in ("--strict", "--no-report"):
        with pytest.raises(SystemExit) as end:
            main(["build", "a.toml", "b.toml", option])
        assert end.value.code == 2
        assert "one TYRE_TOML" in capsys.readouterr().err
