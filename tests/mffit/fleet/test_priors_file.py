"""A priors file with a spread that no population has is refused, whoever changed it."""

from __future__ import annotations

import json

import pytest

from mffit import config as configuration
from mffit.errors import InputError
from mffit.fit.priors import Prior, fleet_content, of_fleet

PROJECT = """\
[tyre]
name = "later"
unloaded_radius = 0.3
nominal_load = 1400
nominal_pressure = 250
priors = "priors.json"

[rig]
type = "flat-track"
axes = "iso"

[[sweep]]
file = "a.csv"
"""


@pytest.mark.parametrize("spread", [0.0, -0.1, float("nan"), 0.1])
def test_a_spread_is_positive(tmp_path, spread):
    (tmp_path / "tyre.toml").write_text(PROJECT)
    content = fleet_content({"FNOMIN": 1400.0, "NOMPRES": 250e3}, 5, {"PKY6": Prior(-1.2, spread)})
    (tmp_path / "priors.json").write_text(json.dumps(content))
    later = configuration.load(tmp_path / "tyre.toml")
    if spread > 0.0:
        assert of_fleet(later) == {"PKY6": Prior(-1.2, spread)}
    else:
        with pytest.raises(InputError, match="PKY6 is not a coefficient with a positive spread"):
            of_fleet(later)
