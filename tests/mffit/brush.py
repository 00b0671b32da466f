"""A tyre that is no Magic Formula, a brush whose bristles lose grip as they slide: its sweeps on a flat track, with noise.

Bristles deflect from the front to the rear of the contact (x from +a to -a) by the slip angle, and by the spin of a leaning
wheel, which bends their path. They slide where the deflection exceeds what the pressure, higher in the middle, holds. The grip
falls with the slip and with the load, and the contact grows with the square root of the load.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import pandas as pd

FY, MZ = 6.0, 0.3
"""Noise of a point [N], [Nm]."""
LOADS = (1000, 1700, 2600)
SLIP = (-8, -6, -5, -4, -3, -2, -1.5, -1, -0.5, 0, 0.5, 1, 1.5, 2, 3, 4, 5, 6, 8)
LEAN = (-10, -8, -6, -4, -2, -1, 0, 1, 2, 4, 6, 8, 10)
SHORT = (-8, -6, -4, -3, -2, -1, 0, 1, 2, 3, 4, 6, 8)
PROJECT = """
[tyre]
name = "brush"
unloaded_radius = 0.31
width = 0.15
rim_radius = 0.2159
nominal_load = 1700
nominal_pressure = 250
[rig]
type = "flat-track"
axes = "iso"
u_loadcell_offset_N = 10
u_camber_alignment_deg = 0.5
u_slip_alignment_N = 25
"""


class Brush(NamedTuple):
    """Numbers of the tyre, at its nominal load."""

    a: float = 0.05  #: half length of the contact [m]
    stiffness: float = 4.0e6  #: of the bristles [N/m^2]
    mu: float = 1.2
    mu_load: float = -0.08  #: change of grip by twice the load [-]
    fading: float = 0.6  #: relative loss of grip per slip of 1
    crown: float = 0.3  #: pressure in the middle over a parabola's
    reduction: float = -0.1  #: camber reduction factor
    softening: float = -0.2  #: exponent of the load in the stiffness
    b: float = 0.0  #: half width of the contact [m]
    drive: float = 1.0  #: stiffness of the bristles along the wheel over that across
    carcass: float = (
        np.inf
    )  #: lateral stiffness, by which the side force moves the contact beside the wheel [N/m]
    r_e: float = 0.3  #: [m]
    nominal: float = 1700.0  #: load [N]

    def forces(
        self, alpha: np.ndarray, gamma: np.ndarray, Fz: np.ndarray, phi_t: float = 0.0, direction: float = 1.0
    ) -> tuple[np.ndarray, np.ndarray]:
        """Fy [N] and Mz [Nm] of the wheel that rolls freely; see :meth:`driven`."""
        return self.driven(alpha, gamma, Fz, phi_t=phi_t, direction=direction)[1:]

    def driven(
        self,
        alpha: np.ndarray,
        gamma: np.ndarray,
        Fz: np.ndarray,
        kappa: np.ndarray | float = 0.0,
        phi_t: float = 0.0,
        direction: float = 1.0,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Fx, Fy [N] and Mz [Nm] in ISO-W at angles [rad], loads [N] and longitudinal slip, on a path of turn slip ``phi_t``.

        All are (n,), ``phi_t`` is in 1/m. Rolling backwards (``direction`` -1) mirrors the contact front to rear.
        """
        alpha, gamma, Fz, kappa = (
            np.asarray(x, dtype=float)[:, None] for x in np.broadcast_arrays(alpha, gamma, Fz, kappa)
        )
        x = np.linspace(1.0, -1.0, 801)
        over = Fz / self.nominal
        a = self.a * np.sqrt(over)
        spin = phi_t - (1.0 - self.reduction) * np.sin(gamma) / self.r_e
        stiffness = self.stiffness * over**self.softening
        slope = -np.tan(direction * alpha) / (1.0 + kappa)
        sideways = stiffness * (a * (1.0 - x) * slope + 0.5 * spin * a**2 * (1.0 - x**2))
        pulled = self.drive * stiffness * a * (1.0 - x) * kappa / (1.0 + kappa)
        shape = (1.0 - x**2) * (1.0 + self.crown * (1.0 - 5.0 * x**2) / 4.0)
        grip = (
            self.mu
            * (1.0 + self.mu_load * (over - 1.0))
            / (1.0 + self.fading * np.hypot(np.tan(alpha), kappa))
        )
        most = grip * Fz * 0.75 / a * np.maximum(shape, 0.0)
        length = 2.0 * a[:, 0] / (len(x) - 1)
        Fx, Fy, Mz = np.zeros((3, len(length)))
        strips = (0.0,) if self.b == 0.0 else self.b * np.array([-0.8, -0.4, 0.0, 0.4, 0.8])
        for y in strips:
            along = pulled - stiffness * spin * y * a * (1.0 - x)
            held = np.minimum(1.0, most / np.maximum(np.hypot(along, sideways), 1e-9)) / len(strips)
            Fx += (held * along).sum(axis=1) * length
            Fy += (held * sideways).sum(axis=1) * length
            Mz += (held * (sideways * a * x - along * y)).sum(axis=1) * length
        return Fx, Fy, direction * Mz - Fx * Fy / self.carcass


def sweeps() -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Sideslip [deg], camber [deg] and load [N] of every sweep."""
    plan: dict[str, tuple[tuple[float, ...], tuple[float, ...], int]] = {}
    for load in LOADS:
        plan[f"sideslip_{load}"] = (SLIP, (0.0,), load)
        plan[f"camber_{load}"] = ((0.0,), LEAN, load)
    for lean, load in ((2, 1700), (4, 1700), (7, 1700), (4, 2600)):
        plan[f"coupled_{load}_{lean}"] = (SHORT, (-lean, lean), load)
    return {
        name: tuple(np.array([(a, g, load) for g in gamma for a in alpha], dtype=float).T)
        for name, (alpha, gamma, load) in plan.items()
    }


def written(
    tyre: Brush,
    folder: Path,
    seed: int,
    play: float = 0.0,
    also: Mapping[float, Brush] = MappingProxyType({}),
    only: str = "",
) -> Path:
    """The project of a campaign of the tyre at 10 m/s; the sideslip axis has ``play`` [deg] that nothing declares.

    ``also`` are further speeds [m/s] at which sweeps are run again, and the tyre there; those whose names begin with ``only``.
    """
    rng = np.random.default_rng(seed)
    lines = [PROJECT]
    plan = [(10.0, tyre, name, *at) for name, at in sweeps().items()]
    plan += [
        (V, there, f"{name}_{V:g}", *at)
        for V, there in also.items()
        for name, at in sweeps().items()
        if name.startswith(only)
    ]
    for V, there, name, alpha, gamma, Fz in plan:
        Fy, Mz = there.forces(np.radians(alpha), np.radians(gamma), Fz)
        table = {
            "alpha_deg": alpha + 0.5 * play * np.sign(Mz), "gamma_deg": gamma, "Fz_N": Fz, "p_kPa": 250.0, "V_mps": V,
            "Fy_N": Fy + FY * rng.standard_normal(len(Fy)), "Mz_Nm": Mz + MZ * rng.standard_normal(len(Fy)),
            "u_Fy_N": FY, "u_Mz_Nm": MZ,
        }  # fmt: skip
        pd.DataFrame(table).to_csv(folder / f"{name}.csv", index=False)
        lines.append(f'[[sweep]]\nfile = "{name}.csv"\n')
    path = folder / "tyre.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    return path
