"""What any tyre must do, whatever its coefficients."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tir
from tir.outputs import outputs_of
from tir.parameters import BY_NAME, TABLE
from tir.transient import Contact

VECTORS = Path(__file__).parent / "vectors"
TYRES = ["MagicFormula61", "MagicFormula62", "moto_front"]
ODD = {row.name: 0.0 for row in TABLE if row.odd}
pytestmark = pytest.mark.filterwarnings("ignore:turn slip is on")
"""The public files have the common defaults of turn slip."""


@pytest.fixture(params=TYRES)
def tyre(request) -> tir.Tyre:
    return tir.read(VECTORS / f"{request.param}.tir")


@pytest.mark.parametrize("Fz", [500.0, 1500.0, 4000.0])
def test_camber_alone_gives_the_normal_mode_times_R0_over_Re(tyre, Fz):
    """The rule that decides the signs of turn slip."""
    gamma = np.array([-1e-4, 1e-4])
    ratio = tyre["UNLOADED_RADIUS"] / tyre.state(Fz).Re
    spin, normal = tyre(Fz, gamma=gamma, turn_slip=True), tyre(Fz, gamma=gamma)
    assert np.diff(spin.Fy)[0] / np.diff(normal.Fy)[0] == pytest.approx(ratio, rel=2e-3)
    assert np.diff(spin.Mz)[0] / np.diff(normal.Mz)[0] == pytest.approx(ratio, rel=2e-3)


def test_the_rolling_radius_grows_with_the_square_of_the_speed_of_rotation(tyre):
    """To a growth of a quarter, more than any tyre's."""
    light = tyre.replace(Q_V1=0.01, DREFF=0.0, FREFF=0.0, LONGVL=15.0, Q_RE0=1.0)
    state = light.state(2000.0, Vx=np.linspace(0.0, 100.0, 21))
    R0 = light["UNLOADED_RADIUS"]
    assert state.Re / R0 == pytest.approx(1.0 + 0.01 * (R0 * state.omega / 15.0) ** 2, rel=1e-14)
    assert state.Re[-1] > 1.25 * R0


def test_without_spin_both_modes_agree(tyre):
    alpha = np.linspace(-0.2, 0.2, 9)
    spin, normal = tyre(2000.0, alpha, phi_t=0.0), tyre(2000.0, alpha)
    np.testing.assert_allclose(spin.Fy, normal.Fy, rtol=1e-12)
    np.testing.assert_allclose(spin.Mz, normal.Mz, rtol=1e-9, atol=1e-9)


def test_a_disc_pushes_the_tyre_outwards(tyre):
    symmetric = tyre.replace(**ODD)
    assert symmetric(2000.0, phi_t=-0.7).Fy < 0
    assert symmetric(2000.0, phi_t=0.7).Fy > 0


@given(
    alpha=st.floats(-0.3, 0.3),
    gamma=st.floats(-0.9, 0.9),
    phi_t=st.floats(-1.0, 1.0),
    Fz=st.floats(200.0, 4000.0),
)
def test_a_symmetric_tyre_mirrors(alpha, gamma, phi_t, Fz):
    tyre = tir.read(VECTORS / "moto_front.tir").replace(**ODD)
    a = tyre(Fz, alpha, gamma, 0.0, phi_t)
    b = tyre(Fz, -alpha, -gamma, 0.0, -phi_t)
    assert a.Fy == pytest.approx(-b.Fy, rel=1e-9, abs=1e-6)
    assert a.Mz == pytest.approx(-b.Mz, rel=1e-9, abs=1e-6)
    assert a.Fx == pytest.approx(b.Fx, rel=1e-9, abs=1e-6)


def test_rolling_backwards_flips_slip_and_ply_steer_only(tyre):
    plain = tyre.replace(**ODD)
    step = np.radians(0.2)

    def slope(Vx, **direction):
        up = plain(2000.0, Vx=Vx, **direction)
        down = plain(2000.0, Vx=Vx, **{k: -v for k, v in direction.items()})
        return up.Fy - down.Fy, up.Mz - down.Mz

    for direction, force_sign in (({"alpha": step}, -1), ({"gamma": step}, 1), ({"phi_t": 0.05}, 1)):
        forwards, backwards = slope(8.0, **direction), slope(-8.0, **direction)
        assert backwards[0] == pytest.approx(force_sign * forwards[0], rel=1e-9)
        assert backwards[1] == pytest.approx(-force_sign * forwards[1], rel=1e-9)
    ply_steer, conicity = plain.replace(PHY1=0.001), plain.replace(PVY1=0.001)
    assert ply_steer(2000.0, Vx=-8.0).Fy == pytest.approx(-ply_steer(2000.0, Vx=8.0).Fy, rel=1e-9)
    assert conicity(2000.0, Vx=-8.0).Fy == pytest.approx(conicity(2000.0, Vx=8.0).Fy, rel=1e-9)


@pytest.mark.parametrize("condition", [{}, {"limits": True}, {"phi_t": -0.5}, {"Vx": -8.0}])
def test_a_load_of_nan_gives_nan(tyre, condition):
    forces = tyre(np.array([np.nan, 2000.0, 0.0]), 0.05, 0.1, 0.01, **condition)
    alone = tyre(float("nan"), np.array([0.05, 0.02]), 0.1, 0.01, **condition)
    one = tyre(float("nan"), 0.05, 0.1, 0.01, **condition)
    for many, channel, single in zip(forces, alone, one, strict=True):
        assert np.isnan(many[0])
        assert np.isfinite(many[1])
        assert many[2] == 0.0
        assert np.all(np.isnan(channel))
        assert np.isnan(single)


@pytest.mark.parametrize("name", [row.name for row in TABLE if row.kind == "number"])
def test_a_zero_in_the_file_gives_a_number_or_a_sentence(name):
    damaged = tir.read(VECTORS / "moto_front.tir").replace(**{name: 0.0})
    for pressure in (None, 0.0):
        if BY_NAME[name].divisor:
            with pytest.raises(tir.TirError, match=f"^{name} is 0"):
                damaged(1800.0, 0.05, 0.1, 0.01, -0.5, 8.0, pressure)
        else:
            with np.errstate(all="ignore"):
                forces = damaged(1800.0, 0.05, 0.1, 0.01, -0.5, 8.0, pressure)
            assert np.shape(forces.Fy) == ()


@pytest.mark.parametrize("of", ["number", "array", "complex", "contact", "outputs", "many"])
def test_a_tyre_without_vertical_stiffness_has_its_forces(of):
    """The radius of A7 enters the forces through the spin of 4.E76 only, so that without turn slip they are the same."""
    stiff = tir.read(VECTORS / "moto_front.tir")
    alpha = {
        "array": np.linspace(-0.1, 0.1, 5),
        "many": np.linspace(-0.1, 0.1, 30_000),
        "complex": 0.05 + 1e-20j,
    }

    def forces(tyre: tir.Tyre) -> object:
        if of == "contact":
            return tir.transient.step(tyre, Contact(), 0.01, 1800.0, 8.0, 0.1, 0.3)[1]
        if of == "outputs":
            return outputs_of(("Fy", "Mz", "K_ya"), tyre.p, {"Fz": 1800.0, "alpha": 0.05})
        return tyre(1800.0, alpha.get(of, 0.05), 0.1, 0.01)

    soft = stiff.replace(VERTICAL_STIFFNESS=0.0)
    np.testing.assert_array_equal(forces(soft), forces(stiff))
    tir.transient.forces(soft, Contact(0.0, 0.01), 1800.0, 8.0)
    assert "VERTICAL_STIFFNESS" in {p.name for p in tir.check(soft) if p.level == "warning"}
    assert not [p for p in tir.check(soft) if p.level == "error"]


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (lambda tyre: tyre.state(1800.0), "of Re, omega divide"),
        (tir.export_c, "of Re, omega divide"),
        (lambda tyre: tyre(1800.0, phi_t=-0.1), "of Fx, Fy, Mx, My, Mz with turn slip divide"),
        (lambda tyre: outputs_of(("Fy", "Re"), tyre.p, {"Fz": 1800.0}), "of Re divide"),
    ],
)
def test_what_needs_the_vertical_stiffness_is_named(asked, said):
    with pytest.raises(
        tir.TirError, match=f"^VERTICAL_STIFFNESS is 0, but the equations {said} by it: give its value"
    ):
        asked(tir.read(VECTORS / "moto_front.tir").replace(VERTICAL_STIFFNESS=0.0))


def test_turn_slip_needs_the_vertical_stiffness_in_a_check():
    tyre = tir.read(VECTORS / "moto_front.tir").replace(VERTICAL_STIFFNESS=0.0, USE_MODE=225.0)
    assert "VERTICAL_STIFFNESS" in {p.name for p in tir.check(tyre) if p.level == "error"}


EXTREMES = st.sampled_from([0.0, -1.0, 1e308, -1e308, 1e200, 1e-320, float("inf"), float("nan")])
NUMBERS = [row.name for row in TABLE if row.kind == "number"]


@given(
    st.dictionaries(st.sampled_from(NUMBERS), EXTREMES, min_size=1, max_size=4),
    st.tuples(*[EXTREMES | st.floats(-10.0, 10.0)] * 7),
    st.tuples(st.booleans(), st.booleans(), st.booleans()),
)
def test_no_damage_ends_in_pythons_arithmetic(values, condition, switches):
    """A number, NaN and infinity among them, or a sentence that names the key; for floats and arrays alike."""
    damaged = tir.read(VECTORS / "moto_front.tir").replace(**values)
    asked = dict(zip(("turn_slip", "star", "limits"), switches, strict=True))
    named = set()
    with np.errstate(all="ignore"):
        for given_as in (condition, [np.array([x, x]) for x in condition]):
            for ask in (damaged, damaged.state):
                try:
                    found = ask(*given_as, **asked)
                except tir.TirError as error:
                    named.add(error.name)
                else:
                    assert all(np.asarray(x).dtype.kind == "f" for x in found)
    assert named <= values.keys()


def test_a_flat_tyre_is_the_same_for_scalars_and_arrays(tyre):
    soft = tyre.replace(QSY8=-0.4)
    assert soft(1800.0, p=0.0).My == pytest.approx(soft(1800.0, p=np.zeros(1)).My[0], rel=1e-12)


def test_forces_vanish_continuously_with_load(tyre):
    load = np.array([-10.0, 0.0, 1e-9, 1e-6, 1e-3, 1.0])
    for limits in (False, True):
        for phi_t in (None, -0.7):
            forces = tyre(load, 0.05, 0.1, 0.01, phi_t, limits=limits)
            for channel in (forces.Fx, forces.Fy, forces.Mx, forces.My):
                assert np.all(np.isfinite(channel))
                assert np.all(channel[:2] == 0.0)
                assert np.all(np.abs(channel[2:4]) < 1e-2)
            assert np.all(np.isfinite(forces.Mz))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_standstill_is_the_limit_of_slow_rolling(tyre, sign):
    for phi_t in (None, -0.7):
        slow = tyre(2000.0, 0.03, 0.2, 0.0, phi_t, Vx=sign * 1e-9)
        rest = tyre(2000.0, 0.03, 0.2, 0.0, phi_t, Vx=sign * 1e-300)
        np.testing.assert_allclose(np.array(slow), np.array(rest), rtol=1e-6, atol=1e-6)
        assert np.all(np.isfinite(np.array(tyre(2000.0, 0.03, 0.2, 0.0, phi_t, Vx=0.0))))


def test_complex_step_equals_differences(tyre):
    p, h = tyre.p, 1e-20
    from tir.evaluate import evaluate

    condition = dict(gamma=0.3, kappa=0.02, phi_t=-0.6, turn_slip=True)
    step = evaluate(p, 1800.0, 0.04 + 1j * h, **condition)[0]
    up, down = (evaluate(p, 1800.0, 0.04 + s, **condition)[0] for s in (1e-6, -1e-6))
    for exact, high, low in zip(step, up, down, strict=True):
        assert np.imag(exact) / h == pytest.approx((high - low) / 2e-6, rel=1e-5, abs=1e-3)
    assert abs(np.imag(step.Fy) / h) > 1000


def test_scalars_and_arrays_agree(tyre):
    alpha = np.linspace(-0.1, 0.1, 5)
    many = tyre(1500.0, alpha, 0.2, 0.01, -0.5)
    for i, a in enumerate(alpha):
        one = tyre(1500.0, float(a), 0.2, 0.01, -0.5)
        assert float(one.Fy) == pytest.approx(many.Fy[i], rel=1e-12)
        assert float(one.Mz) == pytest.approx(many.Mz[i], rel=1e-12)


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_a_wheel_that_turns_on_the_spot_has_the_moment_of_its_name(way):
    """Its turn slip is infinite, its side force 0, and its moment M_zphi_infinity of 4.E95."""
    tyre = tir.read(VECTORS / "moto_front.tir")
    out = tyre(1800.0, phi_t=np.array([way * np.inf, way * 1e9]))
    mu_y = abs(tyre.state(1800.0).mu_y)
    most = tyre["QCRP1"] * mu_y * tyre["UNLOADED_RADIUS"] * 1800.0 * np.sqrt(1800.0 / tyre["FNOMIN"])
    assert out.Fy == pytest.approx(0.0, abs=1e-3)
    assert np.abs(out.Mz) == pytest.approx(most, rel=1e-3)
    assert tyre(1800.0, phi_t=way * np.inf).Mz == pytest.approx(out.Mz[0])
