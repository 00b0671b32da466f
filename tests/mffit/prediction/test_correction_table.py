"""``<name>-correction.csv``: what the formula misses as a table that a simulation adds."""

from __future__ import annotations

import json
import warnings

import numpy as np
import pandas as pd
import pytest
from conftest import LOADS, Built, belt, brush, build
from scipy.interpolate import RegularGridInterpolator

import mffit
import tir
from mffit.prediction.correction import correction
from mffit.scatter import rms

TABLE = "brush-correction.csv"
CHANNELS = {"Fy": "N", "Mz": "Nm"}


def of(tyre: tir.Tyre, at: pd.DataFrame) -> tir.Forces:
    alpha, gamma = np.radians(at.alpha_deg.to_numpy()), np.radians(at.gamma_deg.to_numpy())
    kappa = at.kappa.to_numpy() if "kappa" in at else 0.0
    return tyre(at.Fz_N.to_numpy(), alpha=alpha, gamma=gamma, kappa=kappa)


@pytest.fixture
def tyres(foreign: Built) -> tuple[tir.Tyre, tir.Tyre]:
    """The file, and with the table."""
    file = tir.read(foreign.folder / "brush.tir")
    return file, file.with_correction(foreign.folder / TABLE)


def test_at_the_nodes_it_is_the_best_estimate(foreign: Built, tyres):
    nodes = pd.read_csv(foreign.folder / TABLE, comment="#")
    best, found = mffit.predict(foreign.folder, nodes), of(tyres[1], nodes)
    for name, unit in CHANNELS.items():
        rounding = best[f"u_{name}_best_{unit}"].median() * 0.005
        assert getattr(found, name) == pytest.approx(best[f"{name}_best_{unit}"].to_numpy(), abs=rounding)
        u = nodes[f"u_{name}_missed_{unit}"].to_numpy()
        assert u == pytest.approx(best[f"u_{name}_best_{unit}"].to_numpy(), abs=rounding)


def test_between_and_beyond_the_nodes_it_is_near_the_best_estimate_and_nearer_the_truth(
    foreign: Built, tyres
):
    random = np.random.default_rng(4)
    for reach, load in ((1.0, 1.0), (1.3, 1.2)):
        at = pd.DataFrame(
            {
                "alpha_deg": random.uniform(-10.0 * reach, 10.0 * reach, 400),
                "gamma_deg": random.uniform(-4.0, 4.0, 400),
                "Fz_N": random.uniform(min(LOADS), max(LOADS) * load, 400),
            }
        )
        best = mffit.predict(foreign.folder, at)
        true = dict(
            zip(
                CHANNELS,
                brush(*np.radians(at[["alpha_deg", "gamma_deg"]]).to_numpy().T, at.Fz_N),
                strict=True,
            )
        )
        for name, unit in CHANNELS.items():
            file, found = (getattr(of(tyre, at), name) for tyre in tyres)
            estimate = best[f"{name}_best_{unit}"].to_numpy()
            assert rms(found - estimate) < 0.1 * rms(estimate - file), name
            if reach == 1.0:
                assert rms(found - true[name]) < 0.7 * rms(file - true[name]), name


def test_it_is_listed_and_small(foreign: Built):
    files = json.loads((foreign.folder / "result.json").read_text())["files"]
    assert files == {"normal": "brush.tir", "correction": TABLE}
    assert (foreign.folder / TABLE).stat().st_size < 1e6


def test_what_is_not_proven_is_not_written(of_formula: Built):
    """A tyre of the formula: there is no table, or one of other channels than Fy."""
    assert of_formula.result.correction is None
    assert not list(of_formula.folder.glob("*-correction.csv"))


def test_an_input_that_was_held_has_no_column(tmp_path):
    """Upright sweeps only, each load twice: nothing is known of camber, and all that is written is."""
    built = build(belt(tmp_path / "upright", seed=8, cambers=(0.0, 0.0)))
    table = pd.read_csv(built.folder / TABLE, comment="#")
    assert "gamma_deg" not in table
    assert np.all(np.isfinite(table))
    best = built.predict(**table[["alpha_deg", "Fz_N"]], gamma_deg=0.0)
    assert table.u_Fy_missed_N.to_numpy() == pytest.approx(best.u_Fy_best_N.to_numpy(), rel=0.02)


def test_a_table_of_few_nodes_uses_them_and_says_what_lines_between_them_add(foreign: Built, monkeypatch):
    """Its statement is that of lines between the table's own values, against the model error at other places."""
    monkeypatch.setattr("mffit.prediction.constants.MOST_NODES", 250)
    result, random = foreign.result, np.random.default_rng(7)
    found = correction(result.prediction, result.fit.tyre, list(CHANNELS))
    assert 80 < len(found.table) <= 250
    axes = [np.unique(found.table[name]) for name in ("alpha_deg", "gamma_deg", "Fz_N")]
    at = pd.DataFrame(
        dict(
            zip(
                ("alpha_deg", "gamma_deg", "Fz_N"),
                (random.uniform(x[0], x[-1], 600) for x in axes),
                strict=True,
            )
        )
    )
    best, added = mffit.predict(foreign.folder, at), []
    nodes = found.table.sort_values(["alpha_deg", "gamma_deg", "Fz_N"])
    for name, unit in CHANNELS.items():
        missed = (best[f"{name}_best_{unit}"] - best[f"{name}_{unit}"]).to_numpy()
        values = nodes[f"{name}_missed_{unit}"].to_numpy().reshape([len(x) for x in axes])
        lines = RegularGridInterpolator(axes, values)(at.to_numpy())
        added.append(rms(lines - missed) / rms(missed))
    assert max(added) == pytest.approx(found.added, rel=0.25)


def test_below_the_tested_loads_and_under_slip_prediction_and_table_fade_alike(foreign: Built, tyres):
    """At the lowest load, both have the whole miss; below, the part that the load is; over slip that nobody ran, hardly any."""
    file, whole = tyres
    at = pd.DataFrame({"alpha_deg": [-6.0, -3.0, 2.0, 5.0], "gamma_deg": 2.0, "p_kPa": 200.0, "kappa": 0.0})
    for load in (800.0, 400.0, 80.0):
        for kappa in (0.0, 0.05, 0.3):
            here = at.assign(Fz_N=load, kappa=kappa)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", tir.TirWarning)
                best = mffit.predict(foreign.folder, here)
            missed = of(whole, here).Fy - of(file, here).Fy
            by_prediction = best["Fy_best_N"].to_numpy() - of(file, here).Fy
            assert by_prediction == pytest.approx(missed, abs=1.5 * load / 800.0)
            assert np.all(np.abs(missed) < 60.0 * load / 800.0)
    assert np.all(np.abs(missed) < 0.5)
