"""State of an open project, shared by all windows of a server: the file, the last fits, the current run."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

from mffit.config import Config
from mffit.errors import InputError
from mffit.window.edits import EDITS
from mffit.window.project_file import ProjectFile, digest_of
from mffit.window.runs import PAGES, RUNS, Run, RunOutcome, out_of


class Session:
    """A project that is open in one window or several."""

    def __init__(self, path: Path) -> None:
        self.file = ProjectFile(path)
        self.data: dict[str, Any] | None = None  #: of the last fit, for the page
        self.fits = 0  #: finished fits
        self.last: RunOutcome | None = None  #: of the last run
        self._seen: tuple[str | None, str, Config | None] = (None, "", None)
        self._fitted = ""  #: digest of the tyre.toml of the last fit
        self._run: Run | None = None
        self._lock = threading.Lock()

    def state(self) -> dict[str, Any]:
        """What the page must know beside the data of the fit, as JSON."""
        with self._lock:
            self._collect()
            digest = self.file.digest
            problem, config = self._read(digest)
            return {
                "project": digest_of(bytes(self.file.path)),
                "digest": digest,
                "is_fitted": self._fitted == digest,
                "fits": self.fits,
                "problem": problem,
                "hand": {} if config is None else config.hand,
                "exclude": [] if config is None else [entry.model_dump() for entry in config.fit.exclude],
                "can_undo": self.file.can_undo,
                "run": None
                if self._run is None
                else {"kind": self._run.kind, "sentence": self._run.sentence},
                "last": None
                if self.last is None
                else {"state": self.last.state, "sentence": self.last.sentence},
                "pages": self._pages(config),
            }

    def edit(self, name: str, seen: str, arguments: dict[str, Any]) -> None:
        """Carry out one of the changes of :data:`mffit.window.edits.EDITS` and save it.

        Raises
        ------
        InputError
            The change is unknown or not possible; nothing is written.
        """
        if name not in EDITS:
            raise InputError(f'"{name}" is not a change of tyre.toml')
        with self._lock:
            try:
                self.file.edit(lambda text: EDITS[name](text, **arguments), seen)
            except TypeError:
                raise InputError(f"{name} cannot be done with {', '.join(arguments) or 'nothing'}") from None

    def undo(self) -> None:
        """Take back the last saved change."""
        with self._lock:
            self.file.undo()

    def run(self, kind: str) -> None:
        """Start a run.

        Raises
        ------
        InputError
            It is unknown, or another one is under way.
        """
        if kind not in RUNS:
            raise InputError(f'"{kind}" is not something to run')
        with self._lock:
            self._collect()
            if self._run is not None:
                raise InputError("another run is under way; stop it first")
            self.last = None
            self._run = Run(kind, self.file.path, self.file.digest)

    def stop(self) -> None:
        """End the run that is under way."""
        with self._lock:
            run = self._run
        if run is not None:
            run.stop()

    def _collect(self) -> None:
        """Take the outcome of a run that has ended."""
        if self._run is None or self._run.outcome is None:
            return
        run, self._run = self._run, None
        assert run.outcome is not None
        self.last = run.outcome
        if run.outcome.data is not None:
            self.data = run.outcome.data | {"before": _before(self.data)}
            self.fits += 1
            self._fitted = run.digest

    def _read(self, digest: str) -> tuple[str, Config | None]:
        """The configuration, or what is wrong with it; read anew only if the file has changed."""
        if self._seen[0] != digest:
            try:
                self._seen = digest, "", self.file.config()
            except InputError as error:
                self._seen = digest, str(error), None
        return self._seen[1:]

    def _pages(self, config: Config | None) -> list[dict[str, Any]]:
        """The pages of results: title, address if there is one, whether it is older than tyre.toml."""
        out, changed = out_of(self.file.path), _time(self.file.path)
        has_base = config is not None and config.tyre.base is not None
        return [
            {
                "run": kind,
                "title": title,
                "href": f"out/{place}" if (out / place).is_file() else None,
                "old": _time(out / place) < changed,
            }
            for kind, (title, place) in PAGES.items()
            if kind != "compare" or has_base
        ]


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
