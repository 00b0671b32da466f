"""When data and model cannot decide, the diagnosis says so, or says what to correct."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.diagnosis import diagnose
from mffit.diagnosis.notes import NotVisible, OneSweep
from mffit.errors import InputError
from mffit.results import as_json


def test_a_right_model_has_no_gap(right_model):
    case, config, points = right_model
    found = diagnose(points, case.given, config)
    assert not found.effects
    assert not found.unexplained
    assert found.gap_before == found.gap_after
    assert found.gap_before.chi2_per_dof == pytest.approx(1.0, abs=0.2)
    assert "No effect is missing" in found.headline
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
        (lambda p: p.select(np.arange(8)), "too few"),
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
    assert 4.0 < found.noise.Fy < 18.0
    assert 0.4 < found.noise.Mz < 1.5


def test_the_same_input_gives_the_same_answer(stiffer_camber):
    case, config, points = stiffer_camber
    first, second = (as_json.diagnosis(diagnose(points, case.given, config)) for _ in range(2))
    assert first == second


def test_forces_alone_are_enough_for_an_effect_on_forces(stiffer_camber):
    case, config, points = stiffer_camber
    found = diagnose(points.replace(Mz=np.nan, u_Mz=np.nan), case.given, config)
    assert [f.effect.id for f in found.effects] == ["camber-stiffness"]
    assert any(
        "residual-torque" in {e.id for e in n.effects} and "moment" in n.needs
        for n in found.notes
        if isinstance(n, NotVisible)
    )
