"""A programme of two loads on a disc and its noise-free readings, small enough for closed forms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import tir
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.stated import stated_noise
from mffit.points import Points, make_points
from mffit.rig import Simulation
from mffit.rig_errors import NO_FAULTS, Faults

TYRE = tir.read(Path(__file__).parents[3] / "samples" / "front-120-70" / "true.tir")
U_FY, U_MZ = 6.0, 0.6
SLIP = np.arange(-8.0, 8.1, 1.0)
LEAN = np.array([-40.0, -30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0, 40.0])
LOADS = (1000.0, 1800.0)


def programme(**changes: Any) -> Points:
    """Sideslip and camber at both loads, sideslip backwards at one; 7 sweeps of 17, 9 or 17 points."""
    rows = []
    for k, load in enumerate(LOADS):
        rows += [(a, 0.0, load, 1, 2 * k) for a in SLIP] + [(0.0, g, load, 1, 2 * k + 1) for g in LEAN]
    rows += [(a, 0.0, LOADS[0], -1, 4) for a in SLIP]
    alpha, gamma, Fz, direction, sweep = np.array(rows).T
    given = dict(
        p=250e3, V=6.0, phi_t=-1 / 1.323, direction=direction.astype(int), sweep=sweep.astype(int), u_Fy=U_FY, u_Mz=U_MZ,
        sweep_names=tuple(f"sweep {k}" for k in range(5)), T=25.0, t=60.0 * np.arange(len(rows)),
    )  # fmt: skip
    return make_points(np.radians(alpha), np.radians(gamma), Fz, **given | changes)


def read(
    points: Points, tyre: tir.Tyre = TYRE, faults: Faults = NO_FAULTS, noise: int | None = None
) -> Points:
    """The points with the readings of a tyre on a rig; ``noise`` is the seed of their noise."""
    Fy, Mz = Simulation.of(tyre, faults).readings(points).values()
    if noise is not None:
        drawn = np.random.default_rng(noise).standard_normal((2, len(points)))
        Fy, Mz = Fy + U_FY * drawn[0], Mz + U_MZ * drawn[1]
    return points.replace(Fy=Fy, Mz=Mz)


def problem(points: Points, tyre: tir.Tyre = TYRE) -> DiagnosisProblem:
    """The readings against the tyre, with independent noise as stated."""
    return DiagnosisProblem(points, Simulation.of(tyre), stated_noise(points))
