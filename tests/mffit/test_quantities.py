"""One table of words, symbols and units, for every place that shows them."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from mffit.measured import LoadResult
from mffit.quantities import CHANNELS, CONDITIONS, DIRECT, KEYS, ON_ROAD, QuantityName

EPSILON = QuantityName("camber reduction factor", "ε_γ", "-")
FORCE = QuantityName("turn-slip force", "F_φt", "N")


def test_a_symbol_is_written_as_terminal_picture_and_page_can():
    assert (EPSILON.ascii, EPSILON.mathtext, EPSILON.html) == ("eps_gamma", "ε$_{γ}$", "ε<sub>γ</sub>")
    assert (FORCE.ascii, FORCE.mathtext, FORCE.html) == ("F_phit", "F$_{φt}$", "F<sub>φt</sub>")


def test_what_has_no_unit_is_not_given_one():
    assert EPSILON.axis == "camber reduction factor ε$_{γ}$ [–]"
    assert EPSILON.column("eps") == "eps"
    assert FORCE.column("force") == "force [N]"
    assert FORCE.of(331.4) == "331 N"
    assert CONDITIONS["kappa"].of(-0.052) == "-0.05"
    assert CONDITIONS["kappa"].of(-0.001) == "0"


@pytest.mark.parametrize("quantity", [*CONDITIONS.values(), *CHANNELS.values(), *DIRECT.values()])
def test_every_symbol_can_be_shown_in_a_terminal(quantity):
    assert quantity.ascii.isascii()


def test_the_direct_methods_quantities_are_those_of_its_record():
    attributes = {field.name for field in dataclasses.fields(LoadResult)}
    assert set(KEYS) <= set(DIRECT) - set(ON_ROAD) <= attributes


def test_the_page_of_files_describes_every_result_as_the_list_does():
    page = (Path(__file__).parents[2] / "docs" / "files.md").read_text(encoding="utf-8")
    for name, key in KEYS.items():
        if name != "epsilon_gamma":  # the page explains where the carried value comes from
            assert f"`{key}` | {DIRECT[name].word}: {DIRECT[name].how}" in page


def test_the_unit_in_a_key_is_that_of_the_table():
    for name, key in KEYS.items():
        unit = DIRECT[name].unit.replace("/", "_per_")
        assert key == (name if unit == "-" else f"{name}_{unit}")
