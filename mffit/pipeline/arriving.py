"""The recordings of a project while they arrive: which are complete, how they are read, and which are still being written."""

from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from mffit.config import Config, SweepTable
from mffit.errors import InputError
from mffit.pipeline.intake import entry_of, unlisted
from mffit.points.loading import read
from mffit.recordings.constants import LOOKS_BEFORE_REFUSAL, LOOKS_OF_PATIENCE
from mffit.recordings.project_file import relative
from mffit.sheets import file_of

BINARY = (".gz", ".mat", ".xlsx", ".xlsm", ".parquet")
"""Endings of files whose reader refuses an incomplete file."""


Signature = tuple[int, int]
"""Size and time [ns] of a file, which change when it is written."""


class Arrived(NamedTuple):
    """A complete file."""

    signature: Signature
    entry: SweepTable
    problem: str = ""  #: why it cannot be read


class ArrivingFiles:
    """The files of a project, checked repeatedly."""

    def __init__(self) -> None:
        self.files: dict[
            Path, Arrived
        ] = {}  #: the complete ones, those of ``tyre.toml`` first, the others by their time
        self._seen: dict[Path, tuple[Signature, int]] = {}  #: and at how many looks before it was the same

    @property
    def waiting(self) -> list[Path]:
        """Files that are being written."""
        return [path for path in self._seen if path not in self.files]

    def forget(self) -> None:
        """Read every file again at the next look."""
        self.files = {}

    def look(self, config: Config) -> None:
        """Look at every file, and read those that have become complete."""
        listed = {config.folder / entry.file: entry for entry in config.sweep}
        before, self._seen = self._seen, {}
        for path in (*listed, *unlisted(config)):
            with suppress(OSError):
                stat = file_of(path).stat()
                signature, (old, looks) = (stat.st_size, stat.st_mtime_ns), before.get(path, (None, 0))
                self._seen[path] = signature, looks + 1 if old == signature else 0
        known, self.files = self.files, {}
        for path in sorted(self._seen, key=lambda path: 0 if path in listed else self._seen[path][0][1]):
            file, entry = known.get(path), listed.get(path)
            if file is None or file.signature != self._seen[path][0] or file.entry != (entry or file.entry):
                file = self._read(path, config, entry)
            if file is not None:
                self.files[path] = file

    def _read(self, path: Path, config: Config, entry: SweepTable | None) -> Arrived | None:
        """A file that is complete, or that stays unreadable; None while it is being written."""
        signature, looks = self._seen[path]
        is_final = looks >= LOOKS_OF_PATIENCE  # it has not changed for so long that it is complete
        if not looks or (not is_final and is_cut_off(file_of(path))):
            return None
        try:
            entry = entry or entry_of(path, config)
            read(config.model_copy(update={"sweep": (entry,)}), may_be_empty=True)
        except InputError as error:
            entry = entry or SweepTable(file=relative(path, config.folder))
            return Arrived(signature, entry, str(error)) if looks >= LOOKS_BEFORE_REFUSAL else None
        return Arrived(signature, entry)


def is_cut_off(path: Path) -> bool:
    """Whether a text file lacks the end of its last line, as while it is being written."""
    if path.name.lower().endswith(BINARY):
        return False
    with suppress(OSError), path.open("rb") as file:
        if file.seek(0, 2):
            file.seek(-1, 2)
            return file.read(1) not in b"\r\n"
    return True
