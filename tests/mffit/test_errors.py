"""The sentence a user sees is made in one place."""

from __future__ import annotations

import pytest

from mffit.errors import InputError


@pytest.mark.parametrize(
    ("place", "text"),
    [
        ({}, "is wrong; correct it"),
        ({"file": "a.csv"}, "a.csv: is wrong; correct it"),
        ({"file": "a.csv", "line": 7}, "a.csv:7: is wrong; correct it"),
        ({"file": "a.csv", "line": 7, "column": "Fy_N"}, "a.csv:7: column Fy_N: is wrong; correct it"),
        (
            {"file": "tyre.toml", "line": 2, "key": "tyre.name"},
            "tyre.toml:2: tyre.name: is wrong; correct it",
        ),
        ({"key": "tyre.name"}, "tyre.name: is wrong; correct it"),
    ],
)
def test_the_place_stands_in_front(place, text):
    assert str(InputError("is wrong; correct it", **place)) == text


def test_it_is_one_line_whatever_is_quoted():
    assert "\n" not in str(InputError('"a\n b" is no number'))
