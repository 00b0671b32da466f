"""The equations as text: each formula stands once, and nothing but elementary functions is called."""

from __future__ import annotations

import ast
import builtins
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import tir
from tir.checking import check
from tir.equations import aligning, lateral, normalise
from tir.parameters import TABLE

MODULES = sorted((Path(tir.__file__).parent / "equations").glob("*.py"))
TWICE = {"QCZ1": "the shape of the trail and of its curvature's side"} | dict.fromkeys(
    ("QDZ8", "QDZ9", "QDZ10", "QDZ11"), "residual torque, and its stiffness without pressure"
)


def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.name)
def test_only_elementary_functions_are_called(path):
    """What a compiler or a tape of derivatives has to know is elementary.py alone."""
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Import):
            assert path.name == "elementary.py", f"line {node.lineno} imports {ast.unparse(node)}"
        elif isinstance(node, ast.ImportFrom):
            assert str(node.module).startswith(("tir.equations", "typing", "__future__")), ast.unparse(node)
        elif isinstance(node, ast.Call):
            called = ast.unparse(node.func)
            assert called == "range" or not hasattr(builtins, called), f"line {node.lineno} calls {called}"


def test_every_coefficient_enters_one_formula_only():
    """A formula written again somewhere would use its coefficients again."""
    used = Counter(n.attr for path in MODULES for n in ast.walk(tree(path)) if isinstance(n, ast.Attribute))
    coefficients = [r.name for r in TABLE if r.section.endswith("COEFFICIENTS") and not r.scaling]
    assert {name for name in coefficients if used[name] != 1} == set(TWICE)


@pytest.fixture
def tyre() -> tir.Tyre:
    return tir.read(Path(__file__).parent / "vectors" / "moto_front.tir").replace(
        PVY1=0.02, PVY3=0.3, PEY3=0.1
    )


def condition(tyre, gamma=0.2, Fz=1800.0):
    return normalise.inputs(tyre.p, normalise.OperatingCondition(Fz, 0.05, gamma, pressure=250e3))


def test_vertical_shift_is_that_of_the_state(tyre):
    q = condition(tyre)
    assert lateral.vertical_shift(tyre.p, q, q.gamma) == tyre.state(1800.0, 0.05, 0.2).S_Vy
    upright = lateral.vertical_shift(tyre.p, q, 0.0)
    assert lateral.camber_force(tyre.p, q, q.gamma) == pytest.approx(
        tyre.state(1800.0, 0.05, 0.2).S_Vy - upright, rel=1e-12
    )


def test_zeta4_takes_the_camber_part_of_the_shift_only(tyre):
    """4.E84 by its printed form, from the state's other fields."""
    state = tyre.state(1800.0, 0.05, 0.2, phi_t=-0.5)
    conicity = 1800.0 * (tyre["PVY1"] + tyre["PVY2"] * (1800.0 / tyre["FNOMIN"] - 1.0)) * state.zeta2
    camber_part = state.S_Vy - conicity
    assert state.zeta4 == pytest.approx(1.0 + state.S_Hyphi - camber_part / state.K_ya, rel=1e-12)


def test_trail_at_zero_is_the_trail_where_slip_and_shift_are_zero(tyre):
    plain = tyre.replace(QHZ1=0.0, QHZ2=0.0, QHZ3=0.0, QHZ4=0.0)
    q = condition(plain)
    amplitude = aligning.trail_at_zero(plain.p, q) * plain["UNLOADED_RADIUS"] * 1800.0 / plain["FNOMIN"]
    assert plain.state(1800.0, 0.0, 0.2).trail == pytest.approx(amplitude, rel=1e-12)


def test_eps_gamma_over_load_is_that_of_the_state(tyre):
    load = np.linspace(500.0, 2500.0, 5)
    eps = normalise.camber_reduction(tyre.p, normalise.relative_load(tyre.p, load))
    np.testing.assert_array_equal(eps, tyre.state(load).eps_gamma)


def test_the_check_scales_the_curvature_as_the_force_does(tyre):
    """E_y of the check is that of the equations, its scaling factor included."""
    bent = tyre.replace(PEY1=1.5, PEY2=0.0, PEY3=0.0, PEY4=0.0, PEY5=0.0)
    assert any("reaches 1.50" in p.sentence for p in check(bent))
    assert not any("E_y" in p.sentence for p in check(bent.replace(LEY=0.5)))
