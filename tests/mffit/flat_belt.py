"""Recordings of a flat-belt machine, from the tyre model of ``disc_project``.

SAE axes, km/h, all conditions in one file: sideslip sweeps up and down, a load step between sweeps, camber and pressure
less often. The tyre lags by a first-order filter along the rolled distance and loses grip with the heat that it generates;
both are independent of the project's code.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import scipy.io
from disc_project import moment, side_force
from scipy.signal import lfilter

RATE = 100.0
SPEED = 11.0  # m/s
LOADS = (600.0, 1500.0, 2400.0)
CAMBERS = (0.0, 2.0, 4.0)
UNITS = {
    "ET": "sec", "V": "kph", "SA": "deg", "IA": "deg", "P": "kPa", "FX": "N", "FY": "N", "FZ": "N", "MX": "N-m", "MZ": "N-m",
    "TSTC": "deg C", "SL": "none",
}  # fmt: skip
DRIVE_UNITS = {**UNITS, "SR": "none", "N": "rpm", "RL": "cm"}
"""Also of the channels that only a driven wheel has."""


def recording(
    *,
    loads: Sequence[float] = LOADS,
    cambers: Sequence[float] = CAMBERS,
    pressures: Sequence[float] = (83.0, 97.0),
    sigma: float = 0.0,
    grip_per_K: float = 0.0,
    sweep_s: float = 12.0,
    rest_s: float = 3.0,
    gaps: bool = False,
    seed: int = 1,
) -> pd.DataFrame:
    """Samples under the machine's headings; one sideslip sweep 0 -> 9 -> 0 -> -9 -> 0 deg per condition.

    Parameters
    ----------
    sigma : relaxation length [m]
    grip_per_K : share of the side force lost per degree of tread temperature
    rest_s : at zero sideslip before each sweep, while the load changes over its first half second
    gaps : write only the sweeps, with the true times
    """
    random = np.random.default_rng(seed)
    swept, resting = round(sweep_s * RATE), round(rest_s * RATE)
    phase = np.arange(swept) / swept
    triangle = 9.0 * (1.0 - np.abs((4.0 * phase + 1.0) % 4.0 - 2.0))
    parts = list(product(pressures, cambers, loads))
    alpha = np.concatenate([np.r_[np.zeros(resting), triangle] for _ in parts])
    each = resting + swept
    Fz, gamma, p = (np.repeat([part[k] for part in parts], each).astype(float) for k in (2, 1, 0))
    ramp = round(0.5 * RATE)
    Fz, gamma = (lfilter(np.ones(ramp) / ramp, 1, x - x[0]) + x[0] for x in (Fz, gamma))
    n = len(alpha)
    time = np.arange(n) / RATE
    follows = np.radians(alpha)
    if sigma:
        keeps = np.exp(-SPEED / RATE / sigma)
        follows = lfilter([1.0 - keeps], [1.0, -keeps], follows)
    heat = lfilter(
        [0.004], [1.0, -0.996], np.abs(alpha)
    )  # low-pass of the sideslip, with a time constant of 2.5 s
    T = 55.0 + 3.0 * heat
    grip = 1.0 - grip_per_K * (T - 55.0)
    real = Fz * (1.0 + 0.01 * random.standard_normal(n))
    Fy = grip * side_force(follows, np.radians(gamma), real, side=0.0) + 10.0 * random.standard_normal(n)
    Mz = moment(follows, np.radians(gamma), real, side=0.0) + 0.8 * random.standard_normal(n)
    table = pd.DataFrame(
        {
            "ET": time + 31.5,
            "V": 3.6 * SPEED + 0.05 * random.standard_normal(n),
            "SA": -(alpha + 0.01 * random.standard_normal(n)),
            "IA": gamma + 0.01 * random.standard_normal(n),
            "P": p + 0.3 * random.standard_normal(n),
            "FX": 5.0 * random.standard_normal(n),
            "FY": -Fy,
            "FZ": -real,
            "MX": 0.02 * Fy,
            "MZ": -Mz,
            "TSTC": T,
            "SL": 0.0,
        }
    )
    if gaps:
        table = table[np.tile(np.r_[np.zeros(resting, bool), np.ones(swept, bool)], len(parts))]
    return table.reset_index(drop=True)


def longitudinal_force(kappa: np.ndarray, alpha: np.ndarray, Fz: np.ndarray) -> np.ndarray:
    """Longitudinal force [N] of a plain saturating curve that sideslip [rad] weakens."""
    return 1.2 * Fz * np.tanh(20.0 * kappa) / np.hypot(1.0, 12.0 * alpha)


def loaded_radius(Fz: np.ndarray, free: float = 0.228) -> np.ndarray:
    """Distance [m] of the wheel's centre from the belt."""
    return free - Fz / 250e3


def rolling_radius(Fz: np.ndarray, free: float = 0.228) -> np.ndarray:
    """Speed over rotation [m] of the wheel that rolls freely."""
    return free - 0.003 * np.tanh(Fz / 400.0) - Fz / 2.5e6


def drive_recording(
    *,
    loads: Sequence[float] = LOADS,
    cambers: Sequence[float] = (0.0, 3.0),
    sideslips: Sequence[float] = (0.0, -3.0),
    pressure: float = 83.0,
    free: float = 0.228,
    swing: float = 0.06,
    gaps: bool = True,
    seed: int = 1,
) -> pd.DataFrame:
    """Samples under the machine's headings; one sweep of slip 0.15 -> -0.15 -> 0.15 per condition.

    Parameters
    ----------
    free : unloaded radius [m]
    swing : share of the load by which it falls and rises with the longitudinal force
    gaps : write only the sweeps; else each begins with four seconds of free rolling, while load and angles change
    """
    random = np.random.default_rng(seed)
    resting, moving = round(4.0 * RATE), round(6.0 * RATE)
    held = round(0.5 * RATE)
    down = np.linspace(0.15, -0.15, moving // 2)
    swept = np.r_[np.full(held, 0.15), down, np.full(held, -0.15), down[::-1]]
    parts = list(product(sideslips, cambers, loads))
    kappa = np.concatenate([np.r_[np.zeros(resting), swept] for _ in parts])
    each = resting + len(swept)
    alpha, gamma, Fz = (np.repeat([part[k] for part in parts], each).astype(float) for k in (0, 1, 2))
    ramp = round(0.5 * RATE)
    alpha, gamma, Fz = (lfilter(np.ones(ramp) / ramp, 1, x - x[0]) + x[0] for x in (alpha, gamma, Fz))
    n = len(kappa)
    time = 31.5 + np.arange(n) / RATE
    real = Fz * (1.0 + swing * np.tanh(20.0 * kappa) + 0.01 * random.standard_normal(n))
    a, g = np.radians(alpha), np.radians(gamma)
    shared = 1.0 / np.hypot(1.0, 8.0 * kappa)
    rolling, loaded = rolling_radius(real, free), loaded_radius(real, free)
    omega = (1.0 + kappa) * SPEED / rolling
    table = pd.DataFrame(
        {
            "ET": time,
            "V": 3.6 * SPEED + 0.05 * random.standard_normal(n),
            "N": omega * 60.0 / (2.0 * np.pi),
            "SA": -(alpha + 0.01 * random.standard_normal(n)),
            "IA": gamma + 0.01 * random.standard_normal(n),
            "RL": 100.0 * loaded + 0.01 * random.standard_normal(n),
            "P": pressure + 0.3 * random.standard_normal(n),
            "FX": longitudinal_force(kappa, a, real) + 15.0 * random.standard_normal(n),
            "FY": -(shared * side_force(a, g, real, side=0.0) + 10.0 * random.standard_normal(n)),
            "FZ": -real,
            "MX": 10.0 * random.standard_normal(n) - 50.0,
            "MZ": -(shared * moment(a, g, real, side=0.0) + 2.0 * random.standard_normal(n)),
            "TSTC": 60.0 + 0.2 * random.standard_normal(n),
            "SR": omega * loaded / SPEED - 1.0 + 0.001 * random.standard_normal(n),
            "SL": kappa + 0.001 * random.standard_normal(n),
        }
    )
    if gaps:
        table = table[np.tile(np.r_[np.zeros(resting, bool), np.ones(len(swept), bool)], len(parts))]
    return table.reset_index(drop=True)


def write_mat73(table: pd.DataFrame, path: Path, **texts: str) -> Path:
    """The table as :func:`write_mat` writes it, by MATLAB 7.3: a row for each column, letters as numbers, cells as references.

    Older files are read in a process of their own, which takes as long as all the rest of a small recording.
    """
    h5py = pytest.importorskip("h5py")

    def letters(text: str) -> np.ndarray:
        return np.array([[ord(c)] for c in text], dtype=np.uint16)

    with h5py.File(path, "w", userblock_size=512) as file:
        for name in table:
            file[name] = table[name].to_numpy()[None, :]
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
        channel = file.create_group("channel")
        for key, cells in (("name", list(table)), ("units", [DRIVE_UNITS.get(name, "") for name in table])):
            stored = [
                file.create_dataset(f"#refs#/{key}{k}", data=letters(text)) for k, text in enumerate(cells)
            ]
            for item in stored:
                item.attrs["MATLAB_class"] = np.bytes_("char")
            channel.create_dataset(
                key, data=np.array([item.ref for item in stored], dtype=h5py.ref_dtype)[None, :]
            )
        for name, text in {"tireid": "Tyre A, 7 inch", **texts}.items():
            file[name] = letters(text)
            file[name].attrs["MATLAB_class"] = np.bytes_("char")
    return path


def write_mat(table: pd.DataFrame, path: Path, **texts: str) -> Path:
    """The table as a MATLAB file in the layout of the tyre test consortium."""
    names = np.array(list(table), dtype=object)
    units = np.array([DRIVE_UNITS.get(name, "") for name in table], dtype=object)
    content = {name: table[name].to_numpy()[:, None] for name in table}
    channel = {"name": names, "units": units}
    scipy.io.savemat(path, {**content, "channel": channel, "tireid": "Tyre A, 7 inch", **texts})
    return path
