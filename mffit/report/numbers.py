"""The numbers behind a figure as a table: whoever doubts a picture can draw it again."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from mffit.report import style

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

COLUMNS = ("panel", "series", "x axis", "x", "y axis", "y", "lower", "upper", "value")
"""``lower`` and ``upper`` are ends of an error bar or band, ``value`` what a colour stands for."""
DIGITS = 6
LONGEST = 1000
"""Points of one series that stand in the page: more would make it too large to open."""
MATHTEXT = re.compile(r"\$_\{(\w+)\}\$")

Row = tuple[Any, ...]


def table(figure: Figure) -> str:
    """Everything that the figure draws in its axes' units, as CSV: a header, then a row per point, bar or end of a band.

    Guides through a whole panel are left out, and so are columns that say nothing. What the axes are stands in the header, or in
    columns of its own where panels differ.
    """
    names = _names(figure)
    panels = [ax for ax in figure.axes if ax.get_label() != style.SCALE]
    rows = []
    for ax in panels:
        title, over, up = (
            _text(said) for said in (ax.get_title(loc="left"), ax.get_xlabel(), ax.get_ylabel())
        )
        rows += [(title, said, over, x, up, y, *more) for said, x, y, *more in _rows(ax, names)]
    header = list(COLUMNS)
    used = []
    for k, name in enumerate(COLUMNS):
        found = {row[k] for row in rows}
        if name.endswith(" axis"):
            if len(found) == 1:
                header[k + 1] = ": ".join(filter(None, (header[k + 1], *found)))
            if len(found) < 2:
                continue
        if name in ("x", "y") or found - {""}:
            used.append(k)
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow([header[k] for k in used])
    writer.writerows([[_cell(row[k]) for k in used] for row in rows])
    return buffer.getvalue()


def _rows(ax: Axes, names: dict[tuple[Any, ...], str]) -> Iterator[Row]:
    """What a panel draws: series, x, y, lower, upper, value."""
    from matplotlib.collections import PathCollection, PolyCollection
    from matplotlib.container import ErrorbarContainer
    from matplotlib.patches import Rectangle

    drawn: set[Any] = set()
    for container in ax.containers:
        if isinstance(container, ErrorbarContainer):
            line, caps, _ = container.lines
            drawn.update((line, *caps))
            said = _said(container, names) or _said(line, names)
            yield from ((said, x, _word(ax, y), *ends) for x, y, *ends in _error_bars(container))
    for line in ax.lines:
        if line not in drawn and _in_units(line, ax):
            places = np.column_stack(_data(line))
            some, said = _some(len(places), _said(line, names))
            yield from ((said, *at, "", "", "") for at in places[some])
    for collection in ax.collections:
        said = _said(collection, names)
        if isinstance(collection, PathCollection):
            offsets, values = np.asarray(collection.get_offsets()), collection.get_array()
            shown = np.full(len(offsets), "") if values is None else np.asarray(values)
            some, said = _some(len(offsets), said)
            yield from ((said, *at, "", "", v) for at, v in zip(offsets[some], shown[some], strict=True))
        elif isinstance(collection, PolyCollection):
            yield from ((said, x, "", low, high, "") for x, low, high in _band(collection))
    for bar in ax.patches:
        if isinstance(bar, Rectangle) and bar.get_fill() and _in_units(bar, ax):
            y = _word(ax, bar.get_y() + 0.5 * bar.get_height())
            yield _said(bar, names), bar.get_x() + bar.get_width(), y, "", "", ""


def _some(n: int, said: str) -> tuple[slice, str]:
    """What of a long series stands in the page, and what it is called then; points.csv has every reading."""
    step = -(-n // LONGEST)
    return (slice(None, None, step), f"{said}, every {step}th") if step > 1 else (slice(None), said)


def _in_units(artist: Artist, ax: Axes) -> bool:
    """Whether both coordinates are numbers of the axes; a guide through a whole panel has one that is a share of it."""
    return all(artist.get_transform().contains_branch_seperately(ax.transData))


def _word(ax: Axes, y: float) -> str | float:
    """What stands at the vertical axis at a place, if words stand there."""
    from matplotlib.ticker import FixedLocator

    places = np.asarray(ax.get_yticks(), dtype=float)
    if not isinstance(ax.yaxis.get_major_locator(), FixedLocator) or not len(places):
        return y
    words = ax.yaxis.get_major_formatter().format_ticks(list(places))
    return words[int(np.argmin(np.abs(places - y)))] or y


def _error_bars(container: Any) -> Iterator[tuple[Any, ...]]:
    """Middle, both ends, and no value."""
    line, _, bars = container.lines
    along = 0 if container.has_xerr else 1
    for x, y, segment in zip(*_data(line), bars[0].get_segments(), strict=True):
        ends = np.asarray(segment)
        low, high = ends[:, along] if ends.ndim == 2 else (math.nan, math.nan)  # none where nothing is known
        yield x, y, low, high, ""


def _band(collection: Any) -> Iterator[tuple[float, float, float]]:
    """x and both ends of a filled band, whose edge runs along the lower curve and back along the upper."""
    for path in collection.get_paths():
        by_x: dict[float, list[float]] = {}
        for x, y in path.vertices:
            by_x.setdefault(float(x), []).append(float(y))
        yield from ((x, min(ys), max(ys)) for x, ys in sorted(by_x.items()))


def _data(line: Line2D) -> tuple[np.ndarray, np.ndarray]:
    return np.asarray(line.get_xdata()), np.asarray(line.get_ydata())


def _names(figure: Figure) -> dict[tuple[Any, ...], str]:
    """The entries of the figure's legends by their looks."""
    found: dict[tuple[Any, ...], str] = {}
    for legend in figure.legends:
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
            found.setdefault(_looks(handle), _text(text.get_text()))
    return found


def _said(artist: Any, names: dict[tuple[Any, ...], str]) -> str:
    label = str(artist.get_label())
    return _text(label) if label and not label.startswith("_") else names.get(_looks(artist), "")


def _looks(artist: Any) -> tuple[Any, ...]:
    from matplotlib.colors import to_hex
    from matplotlib.lines import Line2D

    if isinstance(artist, Line2D):
        return to_hex(artist.get_color()), artist.get_linestyle(), str(artist.get_marker())
    colours: Iterable[Any] = artist.get_facecolor() if hasattr(artist, "get_facecolor") else ()
    first = np.atleast_2d(np.asarray(list(colours), dtype=float))
    return (to_hex(first[0][:3]),) if first.size else ()


def _text(text: str) -> str:
    """Without the marks of mathtext."""
    return MATHTEXT.sub(r"_\1", text)


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return value
    return f"{float(value):.{DIGITS}g}" if math.isfinite(value) else ""
