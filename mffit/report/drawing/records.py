"""What a picture shows: a sheet of panels, a panel's axes, and its series in the units of the axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from mffit.report import style


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


class Plotted:
    """Points in the units of a panel's axes."""

    __slots__ = ()

    def columns(self) -> dict[str, np.ndarray]:
        """Columns (n,) of the table behind the picture."""
        raise NotImplementedError

    def __len__(self) -> int:
        return len(self.columns()["x"])


@dataclass(frozen=True, slots=True, kw_only=True)
class Trace(Plotted):
    """Points (n,) with a line through them, markers on them, or both."""

    name: str
    x: np.ndarray
    y: np.ndarray
    look: Look

    def columns(self) -> dict[str, np.ndarray]:
        return {"x": self.x, "y": self.y}


@dataclass(frozen=True, slots=True, kw_only=True)
class Band(Plotted):
    """The area between two curves; arrays (n,)."""

    name: str
    x: np.ndarray
    low: np.ndarray
    high: np.ndarray
    look: Look
    x_high: np.ndarray | None = None  #: of the second curve; None: that of the first

    def columns(self) -> dict[str, np.ndarray]:
        one = {"x": self.x, "lower": self.low, "upper": self.high}
        return one if self.x_high is None else {**one, "x of upper": self.x_high}


def banded(
    name: str, x: np.ndarray, line: np.ndarray, half: np.ndarray, look: Look, line_name: str = ""
) -> list[Band | Trace]:
    """A line with a band of its colour, ``half`` wide to both sides; arrays (n,)."""
    shade = Look(colour=look.colour, opacity=style.SHADE)
    return [
        Band(name=name, x=x, low=line - half, high=line + half, look=shade),
        Trace(name=line_name or name, x=x, y=line, look=look),
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorBars(Plotted):
    """Points (n,) with bars of one standard uncertainty, which may be NaN."""

    name: str
    x: np.ndarray
    y: np.ndarray
    u: np.ndarray
    look: Look
    along: str = "y"  #: the axis of the uncertainty

    def columns(self) -> dict[str, np.ndarray]:
        middle = self.x if self.along == "x" else self.y
        return {"x": self.x, "y": self.y, "lower": middle - self.u, "upper": middle + self.u}


@dataclass(frozen=True, slots=True, kw_only=True)
class Bars(Plotted):
    """Horizontal bars (n,) from zero, or from the left end of a logarithmic axis."""

    name: str
    lengths: np.ndarray
    places: np.ndarray  #: on the vertical axis
    colours: Sequence[str]
    height: float = 0.62  #: in units of the vertical axis

    def columns(self) -> dict[str, np.ndarray]:
        return {"x": self.lengths, "y": self.places}


@dataclass(frozen=True, slots=True, kw_only=True)
class Map(Plotted):
    """Points (n,) whose colour shows a value; the scale ends at ± ``limit``."""

    name: str
    x: np.ndarray
    y: np.ndarray
    values: np.ndarray
    limit: float

    def columns(self) -> dict[str, np.ndarray]:
        return {"x": self.x, "y": self.y, "value": self.values}


DataSeries = Trace | Band | ErrorBars | Bars | Map


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
    """A text behind a place in a panel."""

    x: float
    y: float
    text: str
    colour: str = style.INK


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """Label, range and numbers of an axis."""

    label: str = ""
    low: float | None = None  #: None: where the data begin
    high: float | None = None  #: below ``low`` for an axis that runs backwards
    words: Mapping[float, str] | None = None  #: names in place of numbers
    logarithmic: bool = False


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
    wide: bool = False  #: whether a sole panel takes the whole width
    remark: str = ""  #: what holds for these data only and what is not drawn, in sentences for the caption

    @property
    def panels(self) -> list[Panel]:
        return [panel for row in self.rows for panel in row]

    @property
    def columns(self) -> int:
        """Panels that the width has room for; a sole one is half as wide as the picture."""
        return max([1 if self.wide else 2, *map(len, self.rows)])


def in_rows(*groups: Sequence[Panel], columns: int = 5) -> list[list[Panel]]:
    """Rows of at most ``columns`` panels; every group starts a new row."""
    return [
        list(group[start : start + columns]) for group in groups for start in range(0, len(group), columns)
    ]


def of_one_range(row: Sequence[Panel]) -> list[Panel]:
    """The panels with one vertical range, so that heights can be compared."""
    found = [c.columns() for panel in row for c in panel.series]
    values = np.concatenate(
        [x for columns in found for name, x in columns.items() if not name.startswith("x")]
    )
    low, high = float(np.nanmin(values, initial=0.0)), float(np.nanmax(values, initial=0.0))
    room = 0.05 * (high - low)
    return [replace(panel, y=replace(panel.y, low=low - room, high=high + room)) for panel in row]


def with_fewer_rows(sheet: Sheet, most: int) -> Sheet:
    """The sheet with at most so many panels: rows evenly chosen, both ends among them."""
    if len(sheet.panels) <= most:
        return sheet
    chosen = np.linspace(0, len(sheet.rows) - 1, max(1, most // sheet.columns)).round().astype(int)
    rows = [sheet.rows[k] for k in chosen]
    said = f"{len(sheet.panels) - sum(map(len, rows))} more panels are not drawn, for lack of room; the numbers have them."
    return replace(sheet, rows=rows, remark=" ".join(filter(None, (sheet.remark, said))))


def with_shorter_series(sheet: Sheet, most: int) -> Sheet:
    """The sheet with every so many of its points of each longer series, so that they are at most ``most``."""
    if all(len(series) <= most for panel in sheet.panels for series in panel.series):
        return sheet
    rows = [[replace(p, series=[_shorter(s, most) for s in p.series]) for p in row] for row in sheet.rows]
    said = f"Of longer series at most {most} points, evenly spaced, are drawn and listed."
    return replace(sheet, rows=rows, remark=" ".join(filter(None, (sheet.remark, said))))


def _shorter(series: DataSeries, most: int) -> DataSeries:
    every = -(-len(series) // most)
    arrays = ((f.name, getattr(series, f.name)) for f in fields(series))
    kept: dict[str, Any] = {name: x[::every] for name, x in arrays if isinstance(x, np.ndarray)}
    return replace(series, **kept)
