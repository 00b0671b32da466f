"""Rig errors are separated from the tyre, with uncertainties that contain the truth."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_rigs import FY, MZ, SAMPLE, built, disc, flat, truth

import tir


@pytest.fixture(scope="module")
def misaligned(tmp_path_factory):
    """Half a degree of sideslip, camber and load cell within what the rig declares; a square camber axis."""
    content = disc(faults={"alpha_0_deg": 0.5, "gamma_0_deg": 0.4, "F0_N": 8.0})
    content["rig"] = content["rig"] | {"u_camber_skew_deg": 0.0}
    return built(content, tmp_path_factory.mktemp("misaligned"))


def test_the_misalignment_is_taken_off_the_angles(misaligned):
    """With its sign. Its sum with ply-steer is known, and each of them to 0.002 rad, the prior of ply-steer."""
    value, u = misaligned.fit.rig["alpha_0_deg"]
    assert misaligned.measured.misaligned
    sum_found = value + math.degrees(misaligned.fit.tyre["PHY1"])
    assert sum_found == pytest.approx(0.5 + math.degrees(truth()["PHY1"]), abs=0.03)
    assert value == pytest.approx(0.5, abs=2.0 * u)
    assert u == pytest.approx(math.degrees(0.002), rel=0.1)
    channels = misaligned.fit.channels
    assert channels["Fy"].rmse < 1.1 * FY
    assert channels["Mz"].rmse < 1.1 * MZ


def test_the_file_describes_the_aligned_tyre(misaligned):
    alpha = np.radians(np.linspace(-7.0, 7.0, 29))
    made, true = (tyre(1400.0, alpha, phi_t=-1 / 1.323, Vx=6.0) for tyre in (misaligned.fit.tyre, truth()))
    # Half a degree would be 190 N; the uncertainty from camber and load cell is some 15 N.
    assert np.max(np.abs(made.Fy - true.Fy)) < 40.0


def test_the_cornering_stiffness_without_spin_is_that_of_the_tyre_on_a_straight_path(misaligned):
    """On the disc it is 3 to 4 % smaller."""
    row, step = misaligned.measured.nominal, 1e-5

    def slope(phi_t):
        up, down = (truth()(1400.0, x, phi_t=phi_t, Vx=6.0, turn_slip=True).Fy for x in (step, -step))
        return float(up - down) / (2.0 * step)

    for found, true in ((row.C_alpha, slope(-1 / 1.323)), (row.C_alpha_straight, slope(0.0))):
        assert abs(found.value - true) < 3.0 * found.u
        assert found.u < 0.02 * abs(true)
    assert abs(row.C_alpha_straight.value) > 1.02 * abs(row.C_alpha.value)


def test_rig_errors_lie_within_their_uncertainties(misaligned):
    """PECP1 is held at the measured eps_gamma. A camber zero compensates for its error, so that the zero is as uncertain."""
    rig = misaligned.fit.rig
    for name, true in (("gamma_0_deg", 0.4), ("F0_N", 8.0), ("path_radius_m", 1.323)):
        value, u = rig[name]
        assert abs(value - true) < 2.5 * u, name


def test_the_camber_zero_is_as_uncertain_as_eps_gamma(misaligned):
    """F = r_e C_gamma / (R (1 - eps)) at zero moves by F u / (1 - eps), which a camber of r_e u / R (1 - eps)^2 compensates."""
    epsilon, r_e = misaligned.measured.epsilon_gamma, misaligned.measured.r_e.value
    hidden = math.degrees(r_e * epsilon.u / 1.323 / (1.0 - epsilon.value) ** 2)
    assert misaligned.fit.rig["gamma_0_deg"][1] == pytest.approx(hidden, rel=0.15)


def test_fitted_coefficients_scatter_about_the_truth_by_their_standard_errors(misaligned):
    """Some fifty pulls, many of them correlated; ply-steer is left out, because the misalignment is not separable from it."""
    coefficients, true = misaligned.fit.coefficients, truth()
    pulls = {
        name: (c.value - true[name]) / c.stderr
        for name, c in coefficients.items()
        if c.status == "fitted" and c.stderr and name not in ("PHY1", "Q_RE0")
    }
    assert len(pulls) > 40
    values = np.array(list(pulls.values()))
    assert 0.5 < np.sqrt(np.mean(values**2)) < 1.6
    assert np.max(np.abs(values)) < 4.0


def test_coefficients_that_few_points_do_not_determine_stay_near_the_base_file(misaligned):
    """A hundred points on one disc show how spin reduces stiffness and trail, but not the shape of every curve."""
    coefficients, base = misaligned.fit.coefficients, tir.read(SAMPLE / "base.tir")
    for name in ("PHYP1", "PHYP2", "PDYP3", "QCRP2", "QBRP1", "QDRP1"):
        found = coefficients[name]
        assert found.status == "regularised", name
        assert found.value == pytest.approx(base[name], rel=0.5), name
        assert 0.01 < found.stderr / abs(base[name]) < 1.1, name
    for name in ("PKYP1", "QDTP1"):
        assert coefficients[name].status == "fitted", name
    for name in ("PPY1", "PPY5", "PPZ1"):  # one pressure
        assert (coefficients[name].value, coefficients[name].status) == (base[name], "base")
    assert coefficients["PECP1"].status == "measured"
    assert coefficients["PECP1"].value == misaligned.measured.epsilon_gamma.value


def test_the_fit_of_a_misaligned_rig_reaches_the_noise(misaligned):
    channels = misaligned.fit.channels
    assert 0.7 * FY < channels["Fy"].rmse < 1.1 * FY
    assert 0.7 * MZ < channels["Mz"].rmse < 1.1 * MZ
    assert {"F0_N", "gamma_0_deg", "alpha_0_deg", "path_radius_m"} <= set(misaligned.fit.rig)


def test_coefficients_of_which_only_a_combination_is_determined_name_each_other(misaligned):
    told = {n: c for n, c in misaligned.fit.coefficients.items() if c.correlated_with}
    assert told
    for name, found in told.items():
        assert found.correlated_with != name
        assert 0.95 < abs(found.correlation) <= 1.0
    # Where the stiffness peaks and how high it is are hardly separable over loads that all lie below the peak.
    assert told["PKY2"].correlated_with in ("PKY1", "PKY4")


def test_rolling_resistance_comes_from_the_measured_moment(misaligned):
    found = misaligned.fit.coefficients["QSY1"]
    assert abs(found.value - truth()["QSY1"]) < 2.0 * found.stderr
    assert (
        found.stderr < 0.15 * truth()["QSY1"]
    )  # the zero of My is uncertain by 5 Nm, as much as the moment itself
    assert misaligned.fit.tyre["QSY1"] != misaligned.fit.tyre["QSY2"]
    assert misaligned.fit.coefficients["QSY1"].status == "fitted"


def test_without_a_measured_moment_rolling_resistance_stays_an_estimate(tmp_path):
    content = flat(noise={"Fy_N": FY, "Mz_Nm": MZ})
    result = built(content, tmp_path)
    assert result.fit.coefficients["QSY1"].status != "fitted"
