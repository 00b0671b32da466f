"""Records to shapes: where everything of a sheet is drawn. Each panel is laid out once, for the page and for the PNG."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mffit.report import constants, style
from mffit.report.drawing.letters import shortened, width_of
from mffit.report.drawing.records import (
    Axis,
    Band,
    Bars,
    ColourScale,
    ErrorBars,
    Frame,
    Guide,
    Look,
    Map,
    Note,
    Panel,
    Sheet,
    Trace,
)
from mffit.report.drawing.scales import Scale, limits, numbers_at
from mffit.report.drawing.shapes import Area, Drawing, Letters, Marks, Shape, Stroke

DASHES = {"-": (), "--": (4.4, 2.2), ":": (1.2, 1.9)}
"""Lengths of dash and gap [pt]."""
INCH = 72.0
GAP = 10.0
"""Between panels side by side [pt]."""
TITLE, LABEL, NUMBER = 8.5, 8.0, 7.5
"""Sizes of letters [pt]."""
TOP, BOTTOM, RIGHT = 17.0, 30.0, 7.0
"""Margins of a data area [pt]."""
TICK, SPACE, LINE = 2.5, 2.5, 11.0
"""Length of a tick, space between letters and what they belong to, height of a line of text [pt]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LaidOut:
    """A sheet as drawings: the entries of its key, and its panels in rows."""

    key: Sequence[Drawing]
    rows: Sequence[Sequence[Drawing]]


def lay_out(sheet: Sheet) -> LaidOut:
    """Every panel and every entry of the key as a drawing of its own."""
    columns = max(len(row) for row in sheet.rows)
    share = (constants.PICTURE_WIDTH - (columns - 1) * GAP) / columns
    width = sheet.panel_width or min(max(share, constants.NARROWEST_PANEL), constants.WIDEST_PANEL)
    prepared = [[_Prepared.of(panel, sheet.height * INCH) for panel in row] for row in sheet.rows]
    # Panels with numbers at the vertical axis begin at the same place, so that columns are aligned.
    numbered = [p.left for row in prepared for p in row if p.panel.y.words is None]
    left = max(numbered, default=0.0)
    rows = [[p.drawing(left if p.panel.y.words is None else p.left, width) for p in row] for row in prepared]
    key = [_entry(label, look) for label, look in sheet.key.items()]
    return LaidOut(key=[*key, *([_colour_scale(sheet.scale)] if sheet.scale else [])], rows=rows)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Prepared:
    """A panel whose vertical axis is known, and with it the room that its numbers or words take."""

    panel: Panel
    height: float  #: of the data area [pt]
    x_ends: tuple[float, float]
    y: Scale
    y_numbers: dict[float, str]

    @classmethod
    def of(cls, panel: Panel, height: float) -> _Prepared:
        extents = [series.extent() for series in panel.series]
        guided = {axis: np.array([g.at for g in panel.guides if g.axis == axis]) for axis in "xy"}
        x_ends = limits(panel.x, [guided["x"], *(x for x, _ in extents)])
        low, high = limits(panel.y, [guided["y"], *(y for _, y in extents)])
        scale = Scale(low=low, high=high, begin=TOP + height, end=TOP, logarithmic=panel.y.logarithmic)
        most = min(panel.y.ticks, max(2, int(height / (1.6 * LINE))))
        return cls(
            panel=panel,
            height=height,
            x_ends=x_ends,
            y=scale,
            y_numbers=numbers_at(panel.y, low, high, most),
        )

    @property
    def left(self) -> float:
        """Room for the label, numbers and ticks of the vertical axis [pt]."""
        written = self.y_numbers.values() if self.panel.y.numbered else ()
        widest = max((width_of(t, NUMBER, t == self.panel.y.bold) for t in written), default=0.0)
        return TICK + SPACE + widest + (LINE + SPACE if self.panel.y.label else 0.0) + 1.0

    def drawing(self, left: float, width: float) -> Drawing:
        low, high = self.x_ends
        panel, axis = self.panel, self.panel.x
        x = Scale(low=low, high=high, begin=left, end=width - RIGHT, logarithmic=axis.logarithmic)
        frame = _DataArea(x=x, y=self.y)
        areas = [series for series in panel.series if isinstance(series, Bars | Band)]
        below = LINE + SPACE + TICK + (LINE + SPACE if axis.label else 0.0)
        shapes = [
            *frame.grid(panel, _fitting(axis, x), self.y_numbers),
            *(shape for span in panel.spans for shape in frame.span(span.first, span.last, span.look)),
            *(shape for series in areas for shape in frame.series(series)),
            *(frame.guide(guide) for guide in panel.guides),
            *(
                shape
                for series in panel.series
                if not isinstance(series, Bars | Band)
                for shape in frame.series(series)
            ),
            *(frame.frame(region) for region in panel.frames),
            *(frame.note(note) for note in panel.notes),
            *frame.labels(panel, width),
        ]
        return Drawing(
            width=width,
            height=TOP + self.height + (below if axis.numbered else SPACE),
            shapes=shapes,
        )


def _fitting(axis: Axis, x: Scale) -> dict[float, str]:
    """As many numbers of the horizontal axis as fit side by side."""
    for intervals in range(axis.ticks, 0, -1):
        numbers = numbers_at(axis, x.low, x.high, intervals)
        places = np.sort(x.of(np.array([*numbers])))
        widest = max((width_of(text, NUMBER) for text in numbers.values()), default=0.0)
        if len(places) < 2 or np.diff(places).min() > widest + 2.0 * SPACE:
            break
    return numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class _DataArea:
    """The data area of a panel."""

    x: Scale
    y: Scale

    def points(self, x: np.ndarray | Sequence[float], y: np.ndarray | Sequence[float]) -> np.ndarray:
        """Places (n, 2) of points in the units of the axes."""
        return np.column_stack([self.x.of(np.asarray(x)), self.y.of(np.asarray(y))])

    def grid(self, panel: Panel, below: dict[float, str], beside: dict[float, str]) -> Iterator[Shape]:
        """Grid, axes, ticks and numbers; words have no grid lines of their own."""
        left, right, bottom, top = self.x.begin, self.x.end, self.y.begin, self.y.end
        columns, rows = self.x.of(np.array([*below])), self.y.of(np.array([*beside]))
        lines = [np.array([[at, bottom], [at, top]]) for at in columns]
        if panel.y.words is None:
            lines += [np.array([[left, at], [right, at]]) for at in rows]
        yield Stroke(lines=lines, colour=style.GRID, width=0.7)
        ticks = [np.array([[at, bottom], [at, bottom + TICK]]) for at in columns]
        ticks += [np.array([[left - TICK, at], [left, at]]) for at in rows]
        corner = np.array([[left, top], [left, bottom], [right, bottom]])
        yield Stroke(lines=[*ticks, corner], colour=style.FAINT, width=0.8)
        if panel.x.numbered:
            for at, text in zip(columns, below.values(), strict=True):
                yield _text(at, bottom + TICK + SPACE + 6.0, text, NUMBER, style.MUTED, "middle")
        for at, text in zip(rows, beside.values(), strict=True):
            stressed = text == panel.y.bold
            yield Letters(
                x=left - TICK - SPACE,
                y=float(at) + 0.36 * NUMBER,
                text=text,
                size=NUMBER,
                colour=style.ACCENT if stressed else style.MUTED,
                anchor="end",
                bold=stressed,
            )

    def labels(self, panel: Panel, width: float) -> Iterator[Shape]:
        """Title and names of the axes, moved or cut where they would leave the panel."""
        title = shortened(panel.title, width - 1.0, TITLE)
        at = max(0.0, min(self.x.begin, width - 1.0 - width_of(title, TITLE)))
        if title:
            yield _text(at, TOP - 6.0, title, TITLE, style.INK, "start")
        if panel.x.label and panel.x.numbered:
            half = 0.5 * width_of(panel.x.label, LABEL)
            middle = min(max(0.5 * (self.x.begin + self.x.end), half), width - half)
            y = self.y.begin + TICK + 2.0 * SPACE + 6.0 + LABEL
            yield _text(middle, y, panel.x.label, LABEL, style.INK, "middle")
        if panel.y.label:
            yield Letters(
                x=LABEL,
                y=0.5 * (self.y.begin + self.y.end),
                text=panel.y.label,
                size=LABEL,
                colour=style.INK,
                anchor="middle",
                turned=True,
            )

    def series(self, series: Trace | Band | ErrorBars | Bars | Map) -> Iterator[Shape]:
        match series:
            case Trace():
                yield from _drawn(self.points(series.x, series.y), series.look)
            case Band():
                there = self.points(series.x, series.low)
                back = self.points(series.x, series.high)[::-1]
                look = series.look
                yield Area(corners=np.vstack([there, back]), colour=look.colour, opacity=look.opacity)
            case ErrorBars():
                yield from self._error_bars(series)
            case Bars():
                yield from self._bars(series)
            case Map():
                yield from self._map(series)

    def _error_bars(self, series: ErrorBars) -> Iterator[Shape]:
        low, high = series.ends()
        if series.along == "x":
            ends, caps = (self.points(low, series.y), self.points(high, series.y)), np.array([0.0, 1.0])
        else:
            ends, caps = (self.points(series.x, low), self.points(series.x, high)), np.array([1.0, 0.0])
        known = np.isfinite(series.u)
        lines = [np.array(pair) for pair in zip(ends[0][known], ends[1][known], strict=True)]
        if series.cap:
            lines += [
                np.array([end - series.cap * caps, end + series.cap * caps])
                for side in ends
                for end in side[known]
            ]
        look = series.look
        yield Stroke(lines=lines, colour=look.colour, width=look.width)
        yield from _marks(self.points(series.x, series.y), look)

    def _bars(self, series: Bars) -> Iterator[Shape]:
        begin = self.x.low if self.x.logarithmic else 0.0
        half = 0.5 * series.height
        for length, place, colour in zip(series.lengths, series.places, series.colours, strict=True):
            across = np.array([begin, length, length, begin])
            yield Area(
                corners=self.points(across, [place - half, place - half, place + half, place + half]),
                colour=colour,
            )

    def _map(self, series: Map) -> Iterator[Shape]:
        """A shape per colour: squares of one colour are drawn together."""
        places = self.points(series.x, series.y)
        last = constants.MOST_COLOUR_STEPS - 1
        share = 0.5 + 0.5 * np.clip(series.values / series.limit, -1.0, 1.0)
        steps = np.round(share * last).astype(int)
        for step in np.unique(steps):
            yield Marks(
                at=places[steps == step],
                marker="s",
                size=series.size,
                fill=style.between(style.DIVERGING, step / last),
                edge=style.FAINT,
                edge_width=0.4,
            )

    def guide(self, guide: Guide) -> Shape:
        if guide.axis == "x":
            at = float(self.x.of(guide.at))
            line = np.array([[at, self.y.begin], [at, self.y.end]])
        else:
            at = float(self.y.of(guide.at))
            line = np.array([[self.x.begin, at], [self.x.end, at]])
        look = guide.look
        return Stroke(lines=[line], colour=look.colour, width=look.width, dashes=DASHES[look.line])

    def span(self, first: float, last: float, look: Look) -> Iterator[Shape]:
        left, right = (float(self.x.of(value)) for value in (first, last))
        top, bottom = self.y.end, self.y.begin
        corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom]])
        yield Area(corners=corners, colour=look.colour, opacity=look.opacity)

    def frame(self, region: Frame) -> Shape:
        left, right = _side(self.x, region.x)
        bottom, top = _side(self.y, region.y)
        corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom], [left, top]])
        return Stroke(lines=[corners], colour=style.INK, width=1.0, dashes=(3.0, 2.0))

    def note(self, note: Note) -> Shape:
        x, y = float(self.x.of(note.x)), float(self.y.of(note.y))
        dx, dy = (-SPACE, 0.0) if note.turned else (SPACE, 0.36 * note.size)
        return Letters(
            x=x + dx, y=y + dy, text=note.text, size=note.size, colour=note.colour, turned=note.turned
        )


def _side(scale: Scale, bounds: tuple[float, float] | None) -> tuple[float, float]:
    """Ends of a frame on an axis [pt], widened so that a single value has a width, and within the data area."""
    pad = 0.03 * (scale.end - scale.begin)
    if bounds is None:
        return scale.begin + 0.5 * pad, scale.end - 0.5 * pad
    low, high = sorted((scale.begin, scale.end))
    ends = scale.of(np.array(bounds)) + np.array([-pad, pad])
    first, last = np.clip(ends, low, high)
    return float(first), float(last)


def _text(x: float, y: float, text: str, size: float, colour: str, anchor: str) -> Letters:
    return Letters(x=float(x), y=float(y), text=text, size=size, colour=colour, anchor=anchor)


def _drawn(places: np.ndarray, look: Look) -> Iterator[Shape]:
    """A line in pieces between unknown points, then its markers."""
    known = np.isfinite(places).all(axis=1)
    if look.line:
        pieces = np.split(places, np.flatnonzero(~known))
        lines = [piece[np.isfinite(piece).all(axis=1)] for piece in pieces]
        yield Stroke(
            lines=[line for line in lines if len(line) > 1],
            colour=look.colour,
            width=look.width,
            dashes=DASHES[look.line],
        )
    yield from _marks(places[known], look)


def _marks(places: np.ndarray, look: Look) -> Iterator[Shape]:
    if not look.marker or not len(places):
        return
    outlined = look.hollow or look.marker == "x"
    yield Marks(
        at=places,
        marker=look.marker,
        size=look.size,
        fill="" if outlined else look.colour,
        edge=look.colour if outlined else "",
    )


def _entry(label: str, look: Look) -> Drawing:
    """An entry of the key: a piece of what it names, and the name."""
    sample, middle = 16.0, 0.5 * LINE
    shapes: list[Shape] = []
    if look.opacity:
        corners = np.array([[0.0, 1.5], [sample, 1.5], [sample, LINE - 1.5], [0.0, LINE - 1.5]])
        shapes.append(Area(corners=corners, colour=look.colour, opacity=min(1.0, 2.0 * look.opacity)))
    if look.line:
        line = np.array([[0.0, middle], [sample, middle]])
        shapes.append(Stroke(lines=[line], colour=look.colour, width=look.width, dashes=DASHES[look.line]))
    shapes += _marks(np.array([[0.5 * sample, middle]]), look)
    shapes.append(_text(sample + 5.0, middle + 0.36 * LABEL, label, LABEL, style.INK, "start"))
    return Drawing(width=sample + 6.0 + width_of(label, LABEL), height=LINE, shapes=shapes)


def _colour_scale(scale: ColourScale) -> Drawing:
    """The colours of a map from one end of their scale to the other, with numbers and label."""
    begin, wide, tall = 10.0, 180.0, 7.0
    last = constants.MOST_COLOUR_STEPS - 1
    edges = begin + wide * np.arange(last + 2) / (last + 1)
    shapes: list[Shape] = [
        Area(
            corners=np.array([[a, 1.0], [b + 0.3, 1.0], [b + 0.3, tall], [a, tall]]),
            colour=style.between(style.DIVERGING, k / last),
        )
        for k, (a, b) in enumerate(pairwise(edges))
    ]
    at = Scale(low=-scale.limit, high=scale.limit, begin=begin, end=begin + wide, logarithmic=False)
    for value, text in numbers_at(Axis(), -scale.limit, scale.limit, 8).items():
        shapes.append(_text(float(at.of(value)), tall + 9.0, text, NUMBER, style.MUTED, "middle"))
    shapes.append(_text(begin + wide + 8.0, tall, scale.label, LABEL, style.INK, "start"))
    width = begin + wide + 9.0 + width_of(scale.label, LABEL)
    return Drawing(width=width, height=tall + 12.0, shapes=shapes)
