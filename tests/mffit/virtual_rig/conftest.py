"""A small campaign to run: the sample's front tyre, one sideslip, one camber and two zero sweeps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import tir
from mffit import virtual_rig

SAMPLE = Path(__file__).parents[3] / "samples" / "front-120-70"


def small_campaign() -> dict[str, Any]:
    return {
        "truth": {"tyre": "true.tir"},
        "tyre": {
            "name": "small",
            "unloaded_radius": 0.2992,
            "nominal_load": 1400,
            "nominal_pressure": 250,
        },
        "rig": {"path_radius": 1.323, "u_path_radius": 0.0018},
        "rolling_radius": [{"load_N": 1400}],
        "sweep": [
            {"file": "sideslip.csv", "load_N": 1400, "alpha_deg": {"from": -6, "to": 6, "step": 1}},
            {"file": "camber.csv", "load_N": 1400, "gamma_deg": [-40, -20, -5, 0, 5, 20, 40]},
            {"file": "forward.csv", "load_N": 1400, "alpha_deg": [-1, 0, 1]},
            {"file": "backward.csv", "load_N": 1400, "alpha_deg": [-1, 0, 1], "direction": "backward"},
        ],
    }


@pytest.fixture
def content() -> dict[str, Any]:
    """The content of a rig.toml with a perfect rig and no noise."""
    return small_campaign()


@pytest.fixture
def folder() -> Path:
    return SAMPLE


@pytest.fixture(scope="session")
def tyre() -> tir.Tyre:
    return tir.read(SAMPLE / "true.tir")


@pytest.fixture
def run(content, folder, tyre):
    """Run the campaign with tables added or replaced: ``run(faults={...})["camber.csv"]``."""

    def tables(seed: int = 0, **changes: Any) -> virtual_rig.Campaign:
        return virtual_rig.run(virtual_rig.load_plan(content | changes, folder=folder), tyre, seed)

    return tables
