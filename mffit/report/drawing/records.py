"""What a picture shows: a sheet of panels, a panel's axes, and its series in the units of the axes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple

import numpy as np

from mffit.report import constants, style


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """Colour, line and marker of a series and of its entry in the key."""

    colour: str = style.INK
    line: str = ""  #: "-", "--", ":" or "" for none
    width: float = 1.3  #: of the line [pt]
    marker: str = ""  #: "o", ".", "v", "s", "D", "x" or "" for none
    size: float = 3.6  #: of a marker [pt]
    hollow: bool = False  #: markers without a face
    opacity: float = 0.0  #: of an area, 0 to 1; 0 for none


class TableRow(NamedTuple):
    """A row of the table behind a picture; NaN where there is nothing."""

    x: float
    y: float
    lower: float = float("nan")
    upper: float = float("nan")
    value: float = float("nan")


@dataclass(frozen=True, slots=True, kw_only=True)
class Trace:
    """Points (n,) with a line through them, markers on them, or both."""

    name: str
    x: np.ndarray
    y: np.ndarray
    look: Look

    def rows(self) -> Iterator[TableRow]:
        return (TableRow(x, y) for x, y in zip(self.x, self.y, strict=True))

    def extent(self) -> tuple[np.ndarray, np.ndarray]:
        return self.x, self.y


@dataclass(frozen=True, slots=True, kw_only=True)
class Band:
    """The area between two curves; arrays (n,)."""

    name: str
    x: np.ndarray
    low: np.ndarray
    high: np.ndarray
    look: Look

    def rows(self) -> Iterator[TableRow]:
        nan = float("nan")
        return (TableRow(x, nan, low, high) for x, low, high in zip(self.x, self.low, self.high, strict=True))

    def extent(self) -> tuple[np.ndarray, np.ndarray]:
        return self.x, np.concatenate([self.low, self.high])


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorBars:
    """Points (n,) with bars of one standard uncertainty, which may be NaN."""

    name: str
    x: np.ndarray
    y: np.ndarray
    u: np.ndarray
    look: Look
    along: str = "y"  #: the axis of the uncertainty
    cap: float = 0.0  #: half the length of the stroke at the ends [pt]

    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper end of each bar, on the axis ``along``."""
        middle = self.x if self.along == "x" else self.y
        return middle - self.u, middle + self.u

    def rows(self) -> Iterator[TableRow]:
        return (TableRow(*row) for row in zip(self.x, self.y, *self.ends(), strict=True))

    def extent(self) -> tuple[np.ndarray, np.ndarray]:
        ends = np.concatenate([*self.ends(), self.x if self.along == "x" else self.y])
        return (ends, self.y) if self.along == "x" else (self.x, ends)


@dataclass(frozen=True, slots=True, kw_only=True)
class Bars:
    """Horizontal bars (n,) from zero, or from the left end of a logarithmic axis."""

    name: str
    lengths: np.ndarray
    places: np.ndarray  #: on the vertical axis
    colours: Sequence[str]
    height: float = 0.62  #: in units of the vertical axis

    def rows(self) -> Iterator[TableRow]:
        return (TableRow(x, y) for x, y in zip(self.lengths, self.places, strict=True))

    def extent(self) -> tuple[np.ndarray, np.ndarray]:
        return np.append(self.lengths, 0.0), self.places


@dataclass(frozen=True, slots=True, kw_only=True)
class Map:
    """Points (n,) whose colour shows a value; the scale ends at ± ``limit``."""

    name: str
    x: np.ndarray
    y: np.ndarray
    values: np.ndarray
    limit: float
    size: float  #: side of a square [pt]

    def rows(self) -> Iterator[TableRow]:
        nan = float("nan")
        return (TableRow(x, y, nan, nan, v) for x, y, v in zip(self.x, self.y, self.values, strict=True))

    def extent(self) -> tuple[np.ndarray, np.ndarray]:
        return self.x, self.y


@dataclass(frozen=True, slots=True, kw_only=True)
class Ribbon:
    """The area on both sides of a path (n,), which may close; arrays (n,)."""

    name: str
    x: np.ndarray
    y: np.ndarray
    dx: np.ndarray  #: from the path to its one side; the other side lies opposite
    dy: np.ndarray
    look: Look

    def sides(self) -> tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]:
        """Both edges as (x, y)."""
        return (self.x + self.dx, self.y + self.dy), (self.x - self.dx, self.y - self.dy)

    def rows(self) -> Iterator[TableRow]:
        return (TableRow(x, y) for side in self.sides() for x, y in zip(*side, strict=True))

    def extent(self) -> tuple[np.ndarray, np.ndarray]:
        one, other = self.sides()
        return np.concatenate([one[0], other[0]]), np.concatenate([one[1], other[1]])


DataSeries = Trace | Band | Ribbon | ErrorBars | Bars | Map


@dataclass(frozen=True, slots=True, kw_only=True)
class Guide:
    """A line across a whole panel."""

    axis: str  #: "x" for a vertical line at a place on the x axis, "y" for a horizontal one
    at: float
    look: Look = Look(colour=style.FAINT, line="-", width=0.8)


@dataclass(frozen=True, slots=True, kw_only=True)
class Span:
    """A shaded stretch of the x axis."""

    first: float
    last: float
    look: Look


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """A dashed frame around a region; None reaches to the ends of the axis."""

    x: tuple[float, float] | None
    y: tuple[float, float] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Note:
    """A text at a place in a panel."""

    x: float
    y: float
    text: str
    colour: str = style.INK
    size: float = 7.5  #: [pt]
    turned: bool = False  #: upwards, left of the place, beginning at it


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """Label, range and numbers of an axis."""

    label: str = ""
    low: float | None = None  #: None: where the data begin
    high: float | None = None  #: below ``low`` for an axis that runs backwards
    words: Mapping[float, str] | None = None  #: names in place of numbers
    bold: str = ""  #: the word among them to stress
    logarithmic: bool = False
    ticks: int = constants.MOST_TICKS
    numbered: bool = True
    room: float = constants.AXIS_ROOM


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """One diagram, readable by itself."""

    title: str = ""
    x: Axis
    y: Axis
    series: Sequence[DataSeries]
    guides: Sequence[Guide] = ()
    spans: Sequence[Span] = ()
    frames: Sequence[Frame] = ()
    notes: Sequence[Note] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ColourScale:
    """The scale of a sheet's maps, from ``-limit`` to ``limit``."""

    limit: float
    label: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Sheet:
    """A figure: rows of panels of one size below a key."""

    rows: Sequence[Sequence[Panel]]
    height: float  #: of a panel's data area [inch]
    key: Mapping[str, Look] = field(default_factory=dict)
    scale: ColourScale | None = None
    panel_width: float | None = (
        None  #: of a panel with its labels [pt]; None: what the number of columns leaves
    )
    left_out: int = 0  #: panels that are not drawn, for the caption

    @property
    def panels(self) -> list[Panel]:
        return [panel for row in self.rows for panel in row]


def in_rows(*groups: Sequence[Panel], columns: int) -> list[list[Panel]]:
    """Rows of at most ``columns`` panels; every group starts a new row."""
    return [
        list(group[start : start + columns]) for group in groups for start in range(0, len(group), columns)
    ]


def thinned(panels: Sequence[Panel], most: int) -> list[Panel]:
    """At most so many of the panels, evenly chosen, both ends among them."""
    if len(panels) <= most:
        return list(panels)
    return [panels[k] for k in np.linspace(0, len(panels) - 1, most).round().astype(int)]


def long(sheet: Sheet, most: int) -> bool:
    """Whether any series has more points than ``most``."""
    return any(_points(series) > most for panel in sheet.panels for series in panel.series)


def with_shorter_series(sheet: Sheet, most: int) -> Sheet:
    """The sheet with at most so many points, evenly chosen, of every series."""
    rows = [
        [replace(panel, series=[shorter(series, most)[0] for series in panel.series]) for panel in row]
        for row in sheet.rows
    ]
    return replace(sheet, rows=rows)


def shorter(series: DataSeries, most: int) -> tuple[DataSeries, int]:
    """The series with every so many of its points, so that they are at most ``most``, and that stride."""
    n = _points(series)
    every = -(-n // most)
    if every < 2:
        return series, 1
    arrays = ((field.name, getattr(series, field.name)) for field in fields(series))
    kept: dict[str, Any] = {
        name: x[::every] for name, x in arrays if isinstance(x, np.ndarray) and len(x) == n
    }
    return replace(series, **kept), every


def _points(series: DataSeries) -> int:
    return len(series.lengths if isinstance(series, Bars) else series.x)
