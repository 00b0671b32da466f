"""The reader of MATLAB files: v4 to v7 through scipy, v7.3 through h5py.

A recording is a set of column vectors of one length. The layout of the tyre test consortium adds a structure
``channel`` with ``name`` and ``units``, which orders and units them, and the texts ``tireid``, ``testid`` and ``source``.
Only numbers and texts are taken: objects, functions and everything else that could be code stay unread.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from mffit.errors import InputError
from mffit.sweeps import matlab_apart
from mffit.sweeps.extras import needed
from mffit.sweeps.matlab_apart import LARGEST_TEXT, TEXTS, TROUBLE, short
from mffit.sweeps.raw_table import RawTable

HDF5_MARK = b"\x89HDF"
HDF5_AT = (0, 512)
"""Where an HDF5 file begins: MATLAB puts a text of 512 bytes in front."""
LONGEST = 600.0
"""Time for the reader [s], many times what the largest recording takes."""


def read_mat(path: Path) -> RawTable:
    """Read a ``.mat`` file whose variables are column vectors of one length.

    Raises
    ------
    InputError
        The file is no MAT file, is damaged, or holds no vectors of a common length; v7.3 without h5py.
    """
    content = _hdf5(path) if _is_hdf5(path) else _classic(path)
    vectors = {name: values for name, values in content.items() if isinstance(values, np.ndarray)}
    if not vectors:
        raise InputError("holds no column of numbers; save every channel as a vector", file=path)
    lengths = [len(values) for values in vectors.values()]
    n = max(set(lengths), key=lambda length: (lengths.count(length), length))
    names, units = _channels(content)
    kept = [name for name in [*names, *vectors] if name in vectors and len(vectors[name]) == n]
    kept = list(dict.fromkeys(kept))
    if len(kept) < 2:
        raise InputError("holds no two channels of one length; save every channel as a vector", file=path)
    return RawTable(
        headings=tuple(kept),
        units=tuple(units.get(name, "") for name in kept),
        cells=tuple(vectors[name] for name in kept),
        lines=range(1, n + 1),
        path=path,
        heading_line=None,
        about={name: text for name, text in content.items() if isinstance(text, str)},
    )


def _channels(content: Mapping[str, Any]) -> tuple[list[str], dict[str, str]]:
    """Names in the order of the structure ``channel``, and their units; both empty without it."""
    channel = content.get("channel")
    if not isinstance(channel, dict):
        return [], {}
    names, units = channel["name"], channel["units"]
    return names, dict(zip(names, units, strict=False))


def _is_hdf5(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            head = file.read(HDF5_AT[-1] + len(HDF5_MARK))
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror}); check its permissions", file=path) from None
    return any(head[at : at + len(HDF5_MARK)] == HDF5_MARK for at in HDF5_AT)


def _classic(path: Path) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        command = [sys.executable, "-P", matlab_apart.__file__, str(path.absolute()), name]
        try:
            subprocess.run(command, check=True, timeout=LONGEST, capture_output=True)
        except (subprocess.CalledProcessError, subprocess.TimeoutExpired):
            raise InputError("is damaged: its sizes cannot be right; save it again", file=path) from None
        trouble = folder / TROUBLE
        if trouble.exists():
            said = trouble.read_text(encoding="utf-8", errors="replace")
            raise InputError(f"is no MATLAB file that can be read ({said}); save it again", file=path)
        content = json.loads((folder / TEXTS).read_text(encoding="utf-8"))
        vectors = {n: np.load(folder / f"{k}.npy") for k, (n, v) in enumerate(content.items()) if v is None}
    return {**content, **vectors}


def _hdf5(path: Path) -> dict[str, Any]:
    h5py = needed("h5py", "MATLAB files of version 7.3", path)
    content: dict[str, Any] = {}
    try:
        with h5py.File(path, "r") as file:
            for name, item in file.items():
                if name.startswith("#"):
                    continue
                if isinstance(item, h5py.Group):
                    if {"name", "units"} <= set(item):
                        content[name] = {key: _referred(file, item[key]) for key in ("name", "units")}
                elif item.attrs.get("MATLAB_class", b"double") == b"char":
                    content[name] = _letters(item)
                elif item.dtype.kind in "fiu" and item.size > 1 and item.size == max(item.shape):
                    content[name] = np.asarray(item, dtype=float).reshape(-1)
    except Exception as error:
        raise InputError(
            f"is no MATLAB file that can be read ({short(error)}); save it again", file=path
        ) from None
    return content


def _referred(file: Any, cells: Any) -> list[str]:
    """The texts of a cell array, which v7.3 keeps as references."""
    return [_letters(file[reference]) for reference in np.asarray(cells).reshape(-1)]


def _letters(item: Any) -> str:
    """A text, which v7.3 keeps as the numbers of its letters."""
    if item.size > LARGEST_TEXT or item.dtype.kind not in "ui":
        return ""
    return "".join(chr(int(code)) for code in np.asarray(item).reshape(-1, order="F") if code).strip()
