"""Lists of lines, as in ``lines = "39-44, 60"``."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mffit.config.lines import LineListError, line_ranges, line_text, ranges_text

RANGES = st.lists(
    st.tuples(st.integers(1, 200), st.integers(0, 30)).map(lambda p: (p[0], p[0] + p[1])), min_size=1
)
BLANKS = st.sampled_from(["", " ", "  ", "\t"])


@pytest.mark.parametrize(
    ("text", "ranges"),
    [
        ("39", ((39, 39),)),
        ("39-44", ((39, 44),)),
        ("39-44, 60", ((39, 44), (60, 60))),
        (" 60 ,39 - 44 ", ((39, 44), (60, 60))),
        ("1-3,4,2-5", ((1, 5),)),
        ("2,4", ((2, 2), (4, 4))),
    ],
)
def test_a_list_of_lines(text, ranges):
    assert line_ranges(text) == ranges


@pytest.mark.parametrize(
    "text",
    [
        "",
        " ",
        "a",
        "39-",
        "-5",
        "39--44",
        "39,,40",
        "39,",
        "1.5",
        "0",
        "0-3",
        "44-39",
        "3:5",
        "\u0663",
        "9" * 30,
        "9" * 5000,  # Python reads no number of so many digits
        "0" * 5000,
    ],
)
def test_what_is_no_list_of_lines_is_refused_with_a_remedy(text):
    with pytest.raises(LineListError, match=r"write|counted from 1|correct it"):
        line_ranges(text)


@given(RANGES, BLANKS)
def test_a_list_contains_the_lines_that_it_names_and_no_others(ranges, blank):
    text = f"{blank},{blank}".join(f"{a}{blank}-{blank}{b}" if a != b else str(a) for a, b in ranges)
    named = {line for a, b in ranges for line in range(a, b + 1)}
    found = line_ranges(text)
    assert {line for a, b in found for line in range(a, b + 1)} == named
    assert all(b + 1 < c for (_, b), (c, _) in itertools.pairwise(found))
    assert line_ranges(ranges_text(found)) == found


@given(st.lists(st.integers(1, 300), min_size=1))
def test_lines_in_any_order_are_written_as_a_list_that_is_read_back(lines):
    found = line_ranges(line_text(lines))
    assert {line for a, b in found for line in range(a, b + 1)} == set(lines)


@given(st.text(max_size=20))
def test_any_text_gives_ranges_or_a_sentence(text):
    try:
        found = line_ranges(text)
    except LineListError:
        return
    assert found
    assert all(1 <= a <= b for a, b in found)
