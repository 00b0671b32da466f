"""The record of one sweep: measured rows in ISO-W and SI."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from mffit.brief import Brief


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Sweep(Brief):
    """Rows of one sweep in ISO-W, contact frame W, SI; arrays are (n,), all NaN for a channel not measured.

    The rows are finished points, or samples of a time series if ``time`` is finite.
    """

    name: str
    file: str  #: name as in ``tyre.toml``
    alpha: np.ndarray  #: sideslip angle as read [rad]
    gamma: np.ndarray  #: camber as read [rad]
    Fz: np.ndarray  #: load, positive [N]
    Fy: np.ndarray  #: [N]
    Mz: np.ndarray  #: [Nm]
    Mx: np.ndarray  #: [Nm]
    My: np.ndarray  #: [Nm]
    p: np.ndarray  #: pressure, nominal if not measured [Pa]
    V: np.ndarray  #: speed, positive, nominal if not measured [m/s]
    T: np.ndarray  #: tyre temperature [degC]
    t: np.ndarray  #: time at which a finished point was taken [s]
    u_Fy: np.ndarray  #: standard uncertainty [N]
    u_Mz: np.ndarray  #: standard uncertainty [Nm]
    iteration: np.ndarray  #: step of the steering alignment
    direction: np.ndarray  #: +1 forward, -1 backward
    mount: int  #: +1 normal, -1 tyre turned on its rim
    setup: str  #: name of the set-up of the rig; empty if none is declared
    time: np.ndarray  #: time of a sample [s]; NaN for finished points
    point: (
        np.ndarray | None
    )  #: label of the point that a sample belongs to, "" between points; None without labels
    line: np.ndarray  #: line in the file, from 1
    table: pd.DataFrame  #: columns as reported, in the contract's names and units and the rig's axes

    def __len__(self) -> int:
        return len(self.alpha)

    @property
    def is_series(self) -> bool:
        """Whether the rows are samples in time rather than finished points."""
        return bool(np.all(np.isfinite(self.time)))


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ExcludedRows(Brief):
    """Rows of one file that one entry of ``[fit] exclude`` leaves out."""

    file: str  #: name as in ``tyre.toml``
    line: np.ndarray  #: (n,) in the file, counted from 1
    why: str
    sweeps: tuple[Sweep, ...]  #: the same rows as they would have been read; empty if they cannot be


@dataclass(frozen=True, slots=True, repr=False)
class Sweeps(Brief):
    """All sweeps of a configuration, in its order, with warnings."""

    sweeps: tuple[Sweep, ...]  #: without the excluded rows
    warnings: tuple[str, ...]
    excluded: tuple[ExcludedRows, ...] = ()
