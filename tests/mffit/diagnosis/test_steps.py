"""Every step of a diagnosis can be used alone."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.diagnosis import gap
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.selection import contest
from mffit.diagnosis.stated import stated_noise
from mffit.diagnosis.ties import separation
from mffit.diagnosis.validation import validate
from mffit.diagnosis.where import where
from mffit.effects import CATALOG
from mffit.rig import Simulation
from mffit.rig_errors import Faults

BY_ID = {effect.id: effect for effect in CATALOG}


def problem(case, points):
    state = Simulation(dict(case.given.values), Faults(), True, False)
    return DiagnosisProblem(points, state, stated_noise(points))


def test_a_right_model_leaves_one_chi2_per_reading(right_model):
    case, _, points = right_model
    chosen = problem(case, points)
    found = gap(chosen.measured - chosen.start.predict(points), chosen.noise)
    # 780 readings: the standard deviation of chi2 per reading is sqrt(2/780) = 0.05
    assert found.chi2_per_dof == pytest.approx(1.0, abs=0.2)
    assert found.rms("Fy") == pytest.approx(6.0, rel=0.15)


def test_noise_has_hardly_a_significant_region(right_model):
    case, _, points = right_model
    chosen = problem(case, points)
    assert len(where(points, chosen.measured - chosen.start.predict(points), chosen.noise)) <= 1


def test_a_shifted_region_is_found_with_its_size(right_model):
    case, _, points = right_model
    chosen = problem(case, points)
    residual = chosen.measured - chosen.start.predict(points)
    leaned = np.degrees(points.gamma) > 15.0
    residual[: len(points)][leaned] += 30.0
    first = where(points, residual, chosen.noise)[0]
    assert first.channel == "Fy"
    assert first.region["gamma_deg"][0] >= 15.0
    assert first.bias == pytest.approx(30.0, abs=8.0)
    assert first.z > 5.0


def test_a_contest_ranks_the_hidden_effect_first(stiffer_camber):
    case, _, points = stiffer_camber
    chosen = problem(case, points)
    step = contest(chosen, chosen.null, [BY_ID[i] for i in ("camber-grip", "camber-stiffness", "load-grip")])
    assert step.best.effects[-1].id == "camber-stiffness"
    assert step.gain > step.threshold
    assert step.weights()["camber-stiffness"] > 0.99


def test_left_out_sweeps_confirm_a_true_effect(stiffer_camber):
    case, _, points = stiffer_camber
    chosen = problem(case, points)
    fitted = chosen.fit((BY_ID["camber-stiffness"],))
    checked = validate(chosen, fitted)
    assert checked.gap_after.chi2_per_dof < checked.gap_before.chi2_per_dof
    assert checked.gap_after.chi2_per_dof == pytest.approx(1.0, abs=0.2)


def test_the_flipped_mount_separates_conicity_from_a_load_cell(right_model):
    """The proposed run is computed from the refitted explanations and must separate them."""
    case, config, points = right_model
    chosen = problem(case, points)
    conical = chosen.start.with_numbers({"PVY1": float(case.given["PVY1"]) + 0.004})
    predicted = conical.predict(points)
    n = len(points)
    tilted = problem(case, points.replace(Fy=predicted[:n], Mz=predicted[n:]))
    a, b = (tilted.fit((BY_ID[i],)) for i in ("conicity", "crosstalk-fz-fy"))
    best = separation(config, points, a, b, {"Fy": 6.0, "Mz": 0.6})
    assert best.chi2 > 9.0
    assert "with the tyre turned on its rim" in best.run
