"""What a table of pictures says of each: its name, title and caption, the function that draws it, and when it appears."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Generic, TypeVar

from mffit.quantities import CHANNELS
from mffit.report.drawing.records import Sheet


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedChannel:
    """A channel by its name in files and sentences."""

    name: str

    @property
    def title(self) -> str:
        return CHANNELS[self.name].word

    @property
    def unit(self) -> str:
        return CHANNELS[self.name].unit

    @property
    def symbol(self) -> str:
        """The symbol with its subscript, for pictures."""
        return CHANNELS[self.name].mathtext

    @property
    def label(self) -> str:
        """Symbol and unit, for the axis of a picture."""
        return CHANNELS[self.name].short_axis


View = TypeVar("View")
Channel = TypeVar("Channel", bound=NamedChannel)


@dataclass(frozen=True, slots=True, kw_only=True)
class Planned:
    """A picture that a page shows; it is drawn when ``make`` is called."""

    name: str  #: file stem of the PNG
    title: str
    shows: str
    section: str
    make: Callable[[], Sheet]


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture(Generic[View]):
    """A picture of a page."""

    name: str  #: file stem of its PNG, and heading in docs/report.md
    title: str  #: the subject, for readers who do not see it
    shows: str  #: how to read it: the caption
    section: str = ""  #: of the page; empty: one of its own
    draw: Callable[[View], Sheet]
    when: Callable[[View], bool] = lambda view: True

    def planned(self, view: View) -> Iterator[Planned]:
        """The picture of a view, if it appears."""
        if self.when(view):
            make = partial(self.draw, view)
            yield Planned(
                name=self.name,
                title=self.title,
                shows=self.shows,
                section=self.section or self.name,
                make=make,
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelPicture(Generic[View, Channel]):
    """A picture for every channel of a view; ``{channel}`` and ``{word}`` in its texts are replaced."""

    name: str
    title: str
    shows: str
    section: str = ""
    channels: Callable[[View], Iterable[Channel]]
    draw: Callable[[View, Channel], Sheet]
    when: Callable[[View, Channel], bool] = lambda view, channel: True

    def planned(self, view: View) -> Iterator[Planned]:
        """The pictures of a view."""
        for channel in self.channels(view):
            if self.when(view, channel):
                name, title, shows = (
                    text.format(channel=channel.name, word=channel.title)
                    for text in (self.name, self.title, self.shows)
                )
                make = partial(self.draw, view, channel)
                yield Planned(
                    name=name, title=title, shows=shows, section=self.section or self.name, make=make
                )
