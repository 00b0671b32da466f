"""A small project on a flat track with a reading left out, built once."""

from __future__ import annotations

import pytest
from small_rigs import flat, simulated

import mffit
from mffit.results import BuildResult


@pytest.fixture(scope="session")
def result(tmp_path_factory: pytest.TempPathFactory) -> BuildResult:
    path = tmp_path_factory.mktemp("small") / "tyre.toml"
    simulated(flat(loads=(900, 1400)), path.parent)
    out = '\n[fit]\nexclude = [ { file = "sideslip_1400.csv", lines = "4", why = "belt tracking" } ]\n'
    path.write_text(path.read_text(encoding="utf-8") + out, encoding="utf-8")
    return mffit.build(path)
