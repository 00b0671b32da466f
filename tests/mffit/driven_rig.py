"""Drive and brake campaigns of the virtual rig, with the tyre of the combined sample."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from mffit import virtual_rig

SAMPLE = Path(__file__).parents[2] / "samples" / "flat-track-combined"
ANGLES = {"from": -12, "to": 12, "step": 1.5}
FX = 15.0


def driven(folder: Path, step: float = 0.01, speeds: Sequence[float] = (), **faults: float) -> Path:
    """Drive and brake at three loads and under sideslip, two sweeps of sideslip; ISO axes."""
    slip = {"from": -0.2, "to": 0.2, "step": step}
    rolling = {"file": "rolling.csv", "load_N": [2000, 4200, 6500], "free_rolling": True}
    content = {
        "truth": {"tyre": "true.tir"},
        "faults": faults,
        "noise": {"Fx_N": FX, "Fy_N": 12.0, "Mz_Nm": 1.5, "RL_m": 0.0002, "omega_radps": 0.005},
        "conditions": {"V_mps": 16.7},
        "tyre": {
            "name": "drive",
            "unloaded_radius": 0.3185,
            "width": 0.225,
            "rim_radius": 0.2159,
            "nominal_load": 4200,
            "nominal_pressure": 240,
            "nominal_speed": 16.7,
            "side": "left",
        },
        "rig": {"type": "flat-track", "axes": "iso"},
        "sweep": [
            *({"file": f"drive_{load}.csv", "load_N": load, "kappa": slip} for load in (2000, 4200, 6500)),
            {"file": "combined.csv", "load_N": 4200, "kappa": slip, "alpha_deg": [-6, -2, 2, 6]},
            *({"file": f"side_{load}.csv", "load_N": load, "alpha_deg": ANGLES} for load in (2000, 4200)),
            *([rolling | {"V_mps": list(speeds)}] if speeds else []),
        ],
    }
    virtual_rig.simulate(virtual_rig.load_plan(content, folder=SAMPLE), folder, seed=5)
    return folder


def against_loaded_radius(folder: Path, *, with_radius: bool = True) -> None:
    """Rewrite the slip of all files as wheel speed times loaded radius over speed, with or without the two columns."""
    for path in folder.glob("*.csv"):
        table = pd.read_csv(path)
        table["kappa"] = table["omega_radps"].abs() * table["RL_m"] / table["V_mps"] - 1.0
        lost = [] if with_radius else [name for name in table if "RL_m" in name or "omega" in name]
        table.drop(columns=lost).to_csv(path, index=False)
