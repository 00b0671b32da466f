"""A small project on a flat track with a reading left out, and its build, for all tests of the window."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
from small_rigs import belt_with_one_left_out

import mffit
from mffit.results import BuildResult
from mffit.viewer import project_data
from mffit.window.session import Session, stated


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


@pytest.fixture(scope="session")
def data(result: BuildResult) -> dict[str, Any]:
    """What the page shows of the build."""
    return project_data(result) | {"before": None}


@pytest.fixture
def session(tyre_toml: Path, data: dict[str, Any]) -> Session:
    """An open project whose first fit has finished."""
    found = Session(tyre_toml)
    found.data, found.fits, found._fitted = dict(data), 1, stated(found.file.config())
    return found
