"""The replayed graph gives the numbers of the equations, for scalars, arrays and a parameter for each condition."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import tir
from tir.derivatives import gradient, traced
from tir.equations.forces import Forces
from tir.errors import TirError
from tir.evaluate import evaluate, turned_on_rim
from tir.outputs import outputs_of

SAMPLE = Path(__file__).parent / "vectors" / "moto_front.tir"
FORCES = Forces._fields


@pytest.fixture(scope="module")
def p():
    return SimpleNamespace(**tir.read(SAMPLE).values)


def drawn(n: int = 200) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(8)
    return {
        "Fz": rng.uniform(-200.0, 3000.0, n),  # also a wheel in the air
        "alpha": rng.uniform(-0.3, 0.3, n),
        "gamma": rng.uniform(-0.9, 0.9, n),
        "kappa": rng.uniform(-0.4, 0.4, n),
        "phi_t": rng.uniform(-1.0, 1.0, n),
        "Vx": rng.choice([-9.0, 4.0, 16.7], n),
        "pressure": rng.uniform(1.8e5, 3.2e5, n),
    }


def same(found, expected):
    for one, other in zip(found, expected, strict=True):
        assert one == pytest.approx(np.asarray(other), rel=1e-11, abs=1e-9)


@pytest.mark.parametrize("turn_slip", [True, False])
@pytest.mark.parametrize("star", [True, False])
def test_every_force_is_that_of_the_equations(p, turn_slip, star):
    conditions = drawn()
    expected = evaluate(p, **conditions, turn_slip=turn_slip, star=star)[0]
    same(outputs_of(FORCES, p, conditions, turn_slip=turn_slip, star=star), expected)


def test_one_condition_in_floats(p):
    one = {name: float(x[3]) for name, x in drawn().items()}
    same(outputs_of(FORCES, p, one, turn_slip=True), evaluate(p, **one, turn_slip=True)[0])


def test_missing_inputs_take_the_defaults_of_the_equations(p):
    load = {"Fz": np.array([700.0, 1400.0])}
    same(outputs_of(("Fy", "Mz"), p, load, turn_slip=True), evaluate(p, **load, turn_slip=True)[0][1::4])
    assert outputs_of(("Re",), p, load)[0] == pytest.approx(evaluate(p, **load)[1].Re)


def test_a_parameter_may_differ_from_condition_to_condition(p):
    conditions = drawn()
    mounted = turned_on_rim(p, np.where(np.arange(200) % 3 == 0, -1.0, 1.0))
    same(
        outputs_of(FORCES, mounted, conditions, turn_slip=True),
        evaluate(mounted, **conditions, turn_slip=True)[0],
    )


def test_zeros_where_python_would_stop(p):
    """Python's floats raise where numpy's are infinite or NaN."""
    odd = SimpleNamespace(**{**vars(p), "PDY1": 0.0, "PDY2": 0.0, "PKY2": 0.0, "PKY4": 0})
    conditions = drawn()
    found = outputs_of(FORCES, odd, conditions, turn_slip=True)
    with np.errstate(all="ignore"):
        same(found, evaluate(odd, **conditions, turn_slip=True)[0])


def test_a_zero_divisor_is_named(p):
    with pytest.raises(TirError, match="FNOMIN is 0"):
        outputs_of(("Fy",), SimpleNamespace(**{**vars(p), "FNOMIN": 0.0}), {"Fz": 1000.0})


def test_programs_that_come_and_go_leave_derivatives_as_they_are(p):
    """More combinations of inputs than are kept at a time, between two questions about the same one."""
    conditions = {name: x[:20] for name, x in drawn().items()}
    values = dict(vars(p))

    def by(*names):
        numbers = traced({name: float(values[name]) for name in names})
        return gradient(
            outputs_of(("Fy",), SimpleNamespace(**{**values, **numbers}), conditions)[0], [*numbers.values()]
        )

    both = by("PKY1", "PDY1")
    inputs = ["alpha", "gamma", "kappa", "phi_t"]
    for k in range(2 ** len(inputs)):
        some = {"Fz": conditions["Fz"]} | {n: conditions[n] for i, n in enumerate(inputs) if k >> i & 1}
        outputs_of(("Fy",), p, some, turn_slip=True)
    assert by("PDY1")[:, 0] == pytest.approx(both[:, 1], rel=1e-12)


@pytest.mark.parametrize(
    ("names", "inputs", "said"),
    [
        (("Fy",), {"fz": 4e3}, "fz is not an input"),
        (("Fy",), {"Fz": 4e3, "p": 1e5}, "p is not an input"),
        (("Fq",), {"Fz": 4e3}, "Fq is not an output"),
        ("Fy", {"Fz": 4e3}, "is a text"),
        (("Fy",), {"alpha": 0.1}, "load Fz"),
    ],
)
def test_unknown_names_are_refused(names, inputs, said):
    tyre = tir.Tyre.from_values({"FNOMIN": 4e3, "UNLOADED_RADIUS": 0.3})
    with pytest.raises(tir.TirError, match=said):
        outputs_of(names, tyre.p, inputs)


def test_an_output_asked_for_twice_comes_twice():
    tyre = tir.Tyre.from_values({"FNOMIN": 4e3, "UNLOADED_RADIUS": 0.3})
    first, second = outputs_of(("Fy", "Fy"), tyre.p, {"Fz": 4e3, "alpha": 0.1})
    assert first == second
