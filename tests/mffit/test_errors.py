"""The text of an error is made in one place."""

from __future__ import annotations

import pytest

from mffit.errors import InputError, readable, shortened


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
def test_the_text_begins_with_the_place(place, text):
    assert str(InputError("is wrong; correct it", **place)) == text


def test_the_text_is_one_line_even_with_a_quoted_line_break():
    assert "\n" not in str(InputError('"a\n b" is no number'))


def test_a_long_quote_is_cut_and_on_one_line():
    assert shortened(" a\n b ") == "a b"
    assert shortened("x" * 60) == "x" * 60
    assert shortened("x" * 61) == "x" * 60 + "..."


@pytest.mark.parametrize(
    ("name", "sentence"),
    [("nowhere.csv", "there is no such file"), ("", "is a folder; name the files in it")],
)
def test_a_file_that_cannot_be_opened_is_named(tmp_path, name, sentence):
    path = tmp_path / name
    with pytest.raises(InputError, match=sentence) as caught, readable(path):
        path.read_bytes()
    assert caught.value.file == path
