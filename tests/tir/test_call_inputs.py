"""What a call, a state and a step cannot compute with is refused in a sentence that names the way."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

import tir
from tir.derivatives import gradient, traced
from tir.transient import Contact, step

TYRE = tir.Tyre.from_values({"FNOMIN": 1500.0, "UNLOADED_RADIUS": 0.3})
MASKED = np.ma.masked_array([100.0, 200.0], [False, True])
WRONG = (
    None,
    "0.02",
    Decimal("0.02"),
    Fraction(1, 50),
    [0.1, [0.2]],
    np.array([0.1], dtype=object),
    np.datetime64("now"),
)


def calls(name, x):
    """The calls that take the input."""
    given = {"Fz": 1400.0, name: x}
    yield lambda: TYRE(**given)
    yield lambda: TYRE.state(**given)
    if name == "gamma":
        yield lambda: step(TYRE, Contact(), 0.1, 1400.0, 15.0, gamma=x)


@pytest.mark.parametrize("name", ["Fz", "gamma"])
@pytest.mark.parametrize("wrong", WRONG, ids=lambda x: type(x).__name__)
def test_what_is_no_number_is_refused_by_name(name, wrong):
    for call in calls(name, wrong):
        with pytest.raises(tir.TirError, match=rf"^{name} is .*give a number or an array of numbers"):
            call()


def test_a_masked_array_is_refused_and_the_way_to_go_gives_nan():
    for call in calls("gamma", MASKED):
        with pytest.raises(tir.TirError, match=r"gamma\.filled\(numpy\.nan\)"):
            call()
    found = TYRE(1400.0, MASKED.filled(np.nan)).Fy
    assert np.isfinite(found).tolist() == [True, False]


@pytest.mark.parametrize("kind", ["SX", "MX"])
def test_a_symbol_of_casadi_is_refused_with_its_function(kind):
    symbol = getattr(pytest.importorskip("casadi"), kind).sym("x")
    for call in (*calls("gamma", symbol), lambda: TYRE.replace(PKY1=symbol)):
        with pytest.raises(tir.TirError, match=r"use tir\.casadi_function\(tyre\)"):
            call()


def test_what_jax_traces_is_refused_with_its_function_and_its_arrays_are_numbers():
    jax = pytest.importorskip("jax")
    with pytest.raises(tir.TirError, match=r"use tyre\.array_function\(jax\.numpy\)"):
        jax.grad(lambda x: TYRE(1400.0, x).Fy)(0.02)
    array = jax.numpy.array([0.02, 0.03])
    np.testing.assert_array_equal(TYRE(1400.0, array).Fy, TYRE(1400.0, np.asarray(array)).Fy)


def test_numbers_that_record_and_complex_ones_are_computed_with():
    (alpha,) = traced({"alpha": 0.02}).values()
    slope = gradient(TYRE(1400.0, alpha).Fy, [alpha])[0]
    assert slope == pytest.approx(np.imag(TYRE(1400.0, 0.02 + 1e-30j).Fy) / 1e-30, rel=1e-12)
