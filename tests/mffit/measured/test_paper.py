"""Mottola and Massaro, Machines 2022, 10, 921: Tables 1 and 2, the example under (22), the misalignments of section 5.

C_gamma follows from the printed u_F by (24), r_e then from the printed eps_gamma, so only the uncertainties are an
independent check of the printed tables; the six values of eps_gamma check the bookkeeping of signs.
"""

from __future__ import annotations

import math

import pytest
from uncertainties import UFloat

from mffit.measured.camber_reduction import camber_reduction, turn_slip_force, uncertain_rig
from mffit.measured.uncertain import named
from mffit.rig_errors import AtZero

R = 1.323
DECLARED = {"F0_N": 10.0, "gamma_0_deg": 0.5, "alpha_0_deg": 25.0}


def direct_method(F, C_gamma, r_e, R=R, C_alpha=0.0, alpha_b=0.0, **u) -> tuple[UFloat, UFloat]:
    """Turn-slip force [N] and eps_gamma of exact readings, with these uncertainties of the rig."""
    rig = uncertain_rig(u, named(R, 0.0, "path radius", "m"))
    at = AtZero(C_alpha, C_gamma, math.copysign(1.0, alpha_b))
    raw = named(F - C_alpha * alpha_b, 0.0, "noise of the zeros", "N")
    force = turn_slip_force(raw, rig.errors, at, both_directions=False)
    C_phit = math.copysign(1.0, F) * force * rig.R
    return force, camber_reduction(C_phit, C_gamma, r_e)


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
    force, found = direct_method(side * F, -C_gamma, r_e, **DECLARED)
    assert force.std_dev == pytest.approx(u_F, abs=0.1)
    assert found.nominal_value == pytest.approx(epsilon, abs=0.0005)
    assert found.std_dev == pytest.approx(u, abs=0.0003)


def test_43_newtons_are_a_tenth_of_epsilon():
    R, C_gamma, r_e = 1.4, 2000.0, 0.3
    _, epsilon = direct_method(-C_gamma * r_e / R, -C_gamma, r_e, R, F0_N=43.0)
    assert epsilon.nominal_value == pytest.approx(0.0, abs=1e-12)
    assert epsilon.std_dev == pytest.approx(0.1, abs=0.002)


@pytest.mark.parametrize(("alpha_M_deg", "printed"), [(-1.0, 0.53), (-0.5, 0.36), (0.5, -1.31), (1.0, 9.12)])
def test_misalignments_of_section_5(alpha_M_deg, printed):
    """The printed values follow from a linear shift of 337 N/deg, not from the printed -671 and +71 N (371 N/deg)."""
    r_e, F = 0.3, -300.0
    raw = F + 337.0 * alpha_M_deg
    epsilon = direct_method(raw, F * R / r_e, r_e)[1].nominal_value
    if raw > 0:  # the force has turned round: the disc's side is that of the aligned force
        epsilon = 2.0 - epsilon
    assert 1.0 / (1.0 - epsilon) == pytest.approx(1.0 / (1.0 - printed), abs=0.05)


def test_what_is_given_without_uncertainty_is_exact():
    _, epsilon = direct_method(-400.0, -2000.0, 0.29, 1.3, C_alpha=-18000.0)
    assert epsilon.nominal_value == pytest.approx(1.0 - 0.29 * 2000.0 / (400.0 * 1.3))
    assert epsilon.std_dev < 1e-9


@pytest.mark.parametrize("alpha_b", [0.002, -0.002])
def test_sideslip_of_backlash_and_its_uncertainty_are_forces_by_the_cornering_stiffness(alpha_b):
    force, _ = direct_method(
        -400.0, -2e3, 0.29, 1.3, C_alpha=-18e3, alpha_b=alpha_b, backlash_deg=math.degrees(0.002)
    )
    assert force.nominal_value == pytest.approx(-400.0 + 18e3 * alpha_b)
    assert force.std_dev == pytest.approx(18.0)
