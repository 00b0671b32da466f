"""Uncertainty of a fit: bands, draws and bent valleys, against finite differences, counting and a banana in closed form."""

from __future__ import annotations

import numpy as np
import pytest

import mffit
from mffit.fit import ensemble


@pytest.fixture(scope="module")
def fitted(tmp_path_factory):
    from drawn_rigs import SAMPLE, plan_content

    from mffit import virtual_rig

    content = plan_content(thin=True)
    folder = tmp_path_factory.mktemp("thin")
    virtual_rig.simulate(virtual_rig.load_plan(content, folder=SAMPLE), folder, seed=3)
    return mffit.build(folder / "tyre.toml").fit


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
