"""Check by names and by the measured radii that all readings are of one tyre, and of the declared one."""

import itertools
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from mffit.config import Config
from mffit.config.lines import ranges_text
from mffit.points import Points, levels
from mffit.quantities import CONDITIONS
from mffit.suspicion import constants
from mffit.suspicion.rule import Facts, Outcome, rule
from mffit.suspicion.slopes import at_zero
from mffit.sweeps.about import names_tyre
from tir.constants import EFFECTIVE_RADIUS_RANGE
from tir.errors import some


class MeasuredRadius(NamedTuple):
    """A radius of the rolling wheel that points may contain."""

    words: str
    column: str
    of: Callable[[Points], np.ndarray]  #: (n,) [m]; NaN where it was not measured


RADII = (
    MeasuredRadius("loaded radius", "RL_m", lambda points: points.RL),
    MeasuredRadius(
        "rolling radius, speed over rotation,", "omega_radps", lambda points: points.rolling_radius
    ),
)


@rule(
    id="named-tyres",
    of_all=True,
    sentence="names {n} tyres, {names}, and a property file describes one; make a project of each: {cure}",
)
def named_tyres(points: Points, config: Config) -> Iterator[Facts]:
    """Names of tyres in a column of the readings."""
    for heading in filter(names_tyre, map(str, points.table)):
        table = pd.DataFrame(
            {
                "file": np.array(points.files)[points.file],
                "line": points.line,
                "last": points.last_line,
                "name": [_name(cell) for cell in points.table[heading]],
            }
        )
        table = table[table.name != ""].sort_values(["file", "line"], kind="stable")
        count = table.name.value_counts()
        if len(count) < 2 or 2 * len(count) > len(table):  # of one tyre, or a number of each row
            continue
        kept = table.name.iloc[0]
        other = table[table.name != kept].iloc[0]
        facts = {
            "n": len(count),
            "names": some([f'"{name}"' for name in table.name.unique()]),
            "cure": _how_to_keep(kept, table),
        }
        yield {"file": other.file, "line": int(other.line), "column": heading, **facts}
        return


def _name(cell: Any) -> str:
    """The name of a tyre in a cell; "" for none, and for a number between those of two tyres, which is a mean of both."""
    if isinstance(cell, str):
        return " ".join(cell.split())
    number = float(cell)
    return f"{number:.0f}" if number.is_integer() else ""


def _how_to_keep(kept: str, table: pd.DataFrame) -> str:
    """What to write into ``tyre.toml`` to leave out the readings of all tyres but one."""
    if (table.groupby("file").name.nunique() == 1).all():
        return f'to keep "{kept}", remove the [[sweep]] of the files that name another'
    block = ((table.name != table.name.shift()) | (table.file != table.file.shift())).cumsum()
    parts = table.groupby(block).agg(
        file=("file", "first"), name=("name", "first"), line=("line", "first"), last=("last", "last")
    )
    entries = []
    for (file, name), rows in parts[parts.name != kept].groupby(["file", "name"]):
        lines = ranges_text(zip(rows["line"], rows["last"], strict=True))
        entries.append(f'{{ file = "{file}", lines = "{lines}", why = "tyre {name}" }}')
    return f'to keep "{kept}", write exclude = [{", ".join(entries)}] under [fit]'


@rule(
    id="two-tyres",
    sentence="{first} and {second} are of two tyres: the {words} at {load}, upright, is {a:.0f} against {b:.0f} mm; "
    "make a project of each",
)
def two_tyres(points: Points, config: Config) -> Iterator[Facts]:
    """Radii of two files at one load, pressure and speed, upright and rolling freely; worn or warm tyres differ by less."""
    upright = points.select(_rolls_upright(points))
    for radius in RADII:
        cells = _cells(upright.select(np.isfinite(radius.of(upright))), radius)
        for one, other in itertools.combinations(cells.index.unique("file"), 2):
            both = cells.loc[one].merge(
                cells.loc[other], left_index=True, right_index=True, suffixes=("_a", "_b")
            )
            apart = np.abs(both.median_a / both.median_b - 1.0)
            if both.empty or apart.median() <= constants.DIFFERENCE_OF_ANOTHER_TYRE:
                continue
            best = both.loc[both[["size_a", "size_b"]].min(axis=1).idxmax()]
            facts = {
                "first": points.files[one],
                "second": points.files[other],
                "words": radius.words,
                "load": CONDITIONS["Fz_N"].of(best.name[0]),
                "a": 1e3 * best.median_a,
                "b": 1e3 * best.median_b,
            }
            yield {"file": config.path, **facts}
            return


@rule(
    id="other-radius",
    outcome=Outcome.GRADED,
    sentence="the {words} of the readings is {radius:.4g} m, {ratio:.2f} times the unloaded radius of {declared:g} m, which "
    "{judged} unloaded_radius, or the unit of {of_column}",
)
def other_radius(points: Points, config: Config) -> Iterator[Facts]:
    """Median radii of the wheel that rolls freely and upright, over the unloaded radius; refused below the rim and above what
    growth with speed explains.
    """
    upright = points.select(_rolls_upright(points))
    declared, key = config.tyre.unloaded_radius, "tyre.unloaded_radius"
    rim = (config.tyre.rim_radius or 0.0) / declared
    least, most = EFFECTIVE_RADIUS_RANGE
    for radius in RADII:
        values = radius.of(upright)
        values = values[np.isfinite(values)]
        ratio = float(np.median(values)) / declared if len(values) else 1.0
        possible = rim <= ratio <= constants.LARGEST_RADIUS
        if not (possible and least <= ratio <= most):
            judged = "is rare: check" if possible else "no wheel has; correct"
            facts = {"words": radius.words, "radius": ratio * declared, "ratio": ratio, "declared": declared}
            facts |= {"of_column": radius.column, "judged": judged, "asked": possible}
            yield facts | ({} if possible else {"file": config.path, "line": config.line_of(key), "key": key})


def _rolls_upright(points: Points) -> np.ndarray:
    """Mask (n,) of free-rolling points without sideslip and camber, whose radii depend on load, pressure and speed only."""
    return np.asarray(points.free_rolling & at_zero(points))


def _cells(points: Points, radius: MeasuredRadius) -> pd.DataFrame:
    """Median and number of the radii by file and by level of load [N], pressure [Pa] and speed [m/s]."""
    keys = {name: levels.level_values(getattr(points, name), levels.KINDS[name]) for name in ("Fz", "p", "V")}
    table = pd.DataFrame({"file": points.file, **keys, "radius": radius.of(points)})
    return table.groupby(["file", *keys]).radius.agg(["median", "size"])
