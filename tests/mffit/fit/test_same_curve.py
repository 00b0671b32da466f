"""Signs that change no force."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.fit.same_curve import SAME_CURVE, with_expected_signs
from tests.mffit.fit import combined_programme as belt


def test_signs_that_change_no_force_are_those_that_are_expected():
    true = belt.truth()
    rng = np.random.default_rng(4)
    alpha, kappa, gamma = rng.uniform(-0.1, 0.1, 50), rng.uniform(-0.2, 0.2, 50), rng.uniform(-0.1, 0.1, 50)

    def forces(tyre):
        return [
            np.array(tyre(load, alpha, gamma, kappa, phi_t, p=250e3, turn_slip=on)) for on in (False, True)
        ]

    load, phi_t = rng.uniform(500.0, 2500.0, 50), rng.uniform(-0.3, 0.3, 50)
    drawn = {name: rng.uniform(0.1, 0.3) for group in SAME_CURVE for name in group if not true[name]}
    true = true.replace(**drawn)  # so that every sign counts
    for group in SAME_CURVE:
        other = true.replace(**{name: -true[name] for name in group})
        for found, expected in zip(forces(other), forces(true), strict=True):
            np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-8, err_msg=str(group))
        assert with_expected_signs(other.values, dict(true.values)) == {name: true[name] for name in group}
    assert with_expected_signs(true.values, dict(true.values)) == {}


def test_a_curve_that_two_groups_reverse_has_one_form():
    """Reversed RVY6 and RVY1-3 are RVY5 and RVY6 reversed, and then RVY5 with RVY1-3: the same force, and all signs expected."""
    true = dict(belt.truth().replace(RVY1=0.02, RVY2=-0.03, RVY3=0.1, RVY5=1.9, RVY6=12.0).values)
    names = ("RVY6", "RVY1", "RVY2", "RVY3")
    assert with_expected_signs({**true, **{n: -true[n] for n in names}}, true) == {n: true[n] for n in names}


def test_a_slip_stiffness_over_load_has_one_form():
    """Of two exponents with the same value, slope and curvature at nominal load, the one nearer to the expected one."""
    true = belt.truth().replace(PKX1=22.0, PKX2=3.0, PKX3=-0.2)
    twin = true.replace(PKX2=-3.0, PKX3=-0.2 + 6.0 / 22.0)
    load = true["FNOMIN"] * (1.0 + np.array([-0.01, 0.0, 0.01]))
    stiffness = np.array([one.state(load).K_xk / load for one in (true, twin)])
    np.testing.assert_allclose(*stiffness, rtol=1e-6)
    np.testing.assert_allclose(*np.diff(stiffness, 2), rtol=1e-2)
    found = with_expected_signs(twin.values, dict(true.values))
    assert found == {"PKX2": 3.0, "PKX3": pytest.approx(-0.2)}
    assert with_expected_signs(true.values, dict(true.values)) == {}
