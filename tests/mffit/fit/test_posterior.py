"""Uncertainty of a fit: bands, draws and bent valleys, against finite differences, counting and a banana in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from small_rigs import disc, simulated, sound

import mffit
from mffit import config as configuration
from mffit.fit import ensemble
from mffit.fit.beside import BesideNumbers, with_beside
from mffit.numbers import Numbers


@pytest.fixture(scope="module")
def fitted():
    return sound(disc).fit


def test_draws_scatter_by_the_standard_errors(fitted):
    members = ensemble(fitted, 8, seed=1)
    assert len(members) == 8
    names = [n for n, c in fitted.coefficients.items() if c.stderr and not c.at_bound and n in members[0]]
    pulls = np.array(
        [[(m[n] - fitted.tyre[n]) / fitted.coefficients[n].stderr for n in names] for m in members]
    )
    assert len(names) > 50
    assert np.sqrt(np.mean(pulls**2)) == pytest.approx(1.0, abs=0.25)
    assert abs(np.mean(pulls)) < 0.25


def test_the_same_seed_draws_the_same_tyres(fitted):
    assert ensemble(fitted, 1, seed=4) == ensemble(fitted, 1, seed=4)
    assert ensemble(fitted, 1, seed=4) != ensemble(fitted, 1, seed=5)


def test_fitted_numbers_move_with_a_held_one_as_their_covariance_says(fitted, tmp_path):
    """PECP1 is held at the direct measurement: a build in which it is another one ends where the covariance puts it."""
    simulated(disc(spin={"pecp1": "model"}), tmp_path / "set")
    held = fitted
    other = f"PECP1={held.tyre['PECP1'] + 0.03!r}"
    end = mffit.build(
        configuration.load(tmp_path / "set" / "tyre.toml", coefficients=[other]), with_report=False
    ).fit
    names, covariance = held.posterior.names, held.posterior.covariance
    i = names.index("PECP1")
    for name in ("PKY6", "PKY7", "PKYP1", "PEY3", "gamma_0_deg", "camber_skew_deg"):
        here, there = (one.rig[name][0] if name in one.rig else one.tyre[name] for one in (held, end))
        k = names.index(name)
        assert covariance[i, k] / covariance[i, i] == pytest.approx((there - here) / 0.03, rel=0.2), name


def test_numbers_from_readings_of_their_own_keep_what_they_share():
    """With the fit exactly known they have their own covariance; otherwise what they take from the fit is added."""
    fit = Numbers.of(("PKY1", "PKY2"), (-20.0, 1.5), np.array([[4.0, 1.0], [1.0, 9.0]]))
    own, slope = np.array([[2.0, -0.7], [-0.7, 1.0]]), np.array([[0.5, 0.0], [-1.0, 2.0]])
    beside = BesideNumbers({"LATERAL_STIFFNESS": 1.0, "PCFY1": 0.1}, own, fit.names, slope)
    joint = with_beside(fit, beside)
    assert joint.names == (*fit.names, "LATERAL_STIFFNESS", "PCFY1")
    known = joint.given(fit.names)
    assert known.covariance == pytest.approx(own)
    random = np.random.default_rng(3)
    drawn = random.multivariate_normal((0.0, 0.0), fit.covariance, 200_000)
    more = drawn @ slope.T + random.multivariate_normal((0.0, 0.0), own, 200_000)
    assert joint.covariance == pytest.approx(np.cov(np.column_stack([drawn, more]).T), abs=0.4)
