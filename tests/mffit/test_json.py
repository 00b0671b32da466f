"""JSON of records: every number under its key, with null for what is missing."""

from __future__ import annotations

import json
import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from mffit.results import BuildOutcome, as_json
from mffit.results.as_json.of_build import outlier
from mffit.results.as_json.values import plain, stated, text, value_of
from tir import Quantity


def test_a_document_is_standard_json_that_people_can_read():
    content = {"γ": [1.5, math.nan, -math.inf], "n": np.int64(3), "x": np.array([1.0, np.inf]), "s": ("a",)}
    assert text(content).splitlines()[:3] == ["{", '  "γ": [', "    1.5,"]
    assert text(content).endswith("}\n")
    assert json.loads(text(content)) == {"γ": [1.5, None, None], "n": 3, "x": [1.0, None], "s": ["a"]}
    assert plain({3: np.float64(0.5), "b": np.bool_(True)}) == {"3": 0.5, "b": True}


def test_a_quantity_has_its_uncertainty_beside_it():
    assert stated("C", Quantity(4.0, 0.5, "N")) == {"C": 4.0, "u_C": 0.5}
    assert stated("C", Quantity(4.0, 0.5, "N"), scale=10.0) == {"C": 40.0, "u_C": 5.0}
    assert stated("C", None) == {"C": None, "u_C": None}
    assert value_of(Quantity(4.0, 0.5, "N")) == {"value": 4.0, "u": 0.5}
    assert value_of(None) is None


def test_an_outcome_of_many_builds():
    good = BuildOutcome(
        source=Path("a/tyre.toml"), name="a", out=Path("out/a"), state="built", seconds=2.5, warnings=3, file="a.tir",
        epsilon_gamma=Quantity(-0.1, 0.02, "-"), misfit={"Fy": 6.0},
    )  # fmt: skip
    assert as_json.outcome(good) == {
        "tyre_toml": str(Path("a/tyre.toml")), "name": "a", "out": str(Path("out/a")), "state": "built", "sentence": None,
        "seconds": 2.5, "epsilon_gamma": {"value": -0.1, "u": 0.02}, "rmse": {"Fy": 6.0}, "warnings": 3, "tir": "a.tir",
        "trusted": True, "reasons": [], "in_doubt": [],
    }  # fmt: skip
    bad = as_json.outcome(BuildOutcome(Path("b.toml"), "b.toml", None, "refused", "the reason"))
    assert bad == {
        "tyre_toml": "b.toml", "name": "b.toml", "out": None, "state": "refused", "sentence": "the reason", "seconds": 0.0,
        "epsilon_gamma": None, "rmse": {}, "warnings": 0, "trusted": None, "reasons": [], "in_doubt": [], "tir": None,
    }  # fmt: skip


@pytest.mark.parametrize(("line", "written"), [(7, 7), (0, None)])
def test_an_outlier_without_a_known_line(line, written):
    row = SimpleNamespace(
        file="a.csv", line=line, sweep="a", channel="Fy", measured=99.0, expected=-1.0, ratio=16.0, row=5
    )
    assert outlier(row) == {
        "file": "a.csv", "line": written, "sweep": "a", "channel": "Fy", "measured": 99.0, "expected": -1.0, "ratio": 16.0,
    }  # fmt: skip
