"""The record of one sweep: measured rows in ISO-W and SI."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from mffit.brief import Brief
from tir.frozen import ReadOnlyArrays


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class MeasuredRows(ReadOnlyArrays, Brief):
    """Rows in ISO-W, contact frame W, SI; arrays are (n,), all NaN for a channel that was not measured."""

    alpha: np.ndarray  #: sideslip angle as read [rad]
    gamma: np.ndarray  #: camber (inclination angle) as read [rad]
    kappa: np.ndarray  #: longitudinal slip [-], positive if driven; 0 (free rolling) if not measured
    Fz: np.ndarray  #: load, positive [N]
    p: np.ndarray  #: inflation pressure, nominal if not measured [Pa]
    V: np.ndarray  #: speed, positive in both directions, nominal if not measured [m/s]
    Fx: np.ndarray  #: [N]
    Fy: np.ndarray  #: [N]
    Mx: np.ndarray  #: [Nm]
    My: np.ndarray  #: [Nm]
    Mz: np.ndarray  #: [Nm]
    RL: np.ndarray  #: loaded radius [m]
    omega: np.ndarray  #: wheel speed [rad/s], negative when the wheel rolls backwards
    T: np.ndarray  #: tyre temperature [degC]
    t: np.ndarray  #: time at which a finished point was taken [s]
    u_Fx: np.ndarray  #: standard uncertainty of Fx [N]; likewise for the other channels
    u_Fy: np.ndarray
    u_Mx: np.ndarray
    u_My: np.ndarray
    u_Mz: np.ndarray
    u_RL: np.ndarray
    u_omega: np.ndarray
    iteration: np.ndarray  #: step of the steering alignment; NaN when not given
    direction: np.ndarray  #: +1 forward, -1 backward
    time: np.ndarray
    """Time of a sample within its file or moving sweep [s]; NaN for finished and steady points."""
    line: np.ndarray  #: line in the file, from 1
    table: pd.DataFrame
    """Columns as reported, in the contract's names and units and the rig's axes, a row per reading."""

    def __len__(self) -> int:
        return len(self.alpha)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Sweep(MeasuredRows):
    """Rows of one sweep: finished points, or samples of a time series if ``time`` is finite."""

    name: str
    file: str  #: name as in ``tyre.toml``
    mount: int  #: +1 normal, -1 tyre turned on its rim
    setup: str  #: name of the set-up of the rig; empty if none is declared
    point: np.ndarray | None
    """Label of the point that a sample belongs to, "" between points; None without labels."""

    @property
    def is_series(self) -> bool:
        """Whether the rows are samples in time rather than finished points."""
        return bool(np.all(np.isfinite(self.time)))


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ExcludedRows(ReadOnlyArrays, Brief):
    """Rows of a file that an entry of ``[fit] exclude`` leaves out."""

    file: str  #: name as in ``tyre.toml``
    line: np.ndarray  #: (n,) in the file, counted from 1
    why: str


@dataclass(frozen=True, slots=True, repr=False)
class Sweeps(ReadOnlyArrays, Brief):
    """All sweeps of a configuration, in its order, with warnings."""

    sweeps: tuple[Sweep, ...]  #: without the excluded rows
    warnings: tuple[str, ...]
    excluded: tuple[ExcludedRows, ...] = ()
    of_excluded: tuple[Sweep, ...] = ()  #: sweeps of the excluded rows, as far as they can be read
    standing: tuple[tuple[str, np.ndarray], ...] = ()
    """File, as named in ``tyre.toml``, and lines (m,) of the samples at standstill."""
