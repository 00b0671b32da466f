"""Tables as CSV text: the same as pandas writes, whatever is in them."""

import numpy as np
import pandas as pd
import pytest

from mffit import constants
from mffit.csv_tables import csv_text, write_csv

N = 9
NUMBERS = [0.1 + 0.2, 1.0, -0.0, 0.0, np.nan, np.inf, 1e-7, 1e22, 2.0 / 3.0]
TABLES = {
    "numbers": {"distinct": NUMBERS, "repeated": [0.0, -0.0, np.nan] * 3, "n": range(N), "b": [True] * N},
    "texts": {"a, b": ["x,y", 'say "so"', "", None, "two\nlines", "é", "x", "x", "x"], "c": NUMBERS},
    "small floats": {"f": np.array(NUMBERS, dtype=np.float32), "c": range(N)},
    "mixed objects": {"o": [True, 1, 1.0, "1", None, "", np.nan, 2.5, "x"], "c": range(N)},
    "times": {"t": pd.to_datetime(["2026-01-01"] * N), "c": range(N)},
    "one column": {"a": [1.0, np.nan, 2.0]},
    "no rows": {"a": [], "b": []},
    "nothing": {},
}


@pytest.mark.parametrize("content", TABLES.values(), ids=TABLES)
def test_the_text_is_that_of_pandas(content, monkeypatch):
    monkeypatch.setattr(constants, "ROWS_AS_TEXT", 4)  # so that chunks join in the middle of the tables
    table = pd.DataFrame(content)
    assert csv_text(table) == table.to_csv(index=False, lineterminator="\n")


def test_a_file_in_utf_8_has_the_same_line_ends_on_every_system(tmp_path):
    write_csv(pd.DataFrame({"Schräglauf": [1.5, 2.0], "n": [1, 2]}), tmp_path / "a.csv")
    assert (tmp_path / "a.csv").read_bytes() == "Schräglauf,n\n1.5,1\n2.0,2\n".encode()
