"""Mottola and Massaro, Machines 2022, 10, 921: Tables 1 and 2, the example under (22), the misalignments of section 5.

C_gamma follows from the printed u_F by (24), r_e then from the printed eps_gamma, so only the uncertainties are an
independent check of the printed tables; the six values of eps_gamma check the bookkeeping of signs.
"""

from __future__ import annotations

import math

import pytest

from mffit.measured import DirectInputs, direct_method

R = 1.323
ROWS = [  # name, F [N], u_F [N], C_gamma [N/rad], r_e [m], eps_gamma, u
    ("front 1", 385.7, 31.4, 1851, 0.2924, -0.0609, 0.0863),
    ("front 2", 373.5, 31.6, 1895, 0.2932, -0.1245, 0.0951),
    ("front 3", 340.6, 31.2, 1806, 0.2961, -0.1870, 0.1089),
    ("rear 1", 493.7, 32.2, 2024, 0.3172, 0.0174, 0.0642),
    ("rear 2", 454.8, 31.7, 1917, 0.3159, -0.0064, 0.0702),
    ("rear 3", 488.5, 32.1, 2003, 0.3170, 0.0178, 0.0646),
]


@pytest.mark.parametrize(("name", "F", "u_F", "C_gamma", "r_e", "epsilon", "u"), ROWS)
@pytest.mark.parametrize("side", [-1, 1])
def test_tables_1_and_2(name, F, u_F, C_gamma, r_e, epsilon, u, side):
    found = direct_method(DirectInputs(F_raw=side * F, C_gamma=-C_gamma, r_e=r_e, R=R))
    assert found.F_phit.std_dev == pytest.approx(u_F, abs=0.1)
    assert found.epsilon_gamma.nominal_value == pytest.approx(epsilon, abs=0.0005)
    assert found.epsilon_gamma.std_dev == pytest.approx(u, abs=0.0003)


def test_43_newtons_are_a_tenth_of_epsilon():
    R, C_gamma, r_e = 1.4, 2000.0, 0.3
    given = DirectInputs(
        F_raw=-C_gamma * r_e / R,
        C_gamma=-C_gamma,
        r_e=r_e,
        R=R,
        u_offset=43.0,
        u_gamma_0=0.0,
        u_slip_force=0.0,
    )
    epsilon = direct_method(given).epsilon_gamma
    assert epsilon.nominal_value == pytest.approx(0.0, abs=1e-12)
    assert epsilon.std_dev == pytest.approx(0.1, abs=0.002)


@pytest.mark.parametrize(("alpha_M_deg", "printed"), [(-1.0, 0.53), (-0.5, 0.36), (0.5, -1.31), (1.0, 9.12)])
def test_misalignments_of_section_5(alpha_M_deg, printed):
    """The printed values follow from a linear shift of 337 N/deg, not from the printed -671 and +71 N (371 N/deg)."""
    r_e, R, F = 0.3, R_SECTION_5, -300.0
    C_gamma = F * R / r_e
    raw = F + 337.0 * alpha_M_deg
    epsilon = direct_method(
        DirectInputs(
            F_raw=raw,
            C_gamma=math.copysign(abs(C_gamma), -1),
            r_e=r_e,
            R=R,
            u_offset=0,
            u_gamma_0=0,
            u_slip_force=0,
        )
    ).epsilon_gamma.nominal_value
    if raw > 0:  # the force has turned round: the disc's side is that of the aligned force
        epsilon = 2.0 - epsilon
    assert 1.0 / (1.0 - epsilon) == pytest.approx(1.0 / (1.0 - printed), abs=0.05)


R_SECTION_5 = 1.323


def test_what_is_given_without_uncertainty_is_exact():
    exact = {"u_offset": 0.0, "u_gamma_0": 0.0, "u_slip_force": 0.0}
    given = DirectInputs(F_raw=-400.0, C_gamma=-2000.0, r_e=0.29, R=1.3, C_alpha=-18000.0, **exact)
    found = direct_method(given)
    assert found.epsilon_gamma.nominal_value == pytest.approx(1.0 - 0.29 * 2000.0 / (400.0 * 1.3))
    assert found.epsilon_gamma.std_dev < 1e-9


@pytest.mark.parametrize("alpha_b", [0.002, -0.002])
def test_sideslip_of_backlash_and_its_uncertainty_are_forces_by_the_cornering_stiffness(alpha_b):
    exact = {"u_offset": 0.0, "u_gamma_0": 0.0, "u_slip_force": 0.0}
    given = DirectInputs(
        F_raw=-400.0, C_gamma=-2e3, r_e=0.29, R=1.3, C_alpha=-18e3, alpha_b=alpha_b, u_alpha_b=0.001, **exact
    )
    found = direct_method(given).F_phit
    assert found.nominal_value == pytest.approx(-400.0 + 18e3 * alpha_b)
    assert found.std_dev == pytest.approx(18.0)
