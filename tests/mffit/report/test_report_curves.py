"""Points are put on the curves that an engineer would draw."""

from __future__ import annotations

import numpy as np
import pytest
from report_toys import SIDESLIP, made_points, programme, sweep

from mffit.points import make_points
from mffit.report.curves import conditions, curves


@pytest.fixture(scope="module")
def points():
    return made_points(programme())


def test_every_sweep_of_a_programme_becomes_its_curves(points):
    found = {(c.sweep, c.over, c.load, c.pressure, c.held, c.forward) for c in curves(points)}
    assert found == {
        ("sideslip_900", "alpha", 900.0, 250.0, 0.0, True),
        ("sideslip_1500", "alpha", 1500.0, 250.0, 0.0, True),
        ("backward_900", "alpha", 900.0, 250.0, 0.0, False),
        ("backward_1500", "alpha", 1500.0, 250.0, 0.0, False),
        ("soft", "alpha", 900.0, 200.0, 0.0, True),
        ("coupled", "alpha", 1500.0, 250.0, -20.0, True),
        ("coupled", "alpha", 1500.0, 250.0, 20.0, True),
        ("camber_900", "gamma", 900.0, 250.0, 0.0, True),
        ("camber_1500", "gamma", 1500.0, 250.0, 0.0, True),
    }


def test_a_curve_runs_along_its_angle(points):
    for curve in curves(points):
        assert np.all(np.diff(getattr(points, curve.over)[curve.index]) > 0)


def test_no_point_is_on_two_curves(points):
    rows = np.concatenate([c.index for c in curves(points)])
    assert len(rows) == len(np.unique(rows)) == len(points)


def test_scatter_of_load_and_camber_does_not_split_a_curve():
    rng = np.random.default_rng(3)
    n = len(SIDESLIP)
    loose = sweep(SIDESLIP, 3.0 + 0.1 * rng.standard_normal(n), 1500.0)
    loose["Fz"] = 1500.0 * (1.0 + 0.01 * rng.standard_normal(n))
    (curve,) = curves(made_points({"loose": loose}))
    assert len(curve.index) == n
    assert curve.load == pytest.approx(1500.0, abs=20.0)


def test_three_set_points_are_not_a_curve():
    assert curves(made_points({"short": sweep(np.array([-1.0, 0.0, 1.0]), 0.0, 1500.0)})) == []


def test_conditions_split_all_points_by_load_and_pressure(points):
    found = conditions(points)
    assert [c.title for c in found] == ["900 N, 200 kPa", "900 N, 250 kPa", "1500 N, 250 kPa"]
    assert sorted(np.concatenate([c.index for c in found])) == list(range(len(points)))


def test_samples_between_two_loads_do_not_join_them():
    """Chains of neighbours once made a single load of some 1200 N out of both."""
    way = sweep(0.0, 0.0, 950.0)
    way = {name: np.full(8, column) for name, column in way.items()} | {"Fz": np.linspace(950.0, 1450.0, 8)}
    points = made_points({f"{Fz:.0f}": sweep(SIDESLIP, 0.0, Fz) for Fz in (900.0, 1500.0)} | {"way": way})
    assert {c.load for c in curves(points)} >= {900.0, 1500.0}


def test_a_load_that_the_rig_does_not_hold_is_one_level():
    """Rigs hold a load to a share of their range: 534 N of up to 2700 N, held to 50 N, are no two panels."""
    rng = np.random.default_rng(4)
    slip = np.tile(SIDESLIP, 6)
    small = sweep(slip, 0.0, 534.0)
    small["Fz"] = 534.0 + np.where(rng.random(len(slip)) < 0.2, 45.0, 10.0 * rng.standard_normal(len(slip)))
    points = made_points({"small": small, "large": sweep(SIDESLIP, 0.0, 2700.0)})
    assert [c.load for c in conditions(points)] == pytest.approx([535.0, 2700.0], abs=15.0)
    apart = made_points({str(load): sweep(SIDESLIP, 0.0, load) for load in (534.0, 620.0, 2700.0)})
    assert [c.load for c in conditions(apart)] == [530.0, 620.0, 2700.0]


def test_slip_sweeps_at_one_sideslip_have_one_colour():
    """Two sweeps whose rigs held 2.38 and 2.47 deg: one level, so one entry of the key; 4.8 deg is another."""
    kappa = np.tile(np.linspace(-0.15, 0.15, 31), 3)
    alpha = np.radians(np.repeat([2.38, 2.47, 4.8], 31))
    run = np.repeat([0, 1, 2], 31)
    driven = make_points(alpha, 0.0, 1500.0, p=250e3, V=10.0, phi_t=0.0, Fy=0.0, kappa=kappa, sweep=run)
    found = curves(driven.replace(sweep_names=("a", "b", "c")))
    assert [(c.over, len(c.index)) for c in found] == [("kappa", 31)] * 3
    assert sorted(c.held for c in found) == pytest.approx([2.425, 2.425, 4.8], abs=0.1)
    assert len({c.held for c in found}) == 2
