"""Points are read load by load, and what lies between two loads belongs to neither."""

from __future__ import annotations

import numpy as np
import pytest
from plain_tyre import Plain, R, settings
from uncertainties import ufloat

from mffit.measured.zeros import load_groups, zeros_by_path
from mffit.points import make_points


def points(Fz, p=250e3):
    return make_points(0.0, 0.0, Fz, p=p, V=6.0, phi_t=-0.76)


def test_samples_between_two_loads_belong_to_neither():
    way = np.linspace(1000.0, 1370.0, 6)
    groups = load_groups(points(np.concatenate([np.full(60, 900.0), way, np.full(60, 1500.0)])))
    assert [group.load for group in groups] == pytest.approx([900.0, 1500.0])
    assert [len(group.index) for group in groups] == [60, 60]


def test_groups_rise_and_index_the_points():
    Fz = np.tile([1500.0, 900.0, 2100.0], 10)
    for group, load in zip(load_groups(points(Fz)), (900.0, 1500.0, 2100.0), strict=True):
        np.testing.assert_array_equal(Fz[group.index], load)
        assert np.all(np.diff(group.index) > 0)


def test_spread_loads_are_several_groups():
    """400 points with evenly spread load used to be one load."""
    assert len(load_groups(points(np.linspace(800.0, 2200.0, 400)))) >= 3


def test_only_the_main_pressure_is_read():
    (group,) = load_groups(points(1500.0, np.repeat([200e3, 250e3], [10, 30])))
    np.testing.assert_array_equal(group.index, np.arange(10, 40))


def test_zeros_that_were_read_off_zero_are_moved_back_along_the_slope_of_their_direction():
    """Rolling backwards the slip force changes its sign, the turn-slip force does not."""
    tyre, off, ways = Plain(), np.radians(0.1), np.array([1, -1])
    Fy, _ = tyre.readings(off, 0.0, 1500.0, ways)
    both = make_points(off, 0.0, 1500.0, p=250e3, V=6.0, phi_t=tyre.side / R, Fy=Fy, direction=ways)
    (group,) = load_groups(both)
    (zero,) = zeros_by_path(both, group, ufloat(-tyre.cornering * 1500.0, 1.0), settings())
    for force in zero.readings:
        assert force.nominal_value == pytest.approx(tyre.turn_slip_force(1500.0), abs=0.1)
