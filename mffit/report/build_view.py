"""What several pictures of a build draw, taken from its result once."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mffit.fit import Coefficient
from mffit.points import Points
from mffit.quantities import CHANNELS, CONDITIONS, QuantityName
from mffit.report.curves import Curve, CurveCondition, CurveLine, conditions, curves, model_lines
from mffit.results import BuildResult
from mffit.rounding import UNKNOWN, number
from mffit.scatter import finite_median
from tir.frozen import ReadOnlyArrays
from tir.parameters import BY_NAME, Parameter

NOT_DECIDED = ("base", "converted", "default", "estimate", "given", "range")
"""Statuses of values that neither the data nor a model of them decided."""


@dataclass(frozen=True, slots=True)
class ChannelRow(ReadOnlyArrays):
    """One measured channel; arrays (n,) in its unit, NaN where unknown."""

    name: str
    measured: np.ndarray
    u: np.ndarray

    @property
    def known(self) -> QuantityName:
        return CHANNELS[self.name]

    @property
    def noise(self) -> float:
        """Median standard uncertainty of a point; NaN if none is known."""
        return finite_median(self.u)


def channel_rows(points: Points, names: Iterable[str]) -> tuple[ChannelRow, ...]:
    """Those of the channels that have a reading."""
    rows = (ChannelRow(name, points.channel(name), points.u(name)) for name in names)
    return tuple(row for row in rows if np.isfinite(row.measured).any())


class SweepRow(NamedTuple):
    """A sweep and the ranges of its conditions, as texts in the unit of each."""

    name: str
    points: int
    channels: tuple[str, ...]  #: that were measured
    ranges: Mapping[str, str]  #: by column of :data:`mffit.quantities.CONDITIONS`


def sweep_rows(points: Points) -> tuple[SweepRow, ...]:
    """The sweeps of the points, conditions as the rig reads them."""
    known = {key: points.table[key].to_numpy(dtype=float) for key in CONDITIONS if key in points.table}
    found = []
    for i, name in enumerate(points.sweep_names):
        rows = points.sweep == i
        read = [key for key in points.measured if np.isfinite(points.channel(key)[rows]).any()]
        ranges = {key: _range(values[rows]) for key, values in known.items()}
        found.append(SweepRow(name, int(rows.sum()), tuple(read), ranges))
    return tuple(found)


def _range(values: np.ndarray) -> str:
    """Least and largest value, or one if they are written alike."""
    ends = (
        [number(end, digits=3) for end in (np.nanmin(values), np.nanmax(values))]
        if np.isfinite(values).any()
        else [UNKNOWN]
    )
    return " to ".join(dict.fromkeys(ends))


class CoefficientRow(NamedTuple):
    """A coefficient in the table of parameters, and as the fit leaves it."""

    known: Parameter
    found: Coefficient

    @property
    def bounds(self) -> tuple[float | None, float | None]:
        """Those of its fit, or else its usual range."""
        return self.found.bounds or (self.known.lower, self.known.upper)

    @property
    def place(self) -> float | None:
        """Place of the value between its bounds, 0 to 1; None without bounds."""
        lower, upper = self.bounds
        if lower is None or upper is None or not upper > lower:
            return None
        return float(np.clip((self.found.value - lower) / (upper - lower), 0.0, 1.0))

    @property
    def held(self) -> bool:
        return self.found.status in NOT_DECIDED and not self.found.by_hand


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlay:
    """Points with the curves and lines through them."""

    points: Points  #: angles as read
    channels: tuple[ChannelRow, ...]
    curves: tuple[Curve, ...]
    lines: Mapping[Curve, CurveLine]

    def marked(self, channel: str) -> tuple[np.ndarray, np.ndarray]:
        """Rows of readings without weight, and of the points of doubtful sweeps: none unless a fit says so."""
        return np.zeros(0, dtype=int), np.zeros(0, dtype=int)


@dataclass(frozen=True, slots=True, kw_only=True)
class BuildView(Overlay):
    """A build, and what its pictures draw."""

    build: BuildResult
    felt: Points
    """As the tyre felt them, less the errors of the rig, where slip was run; else the same points."""
    conditions: tuple[CurveCondition, ...]
    rows: tuple[CoefficientRow, ...]
    file_names: Mapping[str, str]  #: by use

    def marked(self, channel: str) -> tuple[np.ndarray, np.ndarray]:
        single = [o.row for o in self.build.fit.outliers if o.channel == channel]
        doubtful = [row for doubt in self.build.fit.doubts for row in doubt.index]
        return np.array(single, dtype=int), np.array(doubtful, dtype=int)

    @property
    def normal_file(self) -> str:
        """Name of the file for turn slip off; empty without one."""
        return self.file_names.get("normal", self.file_names.get("both", ""))

    @property
    def beside_curves(self) -> int:
        """Number of points that are on no curve."""
        return len(self.points) - sum(len(curve.index) for curve in self.curves)

    @property
    def residual_unit(self) -> str:
        """Unit of the residuals: the point's uncertainty if every channel states one, else the rms misfit."""
        return "u" if all(np.isfinite(c.noise) for c in self.channels) else "rms misfit"

    @property
    def scaled(self) -> list[tuple[str, np.ndarray]]:
        """Symbol and residuals (n,) of every channel in that unit."""
        found = []
        for c in self.channels:
            u = np.where(np.isfinite(c.u), c.u, c.noise)
            scale = u if self.residual_unit == "u" else self.build.fit.channels[c.name].rmse
            found.append((c.known.mathtext, (c.measured - self.build.fit.model[c.name]) / scale))
        return found

    def nearest(self, curves: Iterable[Curve], *names: str) -> list[Curve]:
        """Those of the curves that are nearest to the nominal ``load`` or ``pressure``, one after the other."""
        found = list(curves)
        for name in names:
            nominal = getattr(self.build.config.tyre, f"nominal_{name}")
            distance = {c: abs(getattr(c, name) - nominal) for c in found}
            found = [c for c in found if distance[c] == min(distance.values())]
        return found

    @property
    def on_disc(self) -> bool:
        return self.build.measured.epsilon_gamma is not None

    @property
    def several_files(self) -> bool:
        return self.build.fit.files is not None and len(self.build.fit.files.by_use) > 1


def view_of(result: BuildResult) -> BuildView:
    """The view of a build."""
    points, fit = result.points, result.fit
    found = tuple(curves(points))
    return BuildView(
        build=result,
        points=points,
        felt=points if np.all(points.free_rolling) else fit.simulation.felt(points),
        channels=channel_rows(points, fit.model),
        curves=found,
        lines=model_lines(fit.simulation, points, found, fit.model),
        conditions=tuple(conditions(points)),
        rows=tuple(CoefficientRow(BY_NAME[name], found) for name, found in fit.coefficients.items()),
        file_names={use: name for use, name in result.files.items() if use in result.uses},
    )
