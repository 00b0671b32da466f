"""Smooth structure beside a hypothesis, against the dense Gaussian that it stands for."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.stats import multivariate_normal
from small_programme import TYRE, programme, read

from mffit.diagnosis.noise import Noise
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.smooth import Smooth, SmoothStructure
from mffit.rig import Simulation

N = 30
BASIS = block_diag(*np.random.default_rng(1).normal(size=(2, N, 5)))


@pytest.fixture(scope="module")
def noise() -> Noise:
    """Independent noise, and two changes that all readings share."""
    u = np.random.default_rng(2).uniform(0.5, 2.0, 2 * N)
    plain = Noise(u=u, stated=u, chain=np.zeros(2 * N, dtype=int), origin=None)
    return plain.sharing(np.random.default_rng(3).normal(size=(2 * N, 2)))


def covariance(noise: Noise, columns: np.ndarray, Fy: float, Mz: float) -> np.ndarray:
    structure = BASIS * np.repeat([Fy, Mz], 5)
    shared = noise.shared
    assert shared is not None
    return np.diag(noise.u**2) + shared @ shared.T + columns @ columns.T + structure @ structure.T


def test_its_evidence_is_the_density_of_the_readings(noise):
    rng = np.random.default_rng(4)
    columns, readings = rng.normal(size=(2 * N, 3)), 3.0 * rng.normal(size=2 * N)
    model = SmoothStructure(noise, BASIS).beside(columns / noise.u[:, None], readings / noise.u)

    def density(x: np.ndarray) -> float:
        whole = covariance(noise, columns, *np.exp(x))
        return float(multivariate_normal(cov=whole).logpdf(readings))

    def evidence(x: np.ndarray) -> float:
        amplitude = dict(zip(("Fy", "Mz"), np.exp(x).tolist(), strict=True))
        return model.evidence(amplitude) + model.improbable(amplitude)

    at, other = np.array([-0.4, 0.3]), np.array([0.8, -2.0])
    assert evidence(at) - evidence(other) == pytest.approx(density(at) - density(other))
    assert model.evidence({}) - evidence(at) == pytest.approx(density([-30.0, -30.0]) - density(at))


def test_structure_in_the_covariance_is_whitened_like_any_shared_change(noise):
    points = read(programme().select(np.arange(N)))
    problem = DiagnosisProblem(points, Simulation.of(TYRE), noise, beside=BASIS)
    beside = problem.at_amplitude(Smooth({"Mz": 0.7}, math.inf)).noise
    white = beside.whiten(np.eye(2 * N))
    whole = covariance(noise, np.zeros((2 * N, 0)), 0.0, 0.7)
    assert white @ whole @ white.T == pytest.approx(np.eye(2 * N), abs=1e-9)
    without = covariance(noise, np.zeros((2 * N, 0)), 0.0, 0.0)
    logs = [np.linalg.slogdet(one)[1] for one in (whole, without)]
    more = beside.half_log_determinant - noise.half_log_determinant
    assert more == pytest.approx(0.5 * (logs[0] - logs[1]))
    alone = np.diag(1.0 / noise.u)
    assert beside.unshared(white) == pytest.approx(alone)
    assert beside.backwards(white) == pytest.approx(np.diag(noise.u) @ np.linalg.inv(whole))


@pytest.mark.parametrize(("size", "found"), [(0.0, False), (0.5, True)])
def test_structure_is_found_where_the_readings_have_it(noise, size, found):
    rng = np.random.default_rng(5)
    readings = noise.u * rng.normal(size=2 * N) + size * 3.0 * BASIS[:, :5].sum(axis=1)
    best = SmoothStructure(noise, 10.0 * BASIS).beside(np.zeros((2 * N, 0)), readings / noise.u).best()
    assert best.found is found
    if found:
        assert best.amplitude["Fy"] > 4.0 * best.amplitude["Mz"]


@pytest.mark.parametrize(("allowed", "found"), [({"Fy": 0.3}, False), ({"Mz": 0.3}, True)])
def test_structure_that_is_allowed_in_its_channel_is_expected(noise, allowed, found):
    readings = noise.u * np.random.default_rng(5).normal(size=2 * N) + 1.5 * BASIS[:, :5].sum(axis=1)
    structure = SmoothStructure(noise, 10.0 * BASIS, allowed)
    best = structure.beside(np.zeros((2 * N, 0)), readings / noise.u).best()
    assert best.found is found
    assert ("Fy" in best.expected) is not found
