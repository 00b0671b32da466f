"""A drive/brake programme on a flat belt with a known tyre, as points: sweeps of slip at several sideslips, and of sideslip."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import tir
from mffit import config as configuration
from mffit.fit import FitResult, fit
from mffit.pipeline.measuring import measure
from mffit.points import Points, make_points
from tir.parameters import TABLE

SAMPLE = Path(__file__).parents[3] / "samples" / "front-120-70"
DRIVEN = {
    "PCX1": 1.5, "PDX1": 1.25, "PDX2": -0.12, "PDX3": 2.0, "PEX1": -0.4, "PEX2": 0.2, "PEX4": 0.1, "PKX1": 28.0, "PKX2": -3.0,
    "PKX3": 0.1, "PVX1": 0.01, "PPX1": -0.3, "PPX3": -0.1, "RBX1": 15.0, "RBX2": 10.0, "RCX1": 1.05, "REX1": -0.4,
    "RBY1": 13.0, "RBY2": 9.0, "RCY1": 1.03, "REY1": -0.5, "RHY1": 0.004, "RVY1": 0.02, "RVY3": 0.3, "RVY4": 14.0, "RVY5": 1.7,
    "RVY6": 12.0, "SSZ1": 0.01, "SSZ2": 0.03, "QSX1": 0.004, "QSX2": 0.4, "QSX3": 0.06,
}  # fmt: skip
NOISE = {"Fx": 12.0, "Fy": 8.0, "Mz": 1.0, "Mx": 2.0}
MX_ZERO, FX_INTO_MX = 30.0, 0.003
"""Errors of the rig [Nm], [m]."""
LOADS, SIDESLIPS = (900.0, 1400.0, 2100.0), (-5.0, -2.0, 0.0, 2.0, 5.0)
SLIP = np.sin(np.linspace(0.0, 2.0 * np.pi, 33))


def truth() -> tir.Tyre:
    """The tyre that is measured."""
    still = dict.fromkeys((f"QSX{k}" for k in range(4, 15)), 0.0)  # one form of the overturning moment
    odd = {row.name: 0.0 for row in TABLE if row.odd}
    return tir.read(SAMPLE / "true.tir").replace(**{**odd, **still, **DRIVEN})


def programme(
    *,
    sideslips: tuple[float, ...] = SIDESLIPS,
    driven: bool = True,
    seed: int = 1,
    tyre: tir.Tyre | None = None,
) -> Points:
    """Points of the programme, with noise; ``driven`` False: its sweeps of sideslip only; ``tyre``: another truth."""
    sweeps: list[tuple[Any, ...]] = []
    for load in LOADS:
        for camber in (0.0, 6.0):
            sweeps.append((load, camber, 250e3, 10.0 * SLIP, 0.0))
            if driven:
                sweeps += [(load, camber, 250e3, alpha, 0.2 * SLIP) for alpha in sideslips]
    for p in (200e3, 300e3):
        for camber in (0.0, 6.0):
            sweeps.append((1400.0, camber, p, 10.0 * SLIP, 0.0))
            if driven:
                sweeps.append((1400.0, camber, p, 0.0, 0.2 * SLIP))
    rows = [
        np.column_stack(
            np.broadcast_arrays(k, load, np.radians(camber), p, np.radians(alpha), kappa, 0.0 * SLIP)
        )
        for k, (load, camber, p, alpha, kappa) in enumerate(sweeps)
    ]
    sweep, Fz, gamma, p, alpha, kappa, _ = np.concatenate(rows).T
    found = (tyre or truth())(Fz, alpha, gamma, kappa, Vx=16.0, p=p, turn_slip=False)
    noise = np.random.default_rng(seed)
    readings = {
        name: getattr(found, name) + sigma * noise.standard_normal(len(Fz)) for name, sigma in NOISE.items()
    }
    readings["Mx"] += MX_ZERO + FX_INTO_MX * found.Fx
    return make_points(
        alpha, gamma, Fz, kappa=kappa, p=p, V=16.0, phi_t=0.0, sweep=sweep.astype(int),
        sweep_names=[f"sweep {k}" for k in range(len(sweeps))],
        **(readings if driven else {name: readings[name] for name in ("Fy", "Mz")}),
        **{f"u_{name}": sigma for name, sigma in NOISE.items() if driven or name in ("Fy", "Mz")},
    )  # fmt: skip


def config() -> Any:
    """The project of the programme, without a base file."""
    return configuration.load(
        {
            "tyre": {
                "name": "belt", "unloaded_radius": 0.2992, "width": 0.12, "rim_radius": 0.2159, "nominal_load": 1400,
                "nominal_pressure": 250,
            },
            "rig": {"type": "flat-track", "axes": "iso", "u_Fx_into_Mx_m": 0.005},
            "sweep": [{"file": "any.csv"}],
        }
    )  # fmt: skip


def fitted(points: Points) -> FitResult:
    """The fit of the project to points."""
    project = config()
    parts, measured = measure(project, points, None)
    return fit(project, points, parts, measured)
