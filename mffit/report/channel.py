"""A measured channel by its words, unit and symbols."""

from __future__ import annotations

from dataclasses import dataclass

from mffit.quantities import CHANNELS


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
