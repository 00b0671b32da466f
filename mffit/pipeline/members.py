"""Tyres drawn from the posterior of a build: a property file each, and a table of their characteristics."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from mffit.comparison import characteristics
from mffit.csv_tables import write_csv
from mffit.results import BuildResult
from tir import Tyre

FOLDER, INDEX = "ensemble", "index.csv"
NUMBERS = (
    "epsilon_gamma",
    "C_alpha_N_per_rad",
    "C_gamma_N_per_rad",
    "C_Mz_alpha_Nm_per_rad",
    "mu_y",
    "Mz_peak_Nm",
)
"""Columns of the table, after the file."""


def write_members(result: BuildResult, out: Path) -> None:
    """Write ``ensemble/<name>-001.tir`` and so on, and ``ensemble/index.csv``; nothing without members.

    Every member is a model for turn slip on (off on a flat track) within the physical limits of the fit.
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
    write_csv(pd.DataFrame(rows), folder / INDEX)


def numbers(tyre: Tyre, *, turn_slip: bool) -> dict[str, float]:
    """The main characteristics at nominal load and pressure on a straight path; SI units, ISO signs."""
    found = characteristics(tyre, float(tyre["FNOMIN"]), turn_slip=turn_slip)
    return {key: found[key] for key in NUMBERS}
