"""For any bytes in a file, a reader returns a table or raises one sentence."""

from __future__ import annotations

import io
import tempfile
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mffit.errors import InputError
from mffit.recordings.guess import guesses
from mffit.sweeps import formats

EXAMPLES = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
FEW = settings(EXAMPLES, max_examples=8)
"""For MATLAB files, each of which is read in a process of its own."""
LETTERS = st.characters(codec="latin-1", exclude_characters="\r\n")
CELLS = st.one_of(
    st.floats().map(str),
    st.text(LETTERS, max_size=8),
    st.sampled_from(["", "NaN", "1,5", '"', "#", "N", "deg"]),
)


def outcome(name: str, content: bytes) -> None:
    """A whole table, in which headings can be looked for, or one sentence."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(content)
        raw, refused = None, ""
        try:
            raw = formats.read(path)
        except InputError as error:
            refused = str(error)
        if raw is None:
            assert refused
            assert "\n" not in refused
            return
        assert len(raw.headings) == len(raw.units) == len(raw.cells) == len(set(raw.headings))
        assert all(len(column) == len(raw.lines) for column in raw.cells)
        guesses(raw)


@pytest.mark.parametrize("name", ["a.csv.gz", "a.dat", *(f"a{kind.endings[0]}" for kind in formats.FORMATS)])
def test_any_bytes(name):
    @(FEW if name == "a.mat" else EXAMPLES)
    @given(st.binary(max_size=400))
    def tried(content):
        outcome(name, content)

    tried()


def test_a_header_outside_a_section_does_not_stop_the_reader():
    """A byte in front of the first section."""
    outcome("a.tdx", b"x**HEADER\n**MEASURCHANNELS\nFYW x N\n**MEASURDATA\n1\n")


def test_a_quotation_mark_that_joins_two_rows_is_one_sentence(tmp_path):
    """pandas counts more cells in them than there are headings, and would drop some with a warning of its own."""
    path = tmp_path / "a.csv"
    path.write_bytes(b'0.0\t1.0\t:\n0.0\t0.0\t0.0\t"\n"\t0.0')
    with pytest.raises(InputError, match="a quotation mark is not closed in its line"):
        formats.read(path)


@EXAMPLES
@given(st.lists(st.lists(CELLS, max_size=6), max_size=8), st.sampled_from([",", ";", "\t", "|", " "]))
def test_any_cells(rows, separator):
    outcome("a.csv", "\n".join(separator.join(row) for row in rows).encode("latin-1"))


@EXAMPLES
@given(
    st.lists(
        st.one_of(
            st.sampled_from(
                ["**HEADER", "**MEASURCHANNELS", "**CONSTANTS", "**measurdata", "**END", "! note"]
            ),
            st.lists(CELLS, max_size=6).map(" ".join),
        ),
        max_size=12,
    )
)
def test_any_lines_of_a_tydex_file(lines):
    outcome("a.tdx", "\n".join(["**HEADER", *lines]).encode("latin-1"))


def whole_mat() -> bytes:
    buffer = io.BytesIO()
    channel = {"name": np.array(["SA", "FY"], dtype=object), "units": np.array(["deg", "N"], dtype=object)}
    scipy.io.savemat(
        buffer, {"SA": np.arange(5.0)[:, None], "FY": np.arange(5.0)[:, None], "channel": channel}
    )
    return buffer.getvalue()


MAT = whole_mat()


@FEW
@given(
    st.lists(st.tuples(st.integers(0, len(MAT) - 1), st.integers(0, 255)), min_size=1, max_size=6),
    st.integers(0, len(MAT)),
)
def test_a_damaged_mat_file(changes, length):
    damaged = bytearray(MAT)
    for at, value in changes:
        damaged[at] = value
    outcome("a.mat", bytes(damaged[:length] if length > 128 else damaged))


def test_a_mat_file_that_crashes_the_library_is_refused_with_a_sentence(tmp_path):
    """A flat data type in place of another makes scipy's reader access memory that is not its own."""
    damaged = bytearray(MAT)
    damaged[560] = 14
    path = tmp_path / "a.mat"
    path.write_bytes(damaged)
    with pytest.raises(InputError, match="save it again"):
        formats.read(path)
