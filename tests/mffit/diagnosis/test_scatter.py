"""Every part of the noise is found in the readings, and only if it is there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from mffit.diagnosis import constants
from mffit.diagnosis.noise import MemorySpan, Noise, Scatter
from mffit.diagnosis.rest import _log_odds
from mffit.diagnosis.scatter import ExplainingColumns, learned
from mffit.diagnosis.stated import stated_noise
from mffit.diagnosis.tails import beyond_weights, heavy_tails, weights
from mffit.linearised.chained import Memory
from mffit.linearised.gaussian import Informed
from mffit.points import make_points
from mffit.scatter import rms

N, SWEEPS = 400, 20
FORCE = 1500.0 * np.sin(np.linspace(0.0, 40.0, N))
NOTHING = np.zeros((2 * N, 1))


def stated(u=6.0):
    chain = np.repeat(np.arange(2 * SWEEPS), N // SWEEPS)
    u = np.repeat([u, u / 10.0], N)
    return Noise(u=u, stated=u, chain=chain, origin=None)


RUNS = np.repeat(np.arange(SWEEPS), N // SWEEPS)


def found(Fy, named=NOTHING, offsets=0.0, longer=False):
    """The noise learned from errors (N,), NaN where nothing was read, with offsets of runs of a usual size [N] if given.

    ``longer``: the sweeps may have followed each other without a pause.
    """
    rng = np.random.default_rng(99)
    residual = np.concatenate([Fy, rng.normal(0.0, 0.6, N)])
    size = np.concatenate([FORCE, 0.02 * FORCE])
    of_parts = np.vstack([RUNS[:, None] == np.arange(SWEEPS), np.zeros((N, SWEEPS))])
    runs = {"run-offsets-fy": offsets * of_parts} if offsets else {}
    noise = stated()
    noise = replace(
        noise,
        u=np.where(np.isfinite(residual), noise.u, np.inf),
        stated=np.where(np.isfinite(residual), noise.u, np.inf),
    )
    if longer:
        chain = {MemorySpan.PROGRAMME: np.zeros(2 * N, dtype=int)}
        noise = replace(noise, longer=chain, turn=np.tile(np.arange(N), 2))
    return learned(noise, residual, ExplainingColumns(named, runs, NOTHING), size)


def correlated(rng, memory, *, again=True):
    """Errors of 6 N with a memory along each sweep, begun ``again`` with each or not."""
    noise = rng.normal(0.0, 6.0, N)
    for i in range(1, N):
        if RUNS[i] == RUNS[i - 1] or not again:
            noise[i] = memory * noise[i - 1] + np.sqrt(1.0 - memory**2) * noise[i]
    return noise


@pytest.fixture
def rng():
    return np.random.default_rng(4)


def test_noise_as_stated_stays_as_stated(rng):
    scatter = found(rng.normal(0.0, 6.0, N)).scatter["Fy"]
    assert scatter.scale == pytest.approx(1.0, abs=0.15)  # 3.5 % of chance
    assert (scatter.growth, scatter.memory.correlation, scatter.tails) == (0.0, 0.0, np.inf)


def test_uncertainties_stated_half_as_large_are_doubled(rng):
    assert found(rng.normal(0.0, 12.0, N)).scatter["Fy"].scale == pytest.approx(2.0, abs=0.3)


def test_noise_that_grows_with_the_force(rng):
    scatter = found(rng.normal(0.0, np.hypot(6.0, 0.015 * FORCE))).scatter["Fy"]
    assert scatter.growth == pytest.approx(0.015, abs=0.004)
    assert scatter.scale == pytest.approx(1.0, abs=0.4)


def test_errors_that_are_correlated_along_a_sweep(rng):
    scatter = found(correlated(rng, 0.9)).scatter["Fy"]
    assert scatter.memory.correlation == pytest.approx(0.9, abs=0.08)
    assert scatter.scale == pytest.approx(1.0, abs=0.35)


def test_a_memory_beside_independent_errors(rng):
    """Of 6 N together; a single memory would be a compromise that leaves slow errors unexplained."""
    scatter = found(0.8 * correlated(rng, 0.97) + rng.normal(0.0, 3.6, N), offsets=5.0).scatter["Fy"]
    assert scatter.memory.correlation == pytest.approx(0.97, abs=0.03)
    assert scatter.scale**2 * scatter.memory.independent == pytest.approx(0.36, abs=0.1)


ERRORS = {
    "short memory": lambda rng: correlated(rng, 0.9),
    "long memory": lambda rng: correlated(rng, 0.985),
    "drift beside independent errors": lambda rng: 0.8 * correlated(rng, 0.97) + rng.normal(0.0, 3.6, N),
}


@pytest.mark.parametrize("errors", ERRORS.values(), ids=ERRORS.keys())
def test_a_memory_is_not_taken_for_offsets_of_runs(errors):
    for seed in (1, 2):
        noise = found(errors(np.random.default_rng(seed)), offsets=5.0)
        assert noise.offsets["run-offsets-fy"].log_odds < constants.SURPRISING_LOG_ODDS


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.9])
def test_offsets_of_runs_are_not_taken_for_a_memory(memory):
    """Offsets of 33 N once passed as noise of 29 N with a memory of 0.96, beside which nothing was left to name."""
    rng = np.random.default_rng(8)
    drawn = rng.normal(0.0, 33.0, SWEEPS)
    noise = found(correlated(rng, memory) + drawn[RUNS], offsets=5.0)
    assert noise.offsets["run-offsets-fy"].log_odds > constants.SURPRISING_LOG_ODDS
    assert 5.0 * noise.offsets["run-offsets-fy"].size == pytest.approx(np.std(drawn), rel=0.25)
    scatter = noise.scatter["Fy"]
    assert scatter.memory.correlation == pytest.approx(memory, abs=0.15)
    # What changes from one point to the next is well known, whatever the memory.
    change, truth = scatter.scale**2 * (1.0 - scatter.memory.correlation), 1.0 - memory
    assert change == pytest.approx(truth, rel=0.3)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_few_runs_hardly_separate_offsets_from_a_memory(seed):
    """Offsets of 12 N under errors of 6 N with a memory of 0.8: the scatter of four means has no precise size."""
    rng = np.random.default_rng(seed)
    Fy = correlated(rng, 0.8) + rng.normal(0.0, 12.0, SWEEPS)[RUNS]
    few, all_ = (
        found(np.where(runs > RUNS, Fy, np.nan), offsets=5.0).offsets["run-offsets-fy"].log_odds
        for runs in (4, SWEEPS)
    )
    assert few < all_ - 1.0
    assert few < constants.SURPRISING_LOG_ODDS + 1.0
    assert all_ > constants.SURPRISING_LOG_ODDS + 1.0


@pytest.mark.parametrize(("again", "span"), [(True, MemorySpan.SWEEP), (False, MemorySpan.PROGRAMME)])
def test_errors_that_run_on_from_sweep_to_sweep_are_told_from_those_that_begin_anew(again, span):
    noise = found(correlated(np.random.default_rng(3), 0.96, again=again), offsets=5.0, longer=True)
    assert noise.scatter["Fy"].span is span
    assert noise.scatter["Fy"].memory.correlation == pytest.approx(0.96, abs=0.03)
    assert noise.offset == frozenset()


def test_a_drift_is_found_where_a_single_memory_is_no_better_than_none():
    """Slow errors of 3 N beside independent ones of 6 N, which once counted as structure of the model."""
    errors = 0.5 * correlated(np.random.default_rng(5), 0.97, again=False)
    scatter = found(errors + np.random.default_rng(6).normal(0.0, 6.0, N), offsets=5.0, longer=True).scatter[
        "Fy"
    ]
    assert scatter.memory.correlation > 0.85
    assert scatter.memory.independent == pytest.approx(0.8, abs=0.15)


def taken(t, file, lines):
    """The chains longer than a sweep of points with times (n,), and the places of the points in time."""
    points = make_points(
        np.zeros(len(t)), np.zeros(len(t)), np.full(len(t), 1e3), p=2e5, V=10.0, phi_t=0.0, Fy=np.zeros(len(t)), t=t,
        u_Fy=np.ones(len(t)), file=file, files=("a", "b", "c"), line=lines,
    )  # fmt: skip
    noise = stated_noise(points, channels=("Fy",))
    return {span: chain.tolist() for span, chain in noise.longer.items()}, noise.turn.tolist()


def test_sweeps_that_follow_each_other_in_time_are_one_chain():
    """File b was run first, then a at once, and c after a pause."""
    t, file = np.array([40.0, 50.0, 20.0, 10.0, 115.0, 125.0]), np.array([0, 0, 1, 1, 2, 2])
    chains, turn = taken(t, file, np.arange(6))
    assert turn == [2, 3, 1, 0, 4, 5]
    assert chains[MemorySpan.FILE] == [1, 1, 0, 0, 2, 2]
    assert chains[MemorySpan.PROGRAMME] == [0, 0, 0, 0, 1, 1]


def test_without_times_only_the_lines_of_a_file_follow_each_other():
    chains, turn = taken(np.full(6, np.nan), np.array([0, 0, 1, 1, 2, 2]), np.array([2, 1, 1, 2, 1, 2]))
    assert turn == [1, 0, 2, 3, 4, 5]
    assert chains == {MemorySpan.FILE: [0, 0, 1, 1, 2, 2]}


def test_files_with_clocks_of_their_own_do_not_follow_each_other():
    chains, _ = taken(np.tile([0.0, 10.0], 3), np.array([0, 0, 1, 1, 2, 2]), np.arange(6))
    assert chains[MemorySpan.PROGRAMME] == [0, 0, 1, 1, 2, 2]


def test_readings_without_noise_get_that_of_the_best_rigs(rng):
    noise = found(rng.normal(0.0, 1e-4, N))
    assert noise.scatter["Fy"].without_noise
    assert not noise.scatter["Mz"].without_noise
    assert pytest.approx(1e-3 * np.sqrt(np.mean(FORCE**2))) == noise.typical("Fy")


def test_outliers_lose_their_weight(rng):
    noise = rng.normal(0.0, 6.0, N)
    off = np.sort(rng.choice(N, 8, replace=False))
    noise[off] += rng.choice((-90.0, 90.0), 8)
    learned_noise = found(noise)
    listed = np.flatnonzero(learned_noise.weight < 0.15)
    assert set(off) <= set(listed)
    assert len(listed) <= 10
    assert np.all(learned_noise.u[off] > 20.0)
    usual = np.setdiff1d(np.arange(N), listed)
    assert np.median(learned_noise.u[usual]) == pytest.approx(6.0, rel=0.25)


def test_the_error_beyond_weights_is_how_a_weighted_mean_scatters(rng):
    wild = rng.random((2000, 400)) < 0.02
    read = rng.normal(size=wild.shape) + wild * rng.choice((-15.0, 15.0), wild.shape)
    tails, width = heavy_tails(read.ravel())
    mean = np.zeros(len(read))
    for _ in range(50):
        weight = weights(read - mean[:, None], tails, width)
        mean = np.sum(weight * read, axis=1) / np.sum(weight, axis=1)
    pull = rms(mean * np.sqrt(np.sum(weight, axis=1)) / width)  # the truth is 0
    assert pull > 1.2
    assert beyond_weights(read.ravel() / width, tails) == pytest.approx(pull, rel=0.05)
    assert beyond_weights(rng.normal(size=400), np.inf) == 1.0


def test_misfit_that_an_effect_could_explain_is_not_noise(rng):
    shape = np.concatenate([np.cos(np.linspace(0.0, 9.0, N)), np.zeros(N)])[:, None]
    scatter = found(rng.normal(0.0, 6.0, N) + 80.0 * shape[:N, 0], 100.0 * shape).scatter["Fy"]
    assert scatter.scale == pytest.approx(1.0, abs=0.15)
    assert scatter.memory.correlation == 0.0


@pytest.mark.parametrize(
    ("share", "span"), [(0.0, MemorySpan.SWEEP), (0.4, MemorySpan.SWEEP), (0.4, MemorySpan.PROGRAMME)]
)
def test_whitened_readings_have_unit_covariance(share, span):
    """Against the explicit covariance: independent uncertainty, memory along sweeps or all readings, shared changes."""
    rng = np.random.default_rng(1)
    n, u = 30, rng.uniform(1.0, 3.0, 60)
    u[40] = np.inf
    chain, shared = np.repeat([0, 1, 2, 3], 15), rng.normal(size=(60, 4))
    memory = {"Fy": Scatter(memory=Memory(0.8, share), span=span), "Mz": Scatter(memory=Memory(0.3))}
    turn = np.concatenate([rng.permutation(n), np.zeros(n, dtype=int)])
    noise = Noise(
        u=u, stated=u, chain=chain, origin=None, scatter=memory, shared=shared, turn=turn,
        longer={MemorySpan.PROGRAMME: np.zeros(60, dtype=int)},
    )  # fmt: skip
    used = np.flatnonzero(np.isfinite(u))
    place = np.concatenate([turn[:n] if span is MemorySpan.PROGRAMME else np.arange(n), np.arange(n, 59)])
    steps = np.abs(np.subtract.outer(place, place))
    rho = np.where(used < n, 0.8, 0.3)
    inside = chain[used][:, None] == chain[used][None, :]
    inside |= np.logical_and.outer(used < n, used < n) & (span is MemorySpan.PROGRAMME)
    alike = np.where(inside, rho[:, None] ** steps, 0.0)
    alike *= np.where((steps > 0) & (used < n)[:, None], 1.0 - share, 1.0)
    covariance = np.outer(u[used], u[used]) * alike
    covariance += shared[used] @ shared[used].T
    white = noise.whiten(np.eye(60))[:, used]
    assert white @ covariance @ white.T == pytest.approx(np.eye(59), abs=1e-10)
    assert noise.whiten(np.empty((60, 0))).shape == (59, 0)  # LAPACK once wrote beyond it
    rows = np.array([2, 3, 7, 33, 50])
    assert noise.error_of_sum(rows) ** 2 == pytest.approx(covariance[np.ix_(rows, rows)].sum())


def test_columns_of_any_size_have_a_factor():
    """A model far from the readings: rounding in A'A loses the 1 that makes it positive definite."""
    rng = np.random.default_rng(5)
    A = rng.normal(size=(40, 1)) @ rng.normal(size=(1, 6)) * 1e10
    root = Informed.of_rows(A, np.zeros(40)).factor
    assert np.all(np.diag(root) > 0.0)
    assert np.allclose(root, np.tril(root))
    assert np.allclose(root @ root.T, A.T @ A + np.eye(6), rtol=1e-9, atol=0.0)
    small = rng.normal(size=(40, 6))
    root = Informed.of_rows(small, np.zeros(40)).factor
    assert np.allclose(root @ root.T, small.T @ small + np.eye(6))


@pytest.mark.parametrize("ratio", [0.5, 1.0, 1.3, 4.0])
def test_evidence_of_a_larger_scatter_is_the_likelihood_of_its_readings(ratio):
    """Readings of this rms under a normal distribution of their own width, against one of unit width."""
    readings = np.random.default_rng(3).standard_normal(60)
    readings *= ratio / rms(readings)
    gain = np.sum(norm.logpdf(readings, scale=ratio) - norm.logpdf(readings))
    assert _log_odds(ratio, 60) == pytest.approx(gain if ratio > 1.0 else 0.0, abs=1e-9)
