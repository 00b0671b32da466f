"""A figure as it stands in a page: its panels as small SVG drawings that the page may rearrange to its width."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np

from mffit.report import style

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.transforms import Bbox

Element = ElementTree.Element

DENSE = 200
"""Markers in one panel above which they are drawn as pixels: a page of a hundred thousand elements opens slowly."""
RASTER_DPI = 144
WIDEST = 360.0
"""Of a panel without its labels [pt]: wider ones could not be read on a telephone."""
WITH_LETTERS = 400.0
"""The same with its labels [pt]."""
NARROW = 180.0
"""Of a panel without its labels that needs no look [pt]."""
ROOM = 1.5
"""Around a panel [pt], for the ends of thick lines and another machine's letters."""
POINTS_PER_INCH = 72.0

SETTINGS: Any = {"svg.fonttype": "none", "svg.hashsalt": "mffit", "text.hinting": "no_hinting"}
"""Text stays text, as wide as a browser sets it, and the same figure gives the same bytes."""
NUMBER = re.compile(r"-?\d+\.\d{3,}")
REFERENCE = re.compile(r"#([\w.-]+)")
NUMERIC = frozenset({"d", "x", "y", "x1", "x2", "y1", "y2", "width", "height", "points", "transform"})


def markup(figure: Figure, name: str) -> str:
    """The figure as HTML: a key (legend, scale of colours), then rows of panels.

    The figure is changed on the way and not to be used afterwards: every panel gets the labels that it shared with its
    neighbours, because it may come to stand alone.

    Parameters
    ----------
    figure : any figure; its panels are its axes
    name : what opens every id, so that several figures can stand in one page
    """
    import matplotlib

    with matplotlib.rc_context(SETTINGS):
        return _markup(figure, name)


def _markup(figure: Figure, name: str) -> str:
    style.stand_alone(figure)
    figure.dpi = POINTS_PER_INCH  # as the SVG has it, so that boxes are in its units
    scales = [ax for ax in figure.axes if ax.get_label() == style.SCALE]
    panels = [ax for ax in figure.axes if ax not in scales]
    for ax in panels:
        _thin_out(ax)
    for ax in panels:
        inside = ax.get_window_extent().width
        if inside < NARROW:
            continue
        beside = _extent(ax).width - inside  # letters, which keep their size
        fits = min(WIDEST, WITH_LETTERS - beside)
        if inside > fits > 0.0:
            style.narrowed(figure, fits / inside)
    for k, artist in enumerate(_parts(figure)):
        artist.set_gid(f"part-{k}")
    source = _Source(figure, name)
    key = list(_entries(figure))
    extents = {ax: _extent(ax) for ax in panels}
    widest = max(box.width for box in extents.values()) + 2.0 * ROOM
    out = [f'<div class="panels" style="--widest:{_short(widest)}">']
    if key or scales:
        drawn = [source.part(artists, box) for artists, box in key]
        drawn += [source.part([ax], _extent(ax)) for ax in scales]
        out += ['<div class="key">', *drawn, "</div>"]
    for row in _rows(panels):
        boxes = [extents[ax] for ax in row]
        low, high = min(box.y0 for box in boxes), max(box.y1 for box in boxes)
        out.append('<div class="row">')
        for ax, box in zip(row, boxes, strict=True):
            box.y0, box.y1 = low, high
            out.append(source.part([ax], box))
        out.append("</div>")
    out.append("</div>")
    return "\n".join(out)


class _Source:
    """The figure's SVG, from which parts are cut."""

    def __init__(self, figure: Figure, name: str) -> None:
        buffer = io.StringIO()
        figure.savefig(buffer, format="svg", dpi=RASTER_DPI, transparent=True, metadata={"Date": None})
        root = ElementTree.fromstring(buffer.getvalue())
        for element in root.iter():
            _plain(element)
        self.named = {element.attrib["id"]: element for element in root.iter() if "id" in element.attrib}
        self.name = name
        self.count = 0
        self.tall = figure.get_figheight() * POINTS_PER_INCH

    def part(self, artists: Sequence[Artist], box: Bbox) -> str:
        """Some artists as a drawing of their own; ``box`` [pt] is what it shows."""
        self.count += 1
        prefix = f"{self.name}-{self.count}-"
        groups = [self.named[str(artist.get_gid())] for artist in artists]
        wanted = self._definitions(groups)
        x, y = box.x0 - ROOM, self.tall - box.y1 - ROOM
        wide, tall = box.width + 2.0 * ROOM, box.height + 2.0 * ROOM
        attributes = {
            "viewBox": " ".join(_short(value) for value in (x, y, wide, tall)),
            "style": f"--w:{_short(wide)}",
        }
        drawing = ElementTree.Element("svg", attributes)
        if wanted:
            ElementTree.SubElement(drawing, "defs").extend(self.named[name] for name in wanted)
        drawing.extend(groups)
        text = ElementTree.tostring(drawing, encoding="unicode")
        used = set(_references(drawing))
        text = re.sub(r' id="([^"]+)"', lambda m: f' id="{prefix}{m[1]}"' if m[1] in used else "", text)
        return REFERENCE.sub(lambda m: f"#{prefix}{m[1]}" if m[1] in used else m[0], text)

    def _definitions(self, groups: Sequence[Element]) -> list[str]:
        """Names of what the groups use and do not hold themselves, in a fixed order."""
        held = {element.attrib.get("id") for group in groups for element in group.iter()}
        used = {name for group in groups for name in _references(group)}
        return sorted(name for name in used - held if name in self.named)


def _references(element: Element) -> Iterator[str]:
    for part in element.iter():
        for name in ("href", "clip-path", "style"):
            value = part.attrib.get(name, "")
            if value.startswith("#") or "url(" in value:
                yield from REFERENCE.findall(value)


def _plain(element: Element) -> None:
    """Without namespaces, which HTML does without, and with two decimals of a point."""
    element.tag = element.tag.rpartition("}")[2]
    element.tail = None
    if element.tag not in ("text", "tspan"):
        element.text = None
    for key in list(element.attrib):
        value = element.attrib.pop(key)
        if key in NUMERIC:
            value = NUMBER.sub(lambda m: _short(float(m[0])), " ".join(value.split()))
        elif key == "style":
            value = value.replace("'DejaVu Sans'", "var(--letters)")
        element.attrib[key.rpartition("}")[2]] = value


def _short(value: float) -> str:
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _parts(figure: Figure) -> Iterator[Artist]:
    """Everything that is cut out: the entries of legends, free texts, panels, scales."""
    for legend in figure.legends:
        yield from (artist for artist in (*legend.legend_handles, *legend.get_texts()) if artist is not None)
    yield from figure.texts
    yield from figure.axes


def _entries(figure: Figure) -> Iterator[tuple[list[Artist], Bbox]]:
    """The entries of the figure's legends and its free texts, each with what it covers."""
    from matplotlib.transforms import Bbox

    for legend in figure.legends:
        for text, handle in zip(legend.get_texts(), legend.legend_handles, strict=True):
            box = text.get_window_extent()
            left = (legend.handlelength + legend.handletextpad) * float(text.get_fontsize())
            artists: list[Artist] = [text] if handle is None else [handle, text]
            yield artists, Bbox.from_extents(box.x0 - left, box.y0, box.x1, box.y1)
    for text in figure.texts:
        yield [text], text.get_window_extent()


def _rows(panels: Sequence[Axes]) -> list[list[Axes]]:
    """Panels beside each other, from the top left."""
    rows: list[list[Axes]] = []
    for ax in sorted(panels, key=lambda ax: -ax.get_position().y1):
        middle = 0.5 * (ax.get_position().y0 + ax.get_position().y1)
        if rows and middle > rows[-1][0].get_position().y0:
            rows[-1].append(ax)
        else:
            rows.append([ax])
    return [sorted(row, key=lambda ax: ax.get_position().x0) for row in rows]


def _extent(ax: Axes) -> Bbox:
    """What a panel covers with its labels."""
    box = ax.get_tightbbox()
    assert box is not None  # only invisible panels have none
    return box


def _thin_out(ax: Axes) -> None:
    """Markers as pixels where there are too many."""
    marked = [line for line in ax.lines if line.get_marker() not in ("", "None", None, " ")]
    clouds = [c for c in ax.collections if np.size(c.get_offsets()) > 2]
    count = sum(np.size(line.get_xdata()) for line in marked)
    count += sum(len(np.asarray(c.get_offsets())) for c in clouds)
    if count > DENSE:
        for artist in (*marked, *clouds):
            artist.set_rasterized(True)
            artist.set_zorder(artist.get_zorder() - 0.1)  # drawn one after the other, they make one image
