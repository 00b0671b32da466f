"""The reader of MATLAB files: v4 to v7 through scipy, v7.3 through h5py.

A recording is a set of column vectors of one length, by themselves or in a structure. The layout of the tyre test consortium adds
a structure ``channel`` with the order of the vectors (``name``) and their ``units``, and the texts ``tireid``, ``testid`` and
``source``.
Only numbers and texts are read, never objects, functions or anything else that could run as code.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mffit.errors import InputError
from mffit.sweeps import matlab_apart
from mffit.sweeps.extras import TIME_TO_READ, check_size, damaged, largest, needed, undamaged
from mffit.sweeps.matlab_apart import LARGEST_TEXT, SIZE, TEXTS, TROUBLE
from mffit.sweeps.raw_table import Cells, RawTable
from mffit.sweeps.wide import stacked

KIND = "MATLAB file"
HDF5_MARK = b"\x89HDF"
CONDITION_OF = re.compile("(alpha|gamma|camber|fz|pressure|speed)_?(fx|fy|mx|my|mz)", re.IGNORECASE)
"""Name of a vector that holds a condition of one channel only."""


def read_mat(path: Path) -> RawTable:
    """Read a ``.mat`` file whose variables are column vectors of one length.

    Raises InputError if the file is not a MAT file, is damaged, or has no vectors of a common length, or if it is of v7.3 and
    h5py is not installed.
    """
    content = _hdf5(path) if _is_hdf5(path) else _classic(path)
    vectors = {name: values for name, values in content.items() if isinstance(values, np.ndarray)}
    vectors, apart = _with_common_conditions(vectors)
    if not vectors:
        raise InputError("has no column of numbers; save every channel as a vector", file=path)
    names, units = _channels(content)
    about = {name: text for name, text in content.items() if isinstance(text, str)}
    if apart:
        about["left out"] = f"{', '.join(apart)}, at conditions of its own"
    sets = stacked(vectors)  # with vectors of one length for each load
    columns: Mapping[str, Cells] = sets.columns if sets else _of_one_length(vectors, names, path)
    stated = sets.units(units) if sets else units
    return RawTable(
        headings=tuple(columns),
        units=tuple(stated.get(name, "") for name in columns),
        cells=tuple(columns.values()),
        lines=range(1, len(next(iter(columns.values()))) + 1),
        path=path,
        heading_line=None,
        about=about | (sets.about if sets else {}),
    )


def _of_one_length(
    vectors: Mapping[str, np.ndarray], names: Sequence[str], path: Path
) -> dict[str, np.ndarray]:
    """The vectors of the most frequent length, those with ``names`` first, in this order."""
    lengths = [len(values) for values in vectors.values()]
    n = max(set(lengths), key=lambda length: (lengths.count(length), length))
    kept = [name for name in dict.fromkeys([*names, *vectors]) if name in vectors and len(vectors[name]) == n]
    if len(kept) < 2:
        raise InputError(
            "has no two channels of the same length; save all channels as vectors of one length", file=path
        )
    return {name: vectors[name] for name in kept}


def _with_common_conditions(vectors: dict[str, np.ndarray]) -> tuple[dict[str, np.ndarray], list[str]]:
    """The vectors with common conditions under plain names, and the names of channels left out.

    Some files have separate conditions for each channel (``alphaFy``, ``Fz_Fy``, ``alphaMz``). A channel is left out if its
    conditions differ from those of the first channel.
    """
    own: dict[str, dict[str, str]] = {}
    for name in vectors:
        found = CONDITION_OF.fullmatch(name)
        if found and found[2] in vectors:
            own.setdefault(found[2], {})[found[1]] = name
    if not own:
        return vectors, []
    first = next(channel for channel in vectors if channel in own)
    apart = [
        channel
        for channel, names in own.items()
        if any(
            not np.array_equal(vectors[names[key]], vectors[own[first].get(key, channel)]) for key in names
        )
    ]
    dropped = {*apart, *(name for names in own.values() for name in names.values())}
    kept = {name: values for name, values in vectors.items() if name not in dropped}
    return {key: vectors[name] for key, name in own[first].items()} | kept, apart


def _channels(content: Mapping[str, Any]) -> tuple[list[str], dict[str, str]]:
    """Names and units from the structure ``channel``, in its order; both empty without it."""
    channel = content.get("channel")
    if not isinstance(channel, dict):
        return [], {}
    names, units = channel["name"], channel["units"]
    return names, dict(zip(names, units, strict=False))


def _classic(path: Path) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        most = str(largest(path))
        command = [sys.executable, "-P", matlab_apart.__file__, str(path.absolute()), name, most]
        try:
            subprocess.run(command, check=True, timeout=TIME_TO_READ, capture_output=True)
        except (subprocess.CalledProcessError, subprocess.TimeoutExpired):
            raise damaged(path, KIND, "reading it failed without a reason") from None
        if (folder / SIZE).exists():
            check_size(int((folder / SIZE).read_text(encoding="utf-8")), path)
        trouble = folder / TROUBLE
        if trouble.exists():
            raise damaged(path, KIND, trouble.read_text(encoding="utf-8", errors="replace"))
        content = json.loads((folder / TEXTS).read_text(encoding="utf-8"))
        vectors = {n: np.load(folder / f"{k}.npy") for k, (n, v) in enumerate(content.items()) if v is None}
    return {**content, **vectors}


def _is_hdf5(path: Path) -> bool:
    """Whether the file is of version 7.3; MATLAB puts a text of 512 bytes before HDF5."""
    with path.open("rb") as file:
        head = file.read(512 + len(HDF5_MARK))
    return head.startswith(HDF5_MARK) or head[512:] == HDF5_MARK


def _hdf5(path: Path) -> dict[str, Any]:
    h5py = needed("h5py", "MATLAB files of version 7.3", path)
    content: dict[str, Any] = {}
    with undamaged(path, KIND), h5py.File(path, "r") as file:
        sizes: list[int] = []
        file.visititems(lambda _, one: sizes.append(int(getattr(one, "nbytes", 0))))
        check_size(sum(sizes), path)
        _refuse_other_files(file, path, h5py)
        variables = {name: item for name, item in file.items() if not name.startswith("#")}
        for name, item in list(variables.items()):
            if isinstance(item, h5py.Group):
                if {"name", "units"} <= set(item):
                    content[name] = {key: _referred(file, item[key]) for key in ("name", "units")}
                else:
                    variables |= {key: one for key, one in item.items() if isinstance(one, h5py.Dataset)}
        for name, item in variables.items():
            if isinstance(item, h5py.Group):
                continue
            if item.attrs.get("MATLAB_class", b"double") == b"char":
                content[name] = _letters(item)
            elif item.dtype.kind in "fiu" and item.size > 1 and item.size == max(item.shape):
                content[name] = np.asarray(item, dtype=float).reshape(-1)
    return content


def _refuse_other_files(file: Any, path: Path, h5py: Any) -> None:
    """HDF5 takes numbers out of any file that it names, which may be none of the sender's."""
    elsewhere: list[bool] = []
    file.visititems_links(lambda _, link: elsewhere.append(isinstance(link, h5py.ExternalLink)))
    file.visititems(
        lambda _, one: elsewhere.append(
            isinstance(one, h5py.Dataset) and bool(one.external or one.is_virtual)
        )
    )
    if any(elsewhere):
        raise InputError("takes numbers out of other files; save it as one file", file=path)


def _referred(file: Any, cells: Any) -> list[str]:
    """The texts of a cell array, which v7.3 stores as references."""
    return [_letters(file[reference]) for reference in np.asarray(cells).reshape(-1)]


def _letters(item: Any) -> str:
    """A text, which v7.3 stores as the codes of its characters."""
    if item.size > LARGEST_TEXT or item.dtype.kind not in "ui":
        return ""
    return "".join(chr(int(code)) for code in np.asarray(item).reshape(-1, order="F") if code).strip()
