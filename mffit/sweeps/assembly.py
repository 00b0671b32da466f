"""Conversion of a file's columns to sweeps in ISO-W and SI; only this module converts a rig's signs."""

from dataclasses import fields, replace
from typing import Any

import numpy as np

from mffit.config import Config, SweepTable
from mffit.errors import InputError
from mffit.quantities import CHANNELS, u_column
from mffit.quantities import column as column_of
from mffit.sweeps import constants
from mffit.sweeps.columns import Columns
from mffit.sweeps.formats import stem
from mffit.sweeps.sweep import Sweep
from tir.conventions import FLIPPED, to_iso


def sweeps_of(columns: Columns, config: Config, entry: SweepTable, setup: str = "") -> list[Sweep]:
    """The sweeps of a file, one per ``run``, or one for the whole file; forces stay in the rig's frame.

    ``setup`` is the name of the set-up of the rig.
    """
    check_loads(columns, config.rig.axes)
    whole = _sweep(columns, config, entry, setup)
    if "run" not in columns.table:
        return [whole]
    runs = columns.table["run"].astype(str).to_numpy()
    names = list(dict.fromkeys(runs))
    return [rows_of(whole, np.flatnonzero(runs == name), f"{whole.name}:{name}") for name in names]


def _sweep(columns: Columns, config: Config, entry: SweepTable, setup: str) -> Sweep:
    table, n, axes = columns.table, len(columns.raw), config.rig.axes

    def column(name: str, missing: float = np.nan) -> np.ndarray:
        # A channel that was not measured takes no memory, even in a long recording.
        return np.asarray(table[name], dtype=float) if name in table else np.broadcast_to(missing, (n,))

    def iso(channel: str, name: str) -> np.ndarray:
        return np.asarray(to_iso(axes, channel, column(name)) + 0.0)  # turns -0.0 into 0.0

    stated = -1 if entry.direction == "backward" else 1
    direction = np.broadcast_to(stated, (n,)) if columns.direction is None else columns.direction
    channels = {name: iso(name, column_of(name)) for name in CHANNELS if column_of(name) in table}
    if "omega" in channels:  # rigs count revolutions without a sign, or with one of their own
        channels["omega"] = direction * np.abs(channels["omega"])
    absent = np.broadcast_to(np.nan, (n,))
    return Sweep(
        name=stem(entry.file),
        file=entry.file,
        alpha=np.radians(iso("alpha", "alpha_deg")),
        gamma=np.radians(iso("gamma", "gamma_deg")),
        kappa=np.nan_to_num(iso("kappa", "kappa")) if "kappa" in table else column("kappa", 0.0),
        Fz=usual_sign(column("Fz_N")) * column("Fz_N"),
        **{name: channels.get(name, absent) for name in CHANNELS},
        p=1e3 * column("p_kPa", config.tyre.nominal_pressure),
        V=column("V_mps", config.tyre.nominal_speed),
        T=column("T_degC"),
        t=column("t_s"),
        **{f"u_{name}": column(u_column(name)) for name in CHANNELS},
        iteration=column("iteration"),
        direction=direction,
        mount=1 if entry.mount == "normal" else -1,
        setup=setup,
        time=column("time_s"),
        point=table["point"].astype(str).to_numpy() if "point" in table else None,
        line=np.asarray(columns.raw.lines),
        table=table,
    )


def rows_of(sweep: Sweep, rows: np.ndarray, name: str) -> Sweep:
    """The sweep ``name`` of these rows (m,) of a sweep."""
    values = {field.name: getattr(sweep, field.name) for field in fields(sweep)}
    arrays: dict[str, Any] = {
        field: value[rows] for field, value in values.items() if isinstance(value, np.ndarray)
    }
    return replace(sweep, name=name, table=sweep.table.iloc[rows].reset_index(drop=True), **arrays)


def usual_sign(Fz: np.ndarray) -> float:
    """Sign of the majority of loads (n,): 1.0 or -1.0."""
    return -1.0 if np.sum(Fz < 0.0) > np.sum(Fz > 0.0) else 1.0


def check_loads(columns: Columns, axes: str) -> None:
    """Refuse loads in kilonewtons or of the wrong sign for the axes; in a table of points also zero loads and mixed signs.

    Zero loads and mixed signs are allowed in a recording, because it may begin with the tyre off the belt.
    """
    Fz = columns.table["Fz_N"].to_numpy(dtype=float)

    def refuse(row: int, sentence: str) -> InputError:
        return InputError(sentence, file=columns.raw.path, line=columns.line(row), column="Fz_N")

    is_series = "time_s" in columns.table
    if is_series and not np.any(np.isfinite(Fz) & (Fz != 0.0)):
        raise refuse(0, "the load is zero in all rows; map the column that holds it under [sweep.columns]")
    if not is_series and np.any(Fz == 0.0):
        raise refuse(int((Fz == 0.0).argmax()), "the load is zero; remove the rows without load")
    if not is_series and np.any(Fz > 0.0) and np.any(Fz < 0.0):
        rare = int(((Fz > 0.0) if np.mean(Fz > 0.0) < 0.5 else (Fz < 0.0)).argmax())
        raise refuse(rare, f"{Fz[rare]:g} N has another sign than most loads; correct it or remove the row")
    if usual_sign(Fz) < 0.0 and "Fz" not in FLIPPED[axes]:
        raise refuse(
            int((Fz < 0.0).argmax()),
            f"loads are negative, but in {axes} axes they are positive; if the rig reports in SAE axes, set "
            'axes = "sae", else map the column with scale = -1 under [sweep.columns]',
        )
    largest = np.nanmax(np.abs(Fz))
    if largest < constants.SMALLEST_LOAD_IN_NEWTONS:
        raise refuse(
            0,
            f"the largest load is {largest:g} N, which looks like kN; write newtons, or "
            'Fz_N = { column = "Fz_N", unit = "kN" } under [sweep.columns]',
        )
