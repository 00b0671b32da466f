"""The fit on simulated rigs with known truth; the study over many rigs is tests/studies/recovery_study.py."""

from __future__ import annotations

import numpy as np
import pytest
from drawn_rigs import SAMPLE, model_error, one_rig, plan_content

import mffit
import tir
from mffit import virtual_rig
from mffit.fit.priors import scatter
from tir.parameters import BY_NAME


@pytest.fixture(scope="module")
def sound_rig(tmp_path_factory):
    """A build from a rig without faults, declared as such, and with noise as declared."""
    content = plan_content()
    content["faults"] = {}
    content["rig"] |= {
        "backlash_deg": 0.0, "u_loadcell_offset_N": 0.5, "u_camber_alignment_deg": 0.02,
    }  # fmt: skip
    folder = tmp_path_factory.mktemp("rig")
    virtual_rig.simulate(virtual_rig.load_plan(content, folder=SAMPLE), folder, seed=5)
    return mffit.build(folder / "tyre.toml")


def test_residuals_are_the_noise(sound_rig):
    channels = sound_rig.fit.channels
    assert channels["Fy"].rmse < 1.15 * 6.0
    assert channels["Mz"].rmse < 1.25 * 0.6


@pytest.mark.parametrize(("phi_t", "Fy", "Mz"), [(-1 / 1.323, 5.5, 0.6), (0.0, 8.0, 1.0)])
def test_the_model_agrees_with_the_truth_between_the_points(sound_rig, phi_t, Fy, Mz):
    error = model_error(
        sound_rig.fit.tyre, tir.read(SAMPLE / "true.tir"), phi_t, np.array([900.0, 1400.0, 2000.0])
    )
    assert error[0] < Fy
    assert error[1] < Mz


def test_eps_gamma_is_recovered(sound_rig):
    measured = sound_rig.measured.epsilon_gamma
    assert abs(measured.value + 0.115) < min(2 * measured.u, 0.05)
    assert sound_rig.fit.tyre["PECP1"] == pytest.approx(-0.115, abs=0.05)


def test_debiased_is_the_direct_method_less_its_error_on_noise_free_readings(sound_rig):
    measured = sound_rig.measured
    # A rig without faults: what is left of the bias is the noise of zeros and camber sweep.
    assert measured.epsilon_gamma_debiased.value == pytest.approx(-0.115, abs=2 * measured.epsilon_gamma.u)
    assert measured.epsilon_gamma_debiased.value != measured.epsilon_gamma.value
    # The bias is an uncertainty of the measured value, not of the one without it.
    bias = measured.epsilon_gamma.value - measured.epsilon_gamma_debiased.value
    assert measured.epsilon_gamma.u == pytest.approx(np.hypot(measured.epsilon_gamma_debiased.u, bias))


def test_the_prior_is_thirty_per_cent_and_at_least_a_share_of_the_bounds():
    """A twentieth around a base file's value, a tenth around a default; a base file's 0 counts as a default."""
    assert scatter("PKY1", -18.0, from_base=True, curved=True) == pytest.approx(5.4)
    width = BY_NAME["PPY2"].width
    assert scatter("PPY2", 0.0, from_base=True, curved=True) == pytest.approx(0.1 * width)
    assert scatter("PPY2", 0.01, from_base=True, curved=True) == pytest.approx(0.05 * width)
    assert scatter("PPY2", 0.01, from_base=False, curved=True) == pytest.approx(0.1 * width)
    # Public files have PVX2 of -0.036 to 0.023, most below 0.003, and RBX3 of 2 to 3247, far outside of the usual range.
    for from_base in (True, False):
        assert 0.001 < scatter("PVX2", 0.0, from_base=from_base, curved=False) < 0.01
        assert 186.0 < scatter("RBX3", 0.0, from_base=from_base, curved=False) < 3247.0


def test_ply_steer_is_small_on_a_disc_and_free_on_a_straight_path():
    assert scatter("PHY1", 0.0, from_base=True, curved=True) == 0.002
    assert scatter("PHY1", 0.0, from_base=True, curved=False) == pytest.approx(0.1 * BY_NAME["PHY1"].width)


def test_pecp1_of_the_model_gives_the_measured_turn_slip_force(sound_rig):
    measured = sound_rig.measured
    forces = [
        sound_rig.fit.tyre(measured.nominal.load, phi_t=-1 / 1.323, Vx=speed, p=250e3).Fy
        for speed in (6.0, -6.0)
    ]
    # The zeros count with their noise, beside all other points: the model need not pass through them.
    assert np.mean(forces) == pytest.approx(measured.F_phit.value, abs=2.0 * measured.F_phit.u)


def test_the_files_radius_is_the_measured_one(sound_rig):
    assert len(sound_rig.measured.r_e_loads) == len(plan_content()["rolling_radius"]) > 0
    for load, r_e in sound_rig.measured.r_e_loads.items():
        assert sound_rig.fit.written.state(load, Vx=6.0).Re == pytest.approx(r_e, abs=1e-4)


def test_errors_of_a_drawn_rig_stay_within_their_intervals():
    draw = one_rig(101)
    pulls = np.array([*draw.pulls.values()])
    assert len(pulls) > 60
    assert np.mean(np.abs(pulls) < 1.96) > 0.8
    # Many of them are correlated: intervals half or twice as wide as they should be give 2 or 0.5.
    assert 0.6 < np.sqrt(np.mean(np.square(pulls))) < 1.5
    assert all(misfit < 1.15 for misfit in draw.misfit.values())
    assert np.mean([band.inside for band in draw.bands.values()]) > 0.7
