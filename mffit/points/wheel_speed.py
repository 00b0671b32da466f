"""Longitudinal slip from the speeds of wheel and road, where a rig records no slip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mffit.points import constants
from mffit.sweeps import Sweep
from tir.errors import some

FROM_SPEEDS = "slip from wheel and road speed"
"""In place of a heading."""


def with_slip(sweeps: Sequence[Sweep], unloaded_radius: float) -> tuple[tuple[Sweep, ...], tuple[str, ...]]:
    """The sweeps, with slip where speeds show that the wheel was driven and none was recorded; and a sentence about it.

    It is ``omega R / (V cos alpha) - 1`` with the radius that holds on average at the load. Its zero is free rolling only as far
    as driving and braking balance; if Fx was measured, it is set to Fx = 0 later.
    """
    out, files = [], []
    for sweep in sweeps:
        slip = _slip(sweep, unloaded_radius)
        if slip is not None:
            files.append(sweep.file)
        out.append(sweep if slip is None else replace(sweep, kappa=slip))
    if not files:
        return tuple(out), ()
    return tuple(out), (
        f"{some(list(dict.fromkeys(files)))}: no slip was recorded, but wheel and road speed show that the wheel was driven or "
        "braked; slip follows from both",
    )


def is_derived(sweep: Sweep) -> bool:
    """Whether the slip of a sweep was not recorded but follows from speeds."""
    return "kappa" not in sweep.table and bool(np.any(sweep.kappa != 0.0))


def _slip(sweep: Sweep, radius: float) -> np.ndarray | None:
    """Slip (n,) of a driven or braked wheel; None if it was recorded, if a speed lacks, or if the wheel rolled freely."""
    if "kappa" in sweep.table or "V_mps" not in sweep.table:
        return None
    along = sweep.V * np.cos(sweep.alpha)
    turning = np.isfinite(sweep.omega) & np.isfinite(along) & (along > constants.SLOWEST_ROLLING)
    if not np.any(turning):
        return None
    slip = np.full(len(sweep), np.nan)
    slip[turning] = np.abs(sweep.omega[turning]) * radius / along[turning] - 1.0
    rolling = _over_load(slip[turning], sweep.Fz[turning])
    slip[turning] = (1.0 + slip[turning]) / (1.0 + rolling) - 1.0
    low, high = np.nanpercentile(slip, constants.CORE)
    return slip if high - low >= constants.SMALLEST_SWEEP_OF_SLIP else None


def _over_load(slip: np.ndarray, Fz: np.ndarray) -> np.ndarray:
    """The slip (n,) as a parabola over load, as that of a freely rolling wheel against its unloaded radius."""
    if np.ptp(Fz) < constants.CONDITION * np.median(Fz):
        return np.full(len(slip), np.median(slip))
    return np.polynomial.Polynomial.fit(Fz, slip, 2)(Fz)
