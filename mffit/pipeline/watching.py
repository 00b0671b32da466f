"""``mffit watch``: what the files of a campaign say while it runs."""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from mffit import config as configuration
from mffit.errors import InputError
from mffit.pipeline.arriving import Arrived, ArrivingFiles
from mffit.pipeline.inputs import read_usable
from mffit.pipeline.intake import sweep_text
from mffit.pipeline.measuring import alignment_of, spin_of
from mffit.pipeline.planning import next_run_of
from mffit.points.loading import Reading
from mffit.recordings.constants import LOOK_AT_RECORDINGS
from mffit.recordings.project_file import relative
from mffit.results.campaign import NOTHING_YET, Arrival, WatchedCampaign
from mffit.sweeps import formats
from mffit.sweeps.loading import NUMBER

OF_ANOTHER = "; tyre.toml does not list this file: if it is of another tyre or rig, move it to another folder"
"""What a file that nobody listed may be, beyond what is wrong with it."""


def watch(
    path: str | Path,
    *,
    every: float = LOOK_AT_RECORDINGS,
    once: bool = False,
    pause: Callable[[float], object] | None = None,
) -> Iterator[WatchedCampaign]:
    """Results of a campaign while it runs, at first and after every change.

    Parameters
    ----------
    path : of a ``tyre.toml``; sweeps that it lists may still be missing, and recordings in its folder that it does not list are
        used
    every : time from one look at the folder to the next [s]
    once : end when nothing is being written any more
    pause : waits for a time [s]; default ``time.sleep``

    Yields
    ------
    WatchedCampaign
        Points, eps_gamma, alignment and the most informative next run of the files that are complete.

    Raises
    ------
    InputError
        At the start: ``tyre.toml`` cannot be read or is wrong. Later its last state counts until it is corrected.
    """
    watched = _Watch(Path(path))
    while True:
        (pause or time.sleep)(every)
        if (found := watched.look()) is not None:
            yield found
        if once and not watched.arriving.waiting:
            return


class _Watch:
    """A campaign that is checked repeatedly."""

    def __init__(self, path: Path) -> None:
        self.path, self.config = path, configuration.load(path, awaiting=True)
        self.arriving = ArrivingFiles()
        self._shown: object = None  #: the inputs of the last campaign
        self._known: dict[Path, Arrived] = {}  #: its files as they last were complete
        self._last = NOTHING_YET
        self._states: dict[str, tuple[object, ...]] = {}  #: of its files, by their names
        self._said: set[str] = set()  #: its warnings, without their numbers
        self.arriving.look(self.config)

    @formats.reading_once()
    def look(self) -> WatchedCampaign | None:
        """The campaign if something has changed since the look before; None otherwise."""
        config, wrong = self.config, ""
        try:
            config = configuration.load(self.path, awaiting=True)
        except InputError as error:
            wrong = str(error)
        if config.model_copy(update={"sweep": self.config.sweep}) != self.config:
            self.arriving.forget()  # columns or axes may be others
        self.config = config
        self.arriving.look(config)
        files, waiting = self.arriving.files, self.arriving.waiting
        rewritten = {
            path: one for path, one in self._known.items() if path in waiting
        }  # no news until complete
        self._known = rewritten | files
        if (config, self._known, wrong) == self._shown:
            return None
        self._shown, found = (config, self._known, wrong), self._campaign()
        self._last = replace(found, problem=wrong) if wrong else found
        return self._last

    def _campaign(self) -> WatchedCampaign:
        """The results of the complete files."""
        files, listed = self.arriving.files.values(), [entry.file for entry in self.config.sweep]
        doubted = {name for name, (is_refused, *_) in self._states.items() if is_refused}
        complete = self.config.model_copy(update={"sweep": tuple(f.entry for f in files if not f.problem)})
        config, reading, unusable, problem = read_usable(complete, listed, doubted)
        measured = alignment = planned = None
        try:
            with threadpool_limits(1):  # the matrices are small: threads cost more than they save
                if reading is not None:
                    measured = spin_of(config, reading)
                    alignment = alignment_of(config, reading.points)
                    planned = next_run_of(config, reading.points, measured)
        except InputError as error:
            problem = str(error)
        given = measured.warnings if measured else reading.warnings if reading else ()
        warnings = {NUMBER.sub("0", sentence): sentence for sentence in given}
        said, self._said = self._said, set(warnings)
        refused = {file.entry.file: file.problem for file in files if file.problem} | unusable
        awaited = [relative(path, self.config.folder) for path in self.arriving.waiting]
        changed = tuple(self._changed(reading, listed, refused, awaited))
        return WatchedCampaign(
            changed=changed,
            taken=tuple(entry.file for entry in config.sweep),
            awaited=tuple(dict.fromkeys([*(n for n in listed if n not in self._states), *awaited])),
            refused=tuple(name for name in refused if name in listed),
            points=0 if reading is None else len(reading.points),
            measured=measured,
            before=self._last.epsilon_gamma,
            alignment=alignment,
            next_run=planned,
            warnings=tuple(sentence for kind, sentence in warnings.items() if kind not in said),
            problem=problem,
        )

    def _changed(
        self, reading: Reading | None, listed: list[str], refused: Mapping[str, str], awaited: list[str]
    ) -> Iterator[Arrival]:
        """Changes of files since the previous campaign; other numbers in a sentence do not count."""
        before, self._states = self._states, {}
        files = np.array(reading.points.files)[reading.points.file] if reading else np.array([], str)
        for file in self.arriving.files.values():
            name = file.entry.file
            why, own = refused.get(name, ""), int(np.sum(files == name))
            self._states[name] = bool(why), own, NUMBER.sub("0", why), file.signature
            if self._states[name] != before.get(name):
                text = "" if why or name in listed else sweep_text(file.entry)
                if why and name not in listed:
                    why += OF_ANOTHER
                yield Arrival(name, "refused" if why else "taken", own, why, text)
        yield from (Arrival(name, "gone") for name in before if name not in {*self._states, *awaited})
