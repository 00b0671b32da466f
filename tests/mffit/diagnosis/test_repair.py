"""Only likely effects are repaired, and no property file is replaced by one that is worse alone."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from plain_pages import without_pictures
from small_programme import LOADS, SLIP, TYRE, U_FY, U_MZ

from mffit import pipeline
from mffit.cli import main
from mffit.config import RigTable
from mffit.diagnosis import Asked, diagnose
from mffit.diagnosis import repair as repairing
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.inexact import EXACT
from mffit.diagnosis.notes import FileKept
from mffit.diagnosis.rest import Answer
from mffit.diagnosis.validation import Gap, Validation
from mffit.effects import CATALOG, Effect, Free
from mffit.errors import InputError
from mffit.pipeline.diagnosing import write_diagnosis
from mffit.points import make_points
from mffit.report import text
from mffit.rig import Simulation
from mffit.rig_errors import NO_FAULTS

CONFIG = SimpleNamespace(
    tyre=SimpleNamespace(name="warm", nominal_load=1400.0),
    model=SimpleNamespace(turn_slip=True, star=False, u_coefficients=0.0),
    rig=RigTable(type="flat-track"),
)
GRIP = Effect("grip", "friction", "tyre", "Another friction.", (Free("LMUY", 0.1, (0.0,), 0.3, 2.0),))
BY_ID = {effect.id: effect for effect in CATALOG}
TEMPERATURE = BY_ID["temperature"]
CROSSTALK = replace(BY_ID["crosstalk-fz-fy"], free=(Free("crosstalk", 0.3),), prior=5.0)
CONICITY = BY_ID["conicity"]
"""Alike on a straight path: the likelier one by its usual size is second by the order of causes."""
PER_KELVIN = -0.01


def campaign(rng, temperature=None):
    """Sideslip up and down at three loads on a straight path, without readings."""
    rows = np.array([(a, load, k) for k, load in enumerate((*LOADS, 1400.0)) for a in (*SLIP, *SLIP[::-1])])
    T = 25.0 if temperature is None else temperature(rows[:, 0]) + rng.normal(0.0, 1.0, len(rows))
    return make_points(
        np.radians(rows[:, 0]), 0.0, rows[:, 1], p=250e3, V=10.0, phi_t=0.0, u_Fy=U_FY, u_Mz=U_MZ,
        sweep=rows[:, 2].astype(int), sweep_names=("a", "b", "c"), T=T,
    )  # fmt: skip


def with_noise(points, Fy, Mz, rng):
    noise = rng.standard_normal((2, len(points)))
    return points.replace(Fy=Fy + U_FY * noise[0], Mz=Mz + U_MZ * noise[1])


def of_a_leaning_cell(*effects, **settings):
    """The diagnosis of a crosstalk, which conicity explains as well."""
    rng = np.random.default_rng(5)
    points = campaign(rng)
    points = with_noise(
        points, *Simulation.of(TYRE, NO_FAULTS.replace(crosstalk=0.005)).readings(points).values(), rng
    )
    return diagnose(points, TYRE, CONFIG, Asked(effects=effects or (CROSSTALK, CONICITY), **settings))


def test_a_suspicion_is_listed_and_not_repaired(tmp_path):
    found = of_a_leaning_cell()
    (effect,) = found.effects
    assert effect.tied_with == ("conicity",)
    assert effect.confidence < 0.5
    assert not effect.repaired
    assert found.gap_after == found.gap_before
    assert found.gap_named.rms("Fy") < 0.9 * found.gap_before.rms("Fy")
    with without_pictures():
        write_diagnosis(found, tmp_path)
    assert not (tmp_path / "warm.tir").exists()
    assert json.loads((tmp_path / "diagnosis.json").read_text())["model_after"] == found.given_file
    assert found.answer is Answer.UNDECIDED
    assert found.trusted
    assert json.loads((tmp_path / "diagnosis.json").read_text())["effects"][0]["repaired"] is False
    assert "not repaired" in found.headline
    assert found.headline.startswith("These data cannot tell what is missing; the best explanation is")
    assert "suspected and not repaired" in text.diagnosis_summary(found)
    assert "suspected, not repaired" in (tmp_path / "diagnosis.html").read_text()


def test_an_effect_that_is_practically_excluded_is_not_suspected(monkeypatch):
    monkeypatch.setattr(Explanation, "confidence", lambda *_: 0.0)
    found = of_a_leaning_cell(CROSSTALK)
    assert not found.effects
    assert found.gap_after == found.gap_named == found.gap_before


def test_all_suspicions_are_repaired_on_request():
    found = of_a_leaning_cell(repair_all=True)
    assert [one.repaired for one in found.effects] == [True]
    assert found.gap_after.rms("Fy") < 0.9 * found.gap_before.rms("Fy")


def test_the_option_of_the_command_asks_for_all(monkeypatch, tmp_path):
    asked = {}

    def noted(*_, **settings):
        asked.update(settings)
        raise InputError("enough")

    monkeypatch.setattr(pipeline, "diagnose", noted)
    for options in ([], ["--repair-all"]):
        with suppress(SystemExit):
            main(["diagnose", str(tmp_path / "tyre.toml"), *options])
        assert asked["repair_all"] == bool(options)


def warming(given, **settings):
    """The tyre warms up along each sweep; the given model took up the mean loss of friction, which a term should hold."""
    rng = np.random.default_rng(3)
    points = campaign(rng, temperature=lambda alpha: 30.0 + 4.0 * np.abs(alpha))
    warmth = 1.0 + PER_KELVIN * (points.T - points.T.min())
    Fy, Mz = Simulation.of(TYRE).readings(points).values()
    points = with_noise(points, warmth * Fy, warmth * Mz, rng)
    return diagnose(points, given, CONFIG, Asked(effects=(GRIP, TEMPERATURE), repair_all=True, **settings))


def test_an_effect_of_the_tyre_is_in_the_file_however_the_readings_warm_up():
    """The corrected file alone misses the warm readings by more than the given one did: they hold what it does not."""
    given = TYRE.replace(LMUY=0.75)
    found = warming(given)
    assert {one.effect.id for one in found.effects} == {"grip", "temperature"}
    check = found.validation
    assert check.gap_after.rms("Fy") < 0.3 * check.gap_before.rms("Fy")
    assert check.gap_after.rms("Fy") < 0.3 * check.gap_given_file.rms("Fy")
    assert found.delivers
    assert found.model_after == "warm.tir"
    assert found.tyre["LMUY"] == pytest.approx(found.state.values["LMUY"])
    cold = Simulation.of(TYRE).readings(found.points.replace(T=np.nan))["Fy"]
    file, before = (
        np.abs(
            Simulation.of(tyre).readings(found.points)["Fy"]
            - cold * (1.0 + PER_KELVIN * (found.state.faults["T_ref_degC"] - found.points.T.min()))
        )
        for tyre in (found.tyre, given)
    )
    assert np.sqrt(np.mean(file**2)) < 0.15 * np.sqrt(np.mean(before**2))


def explanation(*effects):
    return SimpleNamespace(
        chosen=SimpleNamespace(effects=effects),
        coefficients={},
        freed=EXACT,
        refined=None,
        plain=SimpleNamespace(noise=None),
    )


@pytest.mark.parametrize(("gain_of_file", "delivered"), [(0.1, True), (-0.1, False)])
def test_one_number_of_all_channels_decides_about_the_file(monkeypatch, gain_of_file, delivered):
    """Although every channel's own misfit is worse, or better: the joint likelihood of left-out sweeps decides."""
    worse = Gap({"Fy": 9.0, "Mz": 0.9}, 2.0)
    better = Gap({"Fy": 1.0, "Mz": 0.1}, 1.0)
    check = Validation(
        8,
        worse,
        worse if delivered else better,
        better if delivered else worse,
        gain=5.0,
        gain_of_file=gain_of_file,
    )
    named = [SimpleNamespace(effect=e, confidence_of_tie=lambda _: 1.0) for e in (GRIP, TEMPERATURE)]
    both, rig = explanation(GRIP, TEMPERATURE), explanation(TEMPERATURE)
    both.only = lambda effects: explanation(*effects)
    monkeypatch.setattr(repairing, "estimated", lambda found, _: found)
    monkeypatch.setattr(repairing, "validate", lambda *_, **__: check)
    confirmed = repairing.Confirmed(found=both, given=None, named=named, alternatives={}, rest=())
    done = repairing.repair(confirmed, check, SimpleNamespace(inexact=EXACT, asked=Asked()))
    assert done.explanation.chosen.effects == (both if delivered else rig).chosen.effects
    assert isinstance(done.refused, FileKept) is not delivered
