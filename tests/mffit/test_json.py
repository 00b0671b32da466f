"""JSON of records: every number under its key, with null for what is missing."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from mffit import as_json
from mffit.as_json import _KEYS, UNIT, keys, plain, text
from mffit.results import BuildOutcome
from mffit.suspicion import Outlier
from tir import Quantity


def test_a_document_is_standard_json_that_people_can_read():
    content = {"γ": [1.5, math.nan, -math.inf], "n": np.int64(3), "x": np.array([1.0, np.inf]), "s": ("a",)}
    assert text(content).splitlines()[:3] == ["{", '  "γ": [', "    1.5,"]
    assert text(content).endswith("}\n")
    assert json.loads(text(content)) == {"γ": [1.5, None, None], "n": 3, "x": [1.0, None], "s": ["a"]}
    assert plain({3: np.float64(0.5), "b": np.bool_(True)}) == {"3": 0.5, "b": True}


@dataclass(frozen=True, slots=True)
class Inner:
    limits: tuple[float, float] = (1.0, 2.0)
    word: str = ""


@dataclass(frozen=True, slots=True)
class Toy:
    angle: Quantity | None = None
    angle_deg: float = 3.0
    pressures: tuple[float, ...] = (1e5, 2e5)
    load: float = 4.0
    inner: Inner | None = None
    missing: str = ""
    made: str | None = None


@pytest.fixture
def toy():
    keys(
        Toy,
        "±steer_deg=angle angle_deg p_kPa=pressures load_N=load end=inner.limits.1 missing? [made] **more twice",
        more=lambda found: {"a": 1, "b": found.inner},
        twice=lambda found: 2.0 * found.load,
    )
    yield Toy
    del _KEYS[Toy]


def test_a_record_that_states_its_keys(toy):
    found = plain(toy(angle=Quantity(math.pi, math.pi / 2, "rad"), inner=Inner(), made="now"))
    assert found == {
        "steer_deg": 180.0, "u_steer_deg": 90.0, "angle_deg": 3.0, "p_kPa": [100.0, 200.0], "load_N": 4.0, "end": 2.0,
        "missing": None, "made": "now", "a": 1, "b": {"limits": [1.0, 2.0], "word": ""}, "twice": 8.0,
    }  # fmt: skip
    assert plain(toy()) == {
        "steer_deg": None, "u_steer_deg": None, "angle_deg": 3.0, "p_kPa": [100.0, 200.0], "load_N": 4.0, "end": None,
        "missing": None, "a": 1, "b": None, "twice": 8.0,
    }  # fmt: skip


def test_a_record_without_stated_keys_has_its_fields():
    class Pair(NamedTuple):
        quantity: Quantity
        path: Path

    found = plain(Pair(Quantity(4.0, math.inf, "N"), Path("a")))
    assert found == {"quantity": {"value": 4.0, "u": None}, "path": "a"}


def test_an_outcome_of_many_builds():
    good = BuildOutcome(
        source=Path("a/tyre.toml"), name="a", out=Path("out/a"), state="built", seconds=2.5, warnings=3, file="a.tir",
        epsilon_gamma=Quantity(-0.1, 0.02, "-"), misfit={"Fy": 6.0},
    )  # fmt: skip
    assert as_json.document(good) == {
        "tyre_toml": str(Path("a/tyre.toml")), "name": "a", "out": str(Path("out/a")), "state": "built", "sentence": None,
        "seconds": 2.5, "epsilon_gamma": {"value": -0.1, "u": 0.02}, "rmse": {"Fy": 6.0}, "warnings": 3, "tir": "a.tir",
        "trusted": True, "reasons": [], "in_doubt": [],
    }  # fmt: skip
    bad = as_json.document(BuildOutcome(Path("b.toml"), "b.toml", None, "refused", "the reason"))
    assert bad == {
        "tyre_toml": "b.toml", "name": "b.toml", "out": None, "state": "refused", "sentence": "the reason", "seconds": 0.0,
        "epsilon_gamma": None, "rmse": {}, "warnings": 0, "trusted": None, "reasons": [], "in_doubt": [], "tir": None,
    }  # fmt: skip


@pytest.mark.parametrize(("line", "written"), [(7, 7), (0, None)])
def test_an_outlier_without_a_known_line(line, written):
    row = Outlier(
        file="a.csv", line=line, sweep="a", channel="Fy", measured=99.0, expected=-1.0, ratio=16.0, row=5
    )
    assert plain(row) == {
        "file": "a.csv", "line": written, "sweep": "a", "channel": "Fy", "measured": 99.0, "expected": -1.0, "ratio": 16.0,
    }  # fmt: skip


def test_every_stated_key_belongs_to_its_record():
    for record, (words, computed) in _KEYS.items():
        named = {word.strip("±*?[]").partition("=")[0]: word for word in words.split()}
        assert not computed.keys() - named.keys(), record
        for name, word in named.items():
            first = word.strip("±*?[]").partition("=")[2].partition(".")[0]
            known = {name, UNIT.sub("", name)} if not first else {first}
            has = any(hasattr(record, one) or one in record.__annotations__ for one in known)
            assert name in computed or not name or has, f"{record.__name__}: {word}"
