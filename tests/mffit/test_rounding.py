"""Numbers are rounded by their uncertainty."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mffit.rounding import MINUS, ascii_only, number, times, to_uncertainty, with_u


@pytest.mark.parametrize(
    ("value", "u", "unit", "expected"),
    [
        (-0.18237, 0.0412, "", f"{MINUS}0.182 ± 0.041"),
        (424.09, 9.96, "Nm", "424 ± 10 Nm"),
        (-20033.4, 169.6, "N/rad", f"{MINUS}20030 ± 170 N/rad"),
        (0.00042666, 0.000035, "", "0.000427 ± 0.000035"),
        (1.0, 0.0996, "", "1.00 ± 0.10"),
        (-3.671525e-06, 1.3e-07, "1/s", f"{MINUS}3.67e{MINUS}6 ± 0.13e{MINUS}6 1/s"),
        (1.04128, 0.00077, "", "1.04128 ± 0.00077"),
        (2e-9, 5e-7, "", f"0.0e{MINUS}7 ± 5.0e{MINUS}7"),
        (12345.6, 0.0, "N", "12346 N"),
        (0.3, None, "m", "0.3 m"),
        (None, 1.0, "m", "–"),
        (math.nan, 1.0, "m", "–"),
    ],
)
def test_value_with_uncertainty(value, u, unit, expected):
    assert with_u(value, u, unit) == expected


@given(st.floats(-1e6, 1e6), st.floats(1e-9, 1e5))
def test_rounding_moves_a_value_by_less_than_a_tenth_of_its_uncertainty(value, u):
    shown, shown_u = (float(part) for part in ascii_only(with_u(value, u)).split("+-"))
    assert abs(shown - value) <= 0.0501 * u * (1.0 + 1e-9) + 1e-9 * abs(value)
    assert shown_u == pytest.approx(u, rel=0.051)


def test_no_minus_before_a_zero():
    assert number(-0.0001, 2) == "0.00"


@pytest.mark.parametrize(
    ("value", "u", "expected"),
    [
        (239286.4, 3766.0, "239300"),
        (-0.18237, 0.0412, "-0.182"),
        (424.09, 9.96, "424"),
        (0.12345, 0.0, "0.123"),
    ],
)
def test_numbers_of_sentences_have_two_digits_of_their_uncertainty(value, u, expected):
    assert to_uncertainty(value, u) == expected


def test_ratio_needs_both_numbers():
    assert times(6.2, 6.0) == "1.03 ×"
    assert times(6.2, math.nan) == "–"
    assert times(6.2, 0.0) == "–"


def test_terminal_text_is_ascii():
    assert ascii_only(with_u(-1.5, 0.2) + " –×") == "-1.50 +- 0.20 -x"
