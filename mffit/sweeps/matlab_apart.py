"""MATLAB files of v4 to v7, read in a separate process, because scipy's reader may crash on a damaged file.

``python -P matlab_apart.py FILE OUT MOST`` imports nothing of mffit. It writes numbers and texts of the file to the folder OUT
for :func:`mffit.sweeps.matlab.read_mat`. If the file cannot be read, it writes the reason to OUT/trouble.txt.
"""

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
``object`` that only MATLAB reads, the ``shape`` of a matrix, or ``cells`` with vectors that have no names."""


def collect(path: tuple[str, ...], value: Any, found: list[Leaf]) -> None:
    """Add the leaves of a variable to ``found``.

    The variable is a text, an array of numbers, a tuple of cells, a list of structures of the same fields (a list of one for a
    single structure), a mapping as in :data:`Leaf`, or None for anything else.
    """
    if len(found) > MOST_LEAVES:
        raise ValueError(f"it holds more than {MOST_LEAVES} arrays")
    if isinstance(value, list):
        _collect_fields(path, value, found)
    elif isinstance(value, tuple) and all(isinstance(cell, list) for cell in value):
        for k, cell in enumerate(value, 1):  # structures in cells, as an array of them
            collect((*path[:-1], f"{path[-1]}({k})"), cell, found)
    elif isinstance(value, tuple):
        if any(isinstance(cell, np.ndarray) and cell.dtype.kind == "f" and cell.size > 1 for cell in value):
            found.append((path, {"cells": True}))
    elif not isinstance(value, np.ndarray):
        found += [(path, value)] if value is not None else []
    elif value.size > 1:
        is_vector = value.size == max(value.shape)
        vector = value.reshape(-1).astype(float, copy=False) if is_vector else None
        found.append((path, {"shape": [*value.shape]} if vector is None else vector))


def _collect_fields(path: tuple[str, ...], elements: list[dict[str, Any]], found: list[Leaf]) -> None:
    """Add the leaves of structures; single numbers of several of them make a vector."""
    fields = {name: [one[name] for one in elements] for name in (elements[0] if elements else ())}
    if {"name", "units"} <= fields.keys() and not any(
        isinstance(part, np.ndarray) for parts in fields.values() for part in parts
    ):
        found.append(
            (
                path,
                {key: [text for part in fields[key] for text in _texts(part)] for key in ("name", "units")},
            )
        )
        return
    for name, parts in fields.items():
        if len(parts) > 1 and all(isinstance(part, np.ndarray) and part.size == 1 for part in parts):
            found.append(((*path, name), np.array([float(part.reshape(-1)[0]) for part in parts])))
            continue
        for k, part in enumerate(parts, 1):
            collect((*path[:-1], f"{path[-1]}({k})" if len(parts) > 1 else path[-1], name), part, found)


def _texts(value: Any) -> list[str]:
    """A text, or those of a cell array."""
    if isinstance(value, tuple):
        return [next(iter(_texts(cell)), "") for cell in value]
    return [value if isinstance(value, str) else ""]


def plain(value: np.ndarray) -> Any:
    """A variable as scipy reads it, as :func:`collect` takes it."""
    names = value.dtype.names or ()
    if {"s0", "s1", "s2"} <= set(names):  # an object, as scipy shows it: name, system and class
        called, _, kind = (value.reshape(-1)[0][key] for key in ("s0", "s1", "s2"))
        return {"object": _decoded(kind), "called": _decoded(called)}
    if names:
        return [{name: plain(np.asarray(one[name])) for name in names} for one in value.reshape(-1)]
    if value.dtype == object:
        return tuple(plain(np.asarray(cell)) for cell in value.reshape(-1))
    if value.dtype.kind == "U":
        texts = tuple(str(text)[:LARGEST_TEXT].strip() for text in value.reshape(-1))
        return texts if len(texts) > 1 else "".join(texts)
    return value if value.dtype.kind in "fiub" else None


def _decoded(value: Any) -> str:
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


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
    import scipy.io

    folder = Path(out)
    try:
        size = unpacked(Path(source), int(most))
        if size > int(most):
            (folder / SIZE).write_text(str(size), encoding="utf-8")
            return
        content: list[Leaf] = []
        for name, value in scipy.io.loadmat(source, chars_as_strings=True).items():
            if not name.startswith("__") and isinstance(value, np.ndarray):
                collect((name,), plain(value), content)
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
