"""Points that share a mistake, if there is one."""

from __future__ import annotations

import numpy as np

from mffit.fit.coverage import design
from mffit.points import make_points
from mffit.suspicion.groups import groups, parts_of_sweeps


def test_files_are_sweeps_and_a_file_of_everything_is_split_into_conditions():
    alpha = np.tile(np.radians(np.linspace(-8, 8, 11)), 6)
    Fz = np.repeat([1000.0, 1500.0, 2000.0], 22)
    gamma = np.radians(np.tile(np.repeat([0.0, 10.0], 11), 3))
    common = {"p": 250e3, "V": 6.0, "phi_t": 0.0, "Fy": 1.0, "Mz": 1.0}
    one = make_points(alpha, gamma, Fz, **common, sweep_names=("all",), files=("all.csv",))
    assert [len(g.index) for g in groups(one)] == [11] * 6
    assert {g.name for g in groups(one)} >= {"all at 1500 N, 250 kPa, camber 10 deg"}
    sweep = np.repeat(np.arange(6), 11)
    names = tuple(f"s{k}" for k in range(6))
    many = make_points(
        alpha, gamma, Fz, **common, sweep=sweep, file=sweep, sweep_names=names, files=tuple(f"{n}.csv" for n in names)
    )  # fmt: skip
    assert [g.name for g in groups(many)] == list(names)


def test_a_sweep_whose_load_wanders_is_one_group():
    """At 500 N the load follows the braking force by 16 % to either side; parts of one sweep do not predict each other."""
    kappa = np.tile(np.linspace(-0.15, 0.15, 31), 4)
    Fz = np.repeat([500.0, 520.0, 540.0, 2000.0], 31) * (1.0 + 0.16 * kappa / 0.15)
    sweep = np.repeat(np.arange(4), 31)
    points = make_points(
        0.03, 0.0, Fz, kappa=kappa, p=83e3, V=11.0, phi_t=0.0, Fy=1.0, Mz=1.0, sweep=sweep,
        sweep_names=("a", "b", "c", "d"), files=("x",),
    )  # fmt: skip
    assert np.array_equal(parts_of_sweeps(points), sweep)
    assert design(points, "left").run["loads"] == 2


def test_a_sweep_of_camber_is_one_group():
    gamma = np.radians(np.tile(np.linspace(-50, 50, 11), 4))
    sweep = np.repeat(np.arange(4), 11)
    points = make_points(
        0.0, gamma, 1500.0, p=250e3, V=6.0, phi_t=0.0, Fy=1.0, Mz=1.0, sweep=sweep,
        sweep_names=("a", "b", "c", "d"), files=("x",),
    )  # fmt: skip
    assert [len(g.index) for g in groups(points)] == [11] * 4
