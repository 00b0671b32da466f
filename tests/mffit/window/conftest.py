"""A small project on a flat track with a reading left out, and its build, for all tests of the window."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from small_rigs import flat, simulated

import mffit
from mffit.results import BuildResult

LEFT_OUT = (
    '\n[fit]\nexclude = [ { file = "sideslip_1400.csv", lines = "4", why = "belt tracking" } ]  # by Anna\n'
)


@pytest.fixture(scope="session")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("window") / "original"
    simulated(flat(loads=(900, 1400)), folder)
    path = folder / "tyre.toml"
    path.write_text(path.read_text(encoding="utf-8") + LEFT_OUT, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def result(original: Path) -> BuildResult:
    return mffit.build(original)


@pytest.fixture
def tyre_toml(original: Path, tmp_path: Path) -> Path:
    """A copy of the project that a test may change."""
    shutil.copytree(original.parent, tmp_path / "project")
    return tmp_path / "project" / "tyre.toml"
