"""The reader of MATLAB files: v4 to v7 through scipy, v7.3 through h5py.

A recording is a set of column vectors of one length, by themselves or in structures (``nested``).
The layout of the tyre test consortium adds
a structure ``channel`` with the order of the vectors (``name``) and their ``units``, and the texts ``tireid``, ``testid`` and
``source``.
Only numbers and texts are read, never objects, functions or anything else that could run as code.
"""

import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from mffit.errors import InputError
from mffit.sweeps import matlab_apart
from mffit.sweeps.extras import TIME_TO_READ, check_size, damaged, largest, needed, undamaged
from mffit.sweeps.matlab_apart import LARGEST_TEXT, SIZE, TEXTS, TROUBLE, Leaf, collect
from mffit.sweeps.nested import Content, content_of, without_columns
from mffit.sweeps.raw_table import RawTable
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
    found = content_of(_hdf5(path) if _is_hdf5(path) else _classic(path))
    vectors, apart = _with_common_conditions(dict(found.vectors))
    if not vectors:
        raise without_columns(found.others, path)
    about = dict(found.about)
    if apart:
        about["left out"] = f"{', '.join(apart)}, at conditions of its own"
    sets = stacked(vectors, found.units)  # with vectors of one length for each load
    columns = found.runs or (sets.columns if sets else _of_one_length(vectors, found, path))
    stated = sets.units if sets else found.units
    return RawTable(
        headings=tuple(columns),
        units=tuple(stated.get(name, "") for name in columns),
        cells=tuple(columns.values()),
        lines=range(1, len(next(iter(columns.values()))) + 1),
        path=path,
        heading_line=None,
        about=about | (sets.about if sets else {}),
    )


def _of_one_length(vectors: Mapping[str, np.ndarray], content: Content, path: Path) -> dict[str, np.ndarray]:
    """The vectors of the most frequent length, in the file's own order of channels, if it has one."""
    lengths = [len(values) for values in vectors.values()]
    n = max(set(lengths), key=lambda length: (lengths.count(length), length))
    names = dict.fromkeys([*content.order, *vectors])
    kept = [name for name in names if name in vectors and len(vectors[name]) == n]
    if len(kept) < 2 and content.others:
        raise without_columns(content.others, path)
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


def _classic(path: Path) -> list[Leaf]:
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
        texts = json.loads((folder / TEXTS).read_text(encoding="utf-8"))
        return [
            (tuple(names), np.load(folder / f"{k}.npy") if value is None else value)
            for k, (names, value) in enumerate(texts)
        ]


def _is_hdf5(path: Path) -> bool:
    """Whether the file is of version 7.3; MATLAB puts a text of 512 bytes before HDF5."""
    with path.open("rb") as file:
        head = file.read(512 + len(HDF5_MARK))
    return head.startswith(HDF5_MARK) or head[512:] == HDF5_MARK


def _hdf5(path: Path) -> list[Leaf]:
    h5py = needed("h5py", "MATLAB files of version 7.3", path)
    found: list[Leaf] = []
    with undamaged(path, KIND), h5py.File(path, "r") as file:
        sizes: list[int] = []
        file.visititems(lambda _, one: sizes.append(int(getattr(one, "nbytes", 0))))
        check_size(sum(sizes), path)
        _refuse_other_files(file, path, h5py)
        for name, item in file.items():
            if not name.startswith("#"):
                collect((name,), _plain(item, file), found)
    return found


def _plain(item: Any, file: Any) -> Any:
    """A variable of v7.3 as :func:`collect` takes it; cells, and the elements of an array of structures, are references."""
    kind = _class_of(item)
    if "MATLAB_object_decode" in item.attrs:
        return None if kind == "FileWrapper__" else {"object": kind}
    if hasattr(item, "items"):
        fields = {name: _plain(one, file) for name, one in item.items()}
        if all(
            isinstance(value, tuple) and _class_of(item[name]) != "cell" for name, value in fields.items()
        ):
            return [dict(zip(fields, parts, strict=True)) for parts in zip(*fields.values(), strict=True)]
        return [fields]
    if kind == "char":
        return _letters(item)
    if item.dtype.kind == "O":
        return tuple(_plain(file[one], file) for one in np.asarray(item).reshape(-1))
    return np.asarray(item).T if item.dtype.kind in "fiu" else None


def _class_of(item: Any) -> str:
    """MATLAB's class of a variable; "" if the file states none."""
    kind = item.attrs.get("MATLAB_class", b"")
    return kind.decode() if isinstance(kind, bytes) else str(kind)


def _refuse_other_files(file: Any, path: Path, h5py: Any) -> None:
    """Refuse links to other files: HDF5 would read any file on this machine that they name."""
    elsewhere: list[bool] = []
    file.visititems_links(lambda _, link: elsewhere.append(isinstance(link, h5py.ExternalLink)))
    file.visititems(
        lambda _, one: elsewhere.append(
            isinstance(one, h5py.Dataset) and bool(one.external or one.is_virtual)
        )
    )
    if any(elsewhere):
        raise InputError("takes numbers out of other files; save it as one file", file=path)


def _letters(item: Any) -> str:
    """A text, which v7.3 stores as the codes of its characters."""
    if item.size > LARGEST_TEXT or item.dtype.kind not in "ui":
        return ""
    return "".join(chr(int(code)) for code in np.asarray(item).reshape(-1, order="F") if code).strip()
