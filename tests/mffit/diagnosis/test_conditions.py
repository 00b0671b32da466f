"""Sweeps of a file with a whole programme are cut where a held condition steps."""

from __future__ import annotations

import numpy as np

from mffit.diagnosis.conditions import by_condition
from mffit.diagnosis.where import _cut, bins
from mffit.points import make_points

SWEEP = np.radians(np.linspace(-9.0, 9.0, 31))


def programme(loads, cambers_deg, pressures, rng):
    """Sideslip sweeps at every combination, one file, with control errors of a real machine."""
    rows = [(a, g, F, p) for p in pressures for g in cambers_deg for F in loads for a in SWEEP]
    alpha, gamma_deg, Fz, p = map(np.array, zip(*rows, strict=True))
    return make_points(
        alpha,
        np.radians(gamma_deg + rng.normal(0.0, 0.02, len(rows))),
        Fz * (1.0 + rng.normal(0.0, 0.01, len(rows))),
        p=p * (1.0 + rng.normal(0.0, 0.003, len(rows))),
        V=11.0,
        phi_t=0.0,
        Fy=0.0,
    )


def test_a_file_with_a_whole_programme_is_cut_into_its_conditions():
    points = programme((500, 1100, 2200), (0.0, 1.6, 3.2), (70e3, 83e3, 97e3), np.random.default_rng(1))
    cut = by_condition(points)
    assert len(cut.sweep_names) == 27
    assert all(np.ptp(np.log(cut.Fz[cut.sweep == k])) < 0.1 for k in range(27))
    assert np.array_equal(cut.alpha, points.alpha)


def test_a_camber_sweep_stays_whole():
    gamma = np.radians(np.arange(-50.0, 51.0, 5.0))
    points = make_points(0.0, gamma, 1500.0, p=250e3, V=6.0, phi_t=-0.76, sweep_names=("camber",))
    assert by_condition(points).sweep_names == ("camber",)


def test_separate_sweeps_stay_separate():
    points = make_points(
        np.tile(SWEEP, 2),
        0.0,
        1500.0,
        p=250e3,
        V=6.0,
        phi_t=0.0,
        sweep=np.repeat([0, 1], 31),
        sweep_names=("a", "b"),
    )
    assert by_condition(points).sweep_names == ("a", "b")


def test_a_camber_that_is_swept_slowly_is_not_cut():
    """2000 samples over 100 degrees: close enough together for levels, but none of them was held."""
    gamma = np.radians(np.linspace(-50.0, 50.0, 2000))
    points = make_points(0.0, gamma, 1500.0, p=250e3, V=6.0, phi_t=-0.76, sweep_names=("camber",))
    assert by_condition(points).sweep_names == ("camber",)


def test_samples_between_two_loads_do_not_join_their_conditions():
    Fz = np.concatenate([np.full(200, 900.0), np.linspace(900.0, 1500.0, 12), np.full(200, 1500.0)])
    cut = by_condition(make_points(0.0, 0.0, Fz, p=250e3, V=6.0, phi_t=-0.76))
    assert len(cut.sweep_names) == 2


def test_bumps_are_sought_within_each_load_despite_samples_between_them():
    Fz = np.concatenate([np.full(200, 900.0), np.linspace(900.0, 1500.0, 12), np.full(200, 1500.0)])
    loads = bins(make_points(0.0, 0.0, Fz, p=250e3, V=6.0, phi_t=-0.76))["Fz_N"]
    assert len(loads) == 2
    assert sum(mask.sum() for _, mask in loads) == len(Fz)


def test_regions_follow_the_levels_despite_samples_between_them():
    values = np.concatenate([np.full(200, 900.0), np.linspace(900.0, 1500.0, 12), np.full(200, 1500.0)])
    assert len(_cut(values)) == 2
    assert len(_cut(np.linspace(900.0, 1500.0, 400))) == 6
    assert len(_cut(np.array([-1.0] * 10 + [1.0] * 30))) == 2
