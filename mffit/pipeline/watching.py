"""``mffit watch``: what the files of a campaign say while it runs."""

from __future__ import annotations

import time
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from threadpoolctl import threadpool_limits

from mffit import config as configuration
from mffit import fit, planning
from mffit.config import Config, SweepTable
from mffit.config.toml_file import toml_text
from mffit.errors import InputError
from mffit.measured import Measured
from mffit.pipeline.inputs import input_names, read_base, read_points
from mffit.pipeline.intake import STRETCHES
from mffit.pipeline.measuring import alignment_of, epsilon_gamma, spin_of
from mffit.planning import NextRun, next_run, read_goal
from mffit.planning.goals import EPSILON, FILE
from mffit.planning.plan import U
from mffit.planning.prospect import DirectProspect, DirectU, Prospect, nominal_load
from mffit.points import Points
from mffit.points.loading import Reading, read
from mffit.recordings import sniff
from mffit.recordings.arriving import ArrivingFiles, Signature, ends_within_line, same_headings
from mffit.recordings.disc import files_of_folder
from mffit.recordings.project_file import relative, sweeps_text
from mffit.recordings.recording import rolls_backward
from mffit.results.campaign import Arrival, WatchedCampaign
from mffit.sheets import file_of
from mffit.sweeps import formats
from mffit.sweeps.loading import NUMBER
from tir import Quantity

LOOK_EVERY = 1.0
"""Time [s] from one look at the folder to the next."""


def watch(
    path: str | Path,
    *,
    every: float = LOOK_EVERY,
    once: bool = False,
    pause: Callable[[float], object] | None = None,
) -> Iterator[WatchedCampaign]:
    """What the files of a campaign say, at first and after every change.

    Parameters
    ----------
    path : of a ``tyre.toml``; sweeps that it lists may be missing yet, and recordings in its folder that it does not list are
        taken in
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
        found = watched.look()
        if found is not None:
            yield found
        if once and not watched.waiting:
            return


class _File(NamedTuple):
    """A file that rests, as it was read."""

    signature: Signature
    entry: SweepTable
    listed: bool
    problem: str = ""  #: why it cannot be read


class _Watch:
    """A campaign that is looked at again and again; what it holds of files was seen at the last look."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.config = configuration.load(path, awaiting=True)
        self.waiting: tuple[Path, ...] = ()  #: files that are being written
        self._wrong: tuple[str, str] = ("", "")  #: what was wrong with tyre.toml at the look before, and now
        self._arriving = ArrivingFiles()
        self._files: dict[Path, _File] = {}  #: that rest, those of tyre.toml first
        self._shown: tuple[Config, str, dict[Path, _File]] | None = None
        """What the last campaign was made of."""
        self._states: dict[str, tuple[object, ...]] = {}  #: of its files, by their names
        self._said: set[str] = set()
        self._epsilon: Quantity | None = None
        self._see()

    @formats.reading_once()
    def look(self) -> WatchedCampaign | None:
        """The campaign if something has changed since the look before; None otherwise."""
        self._see()
        shown = self._shown[2] if self._shown else {}
        rewritten = {path: shown[path] for path in self.waiting if path in shown}  # no news until complete
        if (self.config, self._lasting_problem, rewritten | self._files) == self._shown:
            return None
        self._shown = self.config, self._lasting_problem, self._files
        return self._campaign()

    def _see(self) -> None:
        self._reload()
        listed = {self.config.folder / entry.file: entry for entry in self.config.sweep}
        paths = [*listed, *self._unlisted(listed)]
        self._arriving.look(map(file_of, paths))
        before, self._files = self._files, {}
        waiting = []
        for path in paths:
            signature = self._arriving.signature(file_of(path))
            entry, known = listed.get(path), before.get(path)
            if signature is None:
                continue
            if known is not None and known.signature == signature and _as_listed(known, entry):
                self._files[path] = known
            elif (found := self._read(path, signature, entry)) is not None:
                self._files[path] = found
            else:
                waiting.append(path)
        self.waiting = tuple(waiting)

    @property
    def _lasting_problem(self) -> str:
        """What is wrong with tyre.toml, unless it is just being saved."""
        return self._wrong[1] if self._wrong[0] == self._wrong[1] else ""

    def _reload(self) -> None:
        """Read tyre.toml again; if it is wrong, the one before counts."""
        try:
            config = configuration.load(self.path, awaiting=True)
        except InputError as error:
            self._wrong = self._wrong[1], str(error)
            return
        self._wrong = self._wrong[1], ""
        if config.model_copy(update={"sweep": self.config.sweep}) != self.config:
            self._files = {}  # read them again: columns or axes may be others
        self.config = config

    def _unlisted(self, listed: Iterable[Path]) -> Iterator[Path]:
        """Recordings in the project's folder, and in those within it that hold sweeps, that tyre.toml does not name."""
        config = self.config
        named = {(config.folder / name).resolve() for name in input_names(config)}
        inside = (path.parent for path in listed if path.resolve().is_relative_to(config.folder.resolve()))
        for folder in dict.fromkeys([config.folder, *inside]):
            for path in files_of_folder(folder) if folder.is_dir() else ():
                if path.resolve() not in named and path.name != STRETCHES:
                    yield path

    def _read(self, path: Path, signature: Signature, listed: SweepTable | None) -> _File | None:
        """A file that is complete, or that stays unreadable; None while it is being written."""
        file = file_of(path)
        if not self._arriving.rests(file):
            return None
        final = self._arriving.is_final(file)
        entry = listed or SweepTable(file=self._name(path))
        try:
            if not final and ends_within_line(file):
                return None
            entry = listed or self._recognised(path)
            read(self._of([entry]), may_be_empty=True)
        except InputError as error:
            return _File(signature, entry, listed is not None, str(error)) if final else None
        self._arriving.take(file)
        return _File(signature, entry, listed is not None)

    def _recognised(self, path: Path) -> SweepTable:
        """The [[sweep]] of a recording that tyre.toml does not list: as a listed one with these headings, else as recognised."""
        config, name = self.config, self._name(path)
        for known in self._files.values():
            alike = known.listed and known.entry.columns and not known.problem
            if alike and same_headings(path, config.folder / known.entry.file):
                entry = SweepTable(file=name, columns=known.entry.columns)
                return entry.model_copy(update={"direction": "backward"}) if rolls_backward(path) else entry
        found = sniff([path], unloaded_radius=config.tyre.unloaded_radius)
        text = sweeps_text(found, config.folder, config.columns)
        return SweepTable.model_validate(tomllib.loads(text)["sweep"][0])

    def _name(self, path: Path) -> str:
        return relative(path, self.config.folder)

    def _of(self, entries: Iterable[SweepTable]) -> Config:
        """The configuration of some sweeps."""
        return self.config.model_copy(update={"sweep": tuple(entries)})

    def _campaign(self) -> WatchedCampaign:
        refused = {path: file.problem for path, file in self._files.items() if file.problem}
        problem, reading, measured, alignment, planned = self._lasting_problem, None, None, None, None
        while taken := {path: file.entry for path, file in self._files.items() if path not in refused}:
            config = self._of(taken.values())
            try:
                reading = read_points(config)
                with threadpool_limits(1):  # the matrices are small: threads cost more than they save
                    measured = spin_of(config, reading)
                    alignment = alignment_of(config, reading.points)
                    planned = next_of(config, reading.points, measured)
            except InputError as error:
                at_fault = [path for path in taken if error.file is not None and error.file.name == path.name]
                if reading is None and at_fault:
                    refused[at_fault[0]] = str(error)
                    continue
                problem = problem or str(error)
            break
        before, self._epsilon = self._epsilon, measured.epsilon_gamma if measured else None
        given = measured.warnings if measured else reading.warnings if reading else ()
        return WatchedCampaign(
            changed=self._changed(reading, refused),
            taken=tuple(entry.file for entry in taken.values()),
            awaited=self._awaited(),
            points=0 if reading is None else len(reading.points),
            measured=measured,
            before=before,
            alignment=alignment,
            next_run=planned,
            warnings=self._not_said(given),
            problem=problem,
        )

    def _changed(self, reading: Reading | None, refused: Mapping[Path, str]) -> tuple[Arrival, ...]:
        """What became of files since the campaign before; other numbers in a sentence are no change."""
        before, self._states, new = self._states, {}, []
        for path, file in self._files.items():
            name, own, why = file.entry.file, 0, refused.get(path, "")
            if reading is not None and not why and name in reading.points.files:
                own = int(np.sum(reading.points.file == reading.points.files.index(name)))
            entry = file.entry.model_dump(mode="json", exclude_defaults=True)
            text = "" if file.listed else toml_text({"sweep": [entry]}).strip()
            self._states[name] = bool(why), own, NUMBER.sub("0", why), file.signature
            if self._states[name] != before.get(name):
                new.append(Arrival(name, "refused" if why else "taken", own, why, text))
        there = {*self._states, *map(self._name, self.waiting)}
        return (*new, *(Arrival(name, "gone") for name in before if name not in there))

    def _awaited(self) -> tuple[str, ...]:
        """Files that are missing or being written."""
        there = {file.entry.file for file in self._files.values()}
        missing = [entry.file for entry in self.config.sweep if entry.file not in there]
        return tuple(dict.fromkeys([*missing, *map(self._name, self.waiting)]))

    def _not_said(self, warnings: Iterable[str]) -> tuple[str, ...]:
        """Warnings that the campaign before did not have, with whatever numbers."""
        before, kinds = self._said, {NUMBER.sub("0", sentence): sentence for sentence in warnings}
        self._said = set(kinds)
        return tuple(sentence for kind, sentence in kinds.items() if kind not in before)


def next_of(config: Config, points: Points, measured: Measured) -> NextRun | None:
    """The most informative next run: for eps_gamma by the direct method, whose readings there the measured slopes predict; on
    a flat track for the file, by a first fit.

    None if no run lowers the uncertainty enough, or if the points cannot determine a first fit yet.
    """
    base, on_disc = read_base(config), config.rig.on_disc
    goal = read_goal(EPSILON if on_disc else FILE, on_disc=on_disc)

    def direct(points: Points) -> DirectU | None:
        found = epsilon_gamma(config, points, base)
        return None if found is None else DirectU(found.u, found.u)

    try:
        if on_disc:
            rig = fit.begin(config, points, measured, base).simulation

            def predicted(run: planning.PlannedRun) -> Points:
                return run.points.replace(**rig.readings(run.points))

            u: U = DirectProspect(points, nominal_load(config, measured), predicted, direct).u
        else:
            found = fit.sketch(config, points, measured, base)
            u = Prospect(config, points, measured, found, direct).u_of(goal)
        return next_run(config, points, goal, u)
    except InputError:
        return None


def _as_listed(known: _File, entry: SweepTable | None) -> bool:
    """Whether a file was read as tyre.toml lists it now, or does not."""
    return known.entry == entry if known.listed or entry is not None else True
