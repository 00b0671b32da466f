"""What a point owes to those before it: the distance that the tyre has rolled, the radius of its path."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.points import make_points
from mffit.rig import distance_km
from mffit.rig.histories import path_radii, usual_radius


@pytest.mark.parametrize("begins", [0.0, 100.0])
def test_the_tyre_has_rolled_since_time_zero_even_if_its_first_point_comes_later(begins):
    """36 km/h are 10 m/s, then the speed rises evenly to 72 km/h: the mean of both counts."""
    t, V = begins + np.array([0.0, 50.0, 150.0]), np.array([10.0, 10.0, 20.0])
    points = make_points(0.0, 0.0, 1500.0, p=250e3, V=V, phi_t=0.0, t=t)
    before = 10.0 * begins
    assert distance_km(points) == pytest.approx((before + np.array([0.0, 500.0, 2000.0])) / 1000.0)


def test_a_clock_that_begins_below_zero_takes_nothing_off():
    t = np.array([-20.0, 0.0, 20.0])
    points = make_points(0.0, 0.0, 1500.0, p=250e3, V=10.0, phi_t=0.0, t=t)
    assert distance_km(points) == pytest.approx([0.0, 0.2, 0.4])


def test_a_straight_path_has_a_radius_that_is_a_number():
    """Formulae of a disc then give what they do on a straight path, without infinities."""
    points = make_points(0.0, 0.0, 1500.0, p=250e3, V=10.0, phi_t=np.array([0.0, 0.4, -0.5, 0.0]))
    radii = path_radii(points)
    assert radii[1:3] == pytest.approx([2.5, 2.0])
    assert np.all(np.isfinite(radii))
    assert min(radii[0], radii[3], usual_radius(points)) > 1e6
