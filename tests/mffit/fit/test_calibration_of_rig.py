"""What the calibration of a rig and the give of its steering leave uncertain in a build."""

from __future__ import annotations

import pytest
import small_rigs

GAINS = {"gain": 1.012, "gain_alpha": 0.995, "gain_Fz": 0.992}
DECLARED = {"u_Fy_gain": 0.01, "u_alpha_gain": 0.005, "u_Fz_gain": 0.01}
GIVE = "compliance_deg_per_Nm"


def built(folder, faults, **declared):
    plan = small_rigs.disc(faults=faults)
    plan["rig"] |= declared
    return small_rigs.built(plan, folder)


def pull(build, name):
    row = build.fit.coefficients[name]
    return abs(row.value - small_rigs.truth()[name]) / row.stderr


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory):
    return built(tmp_path_factory.mktemp("calibrated"), GAINS, **DECLARED)


def test_coefficients_are_no_better_known_than_the_rig_is_calibrated(calibrated):
    """A load that reads 0.8 % high and a force that reads 1.2 % high are 2 % of grip."""
    row = calibrated.fit.coefficients["PDY1"]
    assert row.value / small_rigs.truth()["PDY1"] == pytest.approx(1.012 * 0.992, abs=0.008)
    assert row.stderr > 0.01 * row.value
    assert all(pull(calibrated, name) < 2.0 for name in ("PKY1", "PDY1", "PKY6"))
    assert not any("gain" in name for name in calibrated.fit.rig)


def test_a_new_reading_on_the_rig_is_better_known_than_the_force_of_the_tyre(calibrated):
    conditions = {"alpha_deg": [6.0], "gamma_deg": [0.0], "Fz_N": [1400.0]}
    import pandas as pd

    found = calibrated.prediction.predict(calibrated.tyre, calibrated.tyre, pd.DataFrame(conditions)).iloc[0]
    assert found["u_Fy_best_N"] > 0.01 * abs(found["Fy_N"])
    assert found["u_Fy_run_N"] < 0.5 * found["u_Fy_best_N"]


def test_a_declared_compliance_of_the_steering_is_found_and_an_undeclared_one_is_not_trusted(tmp_path):
    declared = built(tmp_path / "declared", {GIVE: 0.006}, u_steering_compliance_deg_per_Nm=0.005)
    value, u = declared.fit.rig[GIVE]
    assert declared.trusted
    assert abs(value - 0.006) < 2.5 * u < 0.003
    assert pull(declared, "PKY1") < 2.5
    silent = built(tmp_path / "silent", {GIVE: 0.006})
    assert pull(silent, "PKY1") > 4.0
    (reason,) = silent.trust.reasons
    assert "compliance of the steering axis" in reason
    assert "u_steering_compliance_deg_per_Nm" in reason
