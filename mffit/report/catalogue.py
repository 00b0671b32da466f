"""What a page says of a picture: its name, title and caption, and the function that draws it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Generic, TypeVar

from mffit.quantities import CHANNELS
from mffit.report.drawing.records import Sheet

View = TypeVar("View", contravariant=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture(Generic[View]):
    """A picture of a page; it appears if its sheet has a panel."""

    name: str  #: file stem of its PNG, and heading in docs/report.md
    title: str  #: the subject, for readers who do not see it
    shows: str  #: how to read it: the caption
    section: str = ""  #: of the page; empty: one of its own
    draw: Callable[[View], Sheet]


def of_channels(
    name: str, *, title: str, shows: str, section: str, draw: Callable[[View, str], Sheet]
) -> tuple[Picture[View], ...]:
    """A picture for every channel; ``{channel}`` and ``{word}`` in its texts are replaced."""
    return tuple(
        Picture(
            name=f"{name}_{channel}",
            title=title.format(word=known.word),
            shows=shows.format(channel=channel, word=known.word),
            section=section,
            draw=partial(_drawn, draw, channel),
        )
        for channel, known in CHANNELS.items()
    )


def _drawn(draw: Callable[[View, str], Sheet], channel: str, view: View) -> Sheet:
    return draw(view, channel)
