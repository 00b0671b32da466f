"""Relaxation lengths from steps of the sideslip angle and of slip."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import uniform_filter1d
from scipy.signal import lfilter

import tir
from mffit import as_json
from mffit import config as configuration
from mffit.fit.beside import with_beside
from mffit.fit.relaxation import (
    DIRECTIONS,
    StepLength,
    _fitted,
    _Noise,
    relaxation,
)
from mffit.numbers import Numbers
from mffit.points import Points
from mffit.points.loading import read
from mffit.points.points import make_points
from mffit.points.steps import steps
from mffit.rig import Simulation
from mffit.sweeps import load
from tir import Quantity

SAMPLE = Path(__file__).parents[3] / "samples" / "flat-track-combined"
NONE_KNOWN = Numbers.of((), (), np.zeros((0, 0)))
UNKNOWN = {
    "LATERAL_STIFFNESS": 300e3, "PCFY1": 0.0, "PCFY2": 0.0, "PCFY3": 0.0,
    "LONGITUDINAL_STIFFNESS": 800e3, "PCFX1": 0.0, "PCFX2": 0.0, "PCFX3": 0.0,
}  # fmt: skip
SIDEWAYS, SLIP = range(2)


@pytest.fixture(scope="module")
def campaign():
    """The sample's steps of sideslip and of slip, at three loads and at another pressure."""
    config = configuration.load(SAMPLE / "tyre.toml")
    kept = [sweep for sweep in config.sweep if "steps" in sweep.file or sweep.file == "rolling.csv"]
    return config.model_copy(update={"sweep": tuple(kept)})


@pytest.fixture(scope="module")
def recorded(campaign):
    return read(campaign).steps


@pytest.fixture(scope="module")
def truth() -> tir.Tyre:
    return tir.read(SAMPLE / "true.tir")


@pytest.fixture(scope="module")
def found(recorded, truth):
    """The tyre is known but for its carcass, and the rig has its errors."""
    return relaxation(recorded, Simulation.of(truth.replace(**UNKNOWN), turn_slip=False), NONE_KNOWN)


@pytest.mark.parametrize("direction", [SIDEWAYS, SLIP])
def test_the_relaxation_length_is_that_of_the_tyre_at_every_load(found, truth, direction):
    assert len(found[direction].runs) == 4
    for run in found[direction].runs:
        true = float(getattr(truth.state(run.load, p=run.pressure), ("sigma_y", "sigma_x")[direction]))
        assert run.length.value == pytest.approx(true, abs=2.6 * run.length.u)
        assert run.length.u < 0.15 * true
        assert run.written == pytest.approx(run.length.value, rel=1e-6)  # as many coefficients as runs


@pytest.mark.parametrize(
    ("direction", "names"),
    [
        (SIDEWAYS, {"LATERAL_STIFFNESS", "PCFY1", "PCFY2", "PCFY3"}),
        (SLIP, {"LONGITUDINAL_STIFFNESS", "PCFX1", "PCFX2", "PCFX3"}),
    ],
)
def test_coefficients_are_within_their_uncertainty(found, truth, direction, names):
    assert set(found[direction].found) == names
    for name, q in found[direction].found.items():
        assert q.value == pytest.approx(truth[name], abs=2.6 * q.u), name


def test_what_is_held_and_why(recorded, truth, found):
    alpha = recorded["alpha"]
    usual = {"alpha": alpha.select(np.isclose(alpha.p, 240e3))}
    sideways = relaxation(usual, Simulation.of(truth, turn_slip=False), NONE_KNOWN)[SIDEWAYS]
    assert sideways.coverage.held == ("PCFY3",)
    assert "one pressure" in sideways.coverage.missing[0]
    assert found[SLIP].coverage.missing == ()


def test_the_json_has_both_directions(found):
    written = {**as_json.document(found[SIDEWAYS]), "slip": as_json.document(found[SLIP])}
    assert [round(run["load_N"], -2) for run in written["runs"]] == [2000, 4200, 6500, 4200]
    assert [round(run["p_kPa"], -1) for run in written["runs"]] == [240, 240, 240, 280]
    assert written["runs"][0]["sigma_y_m"] == found[SIDEWAYS].runs[0].length.value
    assert len(written["slip"]["runs"]) == 4
    assert written["slip"]["runs"][0]["sigma_x_m"] == found[SLIP].runs[0].length.value
    assert written["slip"]["missing"] is None


def test_offset_and_gain_of_a_run_do_not_matter(recorded, truth, found):
    shifted = {"kappa": recorded["kappa"].replace(Fx=1.3 * recorded["kappa"].Fx + 70.0)}
    again = relaxation(shifted, Simulation.of(truth.replace(**UNKNOWN), turn_slip=False), NONE_KNOWN)[SLIP]
    for run, other in zip(found[SLIP].runs, again.runs, strict=True):
        assert other.length[:2] == pytest.approx(run.length[:2], rel=1e-3)


def test_a_tyre_that_is_not_round_does_not_matter(recorded, truth, found):
    samples = recorded["kappa"]
    speed = (1.0 + samples.kappa) * samples.V / np.array([float(truth.state(x).Re) for x in samples.Fz])
    uneven = samples.replace(omega=speed, Fx=samples.Fx + 60.0 * np.cos(speed.cumsum() / 20.0))
    again = relaxation(
        {"kappa": uneven}, Simulation.of(truth.replace(**UNKNOWN), turn_slip=False), NONE_KNOWN
    )
    for run, other in zip(found[SLIP].runs, again[SLIP].runs, strict=True):
        assert other.length.value == pytest.approx(run.length.value, abs=run.length.u)


@pytest.fixture
def one_run(recorded):
    return {"alpha": recorded["alpha"].select(recorded["alpha"].sweep == 1)}


def test_one_load_determines_the_stiffness_only(one_run, truth):
    sideways, slip = relaxation(one_run, Simulation.of(truth, turn_slip=False), NONE_KNOWN)
    assert set(sideways.found) == {"LATERAL_STIFFNESS"}
    assert not slip.found


def test_the_stiffness_follows_the_cornering_stiffness_of_the_fit(one_run, truth):
    """A relaxation length is cornering stiffness over carcass stiffness: 5 % in PKY1 are 5 % in LATERAL_STIFFNESS."""
    u = 0.05 * abs(truth["PKY1"])
    tyre = Simulation.of(truth, turn_slip=False)
    found = relaxation(one_run, tyre, Numbers.of(("PKY1",), [truth["PKY1"]], np.array([[u**2]])))[SIDEWAYS]
    alone = relaxation(one_run, tyre, NONE_KNOWN)[SIDEWAYS]
    q = found.found["LATERAL_STIFFNESS"]
    own = alone.found["LATERAL_STIFFNESS"].u
    assert q.u == pytest.approx(np.hypot(own, 0.05 * q.value), rel=1e-3)
    joint = with_beside(Numbers.of(("PKY1",), [truth["PKY1"]], np.array([[u**2]])), found.beside)
    assert joint.stderr["LATERAL_STIFFNESS"] == pytest.approx(q.u)
    assert joint.given(["PKY1"]).stderr["LATERAL_STIFFNESS"] == pytest.approx(own)
    assert joint.covariance[0, 1] / u**2 == pytest.approx(q.value / truth["PKY1"], rel=1e-3)


@pytest.mark.parametrize("setting", ["alpha", "kappa"])
def test_steps_that_take_long_are_no_steps(campaign, setting):
    """The same recordings with a rig that takes a second, one metre of rolling, from value to value."""
    series = [sweep for sweep in load(campaign).sweeps if sweep.is_series]
    slow = [replace(sweep, **{setting: uniform_filter1d(getattr(sweep, setting), 20)}) for sweep in series]
    phi_t = {sweep.file: 0.0 for sweep in series}
    assert len(np.unique(steps(series, phi_t, 0.3185)[setting].sweep)) == 4
    assert setting not in steps(slow, phi_t, 0.3185)


def test_a_run_with_a_time_twice_has_no_rolled_distance_and_so_no_steps(campaign):
    series = [sweep for sweep in load(campaign).sweeps if sweep.is_series]
    twice = [replace(sweep, time=np.r_[sweep.time[:1], sweep.time[:-1]]) for sweep in series]
    phi_t = {sweep.file: 0.0 for sweep in series}
    assert steps(series, phi_t, 0.3185)
    assert not steps(twice, phi_t, 0.3185)


def test_steps_of_slip_at_sideslip_show_no_length_of_straight_running(campaign):
    series = [sweep for sweep in load(campaign).sweeps if sweep.is_series]
    steered = [replace(sweep, alpha=sweep.alpha + np.radians(2.0)) for sweep in series]
    assert "kappa" not in steps(steered, {sweep.file: 0.0 for sweep in series}, 0.3185)


def test_without_steps_the_result_says_what_to_run(truth):
    nothing = relaxation({}, Simulation.of(truth, turn_slip=False), NONE_KNOWN)
    for one, direction in zip(nothing, DIRECTIONS, strict=True):
        assert not one.coverage.supported
        assert one.coverage.missing == (direction.run,)
        assert one.coverage.held == direction.names


def test_what_readings_remember_is_taken_off_their_noise():
    """Of a first-order process what is new has the variance 1 - r^2 of the whole."""
    white = np.random.default_rng(3).standard_normal(4000)
    red = lfilter([1.0], [1.0, -0.8], white)
    noise = _Noise.of(red, 0)
    assert noise.memory == pytest.approx([0.8], abs=0.05)
    assert noise.size == pytest.approx(np.std(white), rel=0.02)
    assert np.std(noise.whitened(red)) == pytest.approx(1.0, rel=0.01)


def instant_steps(truth: tir.Tyre, rate: float, random: np.random.Generator) -> Points:
    """Samples of the response sigma alpha'' + alpha' = alpha in closed form, each step done in no time between two samples."""
    load, V, hold = truth["FNOMIN"], 1.0, 2.0
    sigma = float(truth.state(load).sigma_y)
    time = np.arange(0.0, 5.0 * hold, 1.0 / rate)
    read = follows = np.zeros(len(time))
    for k, size in enumerate((1.0, -1.0, -1.0, 1.0), 1):
        since = time - (k * hold + random.uniform(0.0, 1.0 / rate))
        read = read + np.where(since >= 0.0, size, 0.0)
        follows = follows + np.where(since >= 0.0, -size * np.expm1(-V * np.maximum(since, 0.0) / sigma), 0.0)
    one = np.ones(len(time))
    Fy = np.asarray(truth(load, alpha=np.radians(follows), turn_slip=False).Fy)
    return make_points(
        np.radians(read), 0.0 * one, load * one, sweep_names=("steps",), files=("steps.csv",), phi_t=0.0, time=time,
        continuous=True, p=truth["NOMPRES"] * one, V=V * one, kappa=0.0 * one,
        Fy=Fy + 5.0 * random.standard_normal(len(time)), direction=one.astype(int), line=np.arange(len(time)) + 2,
    )  # fmt: skip


@pytest.mark.parametrize(("rate", "draws"), [(20, 16), (50, 12), (100, 8), (1000, 2)])
def test_steps_that_end_between_two_samples_give_the_length_within_its_uncertainty(truth, rate, draws):
    """When within the sample they moved is not read; taken for a ramp from sample to sample, lengths are 15 u off."""
    random = np.random.default_rng(8)
    stiffness = float(truth["LATERAL_STIFFNESS"])
    unknown = Simulation.of(truth.replace(LATERAL_STIFFNESS=2.0 * stiffness), turn_slip=False)
    pulls = []
    for _ in range(draws):
        (run,) = relaxation({"alpha": instant_steps(truth, rate, random)}, unknown, NONE_KNOWN)[SIDEWAYS].runs
        pulls.append((run.length.value - float(truth.state(run.load).sigma_y)) / run.length.u)
    assert np.max(np.abs(pulls)) < 3.5
    assert np.mean(np.abs(pulls) < 1.96) > 0.8


def test_runs_that_scatter_beyond_their_errors_widen_the_uncertainty(truth):
    """Three stiffnesses known to 1 %, 10 % apart: their mean is known by that scatter over the root of three."""
    C = 2e5 * np.array([0.9, 1.0, 1.1])
    at = (float(truth["FNOMIN"]), float(truth["NOMPRES"]), Quantity(0.1, 0.001, "m"))
    runs = [StepLength("steps.csv", *at, Quantity(x, 2e3, "N/m")) for x in C]
    found = _fitted(DIRECTIONS[0], ["LATERAL_STIFFNESS"], (), truth.values, runs, NONE_KNOWN)
    (u,) = np.sqrt(np.diag(found.covariance))
    assert u == pytest.approx(np.std(C, ddof=1) / np.sqrt(3), rel=0.01)
