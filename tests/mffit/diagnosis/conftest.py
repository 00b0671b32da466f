"""Small campaigns that several tests share."""

from __future__ import annotations

import pytest
from blind_scores import loaded
from blind_set import draw_case

from mffit.diagnosis import Diagnosis, diagnose


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


@pytest.fixture(scope="session")
def nothing(right_model) -> Diagnosis:
    """The diagnosis of the campaign whose model is right."""
    case, config, points = right_model
    return diagnose(points, case.given, config)


@pytest.fixture(scope="session")
def camber(stiffer_camber) -> Diagnosis:
    """The diagnosis of the campaign whose model has another camber stiffness."""
    case, config, points = stiffer_camber
    return diagnose(points, case.given, config)
