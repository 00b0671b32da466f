"""Points of one curve, curves of one panel, and the model as a line along a curve, for the pictures only."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.constants import FEWEST, STEPS_OF_LINE
from mffit.parts.constants import SAME_CAMBER
from mffit.points import Points, levels, like
from mffit.quantities import CONDITIONS, SIDEWAYS
from mffit.rig import Simulation
from tir.frozen import ReadOnlyArrays


def condition(load: float, pressure: float) -> str:
    """Load [N] and pressure [kPa] of a panel, in words."""
    return f"{CONDITIONS['Fz_N'].of(load)}, {CONDITIONS['p_kPa'].of(pressure)}"


@dataclass(frozen=True, slots=True, eq=False)
class Curve(ReadOnlyArrays):
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
    def condition(self) -> str:
        return condition(self.load, self.pressure)

    def varied(self, points: Points) -> np.ndarray:
        """What varies (k,): an angle [deg] or longitudinal slip [-]."""
        return np.asarray(shown_values(points, self.over)[self.index])


def shown_values(points: Points, over: str) -> np.ndarray:
    """Sideslip or camber [deg], or longitudinal slip [-], of all points (n,)."""
    values: np.ndarray = getattr(points, over)
    return values if over == "kappa" else np.degrees(values)


@dataclass(frozen=True, slots=True, eq=False)
class CurveCondition(ReadOnlyArrays):
    """Points at one load and pressure."""

    load: float  #: [N]
    pressure: float  #: [kPa]
    index: np.ndarray  #: (k,) rows of the points

    @property
    def title(self) -> str:
        return condition(self.load, self.pressure)


def _load_and_pressure(points: Points) -> tuple[np.ndarray, np.ndarray]:
    """Load [N] and pressure [kPa] of each point's level, rounded to what rigs hold and gauges show."""
    held = levels.labels_of_setting(points, "Fz")
    load = levels.median_of_labels(points.Fz, held)
    return np.round(load, -1), np.round(levels.level_values(points.p, levels.PRESSURE) / 1000.0)


def conditions(points: Points) -> list[CurveCondition]:
    """The points by load and pressure, in that order."""
    keys = np.column_stack(_load_and_pressure(points))
    return [CurveCondition(float(k[0]), float(k[1]), index) for k, index in _groups(keys)]


def curves(points: Points) -> list[Curve]:
    """Every series of at least four set-points over an angle or over longitudinal slip, by load, pressure and held angle.

    Series over an angle are of the freely rolling wheel.
    """
    found: dict[str, list[np.ndarray]] = {name: [] for name in like.VARIED}
    for over, rows in like.series(points, signed=True):
        own = rows if over == "kappa" else rows[points.free_rolling[rows]]
        values = shown_values(points, over)[own]
        if _set_points(values, over) >= FEWEST:
            found[over].append(own[np.argsort(values, kind="stable")])
    load, pressure = _load_and_pressure(points)
    out = []
    for over, each in found.items():
        held = {name: _held(points, name, each) for name in ("alpha", "gamma") if name != over}
        out += [
            Curve(
                over=over,
                load=float(load[rows[0]]),
                pressure=float(pressure[rows[0]]),
                held=next(iter(held.values()))[k],
                forward=bool(points.direction[rows[0]] > 0),
                mount=int(points.mount[rows[0]]),
                sweep=points.sweep_names[points.sweep[rows[0]]],
                index=rows,
                camber=round(held["gamma"][k], 1) + 0.0 if over == "kappa" else 0.0,
            )
            for k, rows in enumerate(each)
        ]
    return sorted(out, key=lambda c: (c.over, c.load, c.pressure, c.camber, c.held, not c.forward))


def _held(points: Points, name: str, rows: Sequence[np.ndarray]) -> list[float]:
    """The angle [deg] that each of some curves holds, the same for curves of one level."""
    middle = np.full(len(points), np.nan)
    for own in rows:
        middle[own] = np.median(getattr(points, name)[own])
    held = np.degrees(levels.level_values(middle, levels.KINDS[name]))
    return [float(held[own[0]]) for own in rows]


def _set_points(values: np.ndarray, over: str) -> int:
    """Number of set-points of an angle (k,) [deg], or of longitudinal slip."""
    width = levels.SLIP.tolerance if over == "kappa" else SAME_CAMBER
    return len(np.unique(np.round(values / width)))


def _groups(keys: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Rows with equal keys, in order of the keys."""
    keys = np.nan_to_num(keys)
    return [(keys[rows[0]], rows) for rows in levels.rows_of_equal(keys)]


VARIED = ("alpha", "gamma", "kappa", "Fz", "p", "V")
"""Conditions that a line holds at their median, or lets vary."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveLine(ReadOnlyArrays):
    """Readings that the rig would give along a curve if the tyre were the model; arrays (m,)."""

    x: np.ndarray  #: what varies: an angle [deg] or longitudinal slip [-]
    raw: Mapping[str, np.ndarray]  #: by channel
    even: Mapping[str, np.ndarray]  #: its even part


def model_lines(
    simulation: Simulation, points: Points, curves: Sequence[Curve], channels: Iterable[str] = SIDEWAYS
) -> dict[Curve, CurveLine]:
    """A line per curve, at the curve's median load, pressure, speed and held angle; the simulation has the errors of the rig."""
    if not curves:
        return {}
    grid = _along_curves(points, curves)
    mirrored = grid.replace(alpha=-grid.alpha, gamma=-grid.gamma)
    here, there = (simulation.readings(p, channels) for p in (grid, mirrored))
    steps = STEPS_OF_LINE
    lines = {}
    for i, curve in enumerate(curves):
        rows = slice(i * steps, (i + 1) * steps)
        lines[curve] = CurveLine(
            x=shown_values(grid, curve.over)[rows],
            raw={name: values[rows] for name, values in here.items()},
            even={name: 0.5 * (values + there[name])[rows] for name, values in here.items()},
        )
    return lines


def _along_curves(points: Points, curves: Sequence[Curve]) -> Points:
    """Points at equal distances along each curve's range."""
    steps = STEPS_OF_LINE
    columns: dict[str, list[np.ndarray]] = {name: [] for name in VARIED}
    for curve in curves:
        for name, values in columns.items():
            here = getattr(points, name)[curve.index]
            values.append(
                np.linspace(here.min(), here.max(), steps)
                if name == curve.over
                else np.full(steps, np.median(here))
            )
    rows = np.repeat([curve.index[0] for curve in curves], steps)
    there = {name: np.concatenate(values) for name, values in columns.items()}
    return points.select(rows).replace(**there, time=np.full(len(rows), np.nan))  # steady, so without lag
