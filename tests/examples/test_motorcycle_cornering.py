"""The motorcycle example: equilibrium, limit of a point mass, symmetry, influence of the camber reduction factor."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tir
from tir.parameters import TABLE

SAMPLES = Path(__file__).parents[2] / "samples"
FRONT, REAR = SAMPLES / "front-120-70" / "true.tir", SAMPLES / "rear-190-55" / "true.tir"
LEAN = math.radians(45.0)
ODD = {row.name: 0.0 for row in TABLE if "odd" in row.symmetry}


@pytest.fixture(scope="module")
def case(example):
    module = example("motorcycle_cornering")
    return module, module.Motorcycle(tir.read(FRONT), tir.read(REAR))


@pytest.fixture(scope="module")
def corners(case):
    module, machine = case
    default = module.with_factor(machine, module.DEFAULT, module.DEFAULT)
    return module.corner(machine, 20.0, LEAN), module.corner(default, 20.0, LEAN)


def test_forces_and_moments_are_in_equilibrium(case, corners):
    _, machine = case
    for corner in corners:
        assert np.max(np.abs(corner.residuals)) < 1e-6
        assert sum(corner.loads) == pytest.approx(machine.mass * 9.81, rel=0.02)


def test_the_assumed_factor_changes_torque_and_sideslip(corners):
    """Lean and speed are equal, so the side force is; sideslip compensates for the other factor."""
    measured, default = corners
    assert default.yaw_rate == pytest.approx(measured.yaw_rate, rel=0.01)
    assert abs(default.torque / measured.torque - 1.0) > 0.02
    assert math.degrees(default.sideslip[0] - measured.sideslip[0]) > 0.1


def test_the_change_of_front_sideslip_is_lost_force_over_stiffness(case, corners):
    """The change of sideslip is the change of side force at equal sideslip divided by the cornering stiffness there."""
    module, machine = case
    measured, default = corners
    Vx, load, gamma = 20.0, measured.loads[0], -LEAN
    condition = dict(gamma=gamma, phi_t=-measured.yaw_rate / Vx, Vx=Vx)
    assumed = machine.front.replace(PECP1=module.DEFAULT)
    alpha = measured.sideslip[0]
    force = assumed(load, alpha, **condition).Fy - machine.front(load, alpha, **condition).Fy
    stiffness = (
        assumed(load, alpha + 1e-4, **condition).Fy - assumed(load, alpha - 1e-4, **condition).Fy
    ) / 2e-4
    assert default.sideslip[0] - alpha == pytest.approx(-force / stiffness, rel=0.15)


def test_without_tyre_width_and_wheel_spin_it_leans_like_a_point_mass(case):
    """tan(lean) = a / g, with a the acceleration of the centre of gravity, which is on a smaller radius than the tyres."""
    module, machine = case
    flat = dict.fromkeys(
        ("QSX1", "QSX2", "QSX3", "QSX4", "QSX9", "QSX10", "QSX12", "QSX13", "QSX14", "QDZ8", "QDZ9"), 0.0
    )
    point = replace(
        machine, front=machine.front.replace(**flat), rear=machine.rear.replace(**flat), crowns=(0.0, 0.0),
        spins=(0.0, 0.0), inertia=(0.0, 0.0, 0.0), trail=0.0,
    )  # fmt: skip
    for lean in (0.2, LEAN):
        corner = module.corner(point, 20.0, lean)
        inwards = corner.yaw_rate * (20.0 - corner.yaw_rate * point.h * math.sin(lean))
        assert math.tan(lean) == pytest.approx(inwards / 9.81, rel=2e-3)


def test_tyre_width_and_spinning_wheels_require_more_lean(case):
    """On a wide tyre the contact moves inwards, and gyroscopic moments act outwards: less acceleration at equal lean."""
    module, machine = case
    thin = replace(machine, crowns=(0.0, 0.0))
    light = replace(machine, spins=(0.0, 0.0))
    yaw_rate = module.corner(machine, 20.0, LEAN).yaw_rate
    assert module.corner(thin, 20.0, LEAN).yaw_rate > 1.05 * yaw_rate
    assert module.corner(light, 20.0, LEAN).yaw_rate > 1.005 * yaw_rate


def test_a_right_hand_corner_mirrors_a_left_hand_one(case):
    module, machine = case
    even = replace(machine, front=machine.front.replace(**ODD), rear=machine.rear.replace(**ODD))
    left, right = module.corner(even, 15.0, LEAN), module.corner(even, 15.0, -LEAN)
    assert right.torque == pytest.approx(-left.torque, rel=1e-6)
    assert right.sideslip == pytest.approx(tuple(-a for a in left.sideslip), rel=1e-6)
    assert right.steer == pytest.approx(-left.steer, rel=1e-6)


def test_the_command_on_the_page_runs(run, tmp_path):
    out = run("motorcycle_cornering", FRONT, REAR, "--picture", tmp_path / "a.png")
    assert len(out.splitlines()) == 7
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
