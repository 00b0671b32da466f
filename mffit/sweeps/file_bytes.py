"""The bytes of a file, unpacked if its name ends in ``.gz``."""

from __future__ import annotations

import gzip
import zlib
from pathlib import Path
from typing import IO

from mffit.errors import InputError, readable


def is_packed(path: Path) -> bool:
    """Whether the file is compressed, by the ending of its name."""
    return path.name.lower().endswith(".gz")


def opened(path: Path) -> IO[bytes]:
    """The file, open for reading its unpacked bytes."""
    return gzip.open(path, "rb") if is_packed(path) else path.open("rb")  # type: ignore[return-value]


def first_bytes(path: Path, most: int = -1) -> bytes:
    """The file's first unpacked bytes; all by default.

    Raises
    ------
    InputError
        The file cannot be read, or is not a complete gzip file.
    """
    with readable(path):
        try:
            with opened(path) as file:
                return file.read(most)
        except (gzip.BadGzipFile, EOFError, zlib.error):
            raise InputError("is not a complete gzip file; compress it again", file=path) from None
