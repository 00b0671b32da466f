"""Single readings that all others contradict, of tyres that the formula does not describe, in sweeps of uneven steps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from brush import FY, MZ, Brush
from disc_project import Project

import mffit

LOADS, RADIUS = (1000.0, 1700.0, 2600.0), 1.323
TYRE = Brush(a=0.052, mu=1.25, fading=0.7, crown=0.4, softening=-0.2, b=0.02)
WRONG = {("sideslip_1700.csv", 6, "Fy"), ("camber_1000.csv", 9, "Mz"), ("coupled_1700_35.csv", 8, "Fy")}
"""Readings that are twelve times the noise off: file, line and channel."""


def uneven(largest: float, rng: np.random.Generator) -> np.ndarray:
    """Angles (n,) [deg] to both sides, with steps that differ by up to ten times."""
    ends = np.cumsum(np.exp(rng.uniform(0.0, np.log(10.0), 7)))
    side = largest * ends / ends[-1]
    return np.round(np.concatenate([-side[::-1], [0.0], side]), 1)


def programme(rng: np.random.Generator) -> dict[str, tuple[np.ndarray, np.ndarray, float, float]]:
    """Sideslip (n,) and camber (n,) [deg], load [N] and direction of every sweep on a disc."""
    rows = {}
    for load in LOADS:
        rows[f"sideslip_{load:.0f}"] = (uneven(8.0, rng), np.zeros(15), load, 1.0)
        rows[f"camber_{load:.0f}"] = (np.zeros(15), uneven(45.0, rng), load, 1.0)
        for way, sign in (("forward", 1.0), ("backward", -1.0)):
            rows[f"align_{load:.0f}_{way}"] = (np.linspace(-1.0, 1.0, 5), np.zeros(5), load, sign)
    for lean, load in ((15.0, 1700.0), (35.0, 1700.0), (20.0, 2600.0)):
        both = np.repeat([-lean, lean], 15)
        rows[f"coupled_{load:.0f}_{lean:.0f}"] = (np.tile(uneven(7.0, rng), 2), both, load, 1.0)
    return rows


def campaign(folder: Path, seed: int) -> Path:
    """A brush tyre on a disc; every reading is true but for its noise and those of ``WRONG``."""
    rng, tables = np.random.default_rng(seed), {}
    for name, (alpha, gamma, Fz, way) in programme(rng).items():
        Fy, Mz = TYRE.forces(
            np.radians(alpha), np.radians(gamma), np.full(len(alpha), Fz), -1.0 / RADIUS, way
        )
        noise = rng.standard_normal((2, len(alpha)))
        for file, line, channel in WRONG:
            if file == f"{name}.csv":
                noise[("Fy", "Mz").index(channel), line - 2] += 12.0
        tables[f"{name}.csv"] = pd.DataFrame(
            {
                "alpha_deg": alpha, "gamma_deg": gamma, "Fz_N": Fz, "p_kPa": 250.0, "V_mps": 6.0,
                "direction": "forward" if way > 0 else "backward",
                "Fy_N": Fy + FY * noise[0], "Mz_Nm": Mz + MZ * noise[1], "u_Fy_N": FY, "u_Mz_Nm": MZ,
            }
        )  # fmt: skip
    base = {"unloaded_radius": 0.306, "width": 0.15, "rim_radius": 0.2159, "nominal_load": LOADS[1]}
    config = {
        "tyre": {"name": "brush", "nominal_pressure": 250, "nominal_speed": 10, **base},
        "rig": {
            "type": "rotating-disk", "axes": "iso", "path_centre": "left", "path_radius": RADIUS, "u_path_radius": 0.0018,
            "backlash_deg": 0.0, "u_camber_skew_deg": 0.0, "u_loadcell_offset_N": 10.0, "u_camber_alignment_deg": 0.5,
            "u_slip_alignment_N": 25.0,
        },
        "rolling_radius": {"load_N": LOADS[1], "effective_radius": TYRE.r_e, "u_effective_radius": 0.0005},
        "camber_stiffness": {"angle_deg": 15},
        "sweep": [{"file": file} for file in tables],
    }  # fmt: skip
    return Project(folder, config, tables).write()


def test_wrong_readings_have_no_weight_and_true_ones_keep_theirs(tmp_path):
    found = mffit.build(campaign(tmp_path, 6), with_report=False).fit.outliers
    assert {(Path(one.file).name, one.line, one.channel) for one in found} == WRONG
