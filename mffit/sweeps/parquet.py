"""The reader of Parquet files."""

from pathlib import Path

import numpy as np

from mffit.sweeps.extras import BYTES_OF_A_NUMBER, check_size, needed, undamaged
from mffit.sweeps.raw_table import Cells, RawTable


def read_parquet(path: Path) -> RawTable:
    """Read a ``.parquet`` file of numbers and texts; the unit of a column is its metadata ``unit`` or ``units``.

    Raises InputError if the file is not a Parquet file, has no rows, has a heading twice, or pyarrow is not installed.
    """
    needed("pyarrow", "Parquet files", path)
    parquet = needed("pyarrow.parquet", "Parquet files", path)
    with undamaged(path, "Parquet file"), parquet.ParquetFile(path) as file:
        about = file.metadata  # values that repeat are stored once, so their number counts too
        stated = sum(about.row_group(k).total_byte_size for k in range(about.num_row_groups))
        check_size(max(stated, BYTES_OF_A_NUMBER * about.num_rows * about.num_columns), path)
        table = file.read()
    headings = tuple(str(name).strip() for name in table.column_names)
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
    unit = about.get(b"unit") or about.get(b"units") or b""
    return unit.decode("utf-8", errors="replace").strip()
