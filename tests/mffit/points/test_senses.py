"""Senses in which a sweep goes through its angles."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.points import make_points
from mffit.points.clock import goes_both_ways, sense


def test_a_sense_belongs_to_the_points_of_its_own_sweep():
    """Up, down and a single point, of which the next one is far away; the last sweep hardly moves."""
    degrees = [-4.0, 0.0, 4.0, 3.0, 1.0, -2.0, 9.0, 2.0, 2.01, 2.0]
    sweep = [0, 0, 0, 1, 1, 1, 2, 3, 3, 3]
    points = make_points(
        np.radians(degrees), 0.0, 1500.0, p=2e5, V=6.0, phi_t=0.0, sweep=sweep, sweep_names=[*"abcd"]
    )
    assert sense(points).tolist() == [1, 1, 1, -1, -1, -1, 0, 0, 0, 0]


@pytest.mark.parametrize(("down", "both"), [(0, False), (20, False), (30, True), (70, True), (80, False)])
def test_a_sweep_goes_both_ways_if_a_quarter_of_it_goes_either_way(down, both):
    assert goes_both_ways(np.repeat([1.0, -1.0], [100 - down, down])) is both
