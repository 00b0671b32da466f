"""Slip against the loaded radius: its zero moves with load and pressure, and a freely rolling wheel shows it, too."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.points import levels
from tests.mffit.points.slip_recording import error, read, recording

LOADED = {"against": "loaded-radius"}


@pytest.mark.parametrize("with_radius", [True, False])
def test_the_zero_of_slip_follows_load_and_pressure(tmp_path, with_radius):
    table = recording((55.0, 83.0, 110.0), driven=True, seed=1)
    found = read(tmp_path, LOADED, drive=table if with_radius else table.drop(columns="RL_m"))
    assert np.max(np.abs(error(found))) < 0.002


@pytest.mark.parametrize("with_force", [True, False])
def test_a_wheel_that_rolls_freely_shows_the_zero_at_its_pressures(tmp_path, with_force):
    """Driven at one pressure only; the other recording does not declare what its slip is against."""
    rolling = recording((55.0, 83.0, 110.0), driven=False, seed=2)
    found = read(
        tmp_path,
        LOADED,
        drive=recording((83.0,), driven=True, seed=1),
        roll=rolling if with_force else rolling.drop(columns="Fx_N"),
    )
    p = found.points
    assert levels.count(p.p, levels.PRESSURE) == 3
    assert np.max(np.abs(error(found))) < 0.002
    assert np.max(np.abs(p.kappa[p.file == p.files.index("roll.csv")])) < 0.002
    assert not any("driven or braked" in sentence for sentence in found.warnings)
