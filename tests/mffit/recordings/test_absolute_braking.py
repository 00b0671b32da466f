"""Brake slip and brake force that are both given as absolute values."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from mffit.recordings import sniff


def braking(path, slip: str, force: str, sign: float = 1.0):
    """Two brakings straight ahead and one sideslip sweep, at 3 kN; a tyre whose slope is 20 times its load."""
    t = np.arange(0.0, 36.0, 0.02)
    kappa = np.where(t < 24.0, 0.06 * (1.0 - np.cos(2.0 * np.pi * t / 12.0)), 0.0)
    alpha = np.where(t < 24.0, 0.0, 8.0 * np.sin(2.0 * np.pi * t / 12.0))
    table = {
        "time [s]": t, "SA [deg]": alpha, "IA [deg]": 0.0 * t, "FZ [N]": 3000.0 + 5.0 * np.sin(7.0 * t), slip: sign * kappa,
        force: sign * 3000.0 * np.tanh(20.0 * kappa), "FY [N]": -3000.0 * np.tanh(15.0 * np.radians(alpha)), "V [m/s]": 15.0,
    }  # fmt: skip
    pd.DataFrame(table).to_csv(path, index=False)
    return path


def test_headings_of_braking_reverse_both(tmp_path):
    path = braking(tmp_path / "a.csv", "brake slip [-]", "brake force [N]")
    found = sniff([path], headings={"Fx_N": "brake force"}).recordings[0].guesses
    assert (found["kappa"].scale, found["Fx_N"].scale) == (-1.0, -1.0)


@pytest.mark.parametrize(("sign", "asked"), [(1.0, True), (-1.0, False)])
def test_values_that_are_never_negative_are_asked_about(tmp_path, sign, asked):
    (recording,) = sniff([braking(tmp_path / "a.csv", "SL [-]", "FX [N]", sign)]).recordings
    assert any("was the wheel driven? If it was braked" in remark for remark in recording.remarks) == asked
    assert (recording.guesses["kappa"].scale, recording.guesses["Fx_N"].scale) == (1.0, 1.0)
