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


def load(path: Path) -> dict[str, Any]:
    """Vectors (n,) and texts by name, including those in structures, and names and units of the structure ``channel``."""
    import scipy.io

    loaded = scipy.io.loadmat(path, chars_as_strings=True)
    content: dict[str, Any] = {}
    for name, value in loaded.items():
        if name.startswith("__") or not isinstance(value, np.ndarray):
            continue
        if value.dtype.names and value.size == 1:
            entry = value.reshape(-1)[0]
            if {"name", "units"} <= set(value.dtype.names):
                content[name] = {key: _texts(entry[key]) for key in ("name", "units")}
            else:
                content |= _known({key: entry[key] for key in value.dtype.names})
        else:
            content |= _known({name: value})
    return content


def _known(variables: dict[str, Any]) -> dict[str, Any]:
    """The variables that are vectors or texts."""
    content: dict[str, Any] = {}
    for name, value in variables.items():
        if value.dtype.kind == "U" and value.size == 1:
            content[name] = str(value.reshape(-1)[0])[:LARGEST_TEXT].strip()
        elif value.dtype.kind in "fiub" and value.size > 1 and value.size == max(value.shape):
            content[name] = value.reshape(-1).astype(float, copy=False)
    return content


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

    size = 0
    for _, shape, _ in scipy.io.whosmat(path):
        size += 8 * int(math.prod(shape))  # the file may store numbers shorter
    with path.open("rb") as file:
        head = file.read(128)
        if 0 in head[:4]:  # v4, which is neither packed nor nested
            return size
        order, held = ("<" if head[126:128] == b"IM" else ">"), 0
        while max(size, held) <= most and len(tag := file.read(8)) == 8:
            kind, length = struct.unpack(f"{order}II", tag)
            packed, inflate = file.read(length), zlib.decompressobj()
            each = 8 if kind == PACKED and _first(packed, order) in NESTED else 1
            while kind == PACKED and packed and held <= most:
                held += each * len(inflate.decompress(packed, CHUNK))
                packed = inflate.unconsumed_tail
    return max(size, held)


def _first(packed: bytes, order: str) -> int:
    """The class of a packed array."""
    flags: bytes = zlib.decompressobj().decompress(packed, 20)[16:20]
    return int.from_bytes(flags, "little" if order == "<" else "big") & 0xFF


def main(source: str, out: str, most: str) -> None:
    """Load the file and write its vectors as ``k.npy``, where k is the index of the name in ``texts.json``.

    If the file holds more than ``most`` bytes, only the number of bytes counted so far is written, to ``size.txt``.
    """
    folder = Path(out)
    try:
        size = unpacked(Path(source), int(most))
        if size > int(most):
            (folder / SIZE).write_text(str(size), encoding="utf-8")
            return
        content = load(Path(source))
        for k, value in enumerate(content.values()):
            if isinstance(value, np.ndarray):
                np.save(folder / f"{k}.npy", value, allow_pickle=False)
        texts = {n: None if isinstance(v, np.ndarray) else v for n, v in content.items()}
        (folder / TEXTS).write_text(json.dumps(texts), encoding="utf-8")
    except Exception as error:  # scipy fails on a damaged file in countless ways
        reason = str(error) or type(error).__name__
        (folder / TROUBLE).write_text(reason, encoding="utf-8", errors="replace")


if __name__ == "__main__":
    main(*sys.argv[1:4])
