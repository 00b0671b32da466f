"""Effects that were found become coefficients, corrected readings, or terms beside the file."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from blind_rig import USUAL_TEMPERATURE, Machine, report
from blind_scores import loaded
from blind_set import draw_case

import tir
from mffit import parts
from mffit.diagnosis import corrected_points, diagnose
from mffit.diagnosis.result import Diagnosis
from mffit.measured import measure
from mffit.rig import Simulation
from mffit.rig_errors import Faults

FAULTS = Faults(
    alpha_0_deg=0.3, gamma_0_deg=-0.6, gain=1.03, F0_N=-12.0, crosstalk=0.01, M0_Nm=0.8, k_T_per_K=0.001, k_V_per_mps=0.004,
    k_t_per_s=1e-6,
)  # fmt: skip
SAME_FAULTS = Machine(
    alpha_0_deg=0.3,
    gamma_0_deg=-0.6,
    gain=1.03,
    F0=-12.0,
    crosstalk=0.01,
    M0=0.8,
    k_T=0.001,
    k_V=0.004,
    k_t=1e-6,
)


def test_a_tyre_effect_becomes_a_coefficient_with_its_reason(stiffer_camber, camber, tmp_path):
    case, found = stiffer_camber[0], camber
    value, error = found.effects[0].parameters["PKY6"]
    assert value == pytest.approx(float(case.true["PKY6"]), abs=5.0 * error)
    found.tyre.write(tmp_path / "after.tir")
    after = tir.read(tmp_path / "after.tir")
    assert after["PKY6"] == pytest.approx(value, rel=1e-6)
    assert "camber stiffness" in after.status["PKY6"]
    assert all(after[name] == case.given[name] for name in case.given.values if name != "PKY6")


def test_corrections_undo_the_faults(right_model):
    """Readings of the tests' own faulty rig, corrected, are the readings of that rig without faults."""
    case, _, points = right_model
    Fy, Mz = report(case.true, SAME_FAULTS, case.run)
    state = Simulation(dict(case.true.values), FAULTS.replace(T_ref_degC=USUAL_TEMPERATURE), True, False)
    corrected = corrected_points(points.replace(Fy=Fy, Mz=Mz), state)
    clean_Fy, clean_Mz = report(case.true, Machine(), case.run)
    assert corrected.Fy == pytest.approx(clean_Fy, abs=1e-6)
    assert corrected.Mz == pytest.approx(clean_Mz, abs=1e-6)
    assert corrected.phi_t == pytest.approx(points.phi_t)


def test_an_environment_effect_leaves_the_file_unchanged(tmp_path):
    case = draw_case("warm", ("temperature",), "large", 21)
    config, points = loaded(case, tmp_path)
    found = diagnose(points, case.given, config)
    assert [f.effect.id for f in found.effects] == ["temperature"]
    value, error = found.effects[0].parameters["k_T_per_K"]
    assert value == pytest.approx(case.machine.k_T, abs=5.0 * error)
    assert found.tyre.values == case.given.values


def test_misaligned_wheel_of_the_paper_is_named_and_eps_gamma_restored(tmp_path):
    """Mottola and Massaro 2022, section 5: half a degree or one to either side ruins eps_gamma; backward runs reveal it."""
    misalignment = 0.5
    case = _with_misalignment(draw_case("paper", (), "large", 31), misalignment)
    config, points = loaded(case, tmp_path)
    found: Diagnosis = diagnose(points, case.given, config)
    assert found.effects[0].effect.id == "sideslip-misalignment"
    assert not found.effects[0].tied_with
    assert found.faults["alpha_0_deg"] == pytest.approx(misalignment, abs=0.02)
    forward = points.select(points.direction > 0)

    def eps_gamma(chosen):
        return measure(config, chosen, parts.split(chosen), case.given).epsilon_gamma

    true = _true_eps_gamma(case)
    restored = eps_gamma(corrected_points(forward, found.state))
    assert restored.value == pytest.approx(true, abs=2.5 * restored.u)
    # without the backward runs and without the correction, alpha_M goes into the turn-slip force unseen
    assert abs(eps_gamma(forward).value - true) > 0.2


def _with_misalignment(case, alpha_0_deg):
    machine = case.machine.with_faults({"alpha_0_deg": alpha_0_deg})
    noise = np.random.default_rng(5)
    Fy, Mz = report(case.true, machine, case.run)
    return replace(
        case,
        machine=machine,
        Fy=Fy + noise.normal(0.0, 6.0, len(Fy)),
        Mz=Mz + noise.normal(0.0, 0.6, len(Mz)),
    )


def _true_eps_gamma(case):
    """eps_gamma by (17) from slopes at zero at the nominal load."""
    load, step = float(case.true["FNOMIN"]), 1e-6
    forces = [
        [float(case.true(load, gamma=g, phi_t=p, Vx=6.0, turn_slip=True).Fy) for g, p in ((s, 0.0), (0.0, s))]
        for s in (step, -step)
    ]
    C_gamma, C_phit = ((up - down) / (2.0 * step) for up, down in zip(*forces, strict=True))
    r_e = float(case.true.state(load, Vx=6.0).Re)
    return 1.0 + r_e * C_gamma / C_phit
