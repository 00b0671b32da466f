"""The function of an array library against the tyre; its derivatives in JAX against CasADi's and the complex step."""

from __future__ import annotations

import re
from decimal import Decimal
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import tir
from tir.codegen.program import INPUTS
from tir.derivatives import gradient, traced
from tir.evaluate import evaluate
from tir.outputs import outputs_of

VECTORS = Path(__file__).parent / "vectors"
PAGE = Path(__file__).parents[2] / "docs" / "export.md"
pytestmark = pytest.mark.filterwarnings("ignore:turn slip is on")
"""The public files have the common defaults of turn slip."""
MEASURED = {"PDYP4": 0.3, "PECP1": -0.1, "QDRP2": -0.2}
"""What a fit writes into the block of turn slip."""


@pytest.fixture
def tyre() -> tir.Tyre:
    return tir.read(VECTORS / "moto_front.tir").replace(**MEASURED)


@pytest.fixture
def jax():
    """JAX in double precision."""
    found = pytest.importorskip("jax")
    found.config.update("jax_enable_x64", True)
    yield found
    found.config.update("jax_enable_x64", False)


def conditions(n: int = 40) -> list[np.ndarray]:
    rng = np.random.default_rng(2)
    return [
        rng.uniform(500.0, 5000.0, n), rng.uniform(-0.2, 0.2, n), rng.uniform(-0.6, 0.6, n), rng.uniform(-0.2, 0.2, n),
        rng.uniform(-0.8, 0.8, n), rng.uniform(5.0, 30.0, n) * rng.choice([-1.0, 1.0], n), rng.uniform(1e5, 4e5, n),
    ]  # fmt: skip


def assert_near(found, wanted) -> None:
    for a, b in zip(found, wanted, strict=True):
        np.testing.assert_allclose(np.asarray(a), b, rtol=1e-12, atol=1e-12 * np.max(np.abs(b)))


@pytest.mark.parametrize("turn_slip", [True, False])
@pytest.mark.parametrize("limits", [True, False])
def test_in_numpy_it_is_the_tyre(tyre, turn_slip, limits):
    rows = conditions()
    rows[0][:2] = -5.0, 0.0
    found = tyre.array_function(np, turn_slip=turn_slip, limits=limits)(*rows)
    assert isinstance(found, tir.Forces)
    assert_near(found, tyre(*rows, turn_slip=turn_slip, limits=limits))


def test_inputs_left_out_are_those_of_the_file(tyre):
    function, wanted = tyre.array_function(np, turn_slip=True), tyre(1400.0, 0.05, turn_slip=True)
    assert float(function(1400.0, alpha=0.05).Fy) == pytest.approx(wanted.Fy, rel=1e-12)
    assert function(1400.0, 0.05, phi_t=None, Vx=None, p=None) == function(1400.0, 0.05)
    with pytest.raises(TypeError, match="Fz"):
        function(alpha=0.05)
    with pytest.raises(TypeError, match="Fz"):
        tyre(alpha=0.05)


@pytest.mark.parametrize(
    "wrong",
    [
        None,
        "1400",
        Decimal(1400),
        np.datetime64("2026-01-01"),
        np.array(["1400"]),
        np.array([1400.0, None], dtype=object),
        np.ma.masked_greater([1000.0, 2000.0], 1500.0),
    ],
    ids=repr,
)
def test_what_a_call_refuses_is_refused(tyre, wrong):
    said = set()
    for call in (tyre, tyre.array_function(np)):
        with pytest.raises(tir.TirError, match=r"^Fz is ") as refused:
            call(wrong)
        said.add(str(refused.value))
    assert len(said) == 1


def test_complex_numbers_are_those_of_a_call(tyre):
    with pytest.raises(tir.TirError, match=r"alpha is .*: for complex numbers call the tyre"):
        tyre.array_function(np)(1400.0, 0.05 + 1e-20j)


@pytest.mark.parametrize("switch", ["turn_slip", "star", "limits"])
def test_a_switch_is_true_or_false(tyre, switch):
    for call in (partial(tyre, 1400.0), partial(tyre.state, 1400.0), partial(tyre.array_function, np)):
        with pytest.raises(tir.TirError, match=f"{switch} is 'yes': give True or False"):
            call(**{switch: "yes"})
    assert tyre(1400.0, 0.05, **{switch: np.True_}) == tyre(1400.0, 0.05, **{switch: True})


def test_numbers_beyond_the_formula_are_quiet(tyre):
    """Warnings fail the tests."""
    found = tyre.array_function(np)(
        np.array([1400.0, np.nan, np.inf, 1400.0]), np.array([0.05, 0.05, 0.05, np.inf])
    )
    assert np.isfinite(found.Fy[0])
    assert np.isnan(found.Fy[1])


def test_outputs_and_factors_are_chosen(tyre):
    function = tyre.array_function(np, outputs=("K_ya", "Fy"), tunable=("LMUY",), turn_slip=False)
    found, other = function(1400.0, alpha=0.05, LMUY=0.7), tyre.replace(LMUY=0.7)
    assert float(found.Fy) == pytest.approx(other(1400.0, 0.05, turn_slip=False).Fy, rel=1e-12)
    assert float(found.K_ya) == pytest.approx(other.state(1400.0, 0.05, turn_slip=False).K_ya, rel=1e-12)
    with pytest.raises(TypeError, match="LKY"):
        function(1400.0, LKY=0.7)


def test_what_is_no_array_library_is_refused(tyre):
    with pytest.raises(tir.TirError, match=r"give numpy, jax\.numpy, torch or cupy"):
        tyre.array_function(re)


def test_in_jax_it_is_the_tyre_compiled_and_mapped_too(tyre, jax):
    rows = conditions()
    function = tyre.array_function(jax.numpy, turn_slip=True)
    wanted = tyre(*rows, turn_slip=True)
    for form in (function, jax.jit(function), jax.vmap(function)):
        assert_near(form(*rows), wanted)


def slopes(jax, function, rows) -> np.ndarray:
    """Derivatives (outputs, inputs, n)."""
    found, back = jax.vjp(function, *map(jax.numpy.asarray, rows))
    zero = jax.numpy.zeros_like(found[0])
    rays = [type(found)(*(zero + (i == k) for i in range(len(found)))) for k in range(len(found))]
    return np.array([back(ray) for ray in rays])


def test_the_derivatives_are_those_of_casadi_and_of_the_complex_step(tyre, jax):
    outputs, rows = ("Fy", "Mz", "K_ya"), conditions(12)
    found = slopes(jax, tyre.array_function(jax.numpy, outputs=outputs, turn_slip=True), rows)
    for k in (0, 1, 2, 3, 4):
        step = [x + 1e-30j * (j == k) for j, x in enumerate(rows)]
        step[5] = rows[5]
        forces, state = evaluate(tyre.p, **dict(zip(INPUTS, step, strict=True)), turn_slip=True)
        for i, wanted in enumerate((forces.Fy, forces.Mz, state.K_ya)):
            np.testing.assert_allclose(found[i, k], np.imag(wanted) / 1e-30, rtol=1e-9, atol=1e-6)
    casadi = pytest.importorskip("casadi")
    assert_near(found, of_casadi(casadi, tyre, outputs, rows))


def of_casadi(casadi, tyre, outputs, rows) -> np.ndarray:
    function = tir.casadi_function(tyre, outputs=outputs, turn_slip=True)
    symbols = [casadi.SX.sym(name) for name in INPUTS]
    every = casadi.vertcat(*function(*symbols))
    jacobian = casadi.Function("J", symbols, [casadi.jacobian(every, casadi.vertcat(*symbols))])
    return np.array([np.array(jacobian(*row)) for row in np.transpose(rows)]).transpose(1, 2, 0)


def test_derivatives_are_numbers_where_numpys_choice_gives_none(tyre, jax):
    """Zero spin, turn slip alone, a standing wheel, a wheel in the air: the root or the arc cosine not chosen has no slope."""
    rows = np.array([[1400.0, 0.0, 0.0, 0.0, 0.0, 10.0, 2.5e5]] * 4).T
    rows[4, 1], rows[5, 2], rows[0, 3] = -0.2, 0.0, -1.0
    outputs = tir.Forces._fields
    found = slopes(jax, tyre.array_function(jax.numpy, turn_slip=True), rows)
    assert np.all(np.isfinite(found))
    casadi = pytest.importorskip("casadi")
    wanted = of_casadi(casadi, tyre, outputs, rows)
    np.testing.assert_allclose(found[..., :3], wanted[..., :3], rtol=1e-9, atol=1e-6)


def test_the_corner_of_the_page_is_taken_at_the_limit(jax, tmp_path, monkeypatch):
    tyre = tir.read(VECTORS.parents[2] / "samples" / "front-120-70" / "true.tir")
    tyre.write(tmp_path / "front.tir")
    monkeypatch.chdir(tmp_path)
    (text,) = (
        block
        for block in re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
        if "jax" in block
    )
    names: dict = {}
    exec(compile(text, str(PAGE), "exec"), names)
    assert np.max(np.abs(names["missing"])) < 0.02
    v, curvature, tightest = names["v"], names["curvature"], int(np.argmin(names["v"]))
    assert abs(curvature[tightest] / np.max(curvature) - 1.0) < 0.05
    friction = tyre.state(1400.0).mu_y
    assert 0.8 * friction < v[tightest] ** 2 * curvature[tightest] / 9.81 < 1.1 * friction
    assert v[0] > 1.2 * v[tightest] < v[-1]


def test_in_torch_it_is_the_tyre_with_derivatives(tyre):
    torch = pytest.importorskip("torch")
    rows = [torch.tensor(x, requires_grad=True) for x in conditions()]
    found = tyre.array_function(torch, turn_slip=True)(*rows)
    assert_near([x.detach().numpy() for x in found], tyre(*conditions(), turn_slip=True))
    found.Fy.sum().backward()
    assert all(bool(torch.isfinite(x.grad).all()) for x in rows[:4])
    ordinary = conditions()
    at = traced(dict(zip(INPUTS, ordinary, strict=True)))
    (Fy,) = outputs_of(("Fy",), tyre.p, at, turn_slip=True)
    assert_near([x.grad.numpy() for x in rows[1:4]], gradient(Fy, [*at.values()])[:, 1:4].T)
