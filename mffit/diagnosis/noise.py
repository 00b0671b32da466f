"""How uncertain every reading is, and how uncertain the given model is: the covariance that residuals are judged by."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum, auto

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from mffit.errors import InputError
from mffit.points import Points
from mffit.rig import Simulation
from tir.parameters import TABLE


class Origin(Enum):
    """Where the uncertainties of the readings come from."""

    STATED = auto()  #: with the data
    SCATTER = auto()  #: of measured minus simulated between neighbouring points


@dataclass(frozen=True, slots=True)
class Noise:
    """Standard uncertainties and the whitening that goes with them."""

    Fy: float  #: typical noise of Fy [N]
    Mz: float  #: of Mz [Nm]; NaN if Mz was not measured
    u: np.ndarray  #: (2n,) standard uncertainty of every reading; inf where missing
    used: np.ndarray  #: (m,) indices of the readings that count
    root: (
        np.ndarray
    )  #: (m, m) Cholesky factor of the covariance; its diagonal (m,) where the readings are independent
    origin: Origin | None  #: of the uncertainties of Fy; None if it was not measured

    def whiten(self, x: np.ndarray) -> np.ndarray:
        """Readings' differences (2n,) or (2n, k) in units of their joint uncertainty: (m,) or (m, k)."""
        x = x[self.used]
        if self.root.ndim == 1:
            return (x.T / self.root).T
        return solve_triangular(self.root, x, lower=True, check_finite=False)

    def error_of_sum(self, rows: np.ndarray) -> float:
        """Standard error of the sum of some used readings, by their position among the used ones."""
        return float(np.linalg.norm(self.root[rows] if self.root.ndim == 1 else self.root[rows].sum(axis=0)))

    def subset(self, keep: np.ndarray) -> Noise:
        """The noise of some points (mask (n,)), with the covariance among them."""
        both = np.concatenate([keep, keep])
        rows = np.flatnonzero(both[self.used])
        new = np.cumsum(both) - 1
        root = self.root[rows]
        if root.ndim == 2:
            root = cholesky(root @ root.T, lower=True)
        return replace(self, u=self.u[both], used=new[self.used[rows]], root=root)

    def inflated(self, factor: float) -> Noise:
        """The same with every uncertainty enlarged."""
        return replace(self, u=factor * self.u, root=factor * self.root)


def with_uncertainties(points: Points, state: Simulation) -> tuple[Points, Origin | None]:
    """The points with a standard uncertainty for every reading, and where it comes from.

    As stated, else from the scatter of measured minus simulated between neighbouring points of each sweep, from which the
    curve itself has largely gone; so before any thinning.

    Raises
    ------
    InputError
        If all stated uncertainties are zero.
    """
    n, simulated = len(points), state.predict(points)
    Fy, origin = _channel(points, points.Fy, points.u_Fy, simulated[:n], "u_Fy_N")
    Mz, _ = _channel(points, points.Mz, points.u_Mz, simulated[n:], "u_Mz_Nm")
    return points.replace(u_Fy=Fy, u_Mz=Mz), origin


def noise_model(
    points: Points, state: Simulation, u_coefficients: float, origin: Origin | None = None
) -> Noise:
    """Covariance of the readings: their own uncertainties (finite where used) and the model's inexactness.

    Parameters
    ----------
    points : with uncertainties as :func:`with_uncertainties` gives them
    state : the simulation whose coefficients are inexact
    u_coefficients : relative standard uncertainty of the P.Y. and Q.Z. coefficients
    origin : where the uncertainties come from
    """
    Fy, Mz = points.u_Fy, points.u_Mz
    u = np.concatenate([Fy, Mz])
    used = np.flatnonzero(np.isfinite(u))
    root = u[used]
    if u_coefficients > 0.0:
        J = coefficient_jacobian(points, state)[used]
        root = cholesky(np.diag(root**2) + u_coefficients**2 * (J @ J.T), lower=True)
    return Noise(
        Fy=float(np.median(Fy[np.isfinite(Fy)])),
        Mz=float(np.median(Mz[np.isfinite(Mz)])) if np.any(np.isfinite(Mz)) else float("nan"),
        u=u,
        used=used,
        root=root,
        origin=origin,
    )


def coefficient_jacobian(points: Points, state: Simulation) -> np.ndarray:
    """Change of the readings (2n, k) per relative change of each P.Y. and Q.Z. coefficient."""
    names = [row.name for row in TABLE if row.normal_mode and state.values[row.name]]
    _, slope = state.sensitivities(points, names)
    return np.nan_to_num(np.concatenate(slope) * [float(state.values[name]) for name in names])


def _channel(
    points: Points, values: np.ndarray, stated: np.ndarray, simulated: np.ndarray, column: str
) -> tuple[np.ndarray, Origin | None]:
    """Uncertainty (n,) of one channel; inf where it was not measured."""
    measured = np.isfinite(values)
    if not np.any(measured):
        return np.full(len(points), np.inf), None
    known = measured & np.isfinite(stated)
    if np.any(known) and np.all(stated[known] <= 0.0):
        raise InputError(
            f"all {column} are zero; give real standard uncertainties, or leave the column out", column=column
        )
    if np.all(known[measured]):
        floor = 0.05 * np.median(stated[known][stated[known] > 0])
        return np.where(measured, np.maximum(stated, floor), np.inf), Origin.STATED
    guess = neighbour_noise(points, values - simulated)
    u = np.where(known, stated, guess)
    return np.where(measured, u, np.inf), Origin.SCATTER


def neighbour_noise(points: Points, values: np.ndarray) -> float:
    """Robust noise of a channel from third differences along each sweep, which a smooth curve hardly has."""
    out = []
    for k in np.unique(points.sweep):
        rows = np.flatnonzero((points.sweep == k) & np.isfinite(values))
        if len(rows) >= 6:
            out.append(np.diff(values[rows], 3) / np.sqrt(20.0))
    if not out:
        return max(0.01 * float(np.ptp(values[np.isfinite(values)])), 1e-9)
    return max(1.4826 * float(np.median(np.abs(np.concatenate(out)))), 1e-9)
