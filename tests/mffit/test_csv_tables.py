"""Tables as CSV text."""

import pandas as pd

from mffit.csv_tables import csv_text, write_csv


def test_a_file_in_utf_8_has_the_same_line_ends_on_every_system(tmp_path):
    table = pd.DataFrame({"Schräglauf": [1.5, 2.0], "n": [1, 2]})
    write_csv(table, tmp_path / "a.csv")
    assert (tmp_path / "a.csv").read_bytes() == "Schräglauf,n\n1.5,1\n2.0,2\n".encode()
    assert csv_text(table).encode() == (tmp_path / "a.csv").read_bytes()
