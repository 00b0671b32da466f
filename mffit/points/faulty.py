"""Samples that are no measurement: gaps, no load, stuck and clipped channels, spikes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.ndimage import median_filter

from mffit.points.steady import runs
from mffit.scatter import robust
from mffit.sweeps import Sweep

UNLOADED = 0.1
"""Load, per usual load of the recording, below which the tyre does not roll on its belt."""
FREE = 0.02
"""Longitudinal slip up to which the wheel counts as rolling freely."""
DRIVEN = "driven or braked, and only free rolling is fitted"
STUCK = 0.5  # s of one value to the last digit
FEWEST_STUCK = 20  # samples of it
CLIPPED = 6  # samples in a row at the very end of a channel's range
CHANGES = 0.8
"""Share of samples that differ from the one before, from which on a value that stays is suspicious."""
MOVED = 12.0
"""Range of the side force, per noise of a sample, that is no noise of an axis at rest."""
SPIKE = 12.0
"""Standard deviations of the noise from the median of five samples."""
SPIKE_SHARE = 0.15
"""The same per usual load, for a force; a moment spikes by this arm [m]:"""
SPIKE_ARM = 0.03
WINDOW = 5


class Fault(NamedTuple):
    """Samples that are no measurement, and what is wrong with them."""

    which: np.ndarray  #: mask (n,)
    reason: str
    stretch: bool  #: it ends the stretch around it; else the samples alone are left out


def driven(sweep: Sweep) -> np.ndarray:
    """Samples or points (n,) at which the wheel does not roll freely."""
    if "kappa" not in sweep.table:
        return np.zeros(len(sweep), dtype=bool)
    return np.abs(sweep.table["kappa"].to_numpy(dtype=float)) > FREE


def faults(sweep: Sweep) -> list[Fault]:
    """Everything wrong with the samples of a series."""
    usual = float(np.nanmedian(np.abs(sweep.Fz))) if np.any(np.isfinite(sweep.Fz)) else 0.0
    found = []
    for name in ("alpha", "gamma", "Fz", "Fy"):
        found.append(Fault(~np.isfinite(getattr(sweep, name)), f"no reading of {name}", True))
    found.append(Fault(sweep.Fz < UNLOADED * usual, "no load on the tyre", True))
    found.append(Fault(driven(sweep), DRIVEN, True))
    rate = 1.0 / max(float(np.median(np.diff(sweep.time))), 1e-9) if len(sweep) > 1 else 1.0
    for name, size in (("Fy", SPIKE_SHARE), ("Mz", SPIKE_ARM), ("Fz", SPIKE_SHARE)):
        values = getattr(sweep, name)
        if values.strides == (0,) or np.all(np.isnan(values)):
            continue
        found.append(Fault(_spikes(values, size * usual), f"spikes of {name}", False))
        at_end = (values == np.nanmax(values)) | (values == np.nanmin(values))
        if not _lively(values, ~at_end):
            continue
        clipped = _runs(at_end, CLIPPED)
        found.append(Fault(clipped, f"{name} clipped", True))
        found.append(Fault(_still(values, rate) & ~clipped, f"{name} stuck", True))
    # An axis that holds a set-point may rest to the last digit; the tyre then answers to nothing new.
    stuck = _still(sweep.alpha, rate) & _lively(sweep.alpha, np.ones(len(sweep), dtype=bool))
    if np.any(stuck):
        found.append(Fault(_while_moving(stuck, sweep.Fy), "alpha stuck while Fy moves", True))
    return [fault for fault in found if np.any(fault.which)]


def _lively(values: np.ndarray, some: np.ndarray) -> bool:
    """Whether nearly every sample differs from the one before, as those of a sensor do, among ``some`` (n,)."""
    steps = np.diff(values)[some[1:] & some[:-1]]
    return bool(len(steps)) and float(np.mean(steps != 0.0)) >= CHANGES


def _still(values: np.ndarray, rate: float) -> np.ndarray:
    """Samples (n,) in runs of one value to the last digit."""
    return _runs(np.r_[False, np.diff(values) == 0.0], max(FEWEST_STUCK, round(STUCK * rate)) - 1)


def _while_moving(stuck: np.ndarray, Fy: np.ndarray) -> np.ndarray:
    """Those of the runs of a mask (n,) in which the side force moves by more than its noise can."""
    noise = robust(np.diff(Fy)) / np.sqrt(2.0)
    out = np.zeros_like(stuck)
    for begin, end in runs(stuck):
        out[begin:end] = np.ptp(Fy[begin:end]) > MOVED * noise
    return out


def _spikes(values: np.ndarray, smallest: float) -> np.ndarray:
    away = np.abs(values - median_filter(values, WINDOW, mode="nearest"))
    finite = away[np.isfinite(away)]
    if not len(finite):
        return np.zeros(len(values), dtype=bool)
    noise = robust(finite[:: max(len(finite) // 100_000, 1)])
    return away > max(SPIKE * noise, smallest)


def _runs(mask: np.ndarray, shortest: int) -> np.ndarray:
    """The samples (n,) of a mask that stand in runs of at least ``shortest``."""
    edges = np.flatnonzero(np.diff(np.r_[False, mask, False].astype(np.int8)))
    begin, end = edges[::2], edges[1::2]
    long = end - begin >= shortest
    out = np.zeros(len(mask) + 1, dtype=np.int32)
    np.add.at(out, begin[long], 1)
    np.add.at(out, end[long], -1)
    return np.cumsum(out)[:-1] > 0
