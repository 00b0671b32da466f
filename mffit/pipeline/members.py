"""Tyres drawn from what a build leaves uncertain: a property file each, and a table of what they differ in."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from mffit.results import BuildResult
from tir import Tyre

FOLDER, INDEX = "ensemble", "index.csv"


def write_members(result: BuildResult, out: Path) -> None:
    """Write ``ensemble/<name>-001.tir`` and so on, and ``ensemble/index.csv``; nothing if none were drawn.

    Every member is a fitted model for turn slip on (off, on a flat track), within the physical limits of the fit.
    """
    members = result.members
    if not members:
        return
    folder = out / FOLDER
    folder.mkdir()
    rows = []
    for i, member in enumerate(members, 1):
        name = f"{result.config.tyre.name}-{i:0{len(str(len(members)))}d}.tir"
        member.write(folder / name)
        rows.append({"file": name, **numbers(member, turn_slip=result.on_disc)})
    pd.DataFrame(rows).to_csv(folder / INDEX, index=False)


def numbers(tyre: Tyre, *, turn_slip: bool) -> dict[str, float]:
    """What an engineer compares first, at nominal load and pressure on a straight path; SI units, ISO signs."""
    load = float(tyre["FNOMIN"])
    small = np.array([-1e-3, 1e-3])
    slip = np.radians(np.linspace(0.0, np.degrees(float(tyre["ALPMAX"])), 101))
    by_slip = tyre(load, alpha=small, turn_slip=turn_slip)
    by_camber = tyre(load, gamma=small, turn_slip=turn_slip)
    curve = tyre(load, alpha=slip, turn_slip=turn_slip)
    step = np.diff(small)[0]
    return {
        "epsilon_gamma": float(tyre["PECP1"]),
        "C_alpha_N_per_rad": float(np.diff(by_slip.Fy)[0] / step),
        "C_gamma_N_per_rad": float(np.diff(by_camber.Fy)[0] / step),
        "C_Mz_alpha_Nm_per_rad": float(np.diff(by_slip.Mz)[0] / step),
        "mu_y": float(np.max(np.abs(curve.Fy)) / load),
        "Mz_peak_Nm": float(np.max(np.abs(curve.Mz))),
    }
