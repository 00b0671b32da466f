"""Leave-one-sweep-out prediction from one fit, against fits that really leave the sweep out."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.fit.coverage import design
from mffit.points import make_points
from mffit.suspicion.constants import MOST_POINTS_SHOWN
from mffit.suspicion.prediction import Group, Leverage, groups, parts_of_sweeps, predictions


def linear_fit(n: int = 60, k: int = 5, seed: int = 4) -> tuple[Leverage, np.ndarray, np.ndarray]:
    """A straight-line world of Fy and Mz with different weights: the fit, its design and its readings (2n,)."""
    rng = np.random.default_rng(seed)
    design = rng.normal(size=(2 * n, k))
    noise = np.concatenate([np.full(n, 6.0), np.full(n, 0.6)])
    weight = noise * rng.uniform(1.0, 3.0, 2 * n)
    weight[7] = np.inf  # a reading without weight
    measured = design @ rng.normal(size=k) * 10.0 + rng.normal(size=2 * n) * noise
    J = design / weight[:, None]
    covariance = np.linalg.inv(J.T @ J)
    residual = design @ (covariance @ J.T @ (measured / weight)) - measured

    combined = design @ np.linalg.cholesky(covariance)

    def at(rows):
        both = np.r_[rows, n + rows]
        return residual[both], combined[both]

    return (
        Leverage(("Fy", "Mz"), at, weight, noise),
        design,
        measured,
    )


def test_a_large_group_is_shown_at_evenly_spaced_points_and_left_out_whole():
    fit, design, measured = linear_fit(n=2000)
    whole = Group("s", "s.csv", np.arange(100, 1300), True)
    found = predictions(fit, whole)["Fy"].error
    assert len(found) == len(whole.shown) == MOST_POINTS_SHOWN
    rest = np.setdiff1d(np.arange(4000), np.concatenate([whole.index, 2000 + whole.index]))
    J = design[rest] / fit.weight[rest, None]
    expected = design @ np.linalg.lstsq(J, measured[rest] / fit.weight[rest], rcond=None)[0]
    assert found == pytest.approx((expected - measured)[whole.shown], rel=1e-8)


@pytest.mark.parametrize("index", [np.arange(0, 12), np.arange(30, 34)])
def test_the_prediction_agrees_with_a_second_fit_without_the_sweep(index):
    fit, design, measured = linear_fit()
    n = len(measured) // 2
    rows = np.concatenate([index, n + index])
    rest = np.setdiff1d(np.arange(2 * n), rows)
    J = design[rest] / fit.weight[rest, None]
    covariance = np.linalg.inv(J.T @ J)
    expected = design @ (covariance @ J.T @ (measured[rest] / fit.weight[rest]))
    found = predictions(fit, Group("s", "s.csv", index, True))
    assert found["Fy"].error == pytest.approx((expected - measured)[index], rel=1e-9)
    assert found["Mz"].error == pytest.approx((expected - measured)[n + index], rel=1e-9)
    spread = design[index] @ covariance @ design[index].T + np.diag(fit.noise[index] ** 2)
    assert found["Fy"].covariance == pytest.approx(spread, rel=1e-9)


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
    assert design(points, "left").loads == 2


def test_a_sweep_of_camber_is_one_group():
    gamma = np.radians(np.tile(np.linspace(-50, 50, 11), 4))
    sweep = np.repeat(np.arange(4), 11)
    points = make_points(
        0.0, gamma, 1500.0, p=250e3, V=6.0, phi_t=0.0, Fy=1.0, Mz=1.0, sweep=sweep,
        sweep_names=("a", "b", "c", "d"), files=("x",),
    )  # fmt: skip
    assert [len(g.index) for g in groups(points)] == [11] * 4
