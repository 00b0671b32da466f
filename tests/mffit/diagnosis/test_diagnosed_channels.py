"""A diagnosis of three channels: covariance, gap, regions and bumps of the third are those of the third."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tir
from mffit.diagnosis.bumps import bump_scan
from mffit.diagnosis.noise import Scatter
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.smooth import smooth_basis
from mffit.diagnosis.stated import stated_noise, with_uncertainties
from mffit.diagnosis.validation import gap, validate
from mffit.diagnosis.where import where
from mffit.least_squares import FreeNumber
from mffit.linearised.chained import Memory
from mffit.points import make_points
from mffit.rig import Simulation

CHANNELS = ("Fy", "Mx", "Mz")
U = {"Fy": 6.0, "Mx": 3.0, "Mz": 0.6}
N = 60


@pytest.fixture(scope="module")
def problem() -> DiagnosisProblem:
    """Readings with noise, and Mx 20 Nm too large at positive sideslip."""
    rng = np.random.default_rng(5)
    tyre = Simulation.of(
        tir.read("samples/front-120-70/true.tir").replace(QSX2=0.3, QSX3=0.05), turn_slip=False
    )
    alpha = np.tile(np.linspace(-0.1, 0.1, 20), 3)
    points = make_points(alpha, 0.0, np.repeat([900.0, 1500.0, 2100.0], 20), p=250e3, V=10.0, phi_t=0.0,
        sweep=np.repeat([0, 1, 2], 20), sweep_names=("a", "b", "c"), **{f"u_{name}": u for name, u in U.items()})  # fmt: skip
    read = tyre.readings(points, CHANNELS)
    points = points.replace(**{name: read[name] + U[name] * rng.standard_normal(N) for name in CHANNELS})
    points = points.replace(Mx=points.Mx + np.where(alpha > 0.0, 20.0, 0.0))
    points, _ = with_uncertainties(points, tyre, CHANNELS)
    return DiagnosisProblem(points, tyre, stated_noise(points, channels=CHANNELS))


def test_the_gap_has_every_channel(problem):
    residual = problem.measured - problem.predict(problem.start)
    found = gap(residual, problem.noise)
    assert list(found.rmse) == list(CHANNELS)
    assert found.rms("Fy") == pytest.approx(6.0, rel=0.3)
    assert found.rms("Mx") == pytest.approx(np.sqrt(3.0**2 + 20.0**2 / 2.0), rel=0.15)


def test_the_region_and_the_bump_are_in_the_channel_that_is_off(problem):
    residual = problem.measured - problem.predict(problem.start)
    first = where(problem.points, residual, problem.noise)[0]
    assert first.channel == "Mx"
    assert first.region["alpha_deg"][0] > 0.0
    bump = bump_scan(problem.points, problem.noise).best(problem.null)
    assert (bump.channel, bump.found) == ("Mx", True)
    assert bump.amplitude > 0.0


@pytest.mark.parametrize("slope", [1.0, 1e9, 1e13])
def test_a_number_explains_no_more_than_there_is_however_steep_it_acts(problem, slope):
    """As a root at zero does, away from where it is expected, beside smooth structure of the same shape."""
    basis = smooth_basis(problem.points, problem.start.readings(problem.points, CHANNELS))
    beside = DiagnosisProblem(problem.points, problem.start, problem.noise, beside=basis)
    null, change = beside.null, problem.noise.whiten(basis.sum(axis=1))
    steep = replace(null, numbers={"QCRP1": 0.0}, jacobian=slope * change[:, None])
    found = beside._weighed(steep, [FreeNumber("QCRP1", 0.0, 0.0, 2.0, expected=1.1, spread=1.0)])
    assert found.log_evidence < null.log_evidence + 0.5 * null.chi2


def test_memory_acts_within_its_channel(problem):
    scatter = {name: Scatter(memory=Memory(0.6 if name == "Mx" else 0.0)) for name in CHANNELS}
    noise = replace(stated_noise(problem.points, channels=CHANNELS), scatter=scatter)
    x = np.random.default_rng(1).standard_normal(3 * N) * np.repeat(list(U.values()), N)
    white, plain = noise.whiten(x), x / np.repeat(list(U.values()), N)
    for name, rows in noise.by_channel(np.arange(3 * N)).items():
        assert np.allclose(white[rows], plain[rows]) == (name != "Mx")
    first = np.arange(N, 2 * N, 20)
    assert white[first] == pytest.approx(plain[first])
    second = first + 1
    assert white[second] == pytest.approx((plain[second] - 0.6 * plain[first]) / 0.8)


def test_smooth_structure_of_a_channel_stays_in_it(problem):
    basis = smooth_basis(problem.points, problem.start.readings(problem.points, CHANNELS))
    third = basis.shape[1] // 3
    for k in range(3):
        block = basis[:, k * third : (k + 1) * third]
        inside = np.arange(3 * N) // N == k
        assert np.all(block[~inside] == 0.0)
        assert np.any(block[inside] != 0.0)


def test_the_gap_of_a_given_model_needs_no_sweep_left_out(problem):
    check = validate(problem, problem.null)
    assert check.gap_before.rms("Mx") == pytest.approx(check.gap_after.rms("Mx"))


@pytest.fixture(scope="module")
def driven() -> DiagnosisProblem:
    """Readings without noise of drive and brake at three sideslips and two loads, and of sideslip sweeps."""
    tyre = Simulation.of(tir.read("samples/flat-track-combined/true.tir"), turn_slip=False)
    slip, steer = np.linspace(-0.2, 0.2, 21), np.linspace(-0.1, 0.1, 15)
    kappa = np.concatenate([np.tile(slip, 6), np.zeros(30)])
    alpha = np.concatenate([np.tile(np.repeat(np.radians([-4.0, 0.0, 4.0]), 21), 2), np.tile(steer, 2)])
    load = np.repeat([2500.0, 5000.0, 2500.0, 5000.0], [63, 63, 15, 15])
    sweep = np.concatenate([np.repeat(np.arange(6), 21), np.repeat([6, 7], 15)])
    points = make_points(alpha, 0.0, load, kappa=kappa, p=240e3, V=16.7, phi_t=0.0, sweep=sweep,
        sweep_names=tuple("abcdefgh"), u_Fx=15.0, u_Fy=12.0, u_Mz=1.5)  # fmt: skip
    points = points.replace(**tyre.readings(points, ("Fx", "Fy", "Mz")))
    return DiagnosisProblem(points, tyre, stated_noise(points, channels=("Fx", "Fy", "Mz")))


def test_a_local_misfit_over_slip_is_found_where_it_is(driven):
    points = driven.points
    bump = 90.0 * np.exp(-0.5 * ((points.kappa - 0.08) / 0.03) ** 2) * (points.alpha > 0.02)
    noise = np.random.default_rng(3).standard_normal(len(points))
    bumpy = DiagnosisProblem(points.replace(Fx=points.Fx + bump + 15.0 * noise), driven.start, driven.noise)
    found = bump_scan(points, driven.noise).best(bumpy.null)
    assert (found.channel, found.found) == ("Fx", True)
    low, high = found.region["kappa"]
    assert low < 0.08 < high
    assert found.region["alpha_deg"][0] > 0.0
    assert found.amplitude == pytest.approx(90.0, rel=0.2)


def test_noise_has_no_bump_over_slip(driven):
    """300 draws; a bump needs four units of log evidence beyond the price of the search."""
    scan, rng = bump_scan(driven.points, driven.noise), np.random.default_rng(4)
    assert any("kappa" in region for region in scan.regions)
    draws = (
        replace(driven.null, residual=rng.standard_normal(len(driven.null.residual))) for _ in range(300)
    )
    assert sum(scan.best(one).found for one in draws) <= 3
