"""Samples that are no measurement: gaps, no load, stuck and clipped channels, spikes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.ndimage import median_filter

from mffit.scatter import robust
from mffit.sweeps import Sweep

UNLOADED = 0.1
"""Load, per usual load of the recording, below which the tyre does not roll on its belt."""
FREE = 0.02
"""Longitudinal slip up to which the wheel counts as rolling freely."""
STUCK = 0.5  # s of one value to the last digit
FEWEST_STUCK = 20  # samples of it
CLIPPED = 6  # samples in a row at the very end of a channel's range
CHANGES = 0.8
"""Share of samples that differ from the one before, from which on a value that stays is suspicious."""
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


def faults(sweep: Sweep) -> list[Fault]:
    """Everything wrong with the samples of a series."""
    usual = float(np.nanmedian(np.abs(sweep.Fz))) if np.any(np.isfinite(sweep.Fz)) else 0.0
    found = []
    for name in ("alpha", "gamma", "Fz", "Fy"):
        found.append(Fault(~np.isfinite(getattr(sweep, name)), f"no reading of {name}", True))
    found.append(Fault(sweep.Fz < UNLOADED * usual, "no load on the tyre", True))
    if "kappa" in sweep.table:
        driven = np.abs(sweep.table["kappa"].to_numpy(dtype=float)) > FREE
        found.append(Fault(driven, "driven or braked, and only free rolling is fitted", True))
    rate = 1.0 / max(float(np.median(np.diff(sweep.time))), 1e-9) if len(sweep) > 1 else 1.0
    for name, size in (("Fy", SPIKE_SHARE), ("Mz", SPIKE_ARM), ("Fz", SPIKE_SHARE)):
        values = getattr(sweep, name)
        if values.strides == (0,) or np.all(np.isnan(values)):
            continue
        found.append(Fault(_spikes(values, size * usual), f"spikes of {name}", False))
        steps = np.diff(values)
        if np.mean(steps != 0.0) < CHANGES:
            continue
        longest = max(FEWEST_STUCK, round(STUCK * rate))
        still = _runs(np.r_[False, steps == 0.0], longest - 1)
        at_end = (values == np.nanmax(values)) | (values == np.nanmin(values))
        clipped = _runs(at_end, CLIPPED)
        found.append(Fault(clipped, f"{name} clipped", True))
        found.append(Fault(still & ~clipped, f"{name} stuck", True))
    return [fault for fault in found if np.any(fault.which)]


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
