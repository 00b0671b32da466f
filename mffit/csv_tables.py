"""Tables as CSV text, as ``pandas.DataFrame.to_csv(index=False, lineterminator="\\n")`` writes them, in a third of its time.

Numbers have the shortest digits that are read as the same number. Equal values of a column are formatted once.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from mffit import constants


def write_csv(table: pd.DataFrame, path: Path) -> None:
    """Write a table to a file in UTF-8."""
    with path.open("w", encoding="utf-8", newline="") as file:
        file.writelines(_chunks(table))


def csv_text(table: pd.DataFrame) -> str:
    """The whole text of a table."""
    return "".join(_chunks(table))


def _chunks(table: pd.DataFrame) -> Iterator[str]:
    """The header, then the text of some rows at a time."""
    columns = [table.iloc[:, k] for k in range(table.shape[1])]
    if len(columns) < 2 or not all(map(_is_plain, columns)):  # a single column has other rules
        yield table.to_csv(index=False, lineterminator="\n")
        return
    yield _line(table.columns.tolist())
    rows = int(constants.ROWS_AS_TEXT)
    for begin in range(0, len(table), rows):
        cells = [_cells(column.iloc[begin : begin + rows]) for column in columns]
        yield "\n".join([*map(",".join, zip(*cells, strict=True)), ""])


def _is_plain(column: pd.Series[Any]) -> bool:
    """Whether all values are float64, integers, booleans, or texts of which some may be missing."""
    if isinstance(column.dtype, np.dtype) and column.dtype != object:
        return column.dtype == float or column.dtype.kind in "iub"
    return isinstance(column.dtype, pd.StringDtype) or set(map(type, column.dropna())) <= {str}


def _cells(column: pd.Series[Any]) -> list[str]:
    """Text (n,) of each value; a missing one is empty."""
    if not isinstance(column.dtype, np.dtype) or column.dtype == object:
        index, distinct = pd.factorize(column)  # -1 where missing
        return _at(index, [*(_line([text, ""])[:-2] for text in distinct), ""])
    values = column.to_numpy()
    if values.dtype != float:
        return _formatted_once(values, lambda each: list(map(repr, each.tolist())))
    # Distinct by their bits, as 0.0 and -0.0 are.
    found = _formatted_once(values.view(np.int64), lambda bits: list(map(repr, bits.view(float).tolist())))
    for i in np.flatnonzero(np.isnan(values)).tolist():
        found[i] = ""
    return found


def _formatted_once(values: np.ndarray, formatted: Callable[[np.ndarray], list[str]]) -> list[str]:
    """The texts (n,) of values; where most are repeated, each is formatted once."""
    distinct, index = np.unique(values, return_inverse=True)
    if 2 * len(distinct) > len(values):
        return formatted(values)
    return _at(index, formatted(distinct))


def _at(index: np.ndarray, texts: Sequence[str]) -> list[str]:
    found: list[str] = np.array(texts, dtype=object)[index].tolist()
    return found


def _line(cells: Sequence[Any]) -> str:
    """The cells as a line, in quotation marks where they are needed."""
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="\n").writerow(cells)
    return buffer.getvalue()
