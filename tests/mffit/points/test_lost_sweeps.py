"""Holds of any length are points once the forces have settled; without any sideslip left, a result is not to be trusted."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from mffit import build, points
from mffit import config as configuration
from mffit.errors import InputError
from mffit.points.steady import SteadySettings, stretches
from mffit.points.stretch import MOVE

RATE = 20.0
LEVELS = (0.0, 2.0, 4.0, 6.0, 4.0, 2.0, 0.0, -2.0, -4.0, -6.0, -4.0, -2.0, 0.0)


def staircase(hold: float, speed: float, straight: float = 1.0) -> pd.DataFrame:
    """Holds of sideslip [s] at two loads, at zero ``straight`` times as long; the force follows over 0.3 m of rolling."""
    random = np.random.default_rng(3)
    parts = []
    for k, load in enumerate((2000.0, 4000.0)):
        lengths = [round(hold * RATE * (1.0 if level else straight)) for level in LEVELS]
        alpha = np.repeat(LEVELS, lengths)
        followed, share = np.zeros(len(alpha)), 1.0 - np.exp(-speed / RATE / 0.3)
        for i in range(1, len(alpha)):
            followed[i] = followed[i - 1] + share * (alpha[i] - followed[i - 1])
        noise = random.standard_normal((2, len(alpha)))
        parts.append(
            pd.DataFrame(
                {
                    "time_s": 1000.0 * k + np.arange(len(alpha)) / RATE,
                    "alpha_deg": alpha + 0.01 * noise[0],
                    "gamma_deg": 0.0,
                    "Fz_N": load,
                    "Fy_N": -1.1 * load * np.tanh(14.0 * np.radians(followed)) + 5.0 * noise[1],
                    "V_mps": speed,
                }
            )
        )
    return pd.concat(parts)


def config_of(table: pd.DataFrame, folder, **more) -> configuration.Config:
    table.to_csv(folder / "a.csv", index=False)
    tyre = {"name": "x", "unloaded_radius": 0.3, "nominal_load": 3000.0, "nominal_pressure": 200.0}
    content = {"tyre": tyre, "rig": {"type": "flat-track"}, "sweep": [{"file": "a.csv"}], **more}
    return configuration.load(content, folder=folder)


@pytest.mark.parametrize(("hold", "speed"), [(3.0, 2.0), (1.5, 5.0), (8.0, 0.6)])
def test_holds_are_points_if_the_wheel_rolls_long_enough(tmp_path, hold, speed):
    """After 2 m the force is settled to 0.1 %, and another metre or two of rolling shows its mean."""
    found = points.read(config_of(staircase(hold, speed), tmp_path))
    assert len(found.points) == 2 * len(LEVELS)
    assert not found.reasons
    truth = -1.1 * found.points.Fz * np.tanh(14.0 * found.points.alpha)
    np.testing.assert_allclose(found.points.Fy, truth, atol=15.0)


def test_without_any_sideslip_left_a_result_is_not_to_be_trusted(tmp_path):
    """At 0.5 m/s a hold of 3 s rolls 1.5 m, and three times as far without sideslip."""
    config = config_of(staircase(3.0, 0.5, straight=3.0), tmp_path)
    (reason,) = points.read(config).reasons
    assert reason.startswith(
        "alpha_deg moves from -6.0 to 6.0 deg in the recordings, but the points hold 0.0 to 0.0 deg"
    )
    assert "hold set-points longer" in reason
    result = build(config)
    assert not result.trusted
    assert reason in result.reasons


def cut(alpha, rate: float) -> list[tuple[str, float, float]]:
    """Kind, begin and end [s] of the stretches of a sideslip [deg] over time, recorded at a rate [Hz] with noise."""
    time = np.arange(round(48.0 * rate)) / rate
    noise = np.random.default_rng(1).standard_normal((4, len(time)))
    one = np.ones(len(time))
    settings = SteadySettings(
        time,
        np.radians(alpha(time) + 0.005 * noise[0]),
        np.radians(0.003 * noise[1]),
        4000.0 * (1.0 + 0.01 * noise[2]),
        240e3 * (1.0 + 0.001 * noise[3]),
        16.7 * one,
        0.0 * one,
    )
    return [(s.kind, time[s.begin], time[s.end - 1]) for s in stretches(settings) if s.kind != MOVE]


@pytest.mark.parametrize("rate", [10.0, 100.0, 1000.0])
def test_the_rate_of_recording_does_not_decide_what_rests(rate):
    """The tops of a sine of 10 deg in 16 s move by 0.15 deg in 0.4 s: they are no rests, however few samples show it."""
    (sweep,) = cut(lambda time: 10.0 * np.sin(2.0 * np.pi * time / 16.0), rate)
    assert sweep == ("sweep", 0.0, pytest.approx(48.0, abs=0.2))
    held = cut(lambda time: 2.0 * np.floor(time / 8.0), rate)
    assert [kind for kind, *_ in held] == ["plateau"] * 6
    np.testing.assert_allclose([begin for _, begin, _ in held], 8.0 * np.arange(6), atol=0.3)


def test_rows_that_are_repeated_are_refused_with_the_lines_to_leave_out(tmp_path):
    table = staircase(3.0, 2.0)
    config = config_of(pd.concat([table[:300], table[200:300], table[300:]]), tmp_path)
    with pytest.raises(InputError, match="100 rows repeated") as found:
        points.read(config)
    entry = {"file": "a.csv", "lines": "302-401", "why": "repeated"}
    assert ", ".join(f'{key} = "{value}"' for key, value in entry.items()) in found.value.sentence
    cured = config_of(pd.read_csv(tmp_path / "a.csv"), tmp_path, fit={"exclude": [entry]})
    assert len(points.read(cured).points) == 2 * len(LEVELS)
