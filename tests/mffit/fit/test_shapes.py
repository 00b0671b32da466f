"""Starting values have derivatives to start with."""

from __future__ import annotations

import numpy as np
import pytest
from small_rigs import truth

from mffit.fit.start import NONZERO_STARTS
from tir.parameters import BY_NAME


@pytest.fixture(scope="module")
def tyre():
    """A tyre without load dependence, camber effects and shifts."""
    changes = dict.fromkeys(
        ("PHY1", "PHY2", "PVY1", "PVY2", "PEY3", "QHZ1", "QHZ2", "QDZ6", "QDZ7", "QEZ3", "QEZ4"), 0.0
    )
    return truth().replace(**changes)


def test_a_start_lies_within_the_bounds():
    for name, value in NONZERO_STARTS.items():
        lower, upper = BY_NAME[name].bounds
        assert lower < value < upper


def test_the_path_of_a_disc_costs_a_little_grip_at_the_start(tyre):
    """Without any, no step would change PDYP1; with much, the fit would begin far from every tyre."""
    start = tyre.replace(**NONZERO_STARTS | {"PDYP2": 0.0, "PDYP3": 0.0, "PDYP4": 0.0})
    grip = start.state(1400.0, phi_t=np.array([0.0, -1.0 / 1.3])).zeta2
    assert 0.995 < grip[1] / grip[0] < 0.999
