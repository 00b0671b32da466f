"""Ink for a figure: matplotlib draws it once, as pixels and as SVG of few and short elements, axes by axes."""

from __future__ import annotations

import io
import re
from typing import Any
from xml.sax.saxutils import escape

import numpy as np
from matplotlib.backend_bases import GraphicsContextBase
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.colors import to_hex
from matplotlib.image import imsave
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.transforms import Affine2D, Transform
from numpy.typing import ArrayLike

FINE = 10
"""Units of the SVG in a pixel: places are whole numbers, which are short."""
ANCHORS = {"left": "start", "center": "middle", "right": "end"}
SUBSCRIPT = re.compile(r"\$_\{?(\w+?)\}?\$([^$]*)")
"""A subscript, and what follows it on the line."""


class Ink(RendererAgg):
    """A renderer of pixels that keeps in ``parts`` what it draws as SVG, of every axes and legend by its gid."""

    def __init__(self, width: float, height: float, dpi: float, name: str) -> None:
        super().__init__(width, height, dpi)  # type: ignore[no-untyped-call]
        vars(self).pop("draw_markers", None)  # matplotlib has put its own function there
        self.parts: dict[str, DrawnPart] = {}
        self._name, self._point = name, FINE * dpi / 72.0
        self._part: DrawnPart | None = None
        self._down = Affine2D().scale(FINE, -FINE).translate(0.0, FINE * height)

    def png(self) -> bytes:
        stream = io.BytesIO()
        settings: dict[str, Any] = {"metadata": {"Software": None}, "pil_kwargs": {"compress_level": 3}}
        imsave(stream, np.asarray(self._renderer), format="png", dpi=self.dpi, **settings)
        return stream.getvalue()

    def open_group(self, s: str, gid: str | None = None) -> None:
        if gid:
            self._part = self.parts[gid] = DrawnPart(f"{self._name}-{gid}")

    def draw_path(
        self, gc: GraphicsContextBase, path: Path, transform: Transform, rgbFace: Any = None
    ) -> None:
        super().draw_path(gc, path, transform, rgbFace)  # type: ignore[no-untyped-call]
        if self._part is not None:
            line = path.codes is None
            clean = path.cleaned(transform=transform + self._down, remove_nans=True, simplify=line)
            corners = np.asarray(clean.vertices)
            clip = self._clip(gc, corners[:-1])
            self._part.add(_path(corners, clean.codes), self._style(gc, rgbFace), clip)

    def draw_markers(
        self,
        gc: GraphicsContextBase,
        marker_path: Path,
        marker_trans: Transform,
        path: Path,
        trans: Transform,
        rgbFace: Any = None,
    ) -> None:
        """Marks of one shape and colour: round ones without an edge as dots of a line, all others by their outline."""
        self._renderer.draw_markers(gc, marker_path, marker_trans, path, trans, rgbFace)
        places = self._down.transform(trans.transform(path.vertices))
        places = places[np.isfinite(places).all(axis=1)]
        if self._part is None or not len(places):
            return
        to_svg = marker_trans + Affine2D().scale(FINE, -FINE)
        clip, style, at = self._clip(gc, places), self._style(gc, rgbFace), np.rint(places).astype(int)
        if marker_path.codes is None or Path.CURVE4 not in np.asarray(marker_path.codes):
            outline = marker_path.cleaned(transform=to_svg)
            corners = np.asarray(outline.vertices)
            first = np.rint(corners[0]).astype(int)
            at, shape = at + first, _path(corners, outline.codes, first)
        else:
            wide = round(float(marker_path.get_extents(to_svg).width))
            if rgbFace is not None and gc.get_linewidth() == 0.0:
                dots = f'stroke="{to_hex(rgbFace[:3])}" stroke-width="{wide}" stroke-linecap="round"'
                style, shape = f'fill="none" {dots}', "h0"
            else:
                half = f"a{wide / 2:g} {wide / 2:g} 0 1 0 "
                at[:, 0] -= wide // 2
                shape = f"{half}{wide} 0{half}-{wide} 0"
        self._part.add("".join(f"M{x} {y}{shape}" for x, y in at.tolist()), style, clip)

    def draw_text(
        self,
        gc: GraphicsContextBase,
        x: float,
        y: float,
        s: str,
        prop: Any,
        angle: float,
        ismath: Any = False,
        mtext: Text | None = None,
    ) -> None:
        super().draw_text(gc, x, y, s, prop, angle, ismath, mtext)  # type: ignore[no-untyped-call]
        if self._part is None:
            return
        anchor = "start"
        if mtext is not None:  # the browser's font has other widths
            at = self._down.transform(mtext.get_transform().transform(mtext.get_unitless_position())) / FINE
            anchor = ANCHORS[mtext.get_horizontalalignment()]
            x, y = (x, float(at[1])) if angle else (float(at[0]), y)
        size = round(self._point * prop.get_size_in_points())
        self._part.write(round(FINE * x), round(FINE * y), s, to_hex(gc.get_rgb()), size, anchor, angle)

    def _style(self, gc: GraphicsContextBase, face: Any) -> str:
        """Attributes of a path."""
        opacity = gc.get_alpha() if gc.get_forced_alpha() else None
        found = [f'fill="{"none" if face is None else to_hex(face[:3])}"']
        if opacity is not None and opacity < 1.0:
            found.append(f'opacity="{opacity:g}"')
        width = round(self._point * gc.get_linewidth())
        if width:
            found.append(f'stroke="{to_hex(gc.get_rgb()[:3])}" stroke-width="{width}"')
            _, dashes = gc.get_dashes()
            if dashes is not None:
                lengths = (str(round(self._point * length)) for length in np.asarray(dashes).tolist())
                found.append(f'stroke-dasharray="{" ".join(lengths)}"')
        return " ".join(found)

    def _clip(self, gc: GraphicsContextBase, places: np.ndarray) -> tuple[int, ...] | None:
        """Left, top, width and height of the window to which places (n, 2) are cut; None if all lie inside."""
        window = gc.get_clip_rectangle()
        if window is None or not len(places):
            return None
        (left, bottom), (right, top) = np.rint(self._down.transform(window.get_points())).astype(int).tolist()
        (low_x, low_y), (high_x, high_y) = np.nanmin(places, axis=0), np.nanmax(places, axis=0)
        if left - FINE <= low_x <= high_x <= right + FINE and top - FINE <= low_y <= high_y <= bottom + FINE:
            return None
        return left, top, right - left, bottom - top


class DrawnPart:
    """SVG of a part of a figure: neighbours that look the same are one path, and texts follow at the end."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._paths: list[tuple[str, tuple[int, ...] | None, list[str]]] = []
        self._texts: dict[str, list[str]] = {}

    def add(self, drawn: str, style: str, clip: tuple[int, ...] | None) -> None:
        if not drawn:
            return
        alike = self._paths and self._paths[-1][:2] == (style, clip) and "opacity" not in style
        if not alike:
            self._paths.append((style, clip, []))
        self._paths[-1][2].append(drawn)

    def write(self, x: int, y: int, text: str, colour: str, size: int, anchor: str, angle: float) -> None:
        said = SUBSCRIPT.sub(_lowered, escape(text)).replace(r"\$", "$")
        turned = f' transform="rotate({-angle:g} {x} {y})"' if angle else ""
        style = f'fill="{colour}" font-size="{size}" text-anchor="{anchor}"'
        self._texts.setdefault(style, []).append(f'<text x="{x}" y="{y}"{turned}>{said}</text>')

    def __str__(self) -> str:
        windows = list(dict.fromkeys(clip for _, clip, _ in self._paths if clip is not None))
        out = [
            f'<clipPath id="{self._name}-{k}"><path d="M{x} {y}h{width}v{height}h{-width}z"/></clipPath>'
            for k, (x, y, width, height) in enumerate(windows)
        ]
        for style, clip, drawn in self._paths:
            cut = "" if clip is None else f' clip-path="url(#{self._name}-{windows.index(clip)})"'
            out.append(f'<path {style}{cut} d="{"".join(drawn)}"/>')
        out += [f"<g {style}>{''.join(texts)}</g>" for style, texts in self._texts.items()]
        return "".join(out)


def _path(corners: np.ndarray, codes: ArrayLike | None, first: np.ndarray | None = None) -> str:
    """Straight lines (n, 2) as SVG, in whole steps; from ``first``, where the pen is already, if that is given."""
    out: list[str] = []
    here = start = None if first is None else first.tolist()
    for (x, y), code in zip(
        np.rint(corners).astype(int).tolist(), np.asarray(codes).ravel().tolist(), strict=True
    ):
        if code == Path.MOVETO:
            if here is None:
                out.append(f"M{x} {y}")
            elif here != [x, y]:
                out.append(f"m{x - here[0]} {y - here[1]}")
            here = start = [x, y]
        elif code == Path.LINETO and here is not None and here != [x, y]:
            right, down = x - here[0], y - here[1]
            out.append(f"h{right}" if not down else f"v{down}" if not right else f"l{right} {down}")
            here = [x, y]
        elif code == Path.CLOSEPOLY:
            out.append("z")
            here = start
    return "".join(out)


def _lowered(match: re.Match[str]) -> str:
    """A subscript in small letters; an em is that of the letters which it moves."""
    behind = f'<tspan dy="-.14em">{match[2]}</tspan>' if match[2] else ""
    return f'<tspan dy=".2em" font-size=".7em">{match[1]}</tspan>{behind}'
