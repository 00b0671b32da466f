"""Functions that several readers share: bytes of a file, libraries imported when needed, errors about damaged files."""

import gzip
import importlib
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from mffit.errors import InputError, check_readable, readable, shortened
from mffit.sweeps import constants


def needed(module: str, what: str, path: Path) -> Any:
    """The imported module. Raises InputError if the module is not installed."""
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
    """Turn any error within this block into an :class:`InputError`; a damaged file may raise any error in a library."""
    check_readable(path)
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        raise damaged(path, kind, str(error) or type(error).__name__) from None


def opened(path: Path) -> IO[bytes]:
    """The file, open for reading its unpacked bytes."""
    is_packed = path.name.lower().endswith(".gz")
    return gzip.open(path, "rb") if is_packed else path.open("rb")  # type: ignore[return-value]


BYTES_OF_A_NUMBER = 8
FLOOR = 65_536
"""Bytes added to a packed size before the limit is computed, because a small file of equal rows packs very well."""
TIME_TO_READ = 600.0
"""Longest time [s] for a reader in a separate process."""


def content_of(path: Path) -> bytes:
    """The file's unpacked bytes.

    Raises InputError if the file cannot be read, is not a complete gzip file, or holds more than :func:`largest` bytes.
    """
    with readable(path):
        try:
            with opened(path) as file:
                content = file.read(largest(path) + 1)
        except (gzip.BadGzipFile, EOFError, zlib.error):
            raise InputError("is not a complete gzip file; compress it again", file=path) from None
    check_size(len(content), path)
    return content


def largest(path: Path) -> int:
    """Maximum number of unpacked bytes accepted for a file of this size."""
    ratio = int(constants.LARGEST_RATIO)
    return min(int(constants.LARGEST_UNPACKED), ratio * (path.stat().st_size + FLOOR))


def check_size(size: int, path: Path) -> None:
    """Refuse a file with more unpacked bytes than :func:`largest`; a small packed file may unpack to a huge one."""
    if size > (most := largest(path)):
        raise InputError(
            f"holds more than {most / 1e6:.0f} MB when unpacked; split it, or export fewer channels",
            file=path,
        )
