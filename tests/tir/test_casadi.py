"""CasADi's function against the equations, its derivatives against the complex step through them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tir
from tir.codegen.program import INPUTS
from tir.evaluate import evaluate

VECTORS = Path(__file__).parent / "vectors"


@pytest.fixture(params=["MagicFormula62", "moto_front"])
def tyre(request) -> tir.Tyre:
    return tir.read(VECTORS / f"{request.param}.tir")


def conditions() -> list[list[float]]:
    rng = np.random.default_rng(2)
    n = 60
    return np.array(
        [
            rng.uniform(500.0, 5000.0, n), rng.uniform(-0.2, 0.2, n), rng.uniform(-0.6, 0.6, n), rng.uniform(-0.2, 0.2, n),
            rng.uniform(-0.8, 0.8, n), rng.uniform(5.0, 30.0, n) * rng.choice([-1.0, 1.0], n), rng.uniform(1e5, 4e5, n),
        ]
    ).T.tolist()  # fmt: skip


def test_without_casadi_the_message_names_the_package(monkeypatch, tyre):
    import sys

    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(tir.TirError, match="pip install casadi"):
        tir.casadi_function(tyre)


@pytest.mark.parametrize("turn_slip", [True, False])
def test_the_function_equals_the_equations(tyre, turn_slip):
    pytest.importorskip("casadi")
    function = tir.casadi_function(tyre, turn_slip=turn_slip)
    rows = conditions()
    found = np.array([[float(x) for x in function(*row)] for row in rows]).T
    wanted = evaluate(tyre.p, **dict(zip(INPUTS, np.array(rows).T, strict=True)), turn_slip=turn_slip)[0]
    for a, b in zip(found, wanted, strict=True):
        assert a == pytest.approx(b, rel=1e-12, abs=1e-15 * np.max(np.abs(b)) * 1e3)


def test_the_derivatives_are_those_of_the_complex_step(tyre):
    casadi = pytest.importorskip("casadi")
    function = tir.casadi_function(tyre, outputs=("Fy", "Mz", "K_ya"))
    symbols = [casadi.SX.sym(name) for name in INPUTS]
    for i, output in enumerate(function(*symbols)):
        jacobian = casadi.Function("J", symbols, [casadi.jacobian(output, casadi.vertcat(*symbols))])
        for row in conditions()[:20]:
            found = np.array(jacobian(*row)).ravel()
            for k in (0, 1, 2, 3, 4):
                step = [x + 1e-30j * (j == k) for j, x in enumerate(row)]
                step[5] = row[5]
                forces, state = evaluate(tyre.p, **dict(zip(INPUTS, step, strict=True)), turn_slip=True)
                wanted = float(np.imag((forces.Fy, forces.Mz, state.K_ya)[i])) / 1e-30
                assert found[k] == pytest.approx(wanted, rel=1e-9, abs=1e-6)
