"""Tables as CSV text in UTF-8, with the same line ends on every system."""

from pathlib import Path

import pandas as pd


def write_csv(table: pd.DataFrame, path: Path) -> None:
    """Write a table to a file in UTF-8."""
    table.to_csv(path, index=False, lineterminator="\n", encoding="utf-8")


def csv_text(table: pd.DataFrame) -> str:
    """The whole text of a table."""
    return table.to_csv(index=False, lineterminator="\n")
