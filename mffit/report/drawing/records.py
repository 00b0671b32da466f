"""What a picture shows: a sheet of panels, a panel's axes, and its series in the units of the axes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from mffit.report import style
from tir.frozen import ReadOnlyArrays


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Trace(ReadOnlyArrays):
    """Points (n,) with a line through them, markers on them, or both; how uncertain they are is a band or bars around them."""

    name: str
    x: np.ndarray
    y: np.ndarray
    look: Look
    half: np.ndarray | None = None  #: half the height of the band of a line, or of the bar at a marker
    half_x: np.ndarray | None = None  #: half the width of the bar at a marker
    shade: np.ndarray | None = None  #: what the colour of each marker shows, on the scale of the sheet

    def columns(self) -> dict[str, np.ndarray]:
        """Columns (n,) of the table behind the picture."""
        out = {"x": self.x, "y": self.y}
        for middle, half in ((self.x, self.half_x), (self.y, self.half)):
            if half is not None:
                out |= {"lower": middle - half, "upper": middle + half}
        return out if self.shade is None else {**out, "value": self.shade}

    def __len__(self) -> int:
        return len(self.x)


@dataclass(frozen=True, slots=True, kw_only=True)
class Bars(ReadOnlyArrays):
    """Horizontal bars (n,) from zero, or from the left end of a logarithmic axis."""

    name: str
    lengths: np.ndarray  #: at 0, 1, ... on the vertical axis; NaN for no bar
    colours: Sequence[str]

    def columns(self) -> dict[str, np.ndarray]:
        """Columns (n,) of the table behind the picture."""
        return {"x": self.lengths, "y": np.arange(len(self.lengths), dtype=float)}


DataSeries = Trace | Bars


@dataclass(frozen=True, slots=True, kw_only=True)
class Guide:
    """A line across a whole panel."""

    axis: str  #: "x" for a vertical line at a place on the x axis, "y" for a horizontal one
    at: float
    look: Look = Look(colour=style.FAINT, line="-", width=0.8)


ZERO = Guide(axis="y", at=0.0)


def both_sides(axis: str, distance: float, look: Look) -> list[Guide]:
    """Lines at one distance to either side of zero."""
    return [Guide(axis=axis, at=side * distance, look=look) for side in (-1.0, 1.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Span:
    """A shaded stretch of the x axis."""

    first: float
    last: float
    look: Look


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


def listed(words: Sequence[str]) -> Axis:
    """A vertical axis with a line for every word, the first at the top."""
    return Axis(low=len(words) - 0.4, high=-0.6, words={float(k): word for k, word in enumerate(words)})


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """One diagram."""

    title: str = ""
    x: Axis = Axis()
    y: Axis = Axis()
    series: Sequence[DataSeries]
    guides: Sequence[Guide] = ()
    spans: Sequence[Span] = ()
    notes: Sequence[Note] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ColourScale:
    """What the colours of a sheet's markers show, from ``-limit`` to ``limit``."""

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


NOTHING = Sheet(rows=(), height=1.0)
"""What the data give no panel."""


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
