"""For any content of a file, its reader returns a record or raises one sentence; tests/mffit/sweeps covers recordings."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from small_plan import SMALL_PLAN

import tir
from mffit import config, fleet, virtual_rig
from mffit.errors import InputError
from mffit.fit.priors import Prior, fleet_content, of_fleet
from mffit.output import written_by
from tir.errors import TirError

EXAMPLES = settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.too_slow])
TYRE_TOML = """\
[tyre]
name = "toy"
unloaded_radius = 0.3
nominal_load = 1500.0
nominal_pressure = 250.0
priors = "priors.json"

[rig]
path_radius = 1.323

[[rolling_radius]]
effective_radius = 0.2945
u_effective_radius = 0.0005

[[sweep]]
file = "sideslip.csv"
columns = { Fy_N = { column = "FY", unit = "kN", scale = -1 } }
"""
PRIORS = json.dumps(fleet_content({"FNOMIN": 1500.0, "NOMPRES": 250e3}, 5, {"PKY1": Prior(-15.0, 2.0)}))
INFORMATION = json.dumps(
    {
        "names": ["PKY1", "F0_N"],
        "values": [-15.0, 1.0],
        "matrix": [[2.0], [0.1, 0.3]],
        "vector": [1.0, 2.0],
        "expected": [-14.0, 0.0],
        "spread": [None, 10.0],
    }
)
RECORD = json.dumps({"about": "x", "files": {"a": "build:00", "b": "spin:11"}})
RESULT = json.dumps(
    {
        "tyre": {"name": "toy"},
        "files": {"turn-slip": "toy.tir"},
        "tir": "toy.tir",
        "spin": {"epsilon_gamma": 0.1, "u_epsilon_gamma": 0.05},
        "fit": {"channels": {"Fy": {"rmse": 3.0, "n": 10}}},
        "warnings": [],
    }
)
TIR = tir.Tyre.from_values({"FNOMIN": 1500.0, "UNLOADED_RADIUS": 0.3}).text()


def in_a_project(name: str, read: Callable[[Path], Any]) -> Callable[[bytes], Any]:
    """Reads the folder of a small project in which one file has this content."""

    def tried(content: bytes) -> None:
        with tempfile.TemporaryDirectory() as made:
            folder = Path(made)
            for file, text in WHOLE.items():
                (folder / file).write_text(text, encoding="utf-8")
            shutil.copyfile(folder / "tyre.toml", folder / "resolved.toml")
            (folder / name).write_bytes(content)
            sentence = "none"
            try:
                read(folder)
            except (InputError, TirError) as refused:
                sentence = str(refused)
            assert sentence
            assert "\n" not in sentence

    return tried


WHOLE = {
    "tyre.toml": TYRE_TOML,
    "rig.toml": SMALL_PLAN,
    "priors.json": PRIORS,
    "toy.tir": TIR,
    "result.json": RESULT,
    "information.json": INFORMATION,
    ".mffit.json": RECORD,
}
READERS: dict[str, Callable[[Path], Any]] = {
    "tyre.toml": lambda folder: config.load(folder / "tyre.toml"),
    "rig.toml": lambda folder: virtual_rig.load_plan(folder / "rig.toml"),
    "priors.json": lambda folder: of_fleet(config.load(folder / "tyre.toml")),
    "toy.tir": lambda folder: tir.read(folder / "toy.tir"),
    "result.json": fleet.read,
    "information.json": fleet.read,
    ".mffit.json": lambda folder: written_by(folder, "build"),
}
SPLICES = st.lists(
    st.tuples(
        st.floats(0.0, 1.0),
        st.integers(0, 12),
        st.one_of(
            st.binary(max_size=4),
            st.sampled_from(
                [
                    b"[",
                    b"{",
                    b'"',
                    b"\n",
                    b"null",
                    b"-1e999",
                    b"nan",
                    b"[[",
                    b"]",
                    b"=",
                    b"0x",
                    b"\xff",
                    b"true",
                ]
            ),
        ),
    ),
    min_size=1,
    max_size=4,
)


def spliced(text: bytes, changes: list[tuple[float, int, bytes]]) -> bytes:
    """The bytes with some replaced, at positions given as shares of the length."""
    for place, cut, new in changes:
        at = int(place * len(text))
        text = text[:at] + new + text[at + cut :]
    return text


@pytest.mark.parametrize("name", WHOLE)
def test_a_sound_file_is_read(name):
    in_a_project(name, READERS[name])(WHOLE[name].encode())


@pytest.mark.parametrize("name", WHOLE)
def test_any_damage_gives_one_sentence(name):
    tried = in_a_project(name, READERS[name])

    @EXAMPLES
    @given(SPLICES)
    def damaged(changes):
        tried(spliced(WHOLE[name].encode(), changes))

    damaged()


JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=3),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(["names", "matrix", "files", "tyre", "nominal", "coefficients", "spin"]), inner
        )
    ),
    max_leaves=8,
)


@pytest.mark.parametrize("name", [name for name in WHOLE if name.endswith(".json")])
def test_any_json_gives_a_record_or_one_sentence(name):
    tried = in_a_project(name, READERS[name])

    @EXAMPLES
    @given(JSON)
    def replaced(content):
        tried(json.dumps(content).encode())

    replaced()
