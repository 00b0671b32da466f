"""Files of a simulated disc rig, for rigs that use nothing of ``mffit``: sweeps as CSV, and ``tyre.toml``."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from tir import Tyre

HEADINGS = (
    "alpha_deg", "gamma_deg", "Fz_N", "p_kPa", "V_mps", "direction", "t_s", "T_degC", "Fy_N", "Mz_Nm", "u_Fy_N", "u_Mz_Nm",
)  # fmt: skip


def write_sweep(path: Path, *conditions: np.ndarray, Fy: np.ndarray, Mz: np.ndarray, u: tuple) -> None:
    """A sweep; ``conditions`` are the columns (n,) up to ``T_degC``, the direction as a mask of backward points."""
    columns = list(conditions)
    columns[HEADINGS.index("direction")] = np.where(
        conditions[HEADINGS.index("direction")], "backward", "forward"
    )
    noise = (np.full(len(Fy), size) for size in u)
    with path.open("w", newline="", encoding="utf-8") as out:
        writer = csv.writer(out)
        writer.writerow(HEADINGS)
        writer.writerows(zip(*columns, np.round(Fy, 3), np.round(Mz, 4), *noise, strict=True))


def write_project(
    folder: Path,
    name: str,
    tyre: Tyre,
    files: Iterable[str],
    *,
    path_radius: float,
    effective_radius: float,
    **model: Any,
) -> None:
    """``tyre.toml`` of a disc whose centre lies to the left; ``model`` are the keys of [model]."""
    (folder / "tyre.toml").write_text(
        f'[tyre]\nname = "{name}"\nunloaded_radius = {tyre["UNLOADED_RADIUS"]}\nwidth = {tyre["WIDTH"]}\n'
        f"rim_radius = {tyre['RIM_RADIUS']}\nnominal_load = {tyre['FNOMIN']}\n"
        f"nominal_pressure = {float(tyre['NOMPRES']) / 1e3}\nnominal_speed = {tyre['LONGVL']}\n"
        f'[rig]\ntype = "rotating-disk"\naxes = "iso"\npath_centre = "left"\npath_radius = {path_radius}\nbacklash_deg = 0.0\n'
        f"[rolling_radius]\nload_N = {tyre['FNOMIN']}\neffective_radius = {effective_radius:.5f}\nu_effective_radius = 0.0005\n"
        "[model]\n"
        + "".join(f"{key} = {str(value).lower()}\n" for key, value in model.items())
        + "".join(f'[[sweep]]\nfile = "{name}.csv"\n' for name in files)
    )
