"""Reading and checking a user's table of conditions, and writing the table of predictions."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd

from mffit.csv_tables import csv_text
from mffit.errors import InputError, meant, shortened
from mffit.quantities import CONDITIONS
from mffit.sweeps.about import simplified
from mffit.sweeps.channels import BY_NAME, NAMED, nearest_channel
from mffit.sweeps.columns import text_of
from mffit.sweeps.constants import LIKENESS_OF_UNUSED_HEADING
from mffit.sweeps.formats import read
from mffit.sweeps.raw_table import RawTable
from mffit.sweeps.units import UnknownUnitError, converted
from tir.writing import replace_file

PATH = "phi_t_per_m"
"""Column of the path curvature."""
REQUIRED = ("alpha_deg", "gamma_deg", "Fz_N")
OPTIONAL = ("kappa", "p_kPa", "V_mps", "T_degC", PATH)
UNITS = {**{name: CONDITIONS[name].unit for name in (*REQUIRED, *OPTIONAL) if name != PATH}, PATH: "1/m"}
"""Units of the columns that a prediction uses."""


def read_conditions(path: Path) -> pd.DataFrame:
    """The conditions (n,) of a file, in its order and in the units of the column names; other columns are kept unchanged.

    Raises InputError, which names file, line and column, if a required column is missing, a column names a condition otherwise,
    or a value is not a number or is impossible.
    """
    raw = read(path)
    return checked(pd.DataFrame({heading: raw.column(heading) for heading in raw.headings}), raw)


def checked(table: pd.DataFrame, raw: RawTable | None = None) -> pd.DataFrame:
    """The table with numbers in the columns that a prediction uses; required columns are finite.

    ``raw`` is the file of the table, which may state units. Raises as :func:`read_conditions`.
    """
    file, line = (None, None) if raw is None else (raw.path, raw.heading_line)
    for heading in table:
        name = _meant(str(heading))
        if name not in ("", *table):
            otherwise = f"if it is {name}, rename it and write it in {UNITS[name]}; else give it another name"
            sentence = f"is no column of conditions; {otherwise}"
            raise InputError(sentence, file=file, line=line, column=str(heading))
    missing = [name for name in REQUIRED if name not in table]
    if missing:
        sentence = f"has no column {missing[0]}; conditions need {', '.join(REQUIRED)} and may have {', '.join(OPTIONAL)}"
        raise InputError(sentence, file=file, line=line)
    if not table.columns.is_unique:
        name = table.columns[table.columns.duplicated()][0]
        raise InputError("there are two columns of this name; rename one", column=str(name))
    used = {name: _numbers(table[name], name, raw) for name in UNITS if name in table}
    return table.assign(**used)


def _meant(heading: str) -> str:
    """The condition of a prediction that a heading names otherwise: as laboratories do, in another unit, or misspelt; or ""."""
    known = NAMED.get(simplified(heading))
    name = known.name if known else nearest_channel(heading, likeness=LIKENESS_OF_UNUSED_HEADING)
    return (
        name if name in UNITS else PATH if meant(heading, [PATH], likeness=LIKENESS_OF_UNUSED_HEADING) else ""
    )


def _numbers(cells: pd.Series, name: str, raw: RawTable | None) -> np.ndarray:
    """A column (n,) in the unit of its name; NaN where an optional column is empty."""
    values = pd.to_numeric(cells, errors="coerce").to_numpy(dtype=float)
    is_empty = (cells.isna() | (cells.astype(str).str.strip() == "")).to_numpy(dtype=bool)

    def refuse_if(wrong: np.ndarray, why: str) -> None:
        """Raise an InputError if any value is wrong; ``why`` may quote the first wrong cell."""
        if np.any(wrong):
            row = int(wrong.argmax())
            cell = cells.iloc[row] if raw is None else text_of(cells.iloc[row])
            sentence = why.format(cell=shortened(cell))
            if raw is None:
                raise InputError(f"row {row + 1}: {sentence}", column=name)
            raise InputError(sentence, file=raw.path, line=int(raw.lines[row]), column=name)

    unit = UNITS[name]
    if name in REQUIRED:
        refuse_if(is_empty, "this cell is empty; complete it or remove the row")
    if name == PATH:
        refuse_if(
            np.isinf(values),
            '"{cell}" is a wheel that turns on the spot, which no sweep shows; write 1/R [1/m], 0 for a straight path',
        )
    refuse_if(~np.isfinite(values) & ~is_empty, f'"{{cell}}" is not a number [{unit}]; correct it')
    stated = "" if raw is None else raw.unit(name)
    if stated:
        try:
            values = converted(values, stated, "" if unit == "-" else unit)
        except UnknownUnitError as error:
            assert raw is not None
            sentence = f"{error}; correct the unit of this column"
            raise InputError(sentence, file=raw.path, line=raw.heading_line, column=name) from None
    if name in ("Fz_N", "V_mps"):
        refuse_if(values <= 0.0, "{cell} is not above zero; correct it or remove the row")
    if name in BY_NAME:
        lower, upper = BY_NAME[name].lower, BY_NAME[name].upper
        below, above = BY_NAME[name].below, BY_NAME[name].above
        refuse_if(values < lower, f"{{cell}} is below {lower:g} [{unit}]; {below or 'correct it'}")
        refuse_if(values > upper, f"{{cell}} is above {upper:g} [{unit}]; {above or 'correct it'}")
    return values


def write_table(found: pd.DataFrame, out: Path, conditions: Path) -> None:
    """Write a prediction completely or not at all; of existing files, only an earlier prediction is replaced.

    Raises
    ------
    InputError
        The path is not a CSV file, belongs to the conditions or another existing file, or cannot be written.
    """
    if out.suffix.lower() != ".csv":
        raise InputError("is written as CSV; name a file that ends in .csv with --out", file=out)
    try:
        if out.exists():
            if out.samefile(conditions):
                raise InputError("is the table of the conditions; name another file with --out", file=out)
            if not _is_prediction(out):
                raise InputError("is there already and no prediction; name another file with --out", file=out)
        out.parent.mkdir(parents=True, exist_ok=True)
        replace_file(out, csv_text(found).encode())
    except OSError as error:
        sentence = f"cannot be written ({error.strerror}); name another file with --out"
        raise InputError(sentence, file=out) from None


def _is_prediction(path: Path) -> bool:
    with path.open(encoding="utf-8", errors="replace") as file:
        return re.search(r"\bu_\w+_best_", file.readline()) is not None
