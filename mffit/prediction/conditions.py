"""A table of conditions, as a user writes it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from mffit.csv_tables import write_csv
from mffit.errors import InputError
from mffit.prediction.predictor import PATH
from mffit.quantities import CONDITIONS
from mffit.sweeps.formats import read

REQUIRED = ("alpha_deg", "gamma_deg", "Fz_N")
OPTIONAL = ("kappa", "p_kPa", "V_mps", "T_degC", PATH)


def read_conditions(path: Path) -> pd.DataFrame:
    """The conditions (n,) of a file, in its order; columns of other names are repeated as they are.

    Raises
    ------
    InputError
        A required column is missing, or a value is no number; names file, line and column.
    """
    raw = read(path)
    table = pd.DataFrame({name: raw.column(name) for name in raw.headings})
    return checked(table, file=path, lines=np.asarray(raw.lines))


def write_table(found: pd.DataFrame, out: Path) -> None:
    """Write a prediction; a file that is none is left alone.

    Raises
    ------
    InputError
        The path is another file or a folder, or it cannot be written.
    """
    if out.is_dir():
        raise InputError("is a folder; name the file to write", file=out)
    try:
        if out.exists() and "_best_" not in out.open(encoding="utf-8", errors="replace").readline():
            raise InputError("exists already and is no prediction; give another name", file=out)
        out.parent.mkdir(parents=True, exist_ok=True)
        new = out.with_name(f".{out.name}.new")
        write_csv(found, new)
        new.replace(out)
    except OSError as error:
        raise InputError(f"cannot be written ({error.strerror}); give another name", file=out) from None


def checked(
    table: pd.DataFrame, *, file: Path | None = None, lines: np.ndarray | None = None
) -> pd.DataFrame:
    """The table with numbers in the columns that are used; those that must be stated are finite.

    Raises
    ------
    InputError
        As :func:`read_conditions`.
    """
    missing = [name for name in REQUIRED if name not in table]
    if missing:
        names = ", ".join(REQUIRED)
        sentence = f"has no column {missing[0]}; conditions need {names}, and may have {', '.join(OPTIONAL)}"
        raise InputError(sentence, file=file)
    found = table.copy()
    for name in (*REQUIRED, *(name for name in OPTIONAL if name in table)):
        numbers = pd.to_numeric(table[name], errors="coerce").to_numpy(dtype=float)
        empty = table[name].isna().to_numpy() | (table[name].astype(str).str.strip() == "").to_numpy()
        wrong = ~np.isfinite(numbers) & ~(empty & (name not in REQUIRED))
        if name == "Fz_N":
            wrong |= ~(numbers > 0.0)
        if np.any(wrong):
            row = int(np.flatnonzero(wrong)[0])
            what = "a positive load" if name == "Fz_N" else "a number"
            unit = CONDITIONS[name].unit if name in CONDITIONS else "1/m"
            raise InputError(
                f"{table[name].iloc[row]!r} is not {what} [{unit}]; correct it",
                file=file,
                line=None if lines is None else int(lines[row]),
                column=name,
            )
        found[name] = numbers
    return found
