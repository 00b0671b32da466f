"""Derivatives by reverse accumulation, on the equations and replayed, against the complex step, which shares no rule with it."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import tir
from tir.derivatives import gradient, traced
from tir.evaluate import evaluate
from tir.outputs import outputs_of
from tir.parameters import TABLE

SAMPLE = Path(__file__).parent / "vectors" / "moto_front.tir"
STEP = 1e-30
COEFFICIENTS = [row.name for row in TABLE if row.stage]


@pytest.fixture(scope="module")
def conditions():
    rng = np.random.default_rng(3)
    n = 60
    return {
        "Fz": rng.uniform(700.0, 2200.0, n),
        "alpha": rng.uniform(-0.15, 0.15, n),
        "gamma": rng.uniform(-0.8, 0.8, n),
        "phi_t": rng.uniform(-1.0, 1.0, n),
        "Vx": np.where(rng.random(n) < 0.2, -6.0, 6.0),
        "pressure": rng.uniform(2e5, 3e5, n),
    }


def forces(values, conditions, turn_slip):
    return evaluate(SimpleNamespace(**values), **conditions, turn_slip=turn_slip)[0]


def replayed(values, conditions, turn_slip):
    found = outputs_of(("Fy", "Mz"), SimpleNamespace(**values), conditions, turn_slip=turn_slip)
    return SimpleNamespace(Fy=found[0], Mz=found[1])


ROUTES = pytest.mark.parametrize("route", [forces, replayed])


@ROUTES
@pytest.mark.parametrize("turn_slip", [True, False])
def test_every_coefficient_has_the_derivative_of_a_complex_step(conditions, turn_slip, route):
    values = dict(tir.read(SAMPLE).values)
    numbers = traced({name: float(values[name]) for name in COEFFICIENTS})
    out = route({**values, **numbers}, conditions, turn_slip)
    for channel in ("Fy", "Mz"):
        found = gradient(getattr(out, channel), list(numbers.values()))
        for k, name in enumerate(COEFFICIENTS):
            moved = forces({**values, name: float(values[name]) + 1j * STEP}, conditions, turn_slip)
            expected = np.imag(getattr(moved, channel)) / STEP * np.ones(60)
            scale = 1.0 + np.max(np.abs(expected))
            assert np.broadcast_to(found, (60, len(COEFFICIENTS)))[:, k] == pytest.approx(
                expected, abs=1e-10 * scale
            ), name


@ROUTES
@pytest.mark.parametrize("name", ["alpha", "gamma", "phi_t", "Fz", "pressure"])
def test_every_input_has_the_derivative_of_a_complex_step(conditions, name, route):
    values = dict(tir.read(SAMPLE).values)
    (number,) = traced({name: conditions[name]}).values()
    out = route(values, {**conditions, name: number}, True)
    moved = forces(values, {**conditions, name: conditions[name] + 1j * STEP}, True)
    for channel in ("Fy", "Mz"):
        expected = np.imag(getattr(moved, channel)) / STEP
        found = gradient(getattr(out, channel), [number])[:, 0]
        assert found == pytest.approx(expected, abs=1e-10 * (1.0 + np.max(np.abs(expected))))


def test_the_derivative_by_an_unused_number_is_zero():
    x, y = traced({"x": 2.0, "y": np.array([1.0, 3.0])}).values()
    assert gradient(x * y, [x, y]) == pytest.approx(np.array([[1.0, 2.0], [3.0, 2.0]]))
    assert gradient(x * 3.0, [x, y]) == pytest.approx([3.0, 0.0])
    assert gradient(np.array([5.0]), [x]) == pytest.approx(np.zeros((1, 1)))
