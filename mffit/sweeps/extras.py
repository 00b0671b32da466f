"""What several readers share: the bytes of a file, libraries imported when needed, and errors about damaged files."""

from __future__ import annotations

import gzip
import importlib
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from mffit.errors import InputError, readable, shortened


def needed(module: str, what: str, path: Path) -> Any:
    """The module.

    Raises
    ------
    InputError
        It is not installed; says how to install it.
    """
    try:
        return importlib.import_module(module)
    except ImportError:
        raise InputError(
            f'{what} are read with {module}, which is not installed; run pip install "mffit[formats]"',
            file=path,
        ) from None


def damaged(path: Path, kind: str, reason: object) -> InputError:
    """The error about a file that its library cannot read."""
    return InputError(f"is not a readable {kind} ({shortened(reason)}); save it again", file=path)


@contextmanager
def undamaged(path: Path, kind: str) -> Iterator[None]:
    """Within this block, any error becomes an :class:`InputError`: libraries fail on a damaged file in countless ways."""
    with readable(path):
        path.open("rb").close()
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        raise damaged(path, kind, str(error) or type(error).__name__) from None


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
