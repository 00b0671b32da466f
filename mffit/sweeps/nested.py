"""Names of the vectors in MATLAB's structures, one within another."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from mffit.errors import InputError
from mffit.sweeps.about import simplified
from mffit.sweeps.channels import NAMED
from mffit.sweeps.matlab_apart import Leaf
from mffit.sweeps.raw_table import Cells
from mffit.sweeps.wide import RUN

NAMES, UNITS = ("name", "label"), ("unit", "units")
"""Keys, in lower case, of the texts next to a vector that state its name and its unit."""


class Content(NamedTuple):
    """The content of a MATLAB file."""

    vectors: Mapping[str, np.ndarray]  #: by name, each (n,)
    runs: Mapping[
        str, Cells
    ]  #: channels of several structures, one below the other, with the structure of each row; else empty
    units: Mapping[str, str]  #: as the file states them
    order: Sequence[str]  #: names of channels, in the order that the file states
    about: Mapping[str, str]  #: texts
    others: Mapping[str, Mapping[str, Any]]  #: objects and matrices


def content_of(leaves: Iterable[Leaf]) -> Content:
    """The content, by the last name of each leaf.

    Where vectors share it, they are called by the structure that each is alone in, as in ``SA.values``, unless only a text next
    to them names a channel; channels that several structures have in common are runs; else a vector is called by all its names.
    """
    found = list(leaves)
    vectors = {path: value for path, value in found if isinstance(value, np.ndarray)}
    texts = {path: value for path, value in found if isinstance(value, str)}
    others: dict[str, Mapping[str, Any]] = {
        value.get("called", path[-1]): value for path, value in found if isinstance(value, dict)
    }
    channels = next((value for value in others.values() if "name" in value), {})
    order = channels.get("name", [])
    repeated = Counter(path[-1] for path in vectors)
    inside = Counter(path[:-1] for path in vectors)
    names: dict[tuple[str, ...], str] = {}
    units = dict(zip(order, channels.get("units", []), strict=False))
    stated = {(*path[:-1], path[-1].lower()): text for path, text in texts.items()}
    for path in vectors:
        alone = len(path) > 1 and inside[path[:-1]] == 1
        called, unit = (
            next((stated[at] for key in keys if alone and (at := (*path[:-1], key)) in stated), "")
            for keys in (NAMES, UNITS)
        )
        own = path[-2] if alone else ".".join(path)
        if called and called not in names.values() and simplified(own) not in NAMED:
            own = called
        names[path] = path[-1] if repeated[path[-1]] == 1 else own
        if unit:
            units[names[path]] = unit
    return Content(
        vectors={name: vectors[path] for path, name in names.items()},
        runs=_runs(vectors),
        units=units,
        order=order,
        about={path[-1]: text for path, text in texts.items() if path[-1].lower() not in UNITS},
        others={name: value for name, value in others.items() if "name" not in value},
    )


def _runs(vectors: Mapping[tuple[str, ...], np.ndarray]) -> dict[str, Cells]:
    """The channels of structures that have the same ones, of one length each; empty unless all vectors are of such."""
    of_parent: dict[tuple[str, ...], dict[str, np.ndarray]] = {}
    for path, values in vectors.items():
        of_parent.setdefault(path[:-1], {})[path[-1]] = values
    first, *others = of_parent.values() or [{}]
    lengths = [{len(values) for values in run.values()} for run in of_parent.values()]
    alike = all(run.keys() == first.keys() for run in others) and all(len(length) == 1 for length in lengths)
    if not others or len(first) < 2 or not alike:
        return {}
    joined: dict[str, Cells] = {
        name: np.concatenate([run[name] for run in of_parent.values()]) for name in first
    }
    counts = [n.pop() for n in lengths]
    return joined | {
        RUN: [".".join(path) for path, n in zip(of_parent, counts, strict=True) for _ in range(n)]
    }


def without_columns(others: Mapping[str, Mapping[str, Any]], path: Path) -> InputError:
    """The error about a file without vectors, with what it holds instead."""
    objects = {name: one["object"] for name, one in others.items() if "object" in one}
    tables = [name for name, kind in objects.items() if "table" in kind]
    matrices = {name: " x ".join(map(str, one["shape"])) for name, one in others.items() if "shape" in one}
    sentence = "has no column of numbers; save every channel as a vector"
    if tables or objects:
        name = next(iter(tables or objects))
        table = f"timetable2table({name})" if objects[name] == "timetable" else name
        remedy = (
            f'write writetable({table}, "{path.stem}.csv") there'
            if tables
            else "save every channel as a vector there"
        )
        sentence = f"holds {name}, an object of MATLAB ({objects[name]}) that nothing else reads: {remedy}"
    elif cells := [name for name, one in others.items() if "cells" in one]:
        sentence = (
            f"holds {cells[0]}, a cell array of vectors, whose cells have no names: save every channel as a vector, such as "
            f"SA = {cells[0]}{{1}}"
        )
    elif matrices:
        name, size = next(iter(matrices.items()))
        sentence = (
            f"holds {name}, a matrix of {size}, and no names of its columns: save every channel as a vector, such as "
            f"SA = {name}(:, 1)"
        )
    return InputError(sentence, file=path)
