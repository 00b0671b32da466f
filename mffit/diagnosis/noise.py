"""How uncertain every reading is, and how uncertain the given model is: the covariance that residuals are judged by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum, auto
from functools import cached_property

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import SuperLU, splu

from mffit.errors import InputError
from mffit.points import Points
from mffit.quantities import CHANNELS
from mffit.rig import Simulation
from mffit.scatter import robust
from tir.parameters import TABLE


class Origin(Enum):
    """Where the uncertainties of the readings come from."""

    STATED = auto()  #: with the data
    SCATTER = auto()  #: of measured minus simulated between neighbouring points


@dataclass(frozen=True, slots=True)
class Scatter:
    """What the readings of one channel scatter like, beside what was stated of them."""

    scale: float = 1.0  #: uncertainty over the stated one
    growth: float = 0.0  #: a part in proportion to the reading, added in squares
    memory: float = 0.0  #: correlation from one point to the next along a sweep
    tails: float = np.inf  #: degrees of freedom of Student's t, infinite where the scatter is normal


@dataclass(frozen=True)
class Noise:
    """Standard uncertainties, how they hang together, and the whitening that goes with them.

    The covariance is D M D + S S': independent uncertainties D, M with ``memory`` to the power of the distance along each
    sweep, and columns S of changes that several readings share, one standard deviation each.
    """

    u: np.ndarray  #: (2n,) standard uncertainty of every reading; inf where missing
    stated: np.ndarray  #: (2n,) the same as stated
    chain: np.ndarray  #: (2n,) number of the sweep and channel along which errors may be correlated
    origin: Origin | None  #: of the uncertainties of Fy; None if it was not measured
    scatter: Mapping[str, Scatter] = field(default_factory=lambda: dict.fromkeys(CHANNELS, Scatter()))
    weight: np.ndarray | None = None  #: (2n,) of each reading; below 1 where it is wild; None: all 1
    shared: np.ndarray | None = (
        None  #: (2n, k) changes by inexactness of the model, one standard deviation each
    )

    @property
    def Fy(self) -> float:
        """Typical noise of Fy [N]."""
        return _typical(self.u[: len(self.u) // 2])

    @property
    def Mz(self) -> float:
        """Typical noise of Mz [Nm]; NaN if Mz was not measured."""
        return _typical(self.u[len(self.u) // 2 :])

    def typically_stated(self, channel: str) -> float:
        """Typical uncertainty of a channel as stated."""
        n = len(self.stated) // 2
        return _typical(self.stated[:n] if channel == "Fy" else self.stated[n:])

    @cached_property
    def used(self) -> np.ndarray:
        """Indices (m,) of the readings that count."""
        return np.flatnonzero(np.isfinite(self.u))

    @cached_property
    def _links(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of the used readings: which follow another in their sweep, which one that is, and the memory between them."""
        chain = self.chain[self.used]
        order = np.argsort(chain, kind="stable")
        follows = chain[order][1:] == chain[order][:-1]
        later, earlier = order[1:][follows], order[:-1][follows]
        memory = np.where(
            self.used[later] < len(self.u) // 2, self.scatter["Fy"].memory, self.scatter["Mz"].memory
        )
        some = memory != 0.0
        return later[some], earlier[some], memory[some]

    @cached_property
    def _axes(self) -> tuple[np.ndarray, np.ndarray]:
        """Orthogonal directions (m, k) of the shared changes, whitened, and their variances (k,)."""
        if self.shared is None or not self.shared.shape[1]:
            return np.empty((len(self.used), 0)), np.empty(0)
        white = self._independent(self.shared[self.used])
        variance, turn = np.linalg.eigh(white.T @ white)
        some = variance > 1e-9 * max(float(variance[-1]), 1e-9)
        return white @ (turn[:, some] / np.sqrt(variance[some])), variance[some]

    @cached_property
    def _forget(self) -> SuperLU:
        """The factors of the transposed whitening of what runs along sweeps."""
        m = len(self.used)
        later, earlier, memory = self._links
        own = np.ones(m)
        own[later] = 1.0 / np.sqrt(1.0 - memory**2)
        rows = np.concatenate([np.arange(m), earlier])
        columns = np.concatenate([np.arange(m), later])
        values = np.concatenate([own, -memory * own[later]]) / self.u[self.used][rows]
        return splu(csc_matrix((values, (rows, columns)), shape=(m, m)))

    def _independent(self, x: np.ndarray) -> np.ndarray:
        """Used readings' differences (m,) or (m, k) freed of their own uncertainty and of the memory along sweeps."""
        z = (x.T / self.u[self.used]).T
        later, earlier, memory = self._links
        if not len(later):
            return z
        out = z.copy()
        out[later] = ((z[later].T - memory * z[earlier].T) / np.sqrt(1.0 - memory**2)).T
        return out

    def whiten(self, x: np.ndarray) -> np.ndarray:
        """Readings' differences (2n,) or (2n, k) in units of their joint uncertainty: (m,) or (m, k)."""
        z = self._independent(x[self.used])
        axes, variance = self._axes
        if not len(variance):
            return z
        lost = 1.0 - 1.0 / np.sqrt(1.0 + variance)
        return z - axes @ ((lost * (axes.T @ z).T).T)

    def error_of_sum(self, rows: np.ndarray) -> float:
        """Standard error of the sum of some used readings, by their position among the used ones."""
        chosen = np.zeros(len(self.used))
        chosen[rows] = 1.0
        y = self._forget.solve(chosen)
        axes, variance = self._axes
        return float(np.sqrt(y @ y + variance @ (axes.T @ y) ** 2))

    def subset(self, keep: np.ndarray) -> Noise:
        """The noise of some points (mask (n,)), with the covariance among them."""
        both = np.concatenate([keep, keep])
        return replace(
            self,
            u=self.u[both],
            stated=self.stated[both],
            chain=self.chain[both],
            weight=None if self.weight is None else self.weight[both],
            shared=None if self.shared is None else self.shared[both],
        )

    def alone(self) -> Noise:
        """The scatter of the readings without the model's inexactness."""
        return replace(self, shared=None)

    def sharing(self, *columns: np.ndarray) -> Noise:
        """The same scatter with these changes (2n, k) shared, and no others."""
        given = [c for c in columns if c.size]
        return replace(self, shared=np.column_stack(given) if given else None)

    def scattering(self, scatter: Mapping[str, Scatter], size: np.ndarray, weight: np.ndarray) -> Noise:
        """The noise with another scatter.

        Parameters
        ----------
        scatter : by channel
        size : (2n,) readings that the growing part is in proportion to
        weight : (2n,) of each reading
        """
        n = len(self.stated) // 2
        u = np.empty(2 * n)
        for name, rows in (("Fy", slice(0, n)), ("Mz", slice(n, 2 * n))):
            s = scatter[name]
            u[rows] = np.hypot(s.scale * self.stated[rows], s.growth * np.nan_to_num(size[rows]))
        return replace(self, u=u / np.sqrt(weight), scatter=dict(scatter), weight=weight)


def with_uncertainties(points: Points, state: Simulation) -> tuple[Points, Origin | None]:
    """The points with a standard uncertainty for every reading, and where it comes from.

    As stated, else from the scatter of measured minus simulated between neighbouring points of each sweep, from which the
    curve itself has largely gone.

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
    u = np.concatenate([points.u_Fy, points.u_Mz])
    chain = np.concatenate([points.sweep, points.sweep + 1 + points.sweep.max(initial=0)])
    noise = Noise(u=u, stated=u, chain=chain, origin=origin)
    if u_coefficients <= 0.0:
        return noise
    return noise.sharing(u_coefficients * coefficient_jacobian(points, state))


def coefficient_jacobian(points: Points, state: Simulation) -> np.ndarray:
    """Change of the readings (2n, k) per relative change of each P.Y. and Q.Z. coefficient."""
    names = [row.name for row in TABLE if row.normal_mode and state.values[row.name]]
    _, slope = state.sensitivities(points, names)
    return np.nan_to_num(np.concatenate(slope) * [float(state.values[name]) for name in names])


def _typical(u: np.ndarray) -> float:
    known = u[np.isfinite(u)]
    return float(np.median(known)) if len(known) else float("nan")


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
    return max(robust(np.concatenate(out)), 1e-9)
