"""The contact's lag against the solution on paper, the steady state, and what a spring does."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tir
from tir.equations import contact as equations
from tir.parameters import TABLE
from tir.transient import Contact, step

TYRE = tir.read(Path(__file__).parent / "vectors" / "MagicFormula61.tir")
SHIFTS = ("PHX1", "PHX2", "PVX1", "PVX2")
"""By which the slope of Fx at no slip is not K_xk."""
SYMMETRIC = TYRE.replace(**{row.name: 0.0 for row in TABLE if "odd" in row.symmetry or row.name in SHIFTS})
Fz = 5000.0
pytestmark = pytest.mark.filterwarnings("ignore:turn slip is on")
"""The public files have the common defaults of turn slip."""


def sigma(Vx: float) -> tuple[float, float]:
    state = TYRE.state(Fz, Vx=Vx)
    return state.sigma_x, state.sigma_y


@pytest.mark.parametrize("Vx", [15.0, 0.5, -8.0])
@pytest.mark.parametrize("dt", [1e-3, 0.05])
def test_a_step_of_sideslip_is_followed_as_on_paper(Vx, dt):
    """v = sigma tan(alpha) (1 - exp(-|Vx| t / sigma)), whatever the length of the steps."""
    Vsy, contact, n = 0.05, Contact(), 40
    length = sigma(Vx)[1]
    assert length > 0.1
    for i in range(1, n + 1):
        contact, _ = step(TYRE, contact, dt, Fz, Vx, Vsy=Vsy)
        path = abs(Vx) * i * dt
        assert contact.v == pytest.approx(length * Vsy / abs(Vx) * (1.0 - np.exp(-path / length)), rel=1e-10)


@pytest.mark.parametrize(
    ("Vx", "kappa", "alpha"),
    [(20.0, 0.0, 0.05), (20.0, 0.08, 0.0), (3.0, -0.2, -0.3), (-10.0, 0.05, 0.1), (-10.0, -0.1, 0.0)],
)
def test_it_settles_where_the_steady_state_is(Vx, kappa, alpha):
    contact, gamma, phi_t = Contact(0.01, -0.02), 0.05, -0.01
    for _ in range(60):
        contact, forces = step(
            TYRE, contact, 1.0, Fz, Vx, -kappa * Vx, Vx * np.tan(alpha), gamma, phi_t
        )  # fmt: skip
    for found, right in zip(forces, TYRE(Fz, alpha, gamma, kappa, phi_t, Vx), strict=True):
        assert found == pytest.approx(right, rel=1e-9, abs=1e-6)


def test_at_standstill_the_contact_is_a_spring_of_the_files_stiffness():
    """Carcass stiffness at load and pressure as the file has it: A8, A9."""
    dfz = Fz / TYRE["FNOMIN"] - 1.0
    lateral = TYRE["LATERAL_STIFFNESS"] * (1 + TYRE["PCFY1"] * dfz + TYRE["PCFY2"] * dfz**2)
    longitudinal = TYRE["LONGITUDINAL_STIFFNESS"] * (1 + TYRE["PCFX1"] * dfz + TYRE["PCFX2"] * dfz**2)
    small = 1e-6
    rest = step(SYMMETRIC, Contact(), 1.0, Fz, 0.0)[1]
    contact, forces = step(SYMMETRIC, Contact(), small, Fz, 0.0, -1.0, 1.0)
    assert contact == pytest.approx((small, small), rel=1e-12)
    assert (forces.Fy - rest.Fy) / small == pytest.approx(-lateral, rel=1e-3)
    assert (forces.Fx - rest.Fx) / small == pytest.approx(longitudinal, rel=1e-3)


def test_pushed_for_an_hour_at_standstill_the_contact_slides_and_springs_back():
    contact, forces = step(TYRE, Contact(), 3600.0, Fz, 0.0, Vsy=1.0)
    assert -1.2 * TYRE.state(Fz).mu_y * Fz < forces.Fy < -0.7 * TYRE.state(Fz).mu_y * Fz
    reach = contact.v
    assert 0.005 < reach < 0.3, "a carcass gives by centimetres"
    contact, forces = step(TYRE, contact, 1.0, Fz, 0.0, Vsy=-reach)
    assert contact.v == pytest.approx(0.0, abs=1e-12)
    assert abs(forces.Fy) < 0.05 * Fz


@pytest.mark.parametrize("speed", [0.0, 1e-300, 1e-12, -1e-12])
def test_nothing_is_divided_by_a_speed(speed):
    contact = Contact()
    for _ in range(5):
        contact, forces = step(TYRE, contact, 0.01, Fz, speed, -0.1, 0.2)
    assert contact == pytest.approx((0.005, 0.01), rel=1e-6)
    assert all(np.isfinite(forces))


def test_reversing_is_smooth():
    """Back and forth through standstill with the wheel turned in: force without a leap, and finite."""
    dt, contact, found = 2e-3, Contact(), []
    for t in np.arange(0.0, 4.0, dt):
        Vx = 2.0 * np.cos(np.pi * t)
        contact, forces = step(SYMMETRIC, contact, dt, Fz, Vx, Vsy=0.1 * Vx)
        found.append(forces.Fy)
    found = np.array(found)
    assert np.all(np.isfinite(found))
    assert np.ptp(found) > 0.5 * Fz
    # the force changes by no more than the spring does at the greatest slip speed
    assert np.max(np.abs(np.diff(found))) < 1.2 * TYRE["LATERAL_STIFFNESS"] * 0.2 * dt


def test_the_longest_step_is_stable():
    contact, forces = step(TYRE, Contact(1.0, -1.0), 1e9, Fz, 30.0, Vsy=1.5)
    assert contact.v == pytest.approx(sigma(30.0)[1] * 0.05, rel=1e-12)
    assert forces.Fy == pytest.approx(TYRE(Fz, np.arctan(0.05), Vx=30.0).Fy, rel=1e-9)


def test_without_load_the_contact_is_lost():
    contact, forces = step(TYRE, Contact(0.03, 0.02), 0.01, 0.0, 0.0, 1.0, 1.0)
    assert contact == Contact(0.0, 0.0)
    assert (forces.Fx, forces.Fy, forces.Mz) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(("damping", "left"), [(0.0, (0.9, 1.1)), (4000.0, (0.0, 0.05))])
def test_a_mass_on_a_standing_wheel_rocks_and_damping_stops_it(damping, left):
    """Explicit steps: velocity by the old force, deflection by the new velocity. 500 kg on the carcass rock at some 2 to 4 Hz."""
    mass, dt, speed, contact, force = 500.0, 1e-3, 0.02, Contact(), 0.0
    rest = step(SYMMETRIC, contact, dt, Fz, 0.0)[1].Fy
    peaks = []
    for _ in range(4000):
        speed += dt * force / mass
        contact, forces = step(SYMMETRIC, contact, dt, Fz, 0.0, Vsy=speed, damping=damping)
        force = forces.Fy - rest
        peaks.append(abs(speed))
    assert left[0] < max(peaks[-500:]) / 0.02 < left[1]


def test_arrays_are_many_wheels():
    loads, speeds, slip = (
        np.array([0.0, 3000.0, 5000.0]),
        np.array([0.0, -2.0, 20.0]),
        np.array([0.1, 0.2, -0.5]),
    )
    contact = Contact(np.array([0.0, 0.01, -0.01]), np.zeros(3))
    after, forces = step(TYRE, contact, 0.02, loads, speeds, 0.3 * slip, slip, damping=100.0)
    for i in range(3):
        one = Contact(float(contact.u[i]), 0.0)
        single, alone = step(
            TYRE,
            one,
            0.02,
            float(loads[i]),
            float(speeds[i]),
            float(0.3 * slip[i]),
            float(slip[i]),
            damping=100.0,
        )
        assert type(single.u) is float and type(alone.Fy) is float  # noqa: PT018
        assert (after.u[i], after.v[i]) == pytest.approx(tuple(single), rel=1e-12)
        assert [f[i] for f in forces] == pytest.approx(list(alone), rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("Vx", [20.0, -10.0, 0.2])
def test_an_endless_step_ends_in_the_steady_state(Vx):
    kappa, alpha = 0.02, -0.03
    contact, forces = step(TYRE, Contact(0.01, -0.02), np.inf, Fz, Vx, -kappa * Vx, Vx * np.tan(alpha))
    assert np.all(np.isfinite(contact))
    for found, right in zip(forces, TYRE(Fz, alpha, 0.0, kappa, Vx=Vx), strict=True):
        assert found == pytest.approx(right, rel=1e-9, abs=1e-6)


def test_an_endless_step_at_standstill_slides_only_where_pushed():
    kept, _ = step(TYRE, Contact(1e-4, -1e-4), np.inf, Fz, 0.0)
    assert kept == (1e-4, -1e-4)
    far = step(TYRE, Contact(), 1e3, Fz, 0.0, Vsy=0.1)[0]
    endless = step(TYRE, Contact(), np.inf, Fz, 0.0, Vsy=0.1)[0]
    assert endless == far
    assert endless.v > 0.0


@pytest.mark.parametrize("Vx", [0.0, 10.0])
@pytest.mark.parametrize("damping", [0.0, 500.0])
def test_a_tyre_without_cornering_stiffness_has_no_deflection_sideways(Vx, damping):
    loose = SYMMETRIC.replace(PKY1=0.0)
    contact, forces = step(loose, Contact(0.0, 0.01), 0.1, Fz, Vx, Vsy=0.5, damping=damping)
    assert contact == (0.0, 0.0)
    assert np.all(np.isfinite(forces))


def test_a_load_of_nan_is_not_taken_for_no_load():
    contact, forces = step(TYRE, Contact(0.01, 0.01), 0.01, np.array([np.nan, Fz, 0.0]), 10.0)
    assert np.isnan(contact.u[0])
    assert np.isnan(contact.v[0])
    assert np.isnan(forces.Fy[0])
    assert np.isfinite(contact.v[1])
    assert contact.v[2] == 0.0


def test_the_contact_slides_where_no_bristle_of_a_parabolic_brush_sticks():
    """A bristle sticks while its stretch under slip asks for less than friction times pressure, from the leading edge on."""
    half, per_length, mu = 0.06, 9e5, 0.9
    behind_edge = np.linspace(1e-6, 2.0 * half, 20_001)
    pressure = 0.75 * Fz / half * (1.0 - (1.0 - behind_edge / half) ** 2)

    def sticks(slip):
        return np.any(per_length * behind_edge * slip < mu * pressure)

    stiffness, length = 2.0 * per_length * half**2, 0.4
    slip = equations.sliding(length, mu, Fz, stiffness) / length
    assert sticks(0.999 * slip)
    assert not sticks(1.001 * slip)
    _, forces = step(TYRE, Contact(), 3600.0, Fz, 0.0, Vsx=-1.0)
    state = TYRE.state(Fz)
    assert step(TYRE, Contact(), 3600.0, Fz, 0.0, Vsx=-1.0)[0].u == pytest.approx(
        state.sigma_x * 3.0 * state.mu_x * Fz / state.K_xk, rel=1e-9
    )
    assert forces.Fx > 0.0


def test_the_damping_of_a_stop_fades_out_as_smoothly_at_its_end_as_it_begins():
    """Half is left at half the speed, nothing at VXLOW, and neither end has a kink: mirrored about the middle."""
    low = 2.0
    speeds = np.linspace(0.0, low, 41)
    left = equations.fading(speeds, low)
    assert left[0] == pytest.approx(1.0)
    assert left + left[::-1] == pytest.approx(np.ones(41))
    assert abs(left[-1] - left[-2]) < 0.01
    assert equations.fading(-speeds, low) == pytest.approx(left)
