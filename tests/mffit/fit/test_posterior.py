"""Uncertainty of a fit: bands, draws and bent valleys, against finite differences, counting and a banana in closed form."""

from __future__ import annotations

import numpy as np
import pytest

import mffit
from mffit.fit import ensemble
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.rig_errors import BY_NAME as RIG_ERRORS


@pytest.fixture(scope="module")
def fitted(tmp_path_factory):
    from drawn_rigs import SAMPLE, plan_content

    from mffit import virtual_rig

    content = plan_content(thin=True)
    folder = tmp_path_factory.mktemp("thin")
    virtual_rig.simulate(virtual_rig.load_plan(content, folder=SAMPLE), folder, seed=3)
    return mffit.build(folder / "tyre.toml").fit


def test_the_band_is_the_propagated_covariance(fitted):
    posterior, tyre = fitted.posterior, fitted.tyre
    alpha, gamma, Fz = (
        np.radians([0.0, 3.0, -6.0]),
        np.radians([20.0, 0.0, 5.0]),
        np.array([1400.0, 900.0, 2000.0]),
    )
    where = make_points(alpha, gamma, Fz, p=250e3, V=10.0, phi_t=0.0)
    half = posterior.band(Simulation.of(tyre), where)
    names = [n for n in posterior.names if n not in RIG_ERRORS]
    rows = [posterior.names.index(n) for n in names]

    def forces(**changed):
        out = tyre.replace(**changed)(Fz, alpha, gamma, Vx=10.0, p=250e3, turn_slip=True)
        return np.array([out.Fy, out.Mz])

    step = {n: 1e-5 * max(abs(tyre[n]), 0.1) for n in names}
    slopes = np.array(
        [(forces(**{n: tyre[n] + h}) - forces(**{n: tyre[n] - h})) / (2 * h) for n, h in step.items()]
    )
    variance = np.einsum("icn,ij,jcn->cn", slopes, posterior.covariance[np.ix_(rows, rows)], slopes)
    assert np.array(list(half.values())) == pytest.approx(1.96 * np.sqrt(variance), rel=1e-3)


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
