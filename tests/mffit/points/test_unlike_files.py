"""Two tyres in one list: their names are said, and their forces are compared at like conditions."""

from __future__ import annotations

from itertools import product

import numpy as np
import pandas as pd
import pytest
from flat_belt import recording, write_mat

from mffit import build, points
from mffit import config as configuration
from mffit.constants import STRAIGHT
from mffit.points.other_label import other_labels
from mffit.points.unlike import unlike_files
from mffit.recordings import sniff
from mffit.report import verdict

LOADS = (700.0, 1400.0)


def tyre(
    *, grip: float = 1.3, stiffness: float = 12.0, offset: float = 0.0, zero_deg: float = 0.0, seed: int = 1
) -> pd.DataFrame:
    """Sideslip there and back at two loads, 6 N of noise: Fy = -D Fz tanh(B alpha), read with the zeros of a rig."""
    n = 1200
    random = np.random.default_rng(seed)
    alpha = np.radians(9.0 * np.sin(2.0 * np.pi * np.arange(n) / n))
    rows = [
        pd.DataFrame(
            {
                "time_s": 100.0 * k + np.arange(n) / 50.0,
                "alpha_deg": np.degrees(alpha) + zero_deg + 0.01 * random.standard_normal(n),
                "gamma_deg": 0.01 * random.standard_normal(n),
                "Fz_N": load + 5.0 * random.standard_normal(n),
                "Fy_N": -grip * load * np.tanh(stiffness * alpha) + offset + 6.0 * random.standard_normal(n),
                "p_kPa": 100.0,
                "V_mps": 10.0,
            }
        )
        for k, load in enumerate(LOADS)
    ]
    return pd.concat(rows, ignore_index=True)


@pytest.fixture
def config(tmp_path):
    def of(*tables):
        for k, table in enumerate(tables):
            table.to_csv(tmp_path / f"{k}.csv", index=False)
        return configuration.load(
            {
                "tyre": {
                    "name": "x",
                    "unloaded_radius": 0.3,
                    "nominal_load": 1000.0,
                    "nominal_pressure": 100.0,
                },
                "rig": {"type": "flat-track"},
                "sweep": [{"file": f"{k}.csv"} for k in range(len(tables))],
            },
            folder=tmp_path,
        )

    return of


@pytest.mark.parametrize("other", [{"grip": 1.04}, {"stiffness": 8.0}], ids=["grip", "stiffness"])
def test_files_with_unlike_forces_are_said_with_the_numbers(config, other):
    one, two = tyre(), tyre(seed=2, **other)
    (doubt,) = points.read(config(one, two)).doubts
    assert doubt.startswith("1.csv reads side forces that are 0.")
    if "grip" in other:
        assert "0.80 times those of 0.csv" in doubt
    assert "1400 N" in doubt
    assert "two tyres" in doubt


@pytest.mark.parametrize(
    "other",
    [{}, {"grip": 1.25}, {"offset": 60.0}, {"zero_deg": 0.8}],
    ids=["again", "warmer", "zero of the force", "zero of the angle"],
)
def test_a_run_of_the_same_tyre_is_not(config, other):
    assert not points.read(config(tyre(), tyre(seed=2, **other))).doubts


def test_few_angles_that_are_held_do_not_show_the_curve(config):
    """Of an angle between two steps some readings belong to either, no distance apart; they differ by 1 % of the force."""
    step, random, rows = np.degrees(STRAIGHT.rad), np.random.default_rng(3), []
    for k, (middle, side) in enumerate(product((-10.5, -4.5, 4.5, 10.5), (-1.0, 1.0))):
        alpha = (middle + 0.02 * side) * step + 0.01 * random.standard_normal(200)
        force = -(1.3 + 0.013 * side) * LOADS[1] * np.tanh(12.0 * np.radians(alpha))
        rows.append(
            {"time_s": 10.0 * k + np.arange(200) / 50.0, "alpha_deg": alpha, "gamma_deg": 0.0, "Fz_N": LOADS[1],
             "Fy_N": force + 6.0 * random.standard_normal(200), "p_kPa": 100.0, "V_mps": 10.0}
        )  # fmt: skip
    held = pd.concat([pd.DataFrame(row) for row in rows], ignore_index=True)
    assert not points.read(config(held, tyre())).doubts


def test_files_without_a_common_condition_are_not_compared(config):
    heavy = tyre(grip=1.0, seed=2)
    heavy["Fz_N"] *= 1.5
    heavy["Fy_N"] *= 1.5
    assert not points.read(config(tyre(), heavy)).doubts


def test_a_build_of_two_tyres_is_not_sound(config):
    result = build(config(tyre(), tyre(grip=1.04, seed=2)))
    assert any("two tyres" in doubt for doubt in result.trust.doubts)
    assert verdict.judged(result) != "sound"


@pytest.mark.parametrize(
    ("names", "said"), [(("R25B 16x7.5", "LC0 18x6"), True), (("R25B 16x7.5", "r25b  16X7.5"), False)]
)
def test_names_of_two_tyres_are_said(tmp_path, names, said):
    table = recording(loads=(600.0, 1500.0), cambers=(0.0, 2.0), pressures=(83.0,))
    files = [write_mat(table, tmp_path / f"{k}.mat", tireid=name) for k, name in enumerate(names)]
    found = [w for w in sniff(files).reading.warnings if "name 2 tyres" in w]
    assert bool(found) == said
    if said:
        assert all(name in found[0] for name in (*names, "0.mat", "1.mat"))


def test_a_title_names_its_tyre(tmp_path):
    for k, name in enumerate(("Soft 10", "Hard 13")):
        text = tyre().to_csv(index=False)
        (tmp_path / f"{k}.csv").write_text(f"Run {k}; Tire Name={name}; Rim=7\n{text}")
    (said,) = [
        w for w in sniff([tmp_path / "0.csv", tmp_path / "1.csv"]).reading.warnings if "name 2 tyres" in w
    ]
    assert '"Soft 10" (0.csv), "Hard 13" (1.csv)' in said


def test_a_dead_force_is_like_nothing(config):
    one, two = tyre().assign(Fy_N=0.0), tyre(seed=2).assign(Fy_N=0.0)
    assert not unlike_files(points.read(config(one, two)).points)
    assert not other_labels(points.read(config(one, two)).points)
