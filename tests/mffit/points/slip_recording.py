"""Recordings of slip against the loaded radius, by the kinematics of a wheel and a tyre of two formulas."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from mffit import config as configuration
from mffit import points
from mffit.points.loading import Reading

R0, SPEED, RATE = 0.23, 11.0, 20
LOADS = (250.0, 650.0, 1050.0)


def radii(Fz, p):
    """Loaded radius and radius of free rolling [m]: a spring that pressure stiffens, and a third of its deflection."""
    deflection = Fz / (1.0e5 * (p / 83.0) ** 0.8)
    return R0 - deflection, R0 - 0.33 * deflection


def recording(pressures, *, driven: bool, seed: int) -> pd.DataFrame:
    """A sweep of slip, or of sideslip while the wheel rolls freely, at each load and pressure; ISO axes."""
    random = np.random.default_rng(seed)
    ramp = np.concatenate([np.zeros(2 * RATE), np.linspace(0, 1, 2 * RATE), np.linspace(1, -1, 4 * RATE)])
    ramp = np.concatenate([ramp, np.linspace(-1, 0, 2 * RATE)])
    parts = [(Fz, p) for p in pressures for Fz in LOADS]
    Fz, p = (np.repeat([part[k] for part in parts], len(ramp)) for k in (0, 1))
    move, n = np.tile(ramp, len(parts)), len(Fz)
    kappa, alpha = (0.18 * move, 0.0 * move) if driven else (0.0 * move, 8.0 * move)
    along = SPEED * np.cos(np.radians(alpha))
    loaded, rolling = radii(Fz, p)
    omega = (1.0 + kappa) * along / rolling
    noise = random.normal(size=(5, n))
    return pd.DataFrame(
        {
            "time_s": np.arange(n) / RATE,
            "alpha_deg": alpha + 0.01 * noise[0],
            "gamma_deg": 0.01 * noise[1],
            "p_kPa": p + 0.05 * noise[2],
            "V_mps": SPEED,
            "omega_radps": omega,
            "RL_m": loaded,
            "Fz_N": Fz,
            "Fx_N": 2.3 * Fz * np.sin(1.5 * np.arctan(10.0 * kappa)) + 3.0 * noise[3],
            "Fy_N": -2.2 * Fz * np.sin(1.5 * np.arctan(9.0 * np.radians(alpha))) + 3.0 * noise[4],
            "kappa": omega * loaded / along - 1.0,
        }
    )


def read(folder: Path, kappa: dict[str, str], **tables: pd.DataFrame) -> Reading:
    """The points of recordings by file name; ``kappa`` is declared of the first one."""
    for name, table in tables.items():
        table.to_csv(folder / f"{name}.csv", index=False)
    tyre = {"name": "x", "unloaded_radius": R0, "nominal_load": 650.0, "nominal_pressure": 83.0}
    first, *others = ({"file": f"{name}.csv"} for name in tables)
    first["columns"] = {"kappa": kappa}
    content = {"tyre": tyre, "rig": {"type": "flat-track", "axes": "iso"}, "sweep": [first, *others]}
    return points.read(configuration.load(content, folder=folder))


def error(found: Reading) -> np.ndarray:
    """Slip of the points less that of the wheel speed and the radius of free rolling."""
    p = found.points
    rolling = radii(p.Fz, 1e-3 * p.p)[1]
    return p.kappa - (p.omega * rolling / (p.V * np.cos(p.alpha)) - 1.0)
