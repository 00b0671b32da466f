"""The record of a campaign that is being run."""

from dataclasses import dataclass
from typing import Literal

from mffit.as_json import document, keys
from mffit.brief import Brief
from mffit.measured import Alignment, Measured
from mffit.planning import NextRun
from tir import Quantity
from tir.errors import counted


@dataclass(frozen=True, slots=True)
class Arrival:
    """What became of a file."""

    file: str  #: as in [[sweep]]
    state: Literal["taken", "refused", "gone"]
    points: int = 0
    why: str = ""  #: why it is refused
    sweep: str = ""  #: the [[sweep]] with which it is read, if ``tyre.toml`` has none


keys(Arrival, "file state points why? sweep?")


@dataclass(frozen=True, slots=True, repr=False)
class WatchedCampaign(Brief):
    """A campaign after a change: the new files, and the results of all files."""

    changed: tuple[Arrival, ...]  #: files, since the campaign before
    taken: tuple[str, ...]  #: files that count
    awaited: tuple[str, ...]  #: files that ``tyre.toml`` lists and that are missing or still being written
    refused: tuple[str, ...]  #: files that ``tyre.toml`` lists and that do not count
    points: int  #: of all files that count
    measured: Measured | None  #: as by ``mffit spin``; None without points that it can use
    before: Quantity | None  #: eps_gamma before the change
    alignment: Alignment | None  #: as by ``mffit align``; None without zeros both ways
    next_run: NextRun | None  #: None if no run lowers the uncertainty, or if it is not known yet
    warnings: tuple[str, ...]  #: that were not given before
    problem: str  #: why ``tyre.toml`` or all files together cannot be used; empty if they can

    @property
    def epsilon_gamma(self) -> Quantity | None:
        """The camber reduction factor by the direct method; None if it is not measured yet."""
        return self.measured.epsilon_gamma if self.measured else None

    @property
    def headline(self) -> str:
        """Progress of the campaign, as a sentence."""
        every = {*self.taken, *self.awaited, *self.refused}
        return f"{len(self.taken)} of {counted(len(every), 'file')}, {counted(self.points, 'point')}"


keys(
    WatchedCampaign,
    "headline changed taken awaited refused points ±epsilon_gamma before=before.value alignment next spin=measured warnings "
    "problem?",
    next=lambda found: (
        found.next_run and {**document(found.next_run.step), "goal": found.next_run.goal.label}
    ),
)


NOTHING_YET = WatchedCampaign((), (), (), (), 0, None, None, None, None, (), "")
"""A campaign before its first file."""
