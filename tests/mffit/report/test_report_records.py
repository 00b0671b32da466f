"""The text of a record fits a screen of a terminal or a notebook, and begins with the most important fact."""

from __future__ import annotations

import dataclasses
import html

import pytest

from mffit.brief import summary
from mffit.constants import TERMINAL_LINES, TERMINAL_WIDTH
from tir import Quantity


def fits(text: str) -> bool:
    lines = text.splitlines()
    return len(lines) <= TERMINAL_LINES and max(map(len, lines)) <= TERMINAL_WIDTH


@pytest.mark.parametrize(
    "part",
    ["config", "points", "parts", "measured", "measured.nominal", "fit", "fit.simulation", "fit.posterior"],
)
def test_every_part_of_a_build_fits_a_screen(result, part):
    record = result
    for name in part.split("."):
        record = getattr(record, name)
    assert fits(repr(record)), repr(record)
    assert repr(record).startswith(f"<{type(record).__name__}")


def test_a_build_begins_with_its_results(result):
    first = repr(result).splitlines()[0]
    found = result.measured.epsilon_gamma
    assert fits(repr(result))
    assert result.config.tyre.name in first
    assert f"{found.value:.3f}" in first
    assert f"{result.fit.channels['Fy'].rmse:.3g} N" in first


def test_a_notebook_shows_a_picture_and_no_foreign_markup(result):
    shown = dataclasses.replace(result, warnings=("<script>alert(1)</script>",))._repr_html_()
    assert "data:image/png;base64," in shown
    assert "<script>" not in shown
    assert html.escape("<script>") in shown


def test_numbers_are_not_hidden_by_their_containers(result):
    assert summary(result.points.Fz) == "115, 900 to 1500"
    assert summary(result.points.Mx) == "115, not known"
    assert summary({}) == summary(()) == "none"
    assert summary(result.measured.nominal.R).endswith(" m")
    assert summary(Quantity(value=1.0412837, u=0.00077, unit="N")) == "1.04128 +- 0.00077 N"
