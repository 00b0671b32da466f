"""A folder of recordings in the window: what is recognised, as a table to correct, and the project made of it."""

import tomllib
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from mffit import config
from mffit.config import Config
from mffit.config.loading import STAND_IN, checked
from mffit.config.models import Column
from mffit.errors import InputError, shortened
from mffit.output import digest, new_files
from mffit.pipeline.intake import STRETCHES, project_of, written_project
from mffit.points import Points
from mffit.points.loading import read
from mffit.recordings.disc import DiscPath, disc_signs, files_of_folder
from mffit.recordings.guess import NO_COLUMNS, ColumnChoice, corrected, guesses
from mffit.recordings.project_file import Stated, relative, slug, sweeps_text, tyre_found
from mffit.recordings.recording import (
    ChosenFile,
    SniffedRecording,
    UnrecognisedError,
    rolls_backward,
    speed_is_negative,
)
from mffit.recordings.sniffed import Sniffed, axes_of, sniff
from mffit.recordings.summary import SummaryRow, apart, bad_runs, two_specimens
from mffit.recordings.unstated import Guess
from mffit.suspicion import before_the_fit
from mffit.suspicion.rereadings import turned
from mffit.sweeps import formats
from mffit.sweeps.channels import BY_NAME, SWEEP_CHANNELS
from mffit.sweeps.columns import numbers
from mffit.viewer.project_points import facets
from mffit.window.edits import add_recordings
from tir.errors import counted

PROJECT = "tyre.toml"
NOT_READABLE_HERE = (PROJECT, STRETCHES)
SEPARATORS = frozenset('/\\:*?"<>|')
"""Characters that separate folders on some system, or that no file there may have."""
SETTINGS = ("Fz", "alpha", "gamma", "kappa", "pressure", "Vx")
"""Conditions whose levels are shown."""


class RecordingsFolder:
    """Recordings in a folder that have no ``tyre.toml`` yet, or that are not in the ``tyre.toml`` there."""

    def __init__(self, folder: Path, project: Path | None = None) -> None:
        self.folder, self.project = folder.resolve(), project

    def _parted(self) -> tuple[list[Path], tuple[SummaryRow, ...], list[Path]]:
        """What is in the folder and not listed: recordings, the rows of summaries about them, and links to files elsewhere."""
        listed = self._listed
        named = [path for path in files_of_folder(self.folder) if path.name not in NOT_READABLE_HERE]
        new = [path for path in named if path.resolve() not in listed]
        here = [path for path in new if path.resolve().is_relative_to(self.folder)]
        return *apart(_tables(here, listed)), [path for path in new if path not in here]

    @property
    def _listed(self) -> set[Path]:
        """The files and sheets that the project lists."""
        if self.project is None:
            return set()
        project = config.load(self.project)
        return {(project.folder / entry.file).resolve() for entry in project.sweep}

    def store(self, name: str, content: bytes) -> Path:
        """Write a recording that was dropped into the page; returns its path.

        Raises InputError if the name is not that of a recording in this folder, the file exists, or the folder cannot be
        written to.
        """
        simple = bool(name) and name.isprintable() and not name.startswith(".") and not set(name) & SEPARATORS
        if not simple or name in NOT_READABLE_HERE or not name.lower().endswith(formats.ENDINGS):
            raise InputError(
                f'"{shortened(name)}" is not the name of a recording ({", ".join(formats.ENDINGS)}); rename the file'
            )
        return new_files(self.folder, {name: content})[0]

    @formats.reading_once()
    def table(self) -> dict[str, Any]:
        """What is recognised: files in groups of equal headings, channels to choose from, and what else the files say."""
        files, _, links = self._parted()
        groups, unreadable = _groups(files, self._columns)
        unreadable += [
            str(InputError("is a link to a file elsewhere and not read; copy the file here", file=path))
            for path in links
        ]
        return {
            "folder": self.folder.name,
            "channels": [
                {"name": c.name, "about": c.description, "required": c.required} for c in SWEEP_CHANNELS
            ],
            "groups": groups,
            "unreadable": unreadable,
            "seen": digest(self.project) if self.project else "",
            **self.recognised({"groups": groups}),
        }

    @formats.reading_once()
    def recognised(self, choice: Mapping[str, Any]) -> dict[str, Any]:
        """What the ticked files say of tyre and rig, with the columns as chosen; ``known`` is False if they say nothing.

        ``problems`` are those of these files, ``remarks`` those of each group that the choice leaves.
        """
        with _complete():
            chosen = self._chosen_files(choice)
            remarks = [self._remarks(group, chosen) for group in choice["groups"]]
        summaries = [row for row in self._parted()[1] if row.recording in chosen]
        problems, found = [], None
        try:
            found = self._sniffed(chosen) if chosen else None
        except InputError as error:
            problems.append(str(error))
        problems += [f"{run.recording.name} is left out: {run.why}" for run in bad_runs(summaries)]
        problems += filter(None, [two_specimens(summaries)])
        known = tyre_found(found, self.folder) if found else Stated(name=slug(self.folder))
        return {
            "known": found is not None,
            "problems": problems,
            "remarks": remarks,
            "tyre": {key: value for key, value in known._asdict().items() if value},
            "axes": list(found.axes) if found else [],
            "disc": disc_signs(found) if found else [],
        }

    @property
    def _columns(self) -> Mapping[str, Column]:
        """[columns] of the project, which are read in every recording."""
        return NO_COLUMNS if self.project is None else config.load(self.project).columns

    def _sniffed(self, chosen: Mapping[Path, ChosenFile], radius: float | None = None) -> Sniffed:
        """What the chosen files hold; the unloaded radius [m], if known, checks the speed of rotation."""
        try:
            return sniff(sorted(chosen), unloaded_radius=radius, chosen=chosen, columns=self._columns)
        except UnrecognisedError as error:
            cure = "choose its columns below, or take its tick away"
            raise InputError(f"{error.said}: {cure}", file=error.file, line=error.line) from None

    def _remarks(self, group: Mapping[str, Any], chosen: Mapping[Path, ChosenFile]) -> list[str]:
        """What the columns of a group leave to ask; nothing if none of its files is used."""
        names = {file["name"] for file in group["files"]}
        path = next((path for path in chosen if path.name in names), None)
        if path is None:
            return []
        raw = formats.read(path)
        guessed = corrected(guesses(raw, columns=self._columns), raw, chosen[path].columns)
        return [remark.said for remark in guessed.remarks]

    @formats.reading_once()
    def check(self, choice: Mapping[str, Any]) -> dict[str, Any]:
        """What the recordings hold if they are read as chosen.

        Raises
        ------
        InputError
            They cannot be read so.
        """
        try:
            return self._checked(choice)
        except InputError as error:
            said = _on_the_page(error.sentence, choice)
            raise InputError(
                said, file=error.file, line=error.line, column=error.column, key=error.key
            ) from None

    def _checked(self, choice: Mapping[str, Any]) -> dict[str, Any]:
        """As :meth:`check`; refusals say what to write in ``tyre.toml``."""
        chosen = self._chosen_config(choice)
        reading = read(chosen, may_be_empty=True)
        warnings = [*reading.notes, *reading.warnings]
        axes: tuple[str, ...] = ()
        wrong: tuple[str, ...] = ()
        conditions: list[dict[str, Any]] = []
        if len(reading.points):
            conditions = _conditions(reading.points)
            axes, wrong = axes_of(reading.points, chosen.rig.axes, load_falls=False)
            warnings += before_the_fit(reading.points, chosen)
        return {
            "points": len(reading.points),
            "conditions": conditions,
            "axes": list(axes),
            "wrong": list(wrong),
            "warnings": [_on_the_page(sentence, choice) for sentence in warnings],
        }

    def _chosen_config(self, choice: Mapping[str, Any]) -> Config:
        """The project as chosen, of these recordings alone."""
        if self.project is None:
            return checked(tomllib.loads(self._project(choice)[1]), path=None, folder=self.folder, lines={})
        text = add_recordings(self.project.read_bytes().decode("utf-8-sig"), **self.added(choice))
        found = checked(tomllib.loads(text), path=self.project, folder=self.project.parent, lines={})
        known = config.load(self.project).sweep
        return found.model_copy(update={"sweep": tuple(one for one in found.sweep if one not in known)})

    @formats.reading_once()
    def added(self, choice: Mapping[str, Any]) -> dict[str, Any]:
        """What :func:`mffit.window.edits.add_recordings` adds to the project.

        Raises InputError if the recordings cannot be read as chosen.
        """
        assert self.project is not None
        project = config.load(self.project)
        with _complete():
            chosen = self._chosen_files(choice)
        found = self._sniffed(chosen, project.tyre.unloaded_radius)
        for recording in found.recordings:
            _check_declared(recording, project.columns)
        bad = [
            {"file": relative(run.recording, self.folder), "lines": run.lines, "why": run.why}
            for run in found.bad_runs
        ]
        return {"sweeps": sweeps_text(found, self.folder, project.columns), "bad": bad}

    @formats.reading_once()
    def make(self, choice: Mapping[str, Any]) -> Path:
        """Write what ``mffit init --from`` writes; returns the path of the ``tyre.toml``.

        Raises InputError if the recordings cannot be read as chosen, or one of the files exists.
        """
        return written_project(self.folder, *self._project(choice))[0]

    @formats.reading_once()
    def _project(self, choice: Mapping[str, Any]) -> tuple[Sniffed, str]:
        """What the recordings hold, and the ``tyre.toml`` as ``mffit init --from`` makes it; only files of this folder."""
        with _complete():
            chosen = self._chosen_files(choice)
            stated = self._stated(choice["tyre"], choice["rig"], [path.name for path in chosen])
        found = self._sniffed(chosen, stated.unloaded_radius)
        signs = [] if stated.belt or stated.disc else disc_signs(found)
        if signs:
            raise InputError(
                f"these look like recordings of a disc ({'; '.join(signs)}): choose disc or belt"
            )
        return project_of(found, self.folder, stated)

    def _chosen_files(self, choice: Mapping[str, Any]) -> dict[Path, ChosenFile]:
        """The files that are used, with the user's statements; only files of this folder."""
        known, columns = {path.name: path for path in self._parted()[0]}, self._columns
        return {
            (path := known[file["name"]]): _chosen(
                path, group["columns"], bool(file.get("backward")), columns
            )
            for group in choice["groups"]
            for file in group["files"]
            if file["name"] in known and file.get("used", True)
        }

    def _stated(self, tyre: Mapping[str, Any], rig: Mapping[str, Any], files: Sequence[str]) -> Stated:
        """The user's statements about tyre and rig, checked like a ``tyre.toml``; what nobody chose is not among them."""
        given, of_rig = ({k: v for k, v in table.items() if v not in (None, "")} for table in (tyre, rig))
        of_rig = {"type": "flat-track"} | of_rig
        on_disc, belt = of_rig["type"] != "flat-track", rig.get("type") == "flat-track"
        if not on_disc:
            of_rig = {k: v for k, v in of_rig.items() if not k.startswith("path")}
        open_yet = {"name": "t", "nominal_pressure": STAND_IN["nominal_pressure"]}
        content = {"tyre": open_yet | given, "rig": of_rig, "sweep": [{"file": name} for name in files]}
        checked(content, path=None, folder=self.folder, lines={})
        disc = DiscPath(float(of_rig["path_radius"]), str(of_rig["path_centre"])) if on_disc else None
        return Stated(**given, axes=of_rig.get("axes"), disc=disc, belt=belt)


def _on_the_page(sentence: str, choice: Mapping[str, Any]) -> str:
    """A sentence that names the box of the page by which a sign is turned, in place of what to write in ``tyre.toml``."""
    with _complete():
        for row in (row for group in choice["groups"] for row in group["columns"]):
            box = f'change "turn sign" of {row["heading"]}'
            sentence = sentence.replace(turned(_choice(row).channel), box)
    return sentence


def _conditions(points: Points) -> list[dict[str, Any]]:
    """The levels of each setting, in words; of many, the first and the last, and the number of points at no level."""
    found, groups = facets(points)
    conditions = []
    for facet in (one for one in found if one["name"] in SETTINGS):
        labels = facet["labels"]
        said = [f"{labels[0]} to {labels[-1]}"] if facet["as_range"] else [*labels]
        others = int(np.sum(groups[facet["name"]] < 0))
        said += [f"others ({counted(others, 'point')})"] if others else []
        conditions.append({"word": facet["word"], "labels": said})
    return conditions


@contextmanager
def _complete() -> Iterator[None]:
    """Within this block, what the page leaves out is an :class:`InputError`."""
    try:
        yield
    except (KeyError, TypeError, AttributeError, IndexError):
        raise InputError("the choice is incomplete: tyre, rig and groups are needed") from None


def _check_declared(recording: SniffedRecording, columns: Mapping[str, Column]) -> None:
    """Refuse a column that is not used as [columns] of the project reads it, which no [[sweep]] can undo."""
    for name, column in columns.items():
        heading = column.column or name
        if column.value is None and heading in recording.headings and name not in recording.guesses:
            raise InputError(
                f'[columns] of the project reads "{heading}" as {name} in every file: choose that, or remove it there',
                file=recording.path,
            )


def _groups(files: Sequence[Path], columns: Mapping[str, Column]) -> tuple[list[dict[str, Any]], list[str]]:
    """Files with equal headings and units, each with the columns as guessed or as [columns] of the project; and why the others
    cannot be read.
    """
    groups: dict[tuple[Any, ...], dict[str, Any]] = {}
    problems = []
    for path in files:
        try:
            raw = formats.read(path)
            found = guesses(raw, columns=columns).found
        except InputError as error:
            problems.append(str(error))
            continue
        guessed = {guess.heading: guess for guess in found.values()}
        key = raw.headings, raw.units, tuple((*_offered(one, guessed),) for one in raw.headings)
        offered = [
            {
                **_offered(heading, guessed)._asdict(),
                "stated": raw.unit(heading),
                "range": None,
                "why": guessed[heading].why if heading in guessed else "",
            }
            for heading in raw.headings
        ]
        group = groups.setdefault(key, {"files": [], "columns": offered})
        for column in group["columns"]:
            readings = numbers(raw.column(column["heading"]))
            seen = np.append(readings[np.isfinite(readings)], column["range"] or [])
            column["range"] = [float(seen.min()), float(seen.max())] if len(seen) else None
        back = "direction" not in found and (rolls_backward(path) or speed_is_negative(found))
        group["files"].append({"name": path.name, "rows": len(raw), "backward": back})
    return list(groups.values()), problems


def _offered(heading: str, guessed: Mapping[str, Guess]) -> ColumnChoice:
    """What a column is taken for, by the guesses by heading."""
    if heading not in guessed:
        return ColumnChoice(heading, "", "", False)
    guess = guessed[heading]
    return ColumnChoice(heading, guess.channel.name, guess.unit, guess.scale < 0.0)


def _chosen(
    path: Path, rows: Sequence[Mapping[str, Any]], backward: bool, columns: Mapping[str, Column]
) -> ChosenFile:
    """What the user states about a recording, as far as it differs from what is recognised or in [columns] of the project."""
    raw = formats.read(path)
    guessed = {guess.heading: guess for guess in guesses(raw, columns=columns).found.values()}
    chosen, taken = [], set()
    for row in rows:
        one = _choice(row)
        if one.heading not in raw.headings:
            raise InputError(f'has no heading "{shortened(one.heading)}"; load the page again', file=path)
        if one.channel and one.channel not in BY_NAME:
            raise InputError(f'"{shortened(one.channel)}" is no channel; load the page again', file=path)
        if one.channel in taken:
            raise InputError(f"{one.channel} is given by two columns; choose one of them")
        taken.update({one.channel} - {""})
        if one != _offered(one.heading, guessed):
            chosen.append(one)
    return ChosenFile(tuple(chosen), backward)


def _tables(files: Sequence[Path], listed: Collection[Path]) -> list[Path]:
    """The files, with the sheets of a workbook in place of it; without those that are ``listed``."""
    found = []
    for file in files:
        try:
            found += formats.tables_of(file)
        except InputError:  # the table of recordings names it with its fault
            found.append(file)
    return [path for path in found if path.resolve() not in listed]


def _choice(row: Mapping[str, Any]) -> ColumnChoice:
    return ColumnChoice(
        str(row["heading"]), str(row.get("channel") or ""), str(row.get("unit") or ""), bool(row.get("minus"))
    )
