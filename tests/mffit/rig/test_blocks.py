"""Many points are simulated block by block; what a point owes to the others of its test must not depend on the blocks."""

from __future__ import annotations

import numpy as np
import pytest
import small_rigs

from mffit.points import make_points
from mffit.rig import Simulation, blocks, successive
from tir import constants

N, SWEEPS = 60, 4
NAMES = ("PKY1", "QBZ1", "alpha_0_deg", "hysteresis_deg", "path_radius_m", "wear_per_km", "F0_N@b")
HISTORY = {
    "hysteresis_deg": 0.2,
    "wear_per_km": 0.05,
    "k_V_per_mps": 0.01,
    "backlash_deg": 0.1,
    "F0_N@b": 7.0,
}


@pytest.fixture(scope="module")
def points():
    """Sweeps whose points follow each other in turn, on two radii and at two speeds."""
    rng = np.random.default_rng(2)
    step = np.arange(N) // SWEEPS
    return make_points(
        np.radians(8.0 * np.sin(0.7 * step + np.arange(N) % SWEEPS)), rng.uniform(-0.3, 0.3, N), rng.uniform(900, 2000, N),
        p=250e3, V=np.where(np.arange(N) < 40, 6.0, 9.0), phi_t=np.where(np.arange(N) % 3, -1 / 1.3, -1 / 1.5),
        t=60.0 * rng.permutation(N), time=0.2 * step, sweep=np.arange(N) % SWEEPS, sweep_names=tuple("abcd"),
    )  # fmt: skip


@pytest.mark.parametrize("lag", [0.0, 0.4])
def test_readings_and_slopes_do_not_depend_on_the_blocks(points, lag, monkeypatch):
    simulation = Simulation.of(small_rigs.truth()).with_numbers({**HISTORY, "relaxation_m": lag})
    out, slopes = simulation.sensitivities(points, NAMES)
    apart = simulation.at_rows(points, NAMES)
    monkeypatch.setattr(constants, "CONDITIONS_PER_BLOCK", 7)
    in_blocks, slopes_in_blocks = simulation.sensitivities(points, NAMES)
    for channel in out:
        assert in_blocks[channel] == pytest.approx(out[channel], rel=1e-9)
        size = np.maximum(np.max(np.abs(slopes[channel]), axis=0), 1e-12)
        assert slopes_in_blocks[channel] / size == pytest.approx(slopes[channel] / size, abs=1e-9)
    some = next(blocks(points, by_sweep=True))
    assert apart(some)[0].Fy == pytest.approx(out.Fy[some], rel=1e-9)


def test_blocks_hold_every_point_once_and_divide_no_sweep_if_asked(points, monkeypatch):
    for most in (7, 20, 40, 100):
        monkeypatch.setattr(constants, "CONDITIONS_PER_BLOCK", most)
        divided, whole = (list(blocks(points, by_sweep=by_sweep)) for by_sweep in (False, True))
        assert max(map(len, divided)) <= most
        for found in (divided, whole):
            assert np.array_equal(np.sort(np.concatenate(found)), np.arange(N))
        of_block = [set(points.sweep[rows].tolist()) for rows in whole]
        assert sum(map(len, of_block)) == SWEEPS
        assert len(whole) == {7: 4, 20: 4, 40: 2, 100: 1}[most]


def test_rows_that_follow_each_other_are_selected_without_a_copy(points):
    rows = np.arange(10, 20)
    part = points.select(successive(rows), with_table=False)
    assert np.shares_memory(part.alpha, points.alpha)
    assert np.array_equal(part.alpha, points.alpha[rows])
    assert len(part.table) == 10
    for other in (rows[::2], rows[::-1], np.array([10, 11, 11, 13]), rows[:0]):
        assert np.array_equal(points.select(successive(other)).alpha, points.alpha[other])
