"""Points of one curve and curves of one panel, for the pictures only."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.points import Points, levels
from mffit.quantities import CONDITIONS
from mffit.report import constants


def condition(load: float, pressure: float) -> str:
    """Load [N] and pressure [kPa] of a panel, in words."""
    return f"{CONDITIONS['Fz_N'].of(load)}, {CONDITIONS['p_kPa'].of(pressure)}"


CurveKey = tuple[str, str, float, float, float, bool, int, float]
"""Sweep, what varies, load, pressure, the held angle, forward, mount, camber."""


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Points of one sweep that differ in one angle, or in longitudinal slip, only."""

    over: str  #: what varies, "alpha", "gamma" or "kappa"
    load: float  #: [N]
    pressure: float  #: [kPa]
    held: float  #: value of the other angle, over longitudinal slip of sideslip [deg]
    forward: bool
    mount: int
    sweep: str
    index: np.ndarray  #: (k,) rows of the points, in order of what varies
    camber: float = 0.0  #: of a curve over longitudinal slip [deg]

    @property
    def key(self) -> CurveKey:
        """Identifies this curve among all."""
        return (
            self.sweep, self.over, self.load, self.pressure, self.held, self.forward, self.mount, self.camber,
        )  # fmt: skip

    @property
    def condition(self) -> str:
        return condition(self.load, self.pressure)

    def varied(self, points: Points) -> np.ndarray:
        """What varies (k,): an angle [deg] or longitudinal slip [-]."""
        varied: np.ndarray = shown_values(points, self.over)[self.index]
        return varied


def shown_values(points: Points, over: str) -> np.ndarray:
    """Sideslip or camber [deg], or longitudinal slip [-], of all points (n,)."""
    values: np.ndarray = getattr(points, over)
    return values if over == "kappa" else np.degrees(values)


@dataclass(frozen=True, slots=True, eq=False)
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
    """Every series of at least four set-points over an angle or over longitudinal slip, by load, pressure and held angle.

    Series over an angle are of the freely rolling wheel.
    """
    driven = _slip_curves(points)
    taken = np.zeros(len(points), dtype=bool)
    for curve in driven:
        taken[curve.index] = True
    held = {
        "alpha": np.degrees(levels.level_values(points.gamma, levels.CAMBER)),
        "gamma": np.degrees(levels.level_values(points.alpha, levels.SIDESLIP)),
    }
    load, pressure = load_levels(points), pressure_levels(points)
    found = driven
    for name, members in _sweeps(points):
        rows = members[points.free_rolling[members] & ~taken[members]]
        if not len(rows):
            continue
        over = _varied(np.degrees(points.alpha[rows]), np.degrees(points.gamma[rows]))
        keys = np.column_stack(
            [load[rows], pressure[rows], held[over][rows], points.direction[rows], points.mount[rows]]
        )
        found += _along(points, name, over, rows, keys, constants.SET_POINT_WIDTH)
    return sorted(found, key=lambda c: (c.over, c.load, c.pressure, c.camber, c.held, not c.forward))


def _slip_curves(points: Points) -> list[Curve]:
    """The series over longitudinal slip."""
    if np.all(points.free_rolling):
        return []
    found: list[Curve] = []
    load, pressure = load_levels(points), pressure_levels(points)
    driven = [(name, rows) for name, rows in _sweeps(points) if not np.all(points.free_rolling[rows])]
    alpha = _held_angles(points.alpha, [rows for _, rows in driven], levels.SIDESLIP)
    gamma = _held_angles(points.gamma, [rows for _, rows in driven], levels.CAMBER)
    for name, rows in driven:
        keys = np.column_stack(
            [
                load[rows],
                pressure[rows],
                alpha[rows],
                points.direction[rows],
                points.mount[rows],
                np.round(gamma[rows], 1),
            ]
        )
        found += _along(points, name, "kappa", rows, keys, constants.SLIP_SET_POINT_WIDTH)
    return found


def _held_angles(angle: np.ndarray, sweeps: Sequence[np.ndarray], kind: levels.LevelKind) -> np.ndarray:
    """The angle (n,) [deg] held at each point of sweeps of slip, the same for sweeps of one level; NaN elsewhere."""
    # Levels within each sweep first: those of a sideslip sweep over all angles say nothing about the angles that are held here.
    held = np.full(len(angle), np.nan)
    for rows in sweeps:
        held[rows] = levels.level_values(angle[rows], kind)
    degrees: np.ndarray = np.degrees(levels.level_values(held, kind))
    return degrees


def _along(
    points: Points, name: str, over: str, rows: np.ndarray, keys: np.ndarray, width: float
) -> list[Curve]:
    """The groups of rows with equal keys (k, 5 or 6) that have enough set-points, in order of what varies."""
    values, found = shown_values(points, over), []
    for key, members in _groups(keys):
        index = rows[members]
        if len(np.unique(np.round(values[index] / width))) < constants.FEWEST_SET_POINTS_OF_CURVE:
            continue
        found.append(
            Curve(
                over=over,
                load=float(key[0]),
                pressure=float(key[1]),
                held=float(key[2]),
                forward=bool(key[3] > 0),
                mount=int(key[4]),
                sweep=name,
                index=index[np.argsort(values[index], kind="stable")],
                camber=float(key[5]) + 0.0 if over == "kappa" else 0.0,
            )
        )
    return found


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
    keys = np.nan_to_num(keys)
    return [(keys[rows[0]], rows) for rows in levels.rows_of_equal(keys)]
