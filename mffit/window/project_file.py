"""``tyre.toml`` of an open window: read again after every change, written as a whole, with undo."""

from __future__ import annotations

import hashlib
import stat
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from mffit.config import Config
from mffit.config.loading import checked
from mffit.config.toml_file import lines_of_keys
from mffit.errors import InputError
from mffit.window import constants
from tir.writing import replace_file

BOM = b"\xef\xbb\xbf"


class Step(NamedTuple):
    """A saved change: the bytes before it, and the digest after it."""

    before: bytes
    after: str


class ProjectFile:
    """A ``tyre.toml`` and the changes that the window made to it."""

    def __init__(self, path: Path) -> None:
        self.path = path.resolve()
        self.steps: list[Step] = []

    @property
    def digest(self) -> str:
        """Digest of the content as it is on the disk; empty if the file is gone."""
        try:
            return digest_of(self.path.read_bytes())
        except OSError:
            return ""

    def config(self) -> Config:
        """The configuration as it is on the disk.

        Raises
        ------
        InputError
            The file cannot be read or is wrong.
        """
        return self._checked(self._bytes())

    def edit(self, change: Callable[[str], str], seen: str) -> None:
        """Write the changed text, if the file is still the one that was seen and the new one is a right ``tyre.toml``.

        Parameters
        ----------
        change : old text -> new text
        seen : digest of the content that the change is meant for

        Raises
        ------
        InputError
            The file was changed by another program or another window, or the new content would be refused; nothing is written.
        """
        before = self._bytes()
        if digest_of(before) != seen:
            raise InputError(
                "was changed elsewhere in the meantime; look at it as it is shown now, and repeat",
                file=self.path,
            )
        text, _ = self._parsed(before)
        try:
            after = (BOM if before.startswith(BOM) else b"") + change(text).encode()
        except UnicodeEncodeError:
            raise InputError(
                "cannot hold a character of the new text; leave it away", file=self.path
            ) from None
        if after == before:
            return
        self._checked(after)
        self._write(after)
        self.steps = [*self.steps[1 - constants.MOST_UNDONE :], Step(before, digest_of(after))]

    def undo(self) -> None:
        """Take back the last change that the window saved.

        Raises
        ------
        InputError
            There is none, or the file was changed elsewhere since.
        """
        if not self.can_undo:
            self.steps = []
            raise InputError("has no change of this window to undo", file=self.path)
        self._write(self.steps.pop().before)

    @property
    def can_undo(self) -> bool:
        """Whether the last change of the window can be taken back."""
        return bool(self.steps) and self.steps[-1].after == self.digest

    def _bytes(self) -> bytes:
        try:
            return self.path.read_bytes()
        except OSError as error:
            raise InputError(f"cannot be read ({error.strerror}); put it back", file=self.path) from None

    def _parsed(self, content: bytes) -> tuple[str, dict[str, object]]:
        """Text and tables."""
        try:
            text = content.decode("utf-8-sig")
            return text, tomllib.loads(text)
        except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            raise InputError(f"is not valid TOML ({error}); correct it", file=self.path) from None

    def _checked(self, content: bytes) -> Config:
        text, tables = self._parsed(content)
        return checked(tables, path=self.path, folder=self.path.parent, lines=lines_of_keys(text))

    def _write(self, content: bytes) -> None:
        """Replace the file only when the new one is complete."""
        try:
            replace_file(self.path, content, stat.S_IMODE(self.path.stat().st_mode))
        except OSError as error:
            raise InputError(
                f"cannot be written ({error.strerror}); check the folder's permissions", file=self.path
            ) from None


def digest_of(content: bytes) -> str:
    """SHA-256 in hex."""
    return hashlib.sha256(content).hexdigest()
