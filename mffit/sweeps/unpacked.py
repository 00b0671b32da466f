"""How much a file holds once it is unpacked, found without keeping it in memory; the readers' one limit is checked with it.

A size that a file merely states is counted only where its reader stops there. A damaged file counts as far as it can be read:
its reader says what is wrong with it.
"""

from __future__ import annotations

import contextlib
import gzip
import importlib
import zipfile
import zlib
from pathlib import Path
from typing import IO

from mffit.sweeps import constants
from mffit.sweeps.extras import is_packed

CHUNK = 1 << 20
HDF5_MARK = b"\x89HDF"
HDF5_AT = (0, 512)
"""Bytes at which HDF5 may begin: MATLAB puts a text of 512 bytes before it."""
MAT_HEADER, MAT_COMPRESSED = 128, 15
BYTES_OF_A_NUMBER = 8


def too_large(size: int) -> bool:
    """Whether a table of this size in bytes is not read."""
    return size > constants.LARGEST_UNPACKED


def of_text(path: Path) -> int:
    """Bytes of a text, also of a packed one; counted up to the limit."""
    if not is_packed(path):
        return path.stat().st_size
    found = 0
    with contextlib.suppress(gzip.BadGzipFile, EOFError, zlib.error), gzip.open(path, "rb") as file:
        while not too_large(found) and (chunk := file.read(CHUNK)):
            found += len(chunk)
    return found


def of_zip(path: Path) -> int:
    """Bytes of all members of a zip file, such as a workbook; reading a member stops at the size that it states."""
    with contextlib.suppress(zipfile.BadZipFile), zipfile.ZipFile(path) as file:
        return sum(member.file_size for member in file.infolist())
    return 0


def of_mat(path: Path) -> int:
    """Bytes of the variables of a MATLAB file of any version."""
    if is_hdf5(path):
        return _of_hdf5(path)
    with path.open("rb") as file:
        order = "big" if file.read(MAT_HEADER)[-2:] == b"MI" else "little"
        return max(_of_elements(file, order == "big"), path.stat().st_size)


def of_parquet(path: Path) -> int:
    """Bytes of a Parquet file's columns; values that repeat are stored once, so their number counts."""
    with contextlib.suppress(Exception):  # not installed or damaged, as its reader says
        about = importlib.import_module("pyarrow.parquet").read_metadata(path)
        stated = sum(about.row_group(k).total_byte_size for k in range(about.num_row_groups))
        return int(max(stated, BYTES_OF_A_NUMBER * about.num_rows * about.num_columns))
    return 0


def is_hdf5(path: Path) -> bool:
    """Whether a MATLAB file is of version 7.3."""
    with path.open("rb") as file:
        head = file.read(HDF5_AT[-1] + len(HDF5_MARK))
    return any(head[at : at + len(HDF5_MARK)] == HDF5_MARK for at in HDF5_AT)


def _of_elements(file: IO[bytes], big: bool) -> int:
    """Bytes of the compressed elements behind the header, each unpacked; counted up to the limit."""
    found = 0
    while not too_large(found) and len(tag := file.read(8)) == 8:
        kind, size = (int.from_bytes(tag[k : k + 4], "big" if big else "little") for k in (0, 4))
        if kind != MAT_COMPRESSED:
            file.seek(size, 1)
            continue
        end, packed = file.tell() + size, zlib.decompressobj()
        with contextlib.suppress(zlib.error):
            while not too_large(found) and (chunk := file.read(min(CHUNK, end - file.tell()))):
                while chunk and not too_large(found):
                    found += len(packed.decompress(chunk, CHUNK))
                    chunk = packed.unconsumed_tail
        file.seek(end)
    return found


def _of_hdf5(path: Path) -> int:
    with contextlib.suppress(Exception):  # not installed or damaged, as its reader says
        h5py = importlib.import_module("h5py")
        with h5py.File(path, "r") as file:
            return sum(int(item.nbytes) for item in file.values() if isinstance(item, h5py.Dataset))
    return 0
