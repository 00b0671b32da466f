"""The shapes that drawings consist of, in points (1/72 inch) from the top left, y downwards."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True, kw_only=True)
class Stroke:
    """Lines of one pen."""

    lines: Sequence[np.ndarray]  #: each (n, 2)
    colour: str
    width: float
    dashes: tuple[float, ...] = ()  #: lengths of dash and gap [pt]; empty for a full line


@dataclass(frozen=True, slots=True, kw_only=True)
class Area:
    """A filled polygon (n, 2)."""

    corners: np.ndarray
    colour: str
    opacity: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Marks:
    """Markers of one kind at places (n, 2)."""

    at: np.ndarray
    marker: str  #: as in :class:`~mffit.report.drawing.records.Look`
    size: float
    fill: str = ""  #: colour of the face, or "" for none
    edge: str = ""  #: colour of the outline, or "" for none
    edge_width: float = 0.8


@dataclass(frozen=True, slots=True, kw_only=True)
class Letters:
    """A line of text; ``x``, ``y`` is a place on its base line."""

    x: float
    y: float
    text: str  #: subscripts as in ``QuantityName.mathtext``
    size: float
    colour: str
    anchor: str = "start"  #: "start", "middle" or "end" of the text is at ``x``
    turned: bool = False  #: reads upwards
    bold: bool = False


Shape = Stroke | Area | Marks | Letters


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """Shapes in drawing order on a sheet of a size."""

    width: float
    height: float
    shapes: Sequence[Shape]


OUTLINES = {
    "s": np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]),
    "D": np.array([[0.0, -0.6], [0.6, 0.0], [0.0, 0.6], [-0.6, 0.0]]),
    "v": np.array([[-0.5, -0.45], [0.5, -0.45], [0.0, 0.5]]),
}
"""Corners of the markers with corners, for a marker of size 1."""
CROSS = np.array([[[-0.5, -0.5], [0.5, 0.5]], [[-0.5, 0.5], [0.5, -0.5]]])
"""Both lines of the marker ``x``."""
