"""Longitudinal slip of a sweep."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mffit.sweeps.sweep import Sweep


def slip(sweep: Sweep) -> np.ndarray:
    """Longitudinal slip (n,) as ratio, positive when driven; NaN where it was not measured."""
    return _channel(sweep, "kappa")


def longitudinal_force(sweep: Sweep) -> np.ndarray:
    """Longitudinal force (n,) [N]; NaN where it was not measured."""
    return _channel(sweep, "Fx_N")


def with_slip(sweep: Sweep, values: np.ndarray) -> Sweep:
    """The sweep with another slip (n,)."""
    return replace(sweep, table=sweep.table.assign(kappa=values))


def _channel(sweep: Sweep, name: str) -> np.ndarray:
    if name not in sweep.table:
        return np.broadcast_to(np.nan, (len(sweep),))
    return sweep.table[name].to_numpy(dtype=float)
