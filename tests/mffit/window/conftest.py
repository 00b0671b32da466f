"""A small project on a flat track with a reading left out, and its build, for all tests of the window."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from small_rigs import belt_with_one_left_out

import mffit
from mffit.results import BuildResult


@pytest.fixture(scope="session")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return belt_with_one_left_out(tmp_path_factory.mktemp("window") / "original")


@pytest.fixture(scope="session")
def result(original: Path) -> BuildResult:
    return mffit.build(original)


@pytest.fixture
def tyre_toml(original: Path, tmp_path: Path) -> Path:
    """A copy of the project that a test may change."""
    shutil.copytree(original.parent, tmp_path / "project")
    return tmp_path / "project" / "tyre.toml"
