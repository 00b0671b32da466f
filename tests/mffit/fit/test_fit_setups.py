"""A rig that was set up twice: the fit finds the zeros of each set-up, and no one blames the tyre for their difference."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from plain_pages import without_pictures
from small_rigs import FY, MZ, SAMPLE, disc, simulated, truth

import mffit
import tir
from mffit.diagnosis import wording
from mffit.effects import CATALOG
from mffit.fit.rig.rig_numbers import rig_numbers
from mffit.pipeline.build_output import points_table
from mffit.pipeline.provenance import rig_of_build
from mffit.pipeline.refining import finite_spin_bias
from mffit.quantities import SIDEWAYS
from mffit.report.text import build_explained, spin_summary
from mffit.rig import Simulation
from mffit.rig_errors import ZEROS, number_of

FAULTS = {
    "left": {"F0_N": 8.0, "alpha_0_deg": 0.05, "gamma_0_deg": 0.5},
    "right": {"F0_N": -9.0, "alpha_0_deg": -0.08, "gamma_0_deg": -0.4, "M0_Nm": 0.8},
}
NAMES = [number_of(error.name, setup) for error in ZEROS if error.shows_in(SIDEWAYS) for setup in FAULTS]


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """Two loads on both sides of the disc, the rig set up anew in between."""
    content = disc((900, 1400), setup=FAULTS)
    other = [
        {**sweep, "file": f"right_{sweep['file']}", "path_centre": "right"} for sweep in content["sweep"]
    ]
    content["sweep"] = content["sweep"] + other
    folder = tmp_path_factory.mktemp("set-ups")
    known = simulated(content, folder)
    assert known.faults_of_setups["right"]["F0_N"] == -9.0
    return folder


@pytest.fixture(scope="module")
def result(project):
    with without_pictures():
        return mffit.build(project / "tyre.toml", out=project / "out")


def test_every_set_up_has_zeros_of_its_own_and_the_misfit_is_the_noise(result):
    rig = result.fit.rig
    assert set(NAMES) < set(rig)
    assert not {error.name for error in ZEROS} & set(rig)
    for setup, faults in FAULTS.items():
        for name in ("F0_N", "gamma_0_deg"):
            value, u = rig[number_of(name, setup)]
            assert abs(value - faults[name]) < 3.0 * u
    assert result.fit.channels["Fy"].rmse < 1.15 * FY
    assert result.fit.channels["Mz"].rmse < 1.15 * MZ
    assert not result.fit.doubts


def test_what_is_common_to_the_set_ups_is_the_tyres_and_what_differs_is_the_rigs(result):
    """Ply-steer adds to both sideslip zeros, residual torque to both zeros of Mz; the difference is known well."""
    for name, differs in (("alpha_0_deg", 0.13), ("M0_Nm", -0.8)):
        (a, b), names = ([result.fit.rig[number_of(name, s)][0] for s in FAULTS], result.fit.posterior.names)
        rows = [names.index(number_of(name, s)) for s in FAULTS]
        C = result.fit.posterior.covariance[np.ix_(rows, rows)]
        u = np.sqrt(C[0, 0] + C[1, 1] - 2.0 * C[0, 1])
        assert abs(a - b - differs) < 3.5 * u
        if name == "alpha_0_deg":
            assert u < 0.2 * np.sqrt(C[0, 0] + C[1, 1])


def test_json_and_property_file_hold_the_zeros_by_set_up(result, project):
    written = json.loads((project / "out" / "result.json").read_text())
    assert written["fit"]["rig"]["alpha_0_deg@left"]["unit"] == "deg"
    assert {row["setup"] for row in written["spin"]["setups"]} == set(FAULTS)
    assert written["spin"]["setup_scatter"] is None  # no path was run in two set-ups
    found = rig_of_build(tir.read(project / "out" / "small.tir"))
    assert {n: found[n] for n in NAMES} == pytest.approx({n: result.fit.rig[n][0] for n in NAMES}, rel=1e-5)
    page = (project / "out" / "report.html").read_text(encoding="utf-8")
    assert "Set-ups of the rig" in page


def test_a_reading_of_a_new_set_up_lies_off_by_its_zeros(result, project):
    """At zero these are the declared ones alone, load cell, sideslip and camber, and what a new run has in any case."""
    asked = pd.DataFrame({"alpha_deg": [0.0], "gamma_deg": [0.0], "Fz_N": [1400.0], "phi_t_per_m": [0.0]})
    found = mffit.predict(project / "out", asked).iloc[0]
    rig, C_gamma = result.config.rig, result.measured.C_gamma.value
    force_of_camber = C_gamma * np.radians(rig.u("gamma_0_deg"))
    zeros = math.hypot(rig.u("F0_N"), rig.u("alpha_0_deg"), force_of_camber)
    assert 0.95 * zeros < found.u_Fy_setup_N < 1.05 * math.hypot(zeros, found.u_Fy_run_N)
    assert found.u_Fy_setup_N > 2.0 * found.u_Fy_best_N


def test_derivatives_by_the_zeros_of_a_set_up_are_exact_and_only_its_own(result):
    points = result.points
    sim = result.fit.simulation
    slopes = sim.sensitivities(points, NAMES)[1]
    for k, name in enumerate(NAMES):
        step = 1e-4
        up, down = (
            sim.with_numbers({name: sim.number(name, points) + s}).readings(points) for s in (step, -step)
        )
        for channel in ("Fy", "Mz"):
            numeric = (getattr(up, channel) - getattr(down, channel)) / (2.0 * step)
            exact = getattr(slopes, channel)[:, k]
            assert exact == pytest.approx(numeric, rel=1e-4, abs=1e-4 * np.max(np.abs(numeric)) + 1e-9)
            elsewhere = points.setup != points.setups.index(name.partition("@")[2])
            assert not np.any(exact[elsewhere])


def test_a_right_file_is_not_blamed_for_the_zeros(project):
    """Three zeros differ in either set-up, within what is declared: 30 N of misfit, and nothing wrong with the tyre."""
    found = mffit.diagnose(project / "tyre.toml", SAMPLE / "true.tir", out=project / "diagnosis")
    assert not found.effects
    assert not found.unexplained
    assert found.gap_before.rms("Fy") > 5.0 * FY
    assert found.gap_after.rms("Fy") < 1.1 * FY
    assert "with the zeros of every set-up" in found.headline
    assert found.tyre["PKY6"] == truth()["PKY6"]
    zeros = {n: v for n, (v, _) in found.coefficients.items()}
    assert zeros["F0_N@left"] == pytest.approx(8.0, abs=2.0)
    assert zeros["M0_Nm@right"] == pytest.approx(0.8, abs=0.1)


def test_a_zero_far_beyond_its_declaration_is_named_in_its_set_up(tmp_path):
    """0.6 deg of sideslip in one of two set-ups, declared to about 0.08 deg."""
    content = disc((1400,), setup={"right": {"alpha_0_deg": 0.6}})
    other = [
        {**sweep, "file": f"right_{sweep['file']}", "path_centre": "right"} for sweep in content["sweep"]
    ]
    content["sweep"] = content["sweep"] + other
    simulated(content, tmp_path)
    known = {
        "sideslip-misalignment",
        "camber-misalignment",
        "run-offsets-alpha",
        "ply-steer",
        "camber-stiffness",
    }
    found = mffit.diagnose(
        tmp_path / "tyre.toml", SAMPLE / "true.tir", effects=[e for e in CATALOG if e.id in known]
    )
    (effect,) = found.effects
    assert effect.effect.id == "sideslip-misalignment"
    assert effect.parameters["alpha_0_deg@right"][0] == pytest.approx(0.6, abs=0.01)
    assert effect.parameters["alpha_0_deg@left"][0] == pytest.approx(0.0, abs=0.01)
    said = wording.remedy(effect, found)
    assert said.startswith("set-up right: turn the steering axis by -0.")
    assert "set-up left" not in said


def test_the_scatter_of_repeated_set_ups_is_the_prior(result):
    """An excess of 24 N beside 10 N declared: the load-cell zero of every set-up is known to 26 N."""
    declared = {n.name: n.spread for n in rig_numbers(result.config, result.measured, tuple(FAULTS))}
    scatter = SimpleNamespace(excess=24.0)
    measured = replace(result.measured, setup_scatter=scatter)
    wider = {n.name: n.spread for n in rig_numbers(result.config, measured, tuple(FAULTS))}
    assert declared["F0_N@left"] == 10.0
    assert wider["F0_N@left"] == pytest.approx(26.0)
    assert wider["gamma_0_deg@left"] == declared["gamma_0_deg@left"]


def test_the_bias_of_finite_spin_does_not_contain_the_zeros(result):
    """It is that of the true tyre on a rig without errors."""
    measured = result.measured
    found = measured.epsilon_gamma.value - measured.epsilon_gamma_debiased.value
    true = finite_spin_bias(result.config, result.points, Simulation.of(truth()), None)
    assert found == pytest.approx(true, abs=0.006)


def test_the_terminal_shows_what_every_set_up_gives_by_itself(result):
    for text in (build_explained(result), spin_summary(result.measured)):
        lines = [line for line in text.splitlines() if " m to the " in line and line[0] not in "- "]
        rows = {line.split()[0]: line for line in lines}
        assert set(rows) == set(FAULTS)
        assert "1.323 m to the right" in rows["right"]
    assert result.points.used_setups == ("left", "right")
    assert set(points_table(result).setup) == set(FAULTS)
