"""Sweeps to Points: finished points as they are, time series reduced, physics checked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from mffit.config import Config
from mffit.errors import InputError
from mffit.points.plausibility import check_physics as physics
from mffit.points.points import Points, concatenate, make_points
from mffit.points.steady import mean_and_error, plateaus
from mffit.sweeps import Sweep, load_sweeps, read_csv, to_sweep

CHANNELS = ("alpha", "gamma", "Fz", "p", "V", "Fy", "Mz", "Mx", "My", "T", "t", "u_Fy", "u_Mz", "iteration")


def load(config: Config, *, check_physics: bool = True) -> tuple[Points, tuple[str, ...]]:
    """Read the sweeps of a configuration as steady points in ISO-W.

    Parameters
    ----------
    config : the validated ``tyre.toml``
    check_physics : test the declared axes, frame and path centre against the data

    Returns
    -------
    points, warnings

    Raises
    ------
    InputError
        On files that cannot be read and on data that contradict the declared axes.
    """
    sweeps = load_sweeps(config)
    phi_t = 0.0
    if config.rig.type == "rotating-disk":
        phi_t = (-1.0 if config.rig.path_centre == "left" else 1.0) / config.rig.radius
    points = concatenate([to_points(sweep, phi_t, config.tyre.unloaded_radius) for sweep in sweeps])
    warnings = [] if np.any(np.isfinite(points.Mz)) else ["Mz was not measured: only Fy is fitted"]
    if check_physics:
        warnings += physics(points, config)
    return points, tuple(warnings)


def load_table(path: str | Path, *, axes: str, path_centre: str) -> Points:
    """Points of a bare CSV file, for the alignment of the sideslip axis."""
    path = Path(path)
    table, line = read_csv(path)
    sweep = to_sweep(path, table, line, axes=axes, pressure=250.0, speed=1.0)
    return to_points(sweep, -1.0 if path_centre == "left" else 1.0, 0.3)


def to_points(sweep: Sweep, phi_t: float, radius: float) -> Points:
    """One file's points; a time series is averaged over its plateaus, or kept sample by sample if it never rests."""
    names = tuple(dict.fromkeys(sweep.run))
    which = np.array([names.index(name) for name in sweep.run])
    common = dict(phi_t=phi_t, mount=sweep.mount, sweep_names=names, files=(sweep.file,))
    if not sweep.is_series:
        given = {name: sweep.channels[name] for name in CHANNELS}
        return make_points(**given, direction=sweep.direction, sweep=which, line=sweep.line, table=sweep.table, **common)
    c = sweep.channels
    if np.any(np.diff(c["time"]) <= 0) and sweep.point is None:
        raise InputError("does not rise from row to row; sort the rows by time", file=sweep.file, column="time_s")
    found = plateaus(c["time"], c["alpha"], c["gamma"], c["V"], radius, sweep.point)
    if not found:
        given = {name: c[name] for name in CHANNELS}
        return make_points(
            **given, direction=sweep.direction, sweep=which, line=sweep.line, table=sweep.table, continuous=True,
            time=c["time"], **common,
        )  # fmt: skip
    return _reduced(sweep, found, which, common)


def _reduced(sweep: Sweep, found, which: np.ndarray, common: dict) -> Points:
    """Means over the plateaus; the standard errors become the points' uncertainties."""
    c = sweep.channels
    means = {name: np.array([np.mean(c[name][p.begin : p.end]) for p in found]) for name in CHANNELS}
    for channel, u in (("Fy", "u_Fy"), ("Mz", "u_Mz")):
        errors = [mean_and_error(c[channel][p.begin : p.end]) for p in found]
        stated = means[u]
        means[channel] = np.array([mean for mean, _ in errors])
        means[u] = np.where(np.isfinite(stated), stated, [error for _, error in errors])
    means["t"] = np.where(np.isfinite(means["t"]), means["t"], [c["time"][p.begin] for p in found])
    first = np.array([p.begin for p in found])
    numeric = sweep.table.select_dtypes("number")
    table = pd.DataFrame([numeric.iloc[p.begin : p.end].mean() for p in found])
    return make_points(
        **means, direction=sweep.direction[first], sweep=which[first], line=sweep.line[first], table=table, **common
    )
