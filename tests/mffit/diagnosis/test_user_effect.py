"""An effect in a user's own file competes with the catalogue."""

from __future__ import annotations

import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from blind_rig import report
from blind_scores import loaded

from mffit.diagnosis import diagnose
from mffit.effects import CATALOG

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
    found = diagnose(points, case.given, config, effects=(*CATALOG, effect))
    assert [f.effect.id for f in found.effects] == ["road-friction"]
    value, error = found.effects[0].parameters["LMUY"]
    assert value == pytest.approx(0.94, abs=5.0 * error)
    assert found.tyre["LMUY"] == pytest.approx(value)
