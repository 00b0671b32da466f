"""The evaluator against published programs' numbers; sources in vectors/README.md."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tir

VECTORS = Path(__file__).parent / "vectors"
TIGHT, LOOSE = 1e-7, 5e-5
STATE_NAMES = {"Kya": "K_ya", "Kxk": "K_xk", "t": "trail", "Shyphi": "S_Hyphi", "Mzr": "residual_torque"}


def table(name: str) -> np.ndarray:
    """The rows of a CSV file, with its headings as the names of the fields."""
    return np.genfromtxt(VECTORS / f"{name}.csv", delimiter=",", names=True, encoding="ascii")


def assert_agree(got, rows: np.ndarray, column: str, tolerance: float) -> None:
    """Relative to the value, or to 1e-3 of the column's largest where the value is smaller."""
    want = rows[column]
    scale = np.maximum(np.abs(want), 1e-3 * np.abs(want).max())
    error = np.abs(np.broadcast_to(got, want.shape) - want) / scale
    assert error.max() < tolerance, f"{column}: {error.max():.2g} in row {error.argmax()}"


@pytest.mark.parametrize("name", ["MagicFormula61", "MagicFormula62", "moto_front"])
@pytest.mark.parametrize("mode", [211, 111])
def test_forces_and_state_equal_mfeval_without_turn_slip(name, mode):
    tyre = tir.read(VECTORS / f"{name}.tir")
    rows = table(f"mfeval_{name}")
    rows = rows[rows["mode"] == mode]
    inputs = [rows[c] for c in ("Fz", "alpha", "gamma", "kappa")]
    condition = dict(Vx=rows["Vx"], p=rows["p"], limits=mode == 111)
    forces, state = tyre(*inputs, **condition), tyre.state(*inputs, **condition)
    for column in ("Fx", "Fy", "Mx", "My"):
        assert_agree(getattr(forces, column), rows, column, TIGHT)
    assert_agree(forces.Mz, rows, "Mz", LOOSE)
    for column in ("Kya", "Kxk", "sigma_x", "sigma_y", "Re"):
        assert_agree(getattr(state, STATE_NAMES.get(column, column)), rows, column, TIGHT)


def test_turn_slip_equals_the_independent_implementation():
    tyre = tir.read(VECTORS / "moto_front.tir")
    rows = table("spin_moto_front")
    inputs = [rows[c] for c in ("Fz", "alpha", "gamma", "kappa", "phit", "Vx", "p")]
    forces, state = tyre(*inputs), tyre.state(*inputs)
    for column in ("Fx", "Fy", "Mx", "My", "Mz"):
        assert_agree(getattr(forces, column), rows, column, LOOSE)
    columns = ["Kya", "Kxk", "sigma_x", "sigma_y", "Re", "omega", "phi", "Shyphi", "t", "Mzr"] + [
        f"zeta{i}" for i in range(1, 9)
    ]
    for column in columns:
        assert_agree(getattr(state, STATE_NAMES.get(column, column)), rows, column, LOOSE)


@pytest.mark.parametrize("PKYP1", [0.0, 0.72])
def test_even_quantities_equal_mfeval_with_turn_slip(PKYP1):
    tyre = tir.read(VECTORS / "moto_front.tir").replace(PKYP1=PKYP1)
    rows = table("mfeval212_moto_front")
    rows = rows[rows["PKYP1"] == PKYP1]
    assert len(rows) >= 30
    Fz, alpha, gamma, kappa, phit, Vx, p = (
        rows[c] for c in ("Fz", "alpha", "gamma", "kappa", "phit", "Vx", "p")
    )
    state = tyre.state(Fz, alpha, gamma, kappa, -phit, Vx, p)
    assert_agree(tyre(Fz, alpha, gamma, kappa, -phit, Vx, p).Fx, rows, "Fx", TIGHT)
    assert_agree(state.K_ya, rows, "Kya", TIGHT)
    assert_agree(state.trail, rows, "t", LOOSE)
    if PKYP1 == 0.0:
        assert_agree(tyre(Fz, alpha, gamma, kappa, phit, Vx, p).Fy, rows, "Fy", TIGHT)


def test_turn_slip_moment_equals_a_modified_mfeval():
    tyre = tir.read(VECTORS / "moto_front.tir").replace(PKYP1=0.0)
    rows = table("nk212_moto_front")
    inputs = [rows[c] for c in ("Fz", "alpha", "gamma", "kappa")]
    forces = tyre(*inputs, -rows["phit"], rows["Vx"], rows["p"])
    for column in ("Fx", "Fy", "Mx", "My"):
        assert_agree(getattr(forces, column), rows, column, TIGHT)
    assert_agree(forces.Mz, rows, "Mz", LOOSE)
