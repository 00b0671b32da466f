"""When data and model cannot decide, the diagnosis says so, or says what to correct."""

from __future__ import annotations

import numpy as np
import pytest

from mffit import as_json
from mffit.diagnosis import diagnose
from mffit.diagnosis.notes import NotVisible, OneSweep, WithoutNoise
from mffit.diagnosis.rest import Answer, RestKind
from mffit.diagnosis.strangers import another_tyre
from mffit.errors import InputError
from mffit.progress import remaining


def test_a_right_model_has_no_gap(right_model, nothing):
    case, found = right_model[0], nothing
    assert not found.effects
    assert not found.unexplained
    assert found.gap_before == found.gap_after
    assert found.gap_before.chi2_per_dof == pytest.approx(1.0, abs=0.2)
    assert found.answer is Answer.NOTHING
    assert found.headline.startswith("Nothing is missing")
    assert found.trusted
    assert all(found.tyre[name] == case.given[name] for name in ("PKY1", "PKY6", "PECP1", "QDZ1"))


def test_one_sweep_cannot_separate_causes(stiffer_camber):
    case, config, points = stiffer_camber
    camber = np.flatnonzero([points.sweep_names[k].startswith("camber") for k in points.sweep])
    one = points.select(camber[:15])
    found = diagnose(one, case.given, config)
    assert not found.effects
    assert OneSweep() in found.notes


def test_effects_that_the_data_cannot_show_are_noted(stiffer_camber):
    case, config, points = stiffer_camber
    found = diagnose(points.select(points.p == 250e3).replace(T=np.nan), case.given, config)
    assert [f.effect.id for f in found.effects] == ["camber-stiffness"]
    lacking = {
        note.needs: tuple(e.id for e in note.effects) for note in found.notes if isinstance(note, NotVisible)
    }
    assert lacking[("pressures",)] == ("pressure",)
    assert set(lacking[("temperatures",)]) == {"temperature", "temperature-grip", "temperature-stiffness"}
    assert not {"pressure", "temperature"} & set(found.alternatives)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda p: p.replace(Fy=-p.Fy), "axes"),
        (lambda p: p.replace(Fz=p.Fz * 1e3), "loads"),
        (lambda p: p.replace(u_Fy=0.0), "zero"),
        (lambda p: p.select(np.arange(7)), "too few"),
    ],
    ids=["axes", "loads", "zero uncertainty", "few points"],
)
def test_model_and_data_that_cannot_belong_together_are_refused_with_the_cause(right_model, change, words):
    case, config, points = right_model
    with pytest.raises(InputError, match=words):
        diagnose(change(points), case.given, config)


def test_scatter_replaces_missing_uncertainties(stiffer_camber):
    case, config, points = stiffer_camber
    found = diagnose(points.replace(u_Fy=np.nan, u_Mz=np.nan), case.given, config)
    assert [f.effect.id for f in found.effects] == ["camber-stiffness"]
    # 6 N and 0.6 Nm were put in; the curvature of the sweeps may add to it
    assert 4.0 < found.noise.typical("Fy") < 18.0
    assert 0.4 < found.noise.typical("Mz") < 1.5


@pytest.mark.parametrize("stated", [True, False])
def test_readings_of_another_simulation_are_recognised(stiffer_camber, stated):
    """Without noise, numerical differences once made numbers certain to seven digits, or ended in a traceback."""
    case, config, points = stiffer_camber
    Fy, Mz = case.noise_free(case.run)
    exact = points.replace(Fy=np.round(Fy, 2), Mz=np.round(Mz, 3)).select(np.arange(0, len(points), 3))
    if not stated:
        exact = exact.replace(u_Fy=np.nan, u_Mz=np.nan)
    found = diagnose(exact, case.given, config)
    assert [f.effect.id for f in found.effects] == ["camber-stiffness"]
    value, error = found.effects[0].parameters["PKY6"]
    assert value == pytest.approx(float(case.true["PKY6"]), abs=error)
    assert error > 1e-5 * abs(value)
    (note,) = [note for note in found.notes if isinstance(note, WithoutNoise)]
    assert dict(note.assumed)["Fy"] == pytest.approx(1e-3 * np.sqrt(np.mean(Fy**2)), rel=0.1)


def test_a_sweep_that_is_off_for_no_known_reason_is_unexplained(right_model):
    """Its misfit once passed as noise of twenty times the stated one."""
    case, config, points = right_model
    off = points.sweep == next(
        k for k, name in enumerate(points.sweep_names) if name.startswith("coupled_1") and "20" in name
    )
    half = points.replace(gamma=np.where(off, 0.0, points.gamma)).select(np.arange(0, len(points), 2))
    found = diagnose(half, case.given, config)
    assert found.unexplained
    assert found.answer is Answer.UNKNOWN
    blamed = {rest.sweep for rest in found.rest if rest.kind in (RestKind.SCATTER, RestKind.SWEEP)}
    assert points.sweep_names[points.sweep[off][0]] in blamed
    assert not found.trusted


def test_a_model_of_another_tyre_is_said(right_model):
    case, config, _ = right_model
    assert another_tyre(case.given, config) is None
    larger = case.given.replace(UNLOADED_RADIUS=1.05 * float(case.given["UNLOADED_RADIUS"]), NOMPRES=290e3)
    other = another_tyre(larger, config)
    assert [name for name, *_ in other.differences] == ["UNLOADED_RADIUS", "NOMPRES"]
    worn = case.given.replace(UNLOADED_RADIUS=0.99 * float(case.given["UNLOADED_RADIUS"]))
    assert another_tyre(worn, config) is None


def test_the_same_input_gives_the_same_answer_and_every_step_has_its_share(stiffer_camber, camber):
    (case, config, points), said = stiffer_camber, []
    again = diagnose(points, case.given, config, progress=said.append)
    assert as_json.document(again) == as_json.document(camber)
    shares = [remaining(sentence, 0.0)[0] for sentence in said]
    assert len(shares) > 8
    assert shares == sorted(shares)
    assert max(np.diff(shares)) < 0.3  # of the time, so that it is seen to move


def test_forces_alone_are_enough_for_an_effect_on_forces(stiffer_camber):
    case, config, points = stiffer_camber
    found = diagnose(points.replace(Mz=np.nan, u_Mz=np.nan), case.given, config)
    assert [f.effect.id for f in found.effects] == ["camber-stiffness"]
    assert any(
        "residual-torque" in {e.id for e in n.effects} and "moment" in n.needs
        for n in found.notes
        if isinstance(n, NotVisible)
    )
