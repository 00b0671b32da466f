"""The set-points that a plan proposes are those of docs/plan.md, at the loads, paths and pressures of the programme."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from small_rigs import LOADS, disc, flat, simulated

from mffit import config as configuration
from mffit import points as ingestion
from mffit.additions import ADDITIONS, SEPARATING, candidates, swept
from mffit.points import concatenate

DOCS = Path(__file__).parents[3] / "docs" / "plan.md"
R, SLIP, CAMBER, PRESSURE = 1.323, 8.0, 45.0, 250e3
ZEROS = [-1.0, -0.5, 0.0, 0.5, 1.0]
SHARES = np.array(
    [-1, -0.75, -0.5, -0.375, -0.25, -0.125, -0.0625, 0, 0.0625, 0.125, 0.25, 0.375, 0.5, 0.75, 1]
)
SMALL = 20.0 * SHARES
FULL = [*(SLIP * SHARES), *np.zeros(15)]
LEANED = [*np.zeros(15), *(CAMBER * SHARES)]


@pytest.fixture(scope="module")
def programme(tmp_path_factory):
    folder = tmp_path_factory.mktemp("programme")
    simulated(disc(LOADS[:2], rolling_radius=[]), folder)
    config = configuration.load(folder / "tyre.toml")
    return config, ingestion.read(config).points


@pytest.fixture
def longer_programme(tmp_path):
    """A flat track's programme with a rolling wheel at a higher load and points of a step of slip."""
    simulated(flat(), tmp_path)
    config = configuration.load(tmp_path / "tyre.toml")
    points = ingestion.read(config).points
    loads = {round(float(load)) for load in np.unique(np.round(points.Fz))}
    some = points.select(np.arange(3))
    rolling = some.replace(alpha=0.0, gamma=0.0, kappa=0.001, Fz=1.6 * np.max(points.Fz))
    step = some.replace(alpha=0.0, gamma=0.0, kappa=0.025)
    return config, concatenate([points, rolling, step]), loads


@pytest.fixture(scope="module")
def runs(programme):
    found: dict[str, list] = {}
    for run in candidates(*programme):
        found.setdefault(run.addition.id, []).append(run)
    return found


@pytest.mark.parametrize(
    ("kind", "alpha", "gamma", "path", "loads"),
    [
        ("zeros", ZEROS * 2, 0.0, R, (900, 1400)),
        ("other-side", ZEROS * 2, 0.0, -R, (900, 1400)),
        ("second-radius", ZEROS * 2, 0.0, 0.7 * R, (900, 1400)),
        ("other-side-camber", 0.0, SMALL, -R, (900, 1400)),
        ("small-camber", 0.0, SMALL, R, (900, 1400)),
        ("backward-camber", 0.0, CAMBER * SHARES, R, (1400,)),
        ("flipped", SLIP * SHARES[3:-3], 0.0, R, (1400,)),
        ("sideslip", SLIP * SHARES, 0.0, R, (900, 1400)),
        ("camber", 0.0, CAMBER * SHARES, R, (900, 1400)),
        ("load", FULL, LEANED, R, (0.7 * 900, 1.3 * 1400)),
    ],
)
def test_set_points(runs, kind, alpha, gamma, path, loads):
    assert [run.load for run in runs[kind]] == pytest.approx(loads, abs=0.1)
    for run in runs[kind]:
        points = run.points
        n = run.cost
        assert np.degrees(points.alpha) == pytest.approx(np.broadcast_to(alpha, n))
        assert np.degrees(points.gamma) == pytest.approx(np.broadcast_to(gamma, n))
        assert points.phi_t == pytest.approx(np.full(n, -1.0 / path))
        assert points.Fz == pytest.approx(np.full(n, run.load))
        assert points.p == pytest.approx(np.full(n, PRESSURE))
        assert points.mount.tolist() == [-1 if kind == "flipped" else 1] * n
        backward = n if kind == "backward-camber" else 5 if len(np.atleast_1d(alpha)) == 10 else 0
        assert points.direction.tolist() == [1] * (n - backward) + [-1] * backward
        assert np.all(np.isnan(points.Fy))
        assert np.all(np.isnan(points.Mz))
        assert points.u_Fy == pytest.approx(np.full(n, 3.0))  # the typical one of the programme


def test_coupled_sweeps_lean_to_both_sides_where_the_programme_has_none(runs):
    """The programme has 20 deg at 1400 N."""
    assert [(round(run.load), run.held_deg) for run in runs["coupled"]] == [
        (900, 10), (900, 20), (900, 35), (1400, 10), (1400, 35),
    ]  # fmt: skip
    for run in runs["coupled"]:
        assert np.degrees(run.points.alpha) == pytest.approx([*(SLIP * SHARES)] * 2)
        assert np.degrees(run.points.gamma) == pytest.approx([-run.held_deg] * 15 + [run.held_deg] * 15)


def test_runs_that_separate_effects_differ_in_one_condition(programme):
    config, points = programme
    points = points.replace(T=30.0, t=np.arange(float(len(points))))
    found = {run.addition.id: run.points for run in candidates(config, points, kinds=SEPARATING)}
    usual = np.median(points.V)
    for kind, run in found.items():
        assert np.degrees(run.alpha) == pytest.approx(SLIP * SHARES)
        assert set(run.direction) == {-1 if kind == "backward" else 1}
        np.testing.assert_allclose(run.V, usual * (2.0 if kind == "fast" else 1.0))
        np.testing.assert_allclose(run.T, 50.0 if kind == "warm" else 30.0)
        np.testing.assert_allclose(run.t, len(points) - 1.0 + 900.0 if kind == "late" else np.nan)
    assert set(found) == {"backward", "fast", "warm", "late"}


def test_pressures_are_a_fifth_lower_and_higher(runs):
    assert [round(run.pressure_kPa) for run in runs["pressure"]] == [200, 300, 200, 300]
    for run in runs["pressure"]:
        assert np.degrees(run.points.alpha) == pytest.approx(FULL)
        assert np.degrees(run.points.gamma) == pytest.approx(LEANED)
        assert run.points.p == pytest.approx(np.full(30, 1e3 * run.pressure_kPa))


def test_without_a_camber_sweep_small_cambers_are_proposed(programme):
    config, points = programme
    upright = points.select(np.abs(points.gamma) < np.radians(0.9))
    (run, *_) = (run for run in candidates(config, upright) if run.addition.id == "camber")
    assert np.degrees(run.points.gamma) == pytest.approx(SMALL)
    cambers = {run.held_deg for run in candidates(config, upright) if run.addition.id == "coupled"}
    assert cambers == {10, 20}


def test_a_flat_track_has_no_runs_about_turn_slip(tmp_path):
    simulated(flat(), tmp_path)
    config = configuration.load(tmp_path / "tyre.toml")
    found = {run.addition.id for run in candidates(config, ingestion.read(config).points)}
    driven = {"drive", "combined", "drive-camber", "drive-pressure"}
    assert found == {"flipped", "sideslip", "camber", "coupled", "pressure", "load", *driven}


def test_rolling_and_steps_are_no_sweeps_of_the_programme(longer_programme):
    """A wheel that only rolled at other loads and a step of slip move neither the loads nor the slips that are proposed."""
    config, points, kinds = longer_programme
    assert np.ptp(points.Fz) > np.ptp(swept(points).Fz) > 0.0
    assert {round(run.load) for run in candidates(config, points) if run.addition.id == "sideslip"} == kinds
    drive = next(run for run in candidates(config, points) if run.addition.id == "drive")
    assert np.max(np.abs(drive.points.kappa)) == pytest.approx(0.15)


def test_runs_have_unique_names(programme):
    names = [run.name for run in candidates(*programme)]
    assert len(set(names)) == len(names)
    assert {"zeros-900N", "coupled-1400N-35deg", "pressure-900N-300kPa"} <= set(names)


def test_the_documentation_lists_every_kind():
    text = DOCS.read_text(encoding="utf-8")
    missing = [addition.id for addition in ADDITIONS if f"`{addition.id}`" not in text]
    assert not missing, f"docs/plan.md lacks {', '.join(missing)}"


def test_a_run_on_another_path_is_a_new_set_up_and_says_so(runs):
    for kind in ("other-side", "other-side-camber", "second-radius"):
        assert "new set-up" in runs[kind][0].addition.reason
    assert {run.points.setups for run in runs["other-side"]} == {("right",)}
    assert {run.points.setups for run in runs["second-radius"]} == {("left-0.9261m",)}
    for kind in ("zeros", "flipped", "backward-camber"):
        assert runs[kind][0].points.setups == ("",)


def test_a_run_on_a_path_that_was_run_is_in_its_set_up(programme):
    config, points = programme
    other = points.select(points.sweep == 0).replace(phi_t=-points.phi_t[0], setups=("may",))
    found = candidates(config, concatenate([points, other]))
    assert {run.points.setups for run in found if run.addition.id == "other-side"} == {("may",)}
