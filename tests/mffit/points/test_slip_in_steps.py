"""Slip against the loaded radius that was run in steps: few readings lie near Fx = 0 beside those of the undriven wheel."""

from __future__ import annotations

import numpy as np
import pytest
from driven_rig import FX, against_loaded_radius, driven

import mffit
from mffit import config, points


@pytest.mark.parametrize("with_radius", [True, False])
@pytest.mark.parametrize("step", [0.02, 0.05])
def test_the_slip_is_that_against_free_rolling(tmp_path, step, with_radius):
    """As the rig set it: the shift is 0.06 at the highest load, and every 0.001 of slip left in it is 150 N there."""
    driven(tmp_path, step)
    true = points.read(config.load(tmp_path / "tyre.toml")).points.kappa
    against_loaded_radius(tmp_path, with_radius=with_radius)
    reading = points.read(config.load(tmp_path / "tyre.toml"))
    assert any("against the loaded radius" in said for said in reading.warnings)
    off = reading.points.kappa - true
    assert np.sqrt(np.mean(off**2)) < 0.0015
    assert np.max(np.abs(off)) < 0.005


def test_such_a_campaign_is_built_to_its_noise(tmp_path):
    driven(tmp_path, 0.05)
    against_loaded_radius(tmp_path)
    result = mffit.build(tmp_path / "tyre.toml")
    assert result.trusted
    assert result.fit.channels["Fx"].rmse < 1.2 * FX


def test_the_free_radius_that_grows_with_speed_is_in_the_zero(tmp_path):
    """The wheel that rolls freely at 8 to 30 m/s: its free radius grows by 0.2 %, which is 100 N of Fx."""
    driven(tmp_path, 0.02, speeds=[8, 16.7, 30])
    against_loaded_radius(tmp_path)
    reading = points.read(config.load(tmp_path / "tyre.toml")).points
    rolling = reading.file == reading.files.index("rolling.csv")
    by_speed = [float(np.mean(reading.kappa[rolling & (np.abs(reading.V - V) < 0.1)])) for V in (8.0, 30.0)]
    assert abs(by_speed[0] - by_speed[1]) < 0.001
