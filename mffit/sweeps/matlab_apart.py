"""MATLAB files of v4 to v7, read in a separate process, because scipy's reader may crash on a damaged file.

``python -P matlab_apart.py FILE OUT MOST`` imports nothing of mffit. It writes numbers and texts of the file to the folder OUT
for :func:`mffit.sweeps.matlab.read_mat`. If the file cannot be read, it writes the reason to OUT/trouble.txt.
"""

from __future__ import annotations

import json
import math
import struct
import sys
import zlib
from pathlib import Path
from typing import Any

import numpy as np

LARGEST_TEXT = 10_000  # letters; not a record of constants.py, which this module must not import
TROUBLE, TEXTS, SIZE = "trouble.txt", "texts.json", "size.txt"
PACKED = 15
"""Data type of a compressed element in MATLAB v5 to v7."""
NESTED = (1, 2, 3)
"""Classes of arrays whose parts scipy's ``whosmat`` does not count: cells, structures, objects."""
CHUNK = 1 << 20
MOST_LEAVES = 10_000  # arrays of one file
Leaf = tuple[tuple[str, ...], Any]
"""The names that lead to it, and a vector (n,), a text, or a mapping: ``name`` and ``units`` of channels, the class of an
``object`` that only MATLAB reads, or the ``shape`` of a matrix."""


def load(path: Path) -> list[Leaf]:
    """What the file holds: see :data:`Leaf`; names and units of the structure ``channel`` are one leaf."""
    import scipy.io

    loaded = scipy.io.loadmat(path, chars_as_strings=True)
    found: list[Leaf] = []
    for name, value in loaded.items():
        if not name.startswith("__") and isinstance(value, np.ndarray):
            _collect((name,), value, found)
    return found


def _collect(path: tuple[str, ...], value: np.ndarray, found: list[Leaf]) -> None:
    """Add the leaves of a variable."""
    if len(found) > MOST_LEAVES:
        raise ValueError(f"it holds more than {MOST_LEAVES} arrays")
    names = value.dtype.names or ()
    if {"s0", "s1", "s2"} <= set(names):  # an object, as scipy shows it: name, system and class
        name, _, kind = (value.reshape(-1)[0][key] for key in ("s0", "s1", "s2"))
        found.append(((_decoded(name),), {"object": _decoded(kind)}))
    elif {"name", "units"} <= set(names) and value.size == 1 and value.reshape(-1)[0]["name"].dtype == object:
        found.append((path, {key: _texts(value.reshape(-1)[0][key]) for key in ("name", "units")}))
    elif names:
        _collect_fields(path, value, found)
    elif value.dtype == object and all(np.asarray(cell).dtype.names for cell in value.reshape(-1)):
        for k, cell in enumerate(value.reshape(-1), 1):  # a cell array of structures, as an array of them
            _collect((*path[:-1], f"{path[-1]}({k})"), np.asarray(cell), found)
    elif value.dtype == object and any(
        np.asarray(cell).dtype.kind == "f" and np.asarray(cell).size > 1 for cell in value.reshape(-1)
    ):
        found.append((path, {"cells": True}))
    elif value.dtype.kind == "U" and value.size == 1:
        found.append((path, str(value.reshape(-1)[0])[:LARGEST_TEXT].strip()))
    elif value.dtype.kind in "fiub" and value.size > 1 and value.size == max(value.shape):
        found.append((path, value.reshape(-1).astype(float, copy=False)))
    elif value.dtype.kind in "fiub" and value.size > 1:
        found.append((path, {"shape": list(value.shape)}))


def _collect_fields(path: tuple[str, ...], value: np.ndarray, found: list[Leaf]) -> None:
    """Add the leaves of a structure, or of an array of them, whose single numbers make a vector."""
    elements = value.reshape(-1)
    for name in value.dtype.names or ():
        parts = [np.asarray(element[name]) for element in elements]
        if len(parts) > 1 and all(part.size == 1 and part.dtype.kind in "fiub" for part in parts):
            found.append(((*path, name), np.array([float(part.reshape(-1)[0]) for part in parts])))
            continue
        for k, part in enumerate(parts, 1):
            _collect((*path[:-1], f"{path[-1]}({k})" if len(parts) > 1 else path[-1], name), part, found)


def _decoded(value: Any) -> str:
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


def _texts(cells: Any) -> list[str]:
    """The texts of a cell array, one level deep."""
    found = []
    for cell in np.asarray(cells, dtype=object).reshape(-1):
        flat = np.asarray(cell).reshape(-1)
        found.append(str(flat[0]).strip() if flat.size else "")
    return found


def unpacked(path: Path, most: int) -> int:
    """Number of bytes that scipy would load; counting stops once it exceeds ``most``."""
    import scipy.io

    size, nested = 0, set(NESTED)
    try:
        for _, shape, _ in scipy.io.whosmat(path):
            size += 8 * int(math.prod(shape))  # the file may store numbers shorter
    except TypeError:  # an object, such as a table, has no shape
        nested = set(range(32))
    with path.open("rb") as file:
        head = file.read(128)
        if 0 in head[:4]:  # v4, which is neither packed nor nested
            return size
        order, held = ("<" if head[126:128] == b"IM" else ">"), 0
        while max(size, held) <= most and len(tag := file.read(8)) == 8:
            kind, length = struct.unpack(f"{order}II", tag)
            packed, inflate = file.read(length), zlib.decompressobj()
            each = 8 if kind == PACKED and _first(packed, order) in nested else 1
            while kind == PACKED and packed and held <= most:
                held += each * len(inflate.decompress(packed, CHUNK))
                packed = inflate.unconsumed_tail
    return max(size, held)


def _first(packed: bytes, order: str) -> int:
    """The class of a packed array."""
    flags: bytes = zlib.decompressobj().decompress(packed, 20)[16:20]
    return int.from_bytes(flags, "little" if order == "<" else "big") & 0xFF


def main(source: str, out: str, most: str) -> None:
    """Load the file and write its vectors as ``k.npy``, where k is the index of the leaf in ``texts.json``.

    If the file holds more than ``most`` bytes, only the number of bytes counted so far is written, to ``size.txt``.
    """
    folder = Path(out)
    try:
        size = unpacked(Path(source), int(most))
        if size > int(most):
            (folder / SIZE).write_text(str(size), encoding="utf-8")
            return
        content = load(Path(source))
        for k, (_, value) in enumerate(content):
            if isinstance(value, np.ndarray):
                np.save(folder / f"{k}.npy", value, allow_pickle=False)
        texts = [[path, None if isinstance(value, np.ndarray) else value] for path, value in content]
        (folder / TEXTS).write_text(json.dumps(texts), encoding="utf-8")
    except Exception as error:  # scipy fails on a damaged file in countless ways
        reason = str(error) or type(error).__name__
        (folder / TROUBLE).write_text(reason, encoding="utf-8", errors="replace")


if __name__ == "__main__":
    main(*sys.argv[1:4])
