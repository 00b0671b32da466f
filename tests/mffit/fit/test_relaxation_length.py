"""Relaxation length of the side force from steps of the sideslip angle."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import uniform_filter1d
from scipy.signal import lfilter

import tir
from mffit import config as configuration
from mffit.fit.posterior import Posterior
from mffit.fit.relaxation import RUN, _correlation, relaxation, relaxation_sentence
from mffit.points.loading import read
from mffit.points.steps import steps
from mffit.rig import Simulation
from mffit.sweeps import load

SAMPLE = Path(__file__).parents[3] / "samples" / "flat-track-combined"
NONE_KNOWN = Posterior((), np.zeros((0, 0)))


@pytest.fixture(scope="module")
def campaign():
    content = configuration.load(SAMPLE / "tyre.toml")
    kept = tuple(row for row in content.sweep if row.file.startswith(("steps", "rolling")))
    return content.model_copy(update={"sweep": kept})


@pytest.fixture(scope="module")
def truth() -> tir.Tyre:
    return tir.read(SAMPLE / "true.tir")


@pytest.fixture(scope="module")
def found(campaign, truth):
    """The tyre is known but for its carcass, and the rig has its errors."""
    start = truth.replace(LATERAL_STIFFNESS=300e3, PCFY1=0.0, PCFY2=0.0)
    return relaxation(read(campaign).steps, Simulation.of(start, turn_slip=False), NONE_KNOWN)


def test_the_relaxation_length_is_that_of_the_tyre_at_every_load(found, truth):
    assert [round(run.load, -2) for run in found.runs] == [2000, 4200, 6500]
    for run in found.runs:
        true = float(truth.state(run.load, p=run.pressure).sigma_y)
        assert run.length.value == pytest.approx(true, abs=2.6 * run.length.u)
        assert run.length.u < 0.06 * true
        assert run.written == pytest.approx(run.length.value, rel=1e-6)  # three loads, three coefficients


def test_coefficients_are_within_their_uncertainty(found, truth):
    assert set(found.found) == {"LATERAL_STIFFNESS", "PCFY1", "PCFY2"}
    for name, q in found.found.items():
        assert q.value == pytest.approx(truth[name], abs=2.6 * q.u), name
    assert found.coverage.held == ("PCFY3",)
    assert "one pressure" in found.coverage.missing[0]


def test_one_load_determines_the_stiffness_only(campaign, truth):
    one = read(campaign).steps
    one = one.select(one.sweep == 1)
    assert set(relaxation(one, Simulation.of(truth, turn_slip=False), NONE_KNOWN).found) == {
        "LATERAL_STIFFNESS"
    }


def test_the_stiffness_follows_the_cornering_stiffness_of_the_fit(campaign, truth):
    """A relaxation length is cornering stiffness over carcass stiffness: 5 % in PKY1 are 5 % in LATERAL_STIFFNESS."""
    one = read(campaign).steps
    one = one.select(one.sweep == 1)
    u = 0.05 * abs(truth["PKY1"])
    found = relaxation(one, Simulation.of(truth, turn_slip=False), Posterior(("PKY1",), np.array([[u**2]])))
    alone = relaxation(one, Simulation.of(truth, turn_slip=False), NONE_KNOWN)
    q = found.found["LATERAL_STIFFNESS"]
    own = alone.found["LATERAL_STIFFNESS"].u
    assert q.u == pytest.approx(np.hypot(own, 0.05 * q.value), rel=1e-3)
    joint = Posterior(("PKY1",), np.array([[u**2]])).with_numbers(found.beside)
    assert joint.stderr["LATERAL_STIFFNESS"] == pytest.approx(q.u)
    best, random = {"PKY1": truth["PKY1"]}, np.random.default_rng(2)
    drawn = [found.beside.drawn({"PKY1": 1.1 * truth["PKY1"]}, best, random) for _ in range(300)]
    stiffness = np.array([row["LATERAL_STIFFNESS"] for row in drawn])
    assert np.mean(stiffness) == pytest.approx(1.1 * q.value, abs=4.0 * own / np.sqrt(300))
    assert np.std(stiffness) == pytest.approx(own, rel=0.15)


def test_steps_that_take_long_are_no_steps(campaign):
    """The same recordings with a steering that takes a second, one metre of rolling, from angle to angle."""
    series = [sweep for sweep in load(campaign).sweeps if sweep.is_series]
    slow = [replace(sweep, alpha=uniform_filter1d(sweep.alpha, 20)) for sweep in series]
    phi_t = {sweep.file: 0.0 for sweep in series}
    assert len(np.unique(steps(series, phi_t, 0.3185).sweep)) == 3
    assert steps(slow, phi_t, 0.3185) is None


def test_without_steps_the_result_says_what_to_run(truth):
    nothing = relaxation(None, Simulation.of(truth, turn_slip=False), NONE_KNOWN)
    assert not nothing.coverage.supported
    assert nothing.coverage.missing == (RUN,)
    assert not nothing.found
    assert relaxation_sentence(nothing) == ""


def test_correlated_residuals_count_as_fewer_and_white_ones_as_they_are():
    """The mean of a first-order process with correlation r has (1 + r) / (1 - r) times the variance of white noise."""
    white = np.random.default_rng(3).standard_normal(4000)
    assert _correlation(white) == pytest.approx(1.0, abs=0.1)
    assert _correlation(lfilter([1.0], [1.0, -0.8], white)) == pytest.approx(9.0, rel=0.25)


def test_the_sentence_gives_every_length_with_its_load(found):
    run = found.runs[0]
    said = f"{1e3 * run.length.value:.0f} +- {1e3 * run.length.u:.0f} mm at {run.load:.0f} N, "
    assert said in relaxation_sentence(found)
