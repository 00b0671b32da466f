"""The prior of what describes the errors along runs: its slopes are those of its density."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.diagnosis.marginal import MarginalParts
from mffit.diagnosis.run_means import MODELS, _at, _log_prior, _prior_slopes


@pytest.mark.parametrize("offsets", [False, True])
@pytest.mark.parametrize("model", MODELS)
def test_the_slopes_of_the_prior_are_its_differences(model, offsets):
    x = np.array([0.1, 0.7, -0.4, 0.3])[: 1 + model.memory + model.independent + offsets]
    parts = MarginalParts(*([0.0] * len(MarginalParts._fields)))
    found = _prior_slopes(_at(x, parts, model, offsets=offsets), model, offsets)
    step = 1e-5 * np.eye(len(x))
    expected = [(_log_prior(x + d, model, offsets) - _log_prior(x - d, model, offsets)) / 2e-5 for d in step]
    np.testing.assert_allclose(found, expected, atol=1e-8)
