"""Points of one curve and curves of one panel, for the pictures only."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from mffit.points import Points, levels
from mffit.quantities import CONDITIONS
from mffit.report import constants


def condition(load: float, pressure: float) -> str:
    """Load [N] and pressure [kPa] of a panel, in words."""
    return f"{CONDITIONS['Fz_N'].of(load)}, {CONDITIONS['p_kPa'].of(pressure)}"


@dataclass(frozen=True, slots=True)
class Curve:
    """Points of one sweep that differ in one angle only."""

    over: str  #: the angle that varies, "alpha" or "gamma"
    load: float  #: [N]
    pressure: float  #: [kPa]
    held: float  #: value of the other angle [deg]
    forward: bool
    mount: int
    sweep: str
    index: np.ndarray  #: (k,) rows of the points, in order of the angle

    @property
    def key(self) -> tuple[str, str, float, float, float, bool, int]:
        """Identifies this curve among all."""
        return self.sweep, self.over, self.load, self.pressure, self.held, self.forward, self.mount

    @property
    def condition(self) -> str:
        return condition(self.load, self.pressure)

    def angles(self, points: Points) -> np.ndarray:
        """The varied angle (k,) [deg]."""
        return np.degrees(getattr(points, self.over)[self.index])


@dataclass(frozen=True, slots=True)
class CurveCondition:
    """Points at one load and pressure."""

    load: float  #: [N]
    pressure: float  #: [kPa]
    index: np.ndarray  #: (k,) rows of the points

    @property
    def title(self) -> str:
        return condition(self.load, self.pressure)


def load_levels(points: Points) -> np.ndarray:
    """Load of each point's level [N], rounded."""
    step = constants.LOAD_ROUNDING
    held = levels.labels_of_sweeps(points.Fz, points.sweep, levels.LOAD)
    return np.round(levels.median_of_labels(points.Fz, held) / step) * step


def pressure_levels(points: Points) -> np.ndarray:
    """Pressure of each point's level [kPa], rounded."""
    step = constants.PRESSURE_ROUNDING
    return np.round(levels.level_values(points.p, levels.PRESSURE) / step) * step / 1000.0


def conditions(points: Points) -> list[CurveCondition]:
    """The points by load and pressure, in that order."""
    keys = np.column_stack([load_levels(points), pressure_levels(points)])
    return [CurveCondition(float(k[0]), float(k[1]), index) for k, index in _groups(keys)]


def curves(points: Points) -> list[Curve]:
    """Every series of at least four set-points over one angle, sorted by load, pressure and held angle."""
    alpha, gamma = np.degrees(points.alpha), np.degrees(points.gamma)
    held = {
        "alpha": np.degrees(levels.level_values(points.gamma, levels.CAMBER)),
        "gamma": np.degrees(levels.level_values(points.alpha, levels.SIDESLIP)),
    }
    angle = {"alpha": alpha, "gamma": gamma}
    load, pressure = load_levels(points), pressure_levels(points)
    found = []
    for name, rows in _sweeps(points):
        over = _varied(alpha[rows], gamma[rows])
        keys = np.column_stack(
            [load[rows], pressure[rows], held[over][rows], points.direction[rows], points.mount[rows]]
        )
        for key, members in _groups(keys):
            index = rows[members]
            if _set_points(angle[over][index]) >= constants.FEWEST_SET_POINTS_OF_CURVE:
                index = index[np.argsort(angle[over][index], kind="stable")]
                found.append(
                    Curve(
                        over=over,
                        load=float(key[0]),
                        pressure=float(key[1]),
                        held=float(key[2]),
                        forward=bool(key[3] > 0),
                        mount=int(key[4]),
                        sweep=name,
                        index=index,
                    )
                )
    return sorted(found, key=lambda c: (c.over, c.load, c.pressure, c.held, not c.forward))


def _sweeps(points: Points) -> Iterable[tuple[str, np.ndarray]]:
    for i, name in enumerate(points.sweep_names):
        yield name, np.flatnonzero(points.sweep == i)


def _varied(alpha: np.ndarray, gamma: np.ndarray) -> str:
    """The angle with more set-points; a grid counts as sideslip sweeps at several cambers."""
    return "alpha" if _set_points(alpha) >= _set_points(gamma) else "gamma"


def _set_points(angle: np.ndarray) -> int:
    """Number of set-points of an angle (k,) [deg]."""
    return len(np.unique(np.round(angle / constants.SET_POINT_WIDTH)))


def _groups(keys: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Rows with equal keys, in order of the keys."""
    if len(keys) == 0:
        return []
    unique, inverse = np.unique(np.nan_to_num(keys), axis=0, return_inverse=True)
    return [(key, np.flatnonzero(inverse.ravel() == i)) for i, key in enumerate(unique)]
