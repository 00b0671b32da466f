"""Small campaigns that several tests share."""

from __future__ import annotations

import pytest
from blind_scores import loaded
from blind_set import draw_case


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
