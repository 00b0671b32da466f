"""Small campaigns of the virtual rig with the tyre of the front sample; they are built in a second or two."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import mffit
import tir
from mffit import virtual_rig

SAMPLE = Path(__file__).parents[2] / "samples" / "front-120-70"
LOADS = (900, 1400, 2100)
SLIP = [-8, -6, -4, -3, -2, -1.5, -1, -0.5, 0, 0.5, 1, 1.5, 2, 3, 4, 6, 8]
LEAN = [-45, -30, -20, -15, -10, -5, 0, 5, 10, 15, 20, 30, 45]
FY, MZ = 3.0, 0.3
"""Noise of a point [N], [Nm]."""


def truth() -> tir.Tyre:
    return tir.read(SAMPLE / "true.tir")


def disc(loads: Sequence[int] = LOADS, **changes: Any) -> dict[str, Any]:
    """Plan of a campaign: sideslip, camber and zeros both ways at each load, one coupled sweep; ``changes`` replace tables."""
    sweeps: list[dict[str, Any]] = []
    for load in loads:
        sweeps += [
            {"file": f"sideslip_{load}.csv", "load_N": load, "alpha_deg": SLIP},
            {"file": f"camber_{load}.csv", "load_N": load, "gamma_deg": LEAN},
            {"file": f"forward_{load}.csv", "load_N": load, "alpha_deg": [-0.5, 0, 0.5]},
            {
                "file": f"backward_{load}.csv",
                "load_N": load,
                "alpha_deg": [-0.5, 0, 0.5],
                "direction": "backward",
            },
        ]
    sweeps.append(
        {"file": "coupled.csv", "load_N": 1400, "alpha_deg": [-6, -3, -1, 0, 1, 3, 6], "gamma_deg": [-20, 20]}
    )
    return {
        "truth": {"tyre": "true.tir"},
        "noise": {"Fy_N": FY, "Mz_Nm": MZ, "My_Nm": 0.2},
        "tyre": {
            "name": "small", "unloaded_radius": 0.2992, "width": 0.12, "rim_radius": 0.2159, "nominal_load": 1400,
            "nominal_pressure": 250, "base": "base.tir",
        },
        "rig": {"path_radius": 1.323, "u_path_radius": 0.0018},
        "rolling_radius": [{"load_N": load} for load in loads],
        "sweep": sweeps,
    } | changes  # fmt: skip


def flat(**changes: Any) -> dict[str, Any]:
    """Plan of the forward sweeps on a flat track."""
    content = disc(rig={"type": "flat-track"}, rolling_radius=[], **changes)
    content["sweep"] = [s for s in content["sweep"] if s.get("direction") != "backward"]
    return content


def simulated(content: dict[str, Any], folder: Path, seed: int = 3) -> virtual_rig.Truth:
    """Write the project of a simulated campaign to a folder; returns the truth."""
    return virtual_rig.simulate(virtual_rig.load_plan(content, folder=SAMPLE), folder, seed=seed)


def belt_with_one_left_out(folder: Path) -> Path:
    """Write a project of two loads on a flat track, of which tyre.toml leaves a reading out; returns its path."""
    simulated(flat(loads=(900, 1400)), folder)
    path = folder / "tyre.toml"
    out = (
        '[fit]\nexclude = [ { file = "sideslip_1400.csv", lines = "4", why = "belt tracking" } ]  # by Anna\n'
    )
    path.write_text(f"{path.read_text(encoding='utf-8')}\n{out}", encoding="utf-8")
    return path


def built(content: dict[str, Any], folder: Path, seed: int = 3) -> mffit.results.BuildResult:
    """The build of a simulated campaign."""
    simulated(content, folder, seed)
    return mffit.build(folder / "tyre.toml")


@cache
def sound(plan: Callable[[], dict[str, Any]]) -> mffit.results.BuildResult:
    """The build of :func:`flat` or :func:`disc` without changes, once in a process; its folder is gone."""
    with tempfile.TemporaryDirectory() as folder:
        return built(plan(), Path(folder))
