"""Records on a screen: a terminal and a notebook show a line per field, however much a record holds."""

import dataclasses
import html
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from mffit.constants import TERMINAL_LINES, TERMINAL_WIDTH
from mffit.rounding import ascii_only, stated
from tir import Quantity, Tyre


class Brief:
    """A record whose ``repr`` fits a screen; its attributes hold all values."""

    __slots__ = ()

    @property
    def headline(self) -> str:
        """The most important fact, for the first line; empty for none."""
        return ""

    def __repr__(self) -> str:
        lines = [f"<{_title(self)}", *(f" {name}: {text}" for name, text in _fields(self))]
        if len(lines) > TERMINAL_LINES:
            shown = TERMINAL_LINES - 1
            lines = [*lines[:shown], f" and {len(lines) - shown} fields more"]
        longest = TERMINAL_WIDTH - 1
        cut = (line if len(line) <= longest else f"{line[: longest - 3]}..." for line in lines)
        return "\n".join(cut) + ">"

    def _repr_html_(self) -> str:
        """For notebooks: the same as a table, with a picture of the tyre if the record has one."""
        rows = "".join(
            f"<tr><th style='text-align:left'>{html.escape(name)}</th><td style='text-align:left'>{html.escape(text)}</td></tr>"
            for name, text in _fields(self)
        )
        tyre = getattr(self, "tyre", None)
        picture = tyre._repr_html_() if isinstance(tyre, Tyre) else ""
        return f"<p><strong>{html.escape(_title(self))}</strong></p><table>{rows}</table>{picture}"


def _title(record: Brief) -> str:
    name = type(record).__name__
    return f"{name}: {record.headline}" if record.headline else name


def _fields(record: Any) -> list[tuple[str, str]]:
    names = (
        [field.name for field in dataclasses.fields(record)]
        if dataclasses.is_dataclass(record)
        else [*type(record).model_fields]
    )
    return [(name, summary(getattr(record, name))) for name in names]


def summary(x: Any) -> str:
    """A value in a few words: a number, or the size of a collection with its members or their range."""
    if isinstance(x, float | np.floating):
        return f"{x:.6g}"
    if isinstance(x, str | Path):
        return repr(str(x))
    if isinstance(x, Quantity):
        return ascii_only(stated(x, x.unit))
    if isinstance(x, np.ndarray):
        return _array(x)
    if isinstance(x, pd.DataFrame):
        return f"table of {x.shape[0]} rows and {x.shape[1]} columns"
    if isinstance(x, Mapping):
        return f"{len(x)}: {', '.join(map(str, x))}" if x else "none"
    if isinstance(x, Brief):
        return _title(x)
    if _is_record(x):
        return type(x).__name__
    if isinstance(x, Collection) and x and all(map(_is_record, x)):
        return f"{len(x)}: {', '.join(dict.fromkeys(type(one).__name__ for one in x))}"
    if isinstance(x, Collection):
        return f"{len(x)}: {', '.join(map(summary, x))}" if x else "none"
    return " ".join(repr(x).splitlines()[0].split())


def _is_record(x: Any) -> bool:
    return not isinstance(x, Brief) and (dataclasses.is_dataclass(x) or hasattr(x, "_fields"))


def _array(x: np.ndarray) -> str:
    size = " x ".join(map(str, x.shape))
    if x.dtype.kind not in "fiu" or not x.size:
        kinds = np.unique(x.astype(str)).tolist()
        return f"{size}: {', '.join(kinds)}" if len(kinds) <= 6 else f"{size} values"
    known = x[np.isfinite(x)]
    if not known.size:
        return f"{size}, not known"
    low, high = known.min(), known.max()
    return (
        f"{size}, all {low:.6g}"
        if low == high and known.size == x.size
        else f"{size}, {low:.6g} to {high:.6g}"
    )
