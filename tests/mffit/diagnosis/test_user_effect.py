"""An effect in a user's own file competes with the catalogue."""

from __future__ import annotations

import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from blind_rig import report
from blind_scores import loaded

from mffit.diagnosis import Asked, diagnose
from mffit.effects import CATALOG, Free

EXAMPLE = Path(__file__).parents[3] / "docs" / "examples" / "road_friction.py"


def test_the_example_of_the_docs_is_named_when_it_is_the_cause(right_model, tmp_path):
    case, _, _ = right_model
    effect = runpy.run_path(str(EXAMPLE))["ROAD_FRICTION"]
    true = case.true.replace(LMUY=0.94)
    noise = np.random.default_rng(3)
    Fy, Mz = report(true, case.machine, case.run)
    rougher = replace(
        case, name="road", Fy=Fy + noise.normal(0.0, 6.0, len(Fy)), Mz=Mz + noise.normal(0.0, 0.6, len(Mz))
    )
    config, points = loaded(rougher, tmp_path)
    found = diagnose(points, case.given, config, Asked(effects=(*CATALOG, effect)))
    assert [f.effect.id for f in found.effects] == ["road-friction"]
    value, error = found.effects[0].parameters["LMUY"]
    assert value == pytest.approx(0.94, abs=5.0 * error)
    assert found.tyre["LMUY"] == pytest.approx(value)


def test_effects_that_free_the_same_number_are_one_answer(right_model, tmp_path):
    """The second step once crashed: it freed the number that the first had freed already."""
    case, _, _ = right_model
    road = runpy.run_path(str(EXAMPLE))["ROAD_FRICTION"]
    wet = replace(
        road, id="wet", name="water on the disc", free=(Free("LMUY", spread=0.1, lower=0.3, upper=1.2),)
    )
    true = case.true.replace(LMUY=0.94, PVY1=case.true["PVY1"] + 0.012)
    noise = np.random.default_rng(4)
    Fy, Mz = report(true, case.machine, case.run)
    both = replace(
        case, name="two", Fy=Fy + noise.normal(0.0, 6.0, len(Fy)), Mz=Mz + noise.normal(0.0, 0.6, len(Mz))
    )
    config, points = loaded(both, tmp_path)
    conicity = next(effect for effect in CATALOG if effect.id == "conicity")
    found = diagnose(points, case.given, config, Asked(effects=(conicity, road, wet)))
    friction, other = sorted(found.effects, key=lambda one: one.effect.id == "conicity")
    assert other.effect.id == "conicity"
    assert {friction.effect.id, *friction.tied_with} == {"road-friction", "wet"}
    assert friction.parameters["LMUY"][0] == pytest.approx(0.94, abs=0.01)
