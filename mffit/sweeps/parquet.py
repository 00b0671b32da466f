"""The reader of Parquet files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mffit.errors import InputError
from mffit.sweeps.extras import needed
from mffit.sweeps.raw_table import Cells, RawTable


def read_parquet(path: Path) -> RawTable:
    """Read a ``.parquet`` file: columns of numbers and texts; a column's metadata ``unit`` or ``units`` is its unit.

    Raises
    ------
    InputError
        The file is no Parquet file, has no rows or headings twice, or pyarrow is not installed.
    """
    needed("pyarrow", "Parquet files", path)
    parquet = needed("pyarrow.parquet", "Parquet files", path)
    try:
        with parquet.ParquetFile(path) as file:
            table = file.read()
    except Exception as error:  # a damaged file fails in whatever way its bytes happen to lead to
        said = " ".join(str(error).split())[:80]
        raise InputError(f"is no Parquet file that can be read ({said}); save it again", file=path) from None
    headings = tuple(str(name).strip() for name in table.column_names)
    if len(set(headings)) < len(headings) or "" in headings:
        raise InputError("has a heading that is empty or stands twice; rename that column", file=path)
    if not table.num_rows or not headings:
        raise InputError("has no rows; write one per point or sample", file=path)
    return RawTable(
        headings=headings,
        units=tuple(_unit(table.schema.field(k)) for k in range(len(headings))),
        cells=tuple(_cells(table.column(k)) for k in range(len(headings))),
        lines=range(1, table.num_rows + 1),
        path=path,
        heading_line=None,
    )


def _cells(column: object) -> Cells:
    import pyarrow

    kind = column.type  # type: ignore[attr-defined]
    if pyarrow.types.is_floating(kind) or pyarrow.types.is_integer(kind):
        values = column.to_numpy()  # type: ignore[attr-defined]
        return np.asarray(values, dtype=float)
    return ["" if value is None else str(value).strip() for value in column.to_pylist()]  # type: ignore[attr-defined]


def _unit(field: object) -> str:
    about = getattr(field, "metadata", None) or {}
    said = about.get(b"unit") or about.get(b"units") or b""
    return said.decode("utf-8", errors="replace").strip()
