"""A program of a user under ``mypy --strict``: what the tyre gives has types, and a wrong one is found."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import get_args

import pytest

from tir.parameters import TABLE
from tir.record import TextKey

ROOT = Path(__file__).parents[2]
PROGRAM = """\
import numpy as np
from numpy.typing import NDArray

import tir

tyre = tir.read("front.tir")


def side_force(alpha: float) -> float:
    return tyre(1400.0, alpha, p=2.5e5).Fy


def side_forces(alpha: NDArray[np.float64]) -> NDArray[np.float64]:
    return tyre(1400.0, alpha).Fy


def stiffness() -> float:
    return tyre.state(1400.0).K_ya * tyre["LKY"]


def stiffnesses(alpha: NDArray[np.float64]) -> NDArray[np.float64]:
    return tyre.state(1400.0, alpha, turn_slip=True).K_ya


def side() -> str:
    return tyre["TYRESIDE"]


tir.export_c(tyre, limit=True)


def wrong() -> str:
    return tyre(1400.0).Fy
"""


def test_the_parameters_that_are_text_are_those_of_the_table():
    assert {*get_args(TextKey)} == {row.name for row in TABLE if row.kind == "text"}


def test_a_strict_program_knows_the_types_of_forces_and_coefficients(tmp_path, monkeypatch):
    api = pytest.importorskip("mypy.api")
    (tmp_path / "program.py").write_text(PROGRAM)
    (tmp_path / "mypy.ini").write_text("[mypy]\nstrict = true\nfollow_imports = silent\n")
    monkeypatch.setenv("MYPYPATH", str(ROOT))
    monkeypatch.chdir(tmp_path)
    said, _, _ = api.run(["program.py", "--python-executable", sys.executable])
    errors = re.findall(r"^program\.py:(\d+): error: (.*)$", said, re.MULTILINE)
    line = len(PROGRAM.splitlines())
    assert [(int(at), text) for at, text in errors] == [
        (line - 4, 'Unexpected keyword argument "limit" for "export_c"; did you mean "limits"?  [call-arg]'),
        (line, 'Incompatible return value type (got "float", expected "str")  [return-value]'),
    ], said
