"""A declared number and its measurements: their weighted mean, unless the measurements contradict what is declared."""

from __future__ import annotations

import pytest

from mffit.measured.uncertain import agreed, named


def number(value: float, u: float):
    return named(value, u, f"{value}", "m")


@pytest.mark.parametrize("apart", [-1.9, -0.5, 1.0, 1.9])
def test_what_agrees_within_95_percent_is_averaged_by_its_information(apart):
    """The difference has a standard uncertainty of hypot(3, 4) = 5; weights are 1/9 and 1/16."""
    found = agreed(number(10.0, 3.0), [number(10.0 + 5.0 * apart, 4.0)])
    assert found.nominal_value == pytest.approx(10.0 + 5.0 * apart * 9.0 / 25.0)
    assert found.std_dev == pytest.approx(12.0 / 5.0)


@pytest.mark.parametrize("apart", [-5.0, -2.1, 2.1, 5.0])
def test_what_contradicts_its_measurements_is_left_out(apart):
    found = agreed(number(10.0, 3.0), [number(10.0 + 5.0 * apart, 4.0)])
    assert found.nominal_value == pytest.approx(10.0 + 5.0 * apart)
    assert found.std_dev == pytest.approx(4.0)
