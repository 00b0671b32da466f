"""The single-track example against the understeer gradient and linear theory with four states."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

import tir

FILE = Path(__file__).parents[1] / "tir" / "vectors" / "MagicFormula61.tir"
SMALL = 1e-4
Vx = 25.0


@pytest.fixture(scope="module")
def case(example):
    module = example("step_steer")
    tyre = tir.read(FILE)
    return module, module.Car(tyre, tyre.replace(LKY=1.15))


@pytest.mark.parametrize("lag", [True, False])
def test_the_steady_yaw_rate_is_that_of_the_understeer_gradient(case, lag):
    """r = V delta / (L + K V^2), K = m/L (b/Cf - a/Cr); the axle stiffnesses are twice the K_ya (4.E25) of the file."""
    module, car = case
    Cf, Cr = (-2.0 * t.state(Fz, Vx=Vx).K_ya for t, Fz in zip((car.front, car.rear), car.loads, strict=True))
    L = car.a + car.b
    K = car.mass / L * (car.b / Cf - car.a / Cr)
    assert K > 1e-4
    # the shift terms of the file change the slope of a mirrored pair by some tenths of a per cent
    assert module.understeer_gradient(car, Vx) == pytest.approx(K, abs=0.01 * car.mass / L * car.b / Cf)
    found = module.simulate(car, Vx, SMALL, 1.0, lag=lag, dt=2e-3)["yaw_rate"][-1]
    K = module.understeer_gradient(car, Vx)
    assert found == pytest.approx(Vx * SMALL / (L + K * Vx**2), rel=1e-4)


def test_the_transient_agrees_with_linear_theory(case):
    """Linear system of lateral speed, yaw rate and two lagging slips, solved with the matrix exponential."""
    module, car = case
    Cf, Cr = module.axle_stiffnesses(car, Vx)
    sf, sr = (t.state(Fz, Vx=Vx).sigma_y for t, Fz in zip((car.front, car.rear), car.loads, strict=True))
    m, J, a, b = car.mass, car.inertia, car.a, car.b
    A = np.array(
        [
            [0.0, -Vx, -Cf / m, -Cr / m],
            [0.0, 0.0, -a * Cf / J, b * Cr / J],
            [1 / sf, a / sf, -Vx / sf, 0.0],
            [1 / sr, -b / sr, 0.0, -Vx / sr],
        ]
    )
    B = np.array([0.0, 0.0, -Vx / sf, 0.0]) * SMALL
    run = module.simulate(car, Vx, SMALL, 0.3, dt=5e-4)
    steady = -np.linalg.solve(A, B)
    for t in (0.01, 0.05, 0.1, 0.2):
        exact = steady - expm(A * t) @ steady
        i = int(np.argmin(np.abs(run["t"] - t)))
        assert run["yaw_rate"][i] == pytest.approx(exact[1], abs=0.01 * steady[1])
        assert run["sideslip"][i] == pytest.approx(exact[0] / Vx, abs=0.01 * np.max(np.abs(run["sideslip"])))


def test_with_lag_the_force_starts_at_zero(case):
    module, car = case
    with_lag, without = (module.simulate(car, Vx, 0.02, 0.05, lag=on, dt=1e-4) for on in (True, False))
    assert without["ay"][0] > 20.0 * with_lag["ay"][0]
    assert with_lag["ay"][-1] > 0.8 * without["ay"][-1]


def test_the_radius_of_a_neutral_car_is_wheelbase_over_steering_angle(case):
    """With equal sideslip of both axles K = 0, and the radius is L/delta at any speed."""
    module, car = case
    even = replace(car, front=car.front, rear=car.front, a=1.35, b=1.35)
    assert module.understeer_gradient(even, Vx) == pytest.approx(0.0, abs=1e-12)
    assert module.simulate(even, Vx, SMALL, 1.0, dt=2e-3)["yaw_rate"][-1] == pytest.approx(
        Vx * SMALL / 2.7, rel=1e-5
    )


def test_the_command_on_the_page_runs(run, tmp_path):
    out = run("step_steer", FILE, "--picture", tmp_path / "a.png")
    assert "understeer gradient" in out
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
