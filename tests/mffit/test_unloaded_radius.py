"""A property file without UNLOADED_RADIUS: every command that looks at one takes it as an option."""

from __future__ import annotations

import json
import re

import pytest

import mffit
import tir
from mffit.cli import main

WHOLE = tir.Tyre.from_values({"FITTYP": 62.0, "FNOMIN": 1500.0, "UNLOADED_RADIUS": 0.31}).expand().text()


@pytest.fixture
def files(tmp_path):
    (tmp_path / "whole.tir").write_text(WHOLE, newline="")
    (tmp_path / "lacking.tir").write_text(re.sub(r"UNLOADED_RADIUS.*\r\n", "", WHOLE), newline="")
    return tmp_path / "whole.tir", tmp_path / "lacking.tir"


def test_the_refusal_names_the_option(files, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["check", str(files[1])])
    assert ended.value.code == 2
    assert "--unloaded-radius" in capsys.readouterr().err


def test_check_takes_it(files, capsys):
    main(["check", str(files[1]), "--unloaded-radius", "0.31"])
    assert "0 errors" in capsys.readouterr().out
    with pytest.raises(SystemExit):  # in millimetres
        main(["check", str(files[1]), "--unloaded-radius", "310"])
    assert "looks like millimetres" in capsys.readouterr().out


def test_compare_takes_it(files, capsys):
    main(["compare", *map(str, files), "--unloaded-radius", "0.31", "--json"])
    assert not json.loads(capsys.readouterr().out)["coefficients"]
    found = mffit.compare(*files, given={"UNLOADED_RADIUS": 0.31})
    assert all(gap.rms == 0.0 for gap in found.curves)
    main(["compare", *map(str, files), "--unloaded-radius", "0.4"])
    assert "Nominal conditions differ" in capsys.readouterr().out


def test_show_takes_it(files, tmp_path):
    for name, radius in (("a", "0.31"), ("b", "0.4")):
        main(
            [
                "show",
                str(files[1]),
                "--unloaded-radius",
                radius,
                "--out",
                str(tmp_path / f"{name}.html"),
                "--quiet",
            ]
        )
    page = mffit.show(files[1], given={"UNLOADED_RADIUS": 0.31}).html
    assert page in (tmp_path / "a.html").read_text()
    assert page not in (tmp_path / "b.html").read_text()
