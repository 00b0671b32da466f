"""Tables with the load in the names of their columns (``Sa400``, ``Fy400``, ``Sa800``, ...), one set of columns for each load."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mffit.sweeps import constants
from mffit.sweeps.about import simplified
from mffit.sweeps.channels import NAMED
from mffit.sweeps.raw_table import Cells, RawTable

WITH_LOAD = re.compile(
    r"([^\W\d][\w ]*?)[ _@=-]*(\d+(?:[.,]\d+)?)[ _]*(N|kN|daN|lbf?|lbs|kp|kgf?)?", re.IGNORECASE
)
"""The name of a channel, a number, and the unit of a load."""
SIDE, LOAD = "Fy_N", "Fz_N"
RUN, LOAD_HEADING = "run", "FZ"
"""Headings of the columns that are added: the number in the name of each set as the name of a sweep, and as the load."""
FROM_NAMES = "load"
"""Key of ``RawTable.about``: whose names have the load."""


class _Set(NamedTuple):
    """The columns with one number in their names."""

    load: float
    unit: str  #: of the load, "" if the names do not state it
    names: Mapping[str, str]  #: of the columns, by the part of the name that is the channel's


class Stacked(NamedTuple):
    """Columns of equal length, with one set of columns below the other."""

    columns: dict[str, Cells]
    units: dict[str, str]
    rows: np.ndarray  #: row of each reading within its set
    about: dict[
        str, str
    ]  #: where the load comes from, for ``RawTable.about``; empty if it is a column of the sets


def with_load_of_names(raw: RawTable) -> RawTable:
    """The table with the sets of columns stacked if their names state the load, else unchanged."""
    found = stacked(
        dict(zip(raw.headings, raw.cells, strict=True)), dict(zip(raw.headings, raw.units, strict=True))
    )
    if found is None:
        return raw
    return replace(
        raw,
        headings=tuple(found.columns),
        units=tuple(found.units.get(heading, "") for heading in found.columns),
        cells=tuple(found.columns.values()),
        lines=np.asarray(raw.lines)[found.rows],
        about={**raw.about, **found.about},
    )


def stacked(columns: Mapping[str, Cells], units: Mapping[str, str]) -> Stacked | None:
    """One set of columns below the other, from columns and their units by name; None if the numbers in the names are not loads.

    They are loads if every set has a side force and the same channels, and the load of the sets, else the peak of the side
    force, is in proportion to them; numbers of wheels or sensors are not.
    """
    sets = _sets(columns)
    if len(sets) < 2:
        return None
    first = sets[0]
    channels = {_channel(stem): stem for stem in first.names}
    lengths = [{len(columns[name]) for name in one.names.values()} for one in sets]
    alike = all(one.names.keys() == first.names.keys() and one.unit == first.unit for one in sets)
    grouped = {name for one in sets for name in one.names.values()}
    shared = [
        name for name, cells in columns.items() if name not in grouped and {len(cells)} == set.union(*lengths)
    ]
    measured = LOAD in channels
    if (
        not alike
        or any(len(length) > 1 for length in lengths)
        or any(_channel(name) == LOAD for name in shared)
    ):
        return None
    sizes = {one.load: columns[one.names[channels[LOAD if measured else SIDE]]] for one in sets}
    if len(sizes) < len(sets) or not _in_proportion(sizes):
        return None
    counts = [length.pop() for length in lengths]
    joined: dict[str, Cells] = {
        name: _joined([columns[name] for _ in sets]) for name in shared if name != RUN
    }
    joined |= {stem: _joined([columns[one.names[stem]] for one in sets]) for stem in first.names}
    if not measured:
        joined[LOAD_HEADING] = np.repeat([one.load for one in sets], counts)
    joined[RUN] = [f"{one.load:g}" for one, n in zip(sets, counts, strict=True) for _ in range(n)]
    of_names = f"from the names {', '.join(one.names[channels[SIDE]] for one in sets)}"
    sources = {name: name for name in shared} | dict(first.names)
    return Stacked(
        columns=joined,
        units={LOAD_HEADING: first.unit} | {k: units[name] for k, name in sources.items() if units.get(name)},
        rows=np.concatenate([np.arange(n) for n in counts]),
        about={} if measured else {FROM_NAMES: of_names},
    )


def _sets(columns: Mapping[str, Cells]) -> list[_Set]:
    """The sets of columns with a side force, in their order."""
    found: dict[str, dict[str, str]] = {}
    units: dict[str, str] = {}
    for name in columns:
        match = WITH_LOAD.fullmatch(name)
        if match and _channel(match[1]):
            found.setdefault(match[2], {})[match[1]] = name
            units[match[2]] = match[3] or ""
    return [
        _Set(float(number.replace(",", ".")), units[number], names)
        for number, names in found.items()
        if SIDE in map(_channel, names)
    ]


def _channel(stem: str) -> str:
    """The channel of a known name; "" for another name."""
    known = NAMED.get(simplified(stem))
    return known.name if known else ""


def _in_proportion(sizes: Mapping[float, Cells]) -> bool:
    """Whether the largest readings are in proportion to the loads, as far as friction falls with the load."""
    ratios = []
    for load, cells in sizes.items():
        if not isinstance(cells, np.ndarray) or not load > 0.0 or not np.any(np.isfinite(cells)):
            return False
        ratios.append(float(np.nanmax(np.abs(cells))) / load)
    return 0.0 < max(ratios) < constants.LARGEST_FALL_OF_GRIP * min(ratios)


def _joined(parts: Sequence[Cells]) -> Cells:
    """The cells of several columns, one below the other."""
    arrays = [part for part in parts if isinstance(part, np.ndarray)]
    return np.concatenate(arrays) if len(arrays) == len(parts) else [cell for part in parts for cell in part]
