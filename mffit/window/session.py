"""An open project, shared by all windows of a server: its tyre.toml with undo, the last fits, the current run."""

import contextlib
import difflib
import hashlib
import threading
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from mffit.config import Config
from mffit.config.loading import TYRE_TOML, checked
from mffit.config.toml_file import tables_of
from mffit.errors import InputError
from mffit.fit.influences.nuisance_choice import refuse_lacking
from mffit.output import BUILT, ChangedMeanwhile, digest, save_over
from mffit.pipeline.inputs import check_named_files, input_names, read_points
from mffit.recordings.disc import files_of_folder
from mffit.sweeps import formats
from mffit.sweeps.loading import check_excluded
from mffit.window.edits import EDITS, setting
from mffit.window.runs import PAGES, RUNS, Run, RunOutcome, out_of
from mffit.window.settings import settings

BOM = b"\xef\xbb\xbf"


class ChangedElsewhere(InputError):
    """A change was meant for another content of the file than it has; ``versions`` are both, as differences to that content."""

    def __init__(self, path: Path, seen: bytes, now: bytes, mine: bytes) -> None:
        super().__init__(
            "was changed elsewhere in the meantime; your change is not saved, that of the others is",
            file=path,
        )
        self.versions = {"theirs": _difference(seen, now), "mine": _difference(seen, mine)}


def _difference(before: bytes, after: bytes) -> str:
    """The lines that differ, each with one around it."""
    old, new = (content.decode("utf-8-sig", errors="replace").splitlines() for content in (before, after))
    lines = list(difflib.unified_diff(old, new, n=1, lineterm=""))[2:]
    return "\n".join("..." if line.startswith("@@") else line for line in lines)


class ProjectFile:
    """A ``tyre.toml`` and the changes that the window made to it."""

    def __init__(self, path: Path) -> None:
        self.path = path.absolute()  # a link lies in its own folder, with the files that it names
        self.steps: list[tuple[bytes, bytes]] = []  #: contents before and after each saved change
        self._shown: dict[str, bytes] = {}  #: contents that windows may have seen, by digest

    @property
    def digest(self) -> str:
        """Digest of the content as it is on the disk; empty if the file is gone."""
        try:
            content = self.path.read_bytes()
        except OSError:
            return ""
        found = digest_of(content)
        self._shown[found] = content
        return found

    def config(self) -> Config:
        """The configuration as it is on the disk. Raises InputError if the file cannot be read or is wrong."""
        return self._checked(self._bytes())

    def tables(self) -> dict[str, object]:
        """The content as it is on the disk; raises as :meth:`config`."""
        return tables_of(self._bytes(), self.path, TYRE_TOML)[0]

    def edit(self, change: Callable[[str], str], seen: str, *, is_setting: bool = False) -> None:
        """Write the changed text, if the file is still the one that was ``seen`` (its digest) and the new one is a right
        ``tyre.toml``. A setting may also be refused because of the readings, which takes as long as reading them.

        Raises InputError if the file was changed by another program or window, or the new content would be refused; nothing is
        written.
        """
        before = self._bytes()
        try:
            if digest_of(before) != seen:
                raise ChangedMeanwhile(before)
            after = self._changed(before, change)
            if after == before:
                return
            self._checked(after)
            refusal = self._refusal(after)
            if refusal is not None and str(refusal) != str(self._refusal(before)):
                raise refusal
            contradiction = self._contradiction(after) if is_setting and refusal is None else None
            if contradiction is not None and self._contradiction(before) is None:
                raise contradiction
            save_over(self.path, before, after)
        except ChangedMeanwhile as error:
            shown = self._shown.get(seen, before)
            raise ChangedElsewhere(self.path, shown, error.now, self._changed(shown, change)) from None
        self.steps.append((before, after))

    def _changed(self, before: bytes, change: Callable[[str], str]) -> bytes:
        """The content after a change."""
        tables_of(before, self.path, TYRE_TOML)
        text = before.decode("utf-8-sig")
        try:
            return (BOM if before.startswith(BOM) else b"") + change(text).encode()
        except UnicodeEncodeError:
            raise InputError(
                "cannot hold a character of the new text; leave it away", file=self.path
            ) from None

    def undo(self) -> None:
        """Take back the last change that the window saved.

        Raises InputError if there is none, or the file was changed elsewhere since.
        """
        try:
            step = self.steps.pop()
            save_over(self.path, *reversed(step))
        except (IndexError, ChangedMeanwhile):
            self.steps = []
            raise InputError("has no change of this window to undo", file=self.path) from None
        except InputError:
            self.steps.append(step)
            raise

    @property
    def can_undo(self) -> bool:
        """Whether the last change of the window can be taken back."""
        return bool(self.steps) and digest_of(self.steps[-1][1]) == self.digest

    def _bytes(self) -> bytes:
        try:
            return self.path.read_bytes()
        except OSError as error:
            raise InputError(f"cannot be read ({error.strerror}); put it back", file=self.path) from None

    def _checked(self, content: bytes) -> Config:
        tables, lines = tables_of(content, self.path, TYRE_TOML)
        return checked(tables, path=self.path, folder=self.path.parent, lines=lines)

    def _refusal(self, content: bytes) -> InputError | None:
        """Why a build refuses a content, or the files and lines that it names except recordings; None if it does not."""
        try:
            config = self._checked(content)
            check_named_files(config)
            for file in {one.file for one in config.fit.exclude}:
                lines = _of_file(_lines, config.folder / file)
                if lines is not None:
                    check_excluded(config, file, lines)
        except InputError as error:
            return error
        return None

    def _contradiction(self, content: bytes) -> InputError | None:
        """Why a build refuses a content because of its readings; None if it does not."""
        config = self._checked(content)
        try:
            refuse_lacking(config, read_points(config).points)
        except InputError as error:
            return error
        return None


def _lines(path: Path) -> np.ndarray | None:
    """The lines (n,) of the rows of a recording; None if a build says why it cannot be read."""
    try:
        return np.asarray(formats.read(path).lines)
    except InputError:
        return None


Found = TypeVar("Found")


def _of_file(question: Callable[[Path], Found], path: Path) -> Found | None:
    """The answer for a file, asked again only if it has changed; None if it is gone."""
    try:
        stat = path.stat()
        found: Found = _answer(question, path, (stat.st_size, stat.st_mtime_ns, stat.st_ctime_ns))
        return found
    except OSError:
        return None


@lru_cache
def _answer(question: Callable[[Path], Any], path: Path, signature: tuple[int, ...]) -> Any:
    return question(path)


def digest_of(content: bytes) -> str:
    """SHA-256 in hex."""
    return hashlib.sha256(content).hexdigest()


class Session:
    """A project that is open in one window or several."""

    def __init__(self, path: Path) -> None:
        self.file = ProjectFile(path)
        self.data: dict[str, Any] | None = None  #: of the last fit, for the page
        self.fits = 0  #: finished fits
        self.readings: dict[str, Any] | None = None  #: for the page until the first fit ends
        self.last: RunOutcome | None = None  #: of the last run
        self._ended_with: tuple[str, dict[Path, int]] = (
            "",
            {},
        )  #: tyre.toml and recordings when it had ended
        self._seen: tuple[str | None, str, Config | None] = (None, "", None)
        self._fitted: dict[str, Any] | None = None  #: what the tyre.toml of the last fit states
        self._run: Run | None = None
        self._first: Run | None = None  #: by which the readings are shown before the first fit
        self._news: dict[str, Any] | None = None  #: what new recordings say, for the page
        self._reading: Run | None = None  #: by which they are read
        self._recordings = self._there()  #: when they were read
        self._lock = threading.Lock()

    def state(self) -> dict[str, Any]:
        """What the page must know in addition to the data of the fit, as JSON."""
        with self._lock:
            self._collect()
            now = self.file.digest
            problem, config = self._read(now)
            self._look_for_recordings()
            differs = [] if config is None else self._differing(config)
            last = self.last if self._ended_with == (now, self._there()) else None
            return {
                "digest": now,
                "is_fitted": config is not None and self._fitted == stated(config) and not differs,
                "differs": differs,
                "fits": self.fits,
                "has_readings": self.readings is not None,
                "problem": problem,
                "hand": {} if config is None else config.hand,
                "exclude": [] if config is None else [entry.model_dump() for entry in config.fit.exclude],
                "can_undo": self.file.can_undo,
                "run": None
                if self._run is None
                else {"kind": self._run.kind, "sentence": self._run.sentence},
                "last": None if last is None else {"state": last.state, "sentence": last.sentence},
                "pages": self._pages(config),
                "news": self._unlisted_news(config),
            }

    def edit(self, name: str, seen: str, arguments: dict[str, Any]) -> None:
        """Carry out one of the changes of :data:`mffit.window.edits.EDITS` and save it.

        Raises InputError if the change is unknown or not possible; nothing is written.
        """
        if name not in EDITS:
            raise InputError(f'"{name}" is not a change of tyre.toml')
        with self._lock:
            try:
                self.file.edit(
                    lambda text: EDITS[name](text, **arguments), seen, is_setting=EDITS[name] is setting
                )
            except TypeError:
                raise InputError(f"{name} cannot be done with {', '.join(arguments) or 'nothing'}") from None

    def settings(self) -> list[dict[str, Any]]:
        """What can be set in addition to coefficients, as in :func:`mffit.window.settings.settings`."""
        return settings(self.file.tables())

    def undo(self) -> None:
        """Take back the last saved change."""
        with self._lock:
            self.file.undo()

    def run(self, kind: str) -> None:
        """Start a run. Raises InputError if it is unknown, or another one is under way."""
        if kind not in RUNS:
            raise InputError(f'"{kind}" is not something to run')
        with self._lock:
            self._collect()
            if self._run is not None:
                raise InputError("another run is under way; stop it first")
            self.last = None
            if self.data is None and self.readings is None:
                self._first = Run("points", self.file.path)
            self._run = Run(kind, self.file.path, stated(self._read(self.file.digest)[1]))

    def stop(self) -> None:
        """End the run that is under way."""
        with self._lock:
            runs = self._run, self._first, self._reading
        for run in runs:
            if run is not None:
                run.stop()

    def _there(self) -> dict[Path, int]:
        """Time of every recording next to tyre.toml [ns]."""
        found = {}
        with contextlib.suppress(OSError):  # gone in between
            for path in files_of_folder(self.file.path.parent):
                found[path] = path.stat().st_mtime_ns
        return found

    def _look_for_recordings(self) -> None:
        """Have new recordings read in a process of its own, which waits until they are complete."""
        there, reading = self._there(), self._reading
        if reading is not None and reading.outcome is not None:
            self._news, self._reading = reading.outcome.data, None
        elif reading is None and there != self._recordings:
            self._recordings, self._reading = there, Run("watch", self.file.path)

    def _collect(self) -> None:
        """Take the outcome of a run that has ended."""
        if self._first is not None and self._first.outcome is not None:
            self.readings, self._first = self._first.outcome.data, None
        if self._run is None or self._run.outcome is None:
            return
        run, self._run = self._run, None
        assert run.outcome is not None
        self.last, self._ended_with = run.outcome, (self.file.digest, self._there())
        if run.outcome.data is not None:
            self.data = run.outcome.data | {"before": _before(self.data)}
            self.fits += 1
            news = self._unlisted_news(self._seen[2])
            self._news = news if news and news["unlisted"] else None  # the fit lacks those
            self._fitted = run.stated

    def _differing(self, config: Config) -> list[str]:
        """The files that the configuration names and that are not those of the last fit, or are gone."""
        if self.data is None:
            return []
        used = self.data["inputs"]
        now = {name: _of_file(digest, config.folder / name) for name in input_names(config)}
        others = [name for name in {**used, **now} if now.get(name) != used.get(name)]
        return [name if now.get(name) else f"{name} (gone)" for name in others]

    def _unlisted_news(self, config: Config | None) -> dict[str, Any] | None:
        """What new recordings say, ``unlisted`` those that tyre.toml still lacks."""
        if self._news is None or config is None:
            return self._news
        known = {sweep.file for sweep in config.sweep}
        return {**self._news, "unlisted": [name for name in self._news["unlisted"] if name not in known]}

    def _read(self, digest: str) -> tuple[str, Config | None]:
        """The configuration, or what is wrong with it; read anew only if the file has changed."""
        if self._seen[0] != digest:
            try:
                self._seen = digest, "", self.file.config()
            except InputError as error:
                self._seen = digest, str(error), None
        return self._seen[1:]

    def _pages(self, config: Config | None) -> list[dict[str, Any]]:
        """The pages of results: title, address if there is one, whether it is older than tyre.toml, and files to save."""
        out, changed = out_of(self.file.path), _time(self.file.path)
        has_base = config is not None and config.tyre.base is not None
        return [
            {
                "run": kind,
                "title": title,
                "href": f"out/{place}" if (out / place).is_file() else None,
                "old": _time(out / place) < changed,
                "files": sorted(path.name for path in out.glob("*.tir")) if kind == "build" else [],
            }
            for kind, (title, place) in PAGES.items()
            if kind != "compare" or (has_base and (out / BUILT).is_file())
        ]


def stated(config: Config | None) -> dict[str, Any] | None:
    """What a tyre.toml states: neither its comments, nor tables without a key."""
    given = {} if config is None else config.model_dump(exclude_unset=True)
    return None if config is None else {key: value for key, value in given.items() if value}


def _before(data: dict[str, Any] | None) -> dict[str, Any] | None:
    """What the page shows of the fit before: coefficients and misfit."""
    if data is None:
        return None
    return {
        "values": {row["name"]: row["value"] for row in data["coefficients"]},
        "rmse": {row["name"]: row["rmse"] for row in data["channels"]},
    }


def _time(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0
