"""CasADi's function against the equations, its derivatives against the complex step through them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tir
from tir.codegen.program import INPUTS
from tir.evaluate import evaluate

VECTORS = Path(__file__).parent / "vectors"
pytestmark = pytest.mark.filterwarnings("ignore:turn slip is on")
"""The public files have the common defaults of turn slip."""


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
    assert function.name_in() == ["Fz", "alpha", "gamma", "kappa", "phi_t", "Vx", "p"]
    found = np.array([[float(x) for x in function(*row)] for row in rows]).T
    wanted = evaluate(tyre.p, **dict(zip(INPUTS, np.array(rows).T, strict=True)), turn_slip=turn_slip)[0]
    for a, b in zip(found, wanted, strict=True):
        assert a == pytest.approx(b, rel=1e-12, abs=1e-15 * np.max(np.abs(b)) * 1e3)


def test_the_derivatives_are_those_of_the_complex_step(tyre):
    casadi = pytest.importorskip("casadi")
    function = tir.casadi_function(tyre, outputs=("Fy", "Mz", "K_ya"), turn_slip=True)
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


MEASURED = {"PDYP4": 0.3, "PECP1": -0.1, "QDRP2": -0.2}
"""What a fit writes into the block of turn slip."""


@pytest.mark.parametrize("at", ["zero spin", "turn slip alone", "standing wheel"])
def test_the_jacobian_is_a_number_where_a_search_begins(at):
    casadi = pytest.importorskip("casadi")
    tyre = tir.read(VECTORS / "moto_front.tir").replace(**MEASURED)
    function = tir.casadi_function(tyre, turn_slip=True)
    symbols = [casadi.SX.sym(name) for name in INPUTS]
    every = casadi.vertcat(*function(*symbols))
    slopes = casadi.Function("J", symbols, [casadi.jacobian(every, casadi.vertcat(*symbols))])
    phi_t, Vx = (-0.2 if at == "turn slip alone" else 0.0), (0.0 if at == "standing wheel" else 10.0)
    row = [1400.0, 0.0, 0.0, 0.0, phi_t, Vx, 2.5e5]
    found = np.array(slopes(*row))
    assert np.all(np.isfinite(found))
    steps = np.array([1.0, 1e-6, 1e-6, 1e-6, 1e-6])
    for k in (0, 1):  # load and sideslip: no kink there
        ahead, behind = ([x + sign * steps[k] * (j == k) for j, x in enumerate(row)] for sign in (1, -1))
        wanted = (np.array(function(*ahead)) - np.array(function(*behind))).ravel() / (2.0 * steps[k])
        np.testing.assert_allclose(found[:, k], wanted, rtol=1e-4, atol=0.05)


def test_the_tightest_corner_is_found_from_zero():
    """A wheel that leans into a flat corner at 15 m/s: the largest lateral force inwards, from zeros as starting values."""
    casadi = pytest.importorskip("casadi")
    tyre = tir.read(VECTORS / "moto_front.tir").replace(**MEASURED)
    function = tir.casadi_function(tyre, outputs=("Fy",), turn_slip=True)
    mass, speed, load = 140.0, 15.0, 140.0 * 9.81
    alpha, gamma, curvature = (casadi.SX.sym(name) for name in ("alpha", "gamma", "curvature"))
    force = function(load, alpha, gamma, 0.0, -curvature, speed, 2.5e5)
    x = casadi.vertcat(alpha, gamma, curvature)
    problem = {"x": x, "f": -curvature, "g": force / (mass * speed**2) - curvature}
    quiet = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.max_iter": 300}
    solver = casadi.nlpsol("s", "ipopt", problem, quiet)
    found = solver(x0=0.0, lbg=0.0, ubg=0.0, lbx=[-0.3, -0.8, -0.5], ubx=[0.3, 0.8, 0.5])
    assert solver.stats()["success"], solver.stats()["return_status"]
    a, g, c = np.array(found["x"]).ravel()
    mu = tyre.state(load).mu_y
    assert 0.5 * mu < c * speed**2 / 9.81 < 1.5 * mu
    assert tyre(load, a, g, 0.0, -c, speed, 2.5e5, turn_slip=True).Fy == pytest.approx(
        mass * speed**2 * c, rel=1e-6
    )


def test_an_input_left_out_of_a_call_by_name_has_the_files_value():
    """CasADi's own default is 0: no speed and no pressure, which gives another force without a word."""
    pytest.importorskip("casadi")
    tyre = tir.read(VECTORS / "moto_front.tir")
    function = tir.casadi_function(tyre, outputs=("Fy", "My"), tunable=("LMUY",))
    wanted = tyre(float(tyre["FNOMIN"]), alpha=0.05)
    found = function(alpha=0.05)
    assert float(found["Fy"]) == pytest.approx(wanted.Fy, rel=1e-12)
    assert float(found["My"]) == pytest.approx(wanted.My, rel=1e-12)


def test_an_unknown_output_is_named():
    pytest.importorskip("casadi")
    with pytest.raises(tir.TirError, match=r"fy is no force or state: use .*Fy"):
        tir.casadi_function(tir.Tyre.from_values({}), outputs=("fy",))


def test_scaling_factors_become_inputs():
    casadi = pytest.importorskip("casadi")
    tyre = tir.read(VECTORS / "moto_front.tir")
    function = tir.casadi_function(tyre, outputs=("Fy",), tunable=("LMUY", "LKY"))
    assert function.name_in()[-2:] == ["LMUY", "LKY"]
    row = [1400.0, 0.06, 0.3, 0.0, 0.0, 10.0, 2.2e5]
    wanted = tyre.replace(LMUY=0.7, LKY=1.1)(*row[:5], Vx=10.0, p=2.2e5, turn_slip=False).Fy
    assert float(function(*row, 0.7, 1.1)) == pytest.approx(wanted, rel=1e-12)
    factor = casadi.SX.sym("LMUY")
    slope = casadi.Function("d", [factor], [casadi.jacobian(function(*row, factor, 1.0), factor)])
    ahead, behind = (float(function(*row, 0.7 + h, 1.0)) for h in (1e-6, -1e-6))
    assert float(slope(0.7)) == pytest.approx((ahead - behind) / 2e-6, rel=1e-6)
    with pytest.raises(tir.TirError, match="PKY1 cannot be turned"):
        tir.casadi_function(tyre, tunable=("PKY1",))
