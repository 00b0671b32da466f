"""Driving and braking of a tyre that is not of the formula: what predictions say of its longitudinal force."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import tomli_w
from brush import SHORT, Brush
from conftest import Built, build

from mffit.prediction import region
from mffit.prediction.region import missed_at_readings
from mffit.report.build_view import view_of
from mffit.report.figures.missed import missed
from tir import TirWarning

TYRE = Brush(drive=1.2, carcass=2e5)
FX_ZERO = -14.0
"""Zero of the rig [N], 0.7 of its declared uncertainty."""
NOISE = {"Fx_N": 8.0, "Fy_N": 6.0, "Mz_Nm": 0.5}


def forces(alpha, Fz, kappa):
    return dict(zip(NOISE, TYRE.driven(np.radians(alpha), 0.0, Fz, kappa), strict=True))


def campaign(folder: Path, sideslip: np.ndarray, held: Sequence[float]) -> Built:
    """Sweeps of sideslip, and of slip at each sideslip that is ``held``, at three loads; angles [deg]."""
    random, runs = np.random.default_rng(4), []
    slip = np.linspace(-0.15, 0.15, 21)
    for Fz in (1000.0, 1700.0, 2600.0):
        for alpha, kappa in ((sideslip, 0.0), *((a, slip) for a in held)):
            table = pd.DataFrame({"alpha_deg": alpha, "gamma_deg": 0.0, "Fz_N": Fz, "kappa": kappa})
            for name, true in forces(table.alpha_deg, Fz, table.kappa).items():
                table[name] = true + NOISE[name] * random.standard_normal(len(table))
                table[f"u_{name}"] = NOISE[name]
            runs.append(table.assign(Fx_N=table.Fx_N + FX_ZERO, run=f"r{len(runs)}"))
    pd.concat(runs).to_csv(folder / "runs.csv", index=False)
    config = {
        "tyre": {"name": "brush", "unloaded_radius": 0.31, "nominal_load": 1700.0, "nominal_pressure": 250.0},
        "rig": {"type": "flat-track", "axes": "iso"},
        "sweep": [{"file": "runs.csv"}],
    }
    path = folder / "tyre.toml"
    path.write_text(tomli_w.dumps(config))
    return build(path)


@pytest.fixture(scope="module")
def driven(tmp_path_factory) -> Built:
    """To both sides of sideslip."""
    return campaign(
        tmp_path_factory.mktemp("driven"), np.array(SHORT, dtype=float), (-5.0, -2.0, 0.0, 2.0, 5.0)
    )


def test_a_zero_of_fx_does_not_make_up_for_a_difference_of_driving_and_braking(driven):
    """A brush slips more to the front than to the rear, which no coefficient describes but those of shifts."""
    value, u = driven.result.fit.rig["Fx0_N"]
    assert value == pytest.approx(FX_ZERO, abs=2.0 * u)
    alpha, Fz = (x.ravel() for x in np.meshgrid(np.linspace(-6.0, 6.0, 13), [1200.0, 1700.0, 2400.0]))
    found = driven.predict(alpha_deg=alpha, gamma_deg=0.0, Fz_N=Fz, kappa=0.0)
    off = found["Fx_best_N"] - forces(alpha, Fz, 0.0)["Fx_N"]
    assert np.mean(np.abs(off) < 1.96 * found["u_Fx_best_N"]) > 0.9


@pytest.mark.parametrize("Fz", [300.0, 500.0])
def test_below_the_lowest_load_a_prediction_says_how_little_is_known(driven, Fz):
    """The lowest tested load is 1000 N, and without load the force is known again: between them it is known less."""
    random = np.random.default_rng(1)
    alpha, kappa = random.uniform(-5.0, 5.0, 300), random.uniform(-0.15, 0.15, 300)
    found = driven.predict(alpha_deg=alpha, gamma_deg=0.0, Fz_N=Fz, kappa=kappa)
    off = found["Fx_best_N"] - forces(alpha, Fz, kappa)["Fx_N"]
    assert np.mean(np.abs(off) < 1.96 * found["u_Fx_best_N"]) > 0.9


def test_beyond_the_tested_slip_the_change_of_the_formula_is_no_knowledge(driven):
    """The force is at its peak where the sweeps end, and bends away as the formula does not foresee."""
    random = np.random.default_rng(2)
    alpha, side = random.uniform(-5.0, 5.0, 300), random.choice([-1.0, 1.0], 300)
    kappa = side * random.uniform(0.16, 0.25, 300)
    with pytest.warns(TirWarning, match="kappa is outside the range"):
        found = driven.predict(alpha_deg=alpha, gamma_deg=0.0, Fz_N=1700.0, kappa=kappa)
    for name in ("Fx", "Fy"):
        off = np.abs(found[f"{name}_best_N"] - forces(alpha, 1700.0, kappa)[f"{name}_N"])
        half = 1.96 * found[f"u_{name}_best_N"]
        assert np.mean(off < half) > 0.9
        assert np.sqrt(np.mean(half**2) / np.mean(off**2)) < 6.0


def test_sideslip_of_the_other_sign_is_known_by_its_mirror_image(tmp_path):
    """As many drive and brake programmes are: what is left unknown is how much a tyre differs from its mirror image."""
    one_sided = campaign(tmp_path, np.array([a for a in SHORT if a >= 0.0], dtype=float), (0.0, 2.0, 5.0))
    alpha, kappa = (x.ravel() for x in np.meshgrid(np.linspace(-7.0, -1.0, 13), np.linspace(-0.1, 0.1, 5)))
    kappa = np.where(alpha < -5.0, 0.0, kappa)
    true = forces(alpha, 1700.0, kappa)["Fy_N"]
    found = one_sided.predict(alpha_deg=alpha, gamma_deg=0.0, Fz_N=1700.0, kappa=kappa)
    half = 1.96 * found["u_Fy_best_N"]
    assert np.mean(np.abs(found["Fy_best_N"] - true) < half) > 0.9
    assert np.sqrt(np.mean(half**2) / np.mean(true**2)) < 0.2


def test_the_grip_of_fx_is_judged_by_sweeps_of_slip(driven, monkeypatch):
    """The Fx of a freely rolling wheel is its resistance: of 18 sweeps, three are of sideslip."""
    seen: dict[str, list[Any]] = {}
    monkeypatch.setattr(region, "_clearest", lambda names, found: seen.update(found))
    result = driven.result
    for name, sweeps in {"Fx": 15, "Fy": 3}.items():
        missed_at_readings(result.prediction, result.fit.tyre, result.points, result.fit.model, {name})
        assert len(seen[""]) == sweeps


def test_lines_of_the_model_error_are_at_conditions_that_its_sweeps_held(driven):
    """Slip was run at five sideslips, and sideslip at no slip; a line has the name of no other."""
    panels = [panel for row in missed(view_of(driven.result)).rows for panel in row]
    lines = {panel.title: [one.name for one in panel.series] for panel in panels}
    assert lines["Fx, by sideslip"] == ["-5 deg", "0 deg", "5 deg"]
    assert lines["Fy, by longitudinal slip"] == ["0"]


def test_slip_at_sideslips_where_it_was_never_run(driven):
    """Sideslip was run to 8 deg alone, and to 5 deg with slip: each was tested, both together were not."""
    random = np.random.default_rng(3)
    alpha = random.choice([-1.0, 1.0], 300) * random.uniform(5.5, 8.0, 300)
    kappa = random.choice([-1.0, 1.0], 300) * random.uniform(0.02, 0.15, 300)
    Fz = random.uniform(1000.0, 2600.0, 300)
    with pytest.warns(TirWarning, match="alpha_deg and kappa were tested, but never together as in"):
        found = driven.predict(alpha_deg=alpha, gamma_deg=0.0, Fz_N=Fz, kappa=kappa)
    for name, unit in {"Fx": "N", "Fy": "N", "Mz": "Nm"}.items():
        off = np.abs(found[f"{name}_best_{unit}"] - forces(alpha, Fz, kappa)[f"{name}_{unit}"])
        assert np.mean(off < 1.96 * found[f"u_{name}_best_{unit}"]) > 0.9


def test_between_combinations_that_were_run_nothing_is_said(driven, recwarn):
    alpha, kappa = (x.ravel() for x in np.meshgrid(np.linspace(-5.0, 5.0, 11), np.linspace(-0.15, 0.15, 11)))
    driven.predict(alpha_deg=alpha, gamma_deg=0.0, Fz_N=1400.0, kappa=kappa)
    assert not recwarn.list
