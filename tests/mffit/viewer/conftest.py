"""A small project on a flat track with a reading left out, built once."""

from __future__ import annotations

import pytest
from small_rigs import belt_with_one_left_out

import mffit
from mffit.results import BuildResult


@pytest.fixture(scope="session")
def result(tmp_path_factory: pytest.TempPathFactory) -> BuildResult:
    return mffit.build(belt_with_one_left_out(tmp_path_factory.mktemp("small")))
