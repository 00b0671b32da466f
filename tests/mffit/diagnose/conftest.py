"""Small campaigns that several tests look at."""

from __future__ import annotations

from pathlib import Path

import pytest
from blind_set import Case, draw_case, write_case

import mffit.points
from mffit import config
from mffit.points import Points


def loaded(case: Case, folder: Path) -> tuple[config.Config, Points]:
    """Configuration and points of a case, through its files."""
    write_case(case, folder / case.name, folder / f"{case.name}.json")
    settings = config.load(folder / case.name / "tyre.toml")
    return settings, mffit.points.load(settings)[0]


@pytest.fixture(scope="session")
def right_model(tmp_path_factory):
    """A campaign whose model is right: case, configuration, points."""
    case = draw_case("right", (), "large", 11)
    return case, *loaded(case, tmp_path_factory.mktemp("right"))


@pytest.fixture(scope="session")
def stiffer_camber(tmp_path_factory):
    """A campaign whose model has another camber stiffness: case, configuration, points."""
    case = draw_case("stiffer", ("camber-stiffness",), "large", 12)
    return case, *loaded(case, tmp_path_factory.mktemp("stiffer"))
