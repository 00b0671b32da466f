"""Do predictions hold on tyres whose forces are known?"""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from conftest import FY_NOISE, MZ_NOISE, OFFSET, Built, belt, brush, build
from small_rigs import FY, MZ, truth

import tir
from mffit.constants import COVERAGE_FACTOR_95
from mffit.scatter import rms

PATH = -1.0 / 1.323  # of the disc, whose centre is on the left [1/m]


def drawn(n: int = 400, *, alpha: float, gamma: float, loads: tuple[float, float]) -> pd.DataFrame:
    """Conditions within the tested range."""
    random = np.random.default_rng(11)
    return pd.DataFrame(
        {
            "alpha_deg": random.uniform(-alpha, alpha, n),
            "gamma_deg": random.uniform(-gamma, gamma, n),
            "Fz_N": random.uniform(*loads, n),
        }
    )


@pytest.fixture(scope="module")
def on_belt() -> pd.DataFrame:
    return drawn(alpha=9.5, gamma=4.0, loads=(800.0, 3400.0))


@pytest.fixture(scope="module")
def true(on_belt) -> dict[str, np.ndarray]:
    """Forces of the brush tyre there."""
    Fy, Mz = brush(np.radians(on_belt.alpha_deg), np.radians(on_belt.gamma_deg), on_belt.Fz_N)
    return {"Fy_N": Fy.to_numpy(), "Mz_Nm": Mz.to_numpy()}


@pytest.fixture(scope="module")
def foretold(foreign, on_belt) -> pd.DataFrame:
    return foreign.predict(**on_belt)


def of_truth(result: pd.DataFrame, **settings: float) -> tir.tyre.Forces:
    """The true forces of the virtual rig's tyre at conditions."""
    angles = {name: np.radians(result[f"{name}_deg"].to_numpy()) for name in ("alpha", "gamma")}
    return truth()(result.Fz_N.to_numpy(), **angles, p=250e3, **settings)


@pytest.mark.parametrize("column", ["Fy_N", "Mz_Nm"])
def test_what_the_formula_misses_is_added(foretold, true, column):
    best = column.replace("_", "_best_")
    assert rms(true[column] - foretold[best]) < 0.6 * rms(true[column] - foretold[column])


@pytest.mark.parametrize(("column", "most", "wide"), [("Fy_N", 0.995, 3.0), ("Mz_Nm", 1.0, 5.0)])
def test_the_truth_lies_within_the_interval_of_the_best_estimate(foretold, true, column, most, wide):
    """The rig is declared as exact, but for the zero of Mz, which nothing declares."""
    best = column.replace("_", "_best_")
    error, half = true[column] - foretold[best], COVERAGE_FACTOR_95 * foretold[f"u_{best}"]
    assert 0.88 <= np.mean(np.abs(error) < half) <= most
    assert rms(half.to_numpy()) < wide * rms(error)


def test_readings_of_new_runs_lie_within_their_intervals(foretold, true):
    """15 N from run to run and 12 N of noise, as drawn: around the file too, whose miss counts."""
    random = np.random.default_rng(2)
    reading = true["Fy_N"] + np.hypot(OFFSET, FY_NOISE) * random.standard_normal(len(foretold))
    for centre, u in (("Fy_N", "u_Fy_N"), ("Fy_best_N", "u_Fy_run_N")):
        inside = np.abs(reading - foretold[centre]) < COVERAGE_FACTOR_95 * foretold[u]
        assert 0.88 <= np.mean(inside) <= 0.995
    of_a_reading = rms(np.sqrt(foretold.u_Fy_run_N**2 - foretold.u_Fy_best_N**2).to_numpy())
    assert of_a_reading == pytest.approx(np.hypot(OFFSET, FY_NOISE), rel=0.2)
    assert np.all(foretold.u_Fy_run_N <= foretold.u_Fy_N)


def test_size_of_what_is_missed_and_noise_are_found(foreign):
    points = foreign.result.points
    Fy, Mz = brush(points.alpha, points.gamma, points.Fz)
    fitted = foreign.predict(
        alpha_deg=np.degrees(points.alpha), gamma_deg=np.degrees(points.gamma), Fz_N=points.Fz
    )
    of_Fy, of_Mz = (foreign.result.prediction.channels[name] for name in ("Fy", "Mz"))
    assert of_Fy.size == pytest.approx(rms(Fy - fitted.Fy_N), rel=0.25)
    assert of_Mz.size == pytest.approx(rms(Mz - fitted.Mz_Nm), rel=0.25)
    assert of_Fy.noise == pytest.approx(FY_NOISE, rel=0.3)
    assert of_Mz.noise == pytest.approx(MZ_NOISE, rel=0.3)


@pytest.mark.parametrize("offset", [6.0, 40.0])
def test_scatter_from_run_to_run_is_found(tmp_path, offset):
    """Fifteen runs tell its size to about a fifth."""
    built = build(belt(tmp_path / "tyre", seed=5, offset=offset))
    assert built.result.prediction.channels["Fy"].components.offset == pytest.approx(offset, rel=0.45)


def test_a_tyre_of_the_formula_misses_nothing(of_formula):
    found = of_formula.predict(**drawn(alpha=8.0, gamma=40.0, loads=(900.0, 2100.0)))
    for name, column, noise in (("Fy", "Fy", FY), ("Mz", "Mz", MZ)):
        unit = "N" if name == "Fy" else "Nm"
        assert of_formula.result.prediction.channels[name].size < 0.2 * noise
        assert rms((found[f"{column}_best_{unit}"] - found[f"{column}_{unit}"]).to_numpy()) < 0.2 * noise
    Fy = of_truth(found, phi_t=PATH).Fy
    assert np.mean(np.abs(Fy - found.Fy_best_N) < COVERAGE_FACTOR_95 * found.u_Fy_best_N) > 0.9


def test_far_from_the_tested_range_the_best_estimate_is_the_file(foreign):
    """And as uncertain as everything that a formula may miss."""
    inside = foreign.predict(alpha_deg=[8.0], gamma_deg=[0.0], Fz_N=[2000.0])
    with pytest.warns(tir.TirWarning, match="Fz_N is outside the range"):
        outside = foreign.predict(alpha_deg=[8.0], gamma_deg=[0.0], Fz_N=[9000.0])
    missed, faded = ((found.Fy_best_N - found.Fy_N)[0] for found in (inside, outside))
    assert abs(faded) < 0.01 * abs(missed)
    assert outside.u_Fy_best_N[0] > foreign.result.prediction.channels["Fy"].components.missed


def test_iso_w_whatever_the_axes_of_the_project(of_formula, in_sae):
    conditions = drawn(alpha=8.0, gamma=40.0, loads=(900.0, 2100.0))
    iso, sae = of_formula.predict(**conditions), in_sae.predict(**conditions)
    for column in ("Fy_N", "Fy_best_N"):
        assert rms((iso[column] - sae[column]).to_numpy()) < 2.0 * FY
    assert rms((iso.Mz_best_Nm - sae.Mz_best_Nm).to_numpy()) < 2.0 * MZ


def test_with_normal_as_plain_file_the_best_estimate_is_of_the_stated_path(straight):
    conditions = drawn(alpha=6.0, gamma=20.0, loads=(900.0, 2100.0))
    on_disc = straight.predict(**conditions)
    file = tir.read(straight.folder / "small.tir")
    assert not file.turn_slip
    assert on_disc.Fy_N.to_numpy() == pytest.approx(of_file(file, on_disc))
    error = of_truth(on_disc, phi_t=PATH).Fy - on_disc.Fy_best_N
    assert rms(error.to_numpy()) < 3.0 * FY
    # The turn-slip force is a fifth of the load, which the uncertainty around a file without it holds.
    assert rms((on_disc.Fy_best_N - on_disc.Fy_N).to_numpy()) > 20.0 * FY
    assert np.all(on_disc.u_Fy_N > np.abs(on_disc.Fy_best_N - on_disc.Fy_N))
    on_road = straight.predict(**conditions, phi_t_per_m=0.0)
    error = of_truth(on_road, turn_slip=False).Fy - on_road.Fy_best_N
    assert np.mean(np.abs(error) < COVERAGE_FACTOR_95 * on_road.u_Fy_best_N) > 0.9


def of_file(file: tir.Tyre, at: pd.DataFrame) -> np.ndarray:
    """Fy of a property file."""
    alpha, gamma = np.radians(at.alpha_deg.to_numpy()), np.radians(at.gamma_deg.to_numpy())
    return file(at.Fz_N.to_numpy(), alpha=alpha, gamma=gamma).Fy


def test_stated_temperature_counts_and_a_missing_one_widens(warming: Built):
    """1 % of the side force per kelvin; the runs were 44 to 60 degC warm."""
    conditions = drawn(200, alpha=9.5, gamma=4.0, loads=(800.0, 3400.0))
    cold, warm = (warming.predict(**conditions, T_degC=T) for T in (46.0, 58.0))
    none, blank = warming.predict(**conditions), warming.predict(**conditions, T_degC=np.nan)
    Fy, _ = brush(np.radians(conditions.alpha_deg), np.radians(conditions.gamma_deg), conditions.Fz_N)
    large = np.abs(Fy) > 1000.0
    lost = ((warm.Fy_best_N - cold.Fy_best_N) / Fy)[large]
    assert np.median(lost) == pytest.approx(-0.12, abs=0.03)
    assert np.array_equal(none.Fy_best_N, blank.Fy_best_N)
    between = (none.Fy_best_N - cold.Fy_best_N) * (none.Fy_best_N - warm.Fy_best_N)
    assert np.mean(between[large] < 0.0) > 0.95
    assert np.all(none.u_Fy_run_N[large] > warm.u_Fy_run_N[large])
    mixed = warming.predict(**conditions, T_degC=[46.0, np.nan] * 100)
    np.testing.assert_allclose(mixed.Fy_best_N[::2], cold.Fy_best_N[::2], rtol=1e-12)
    np.testing.assert_allclose(mixed.Fy_best_N[1::2], none.Fy_best_N[1::2], rtol=1e-12)


@pytest.mark.parametrize("T", [46.0, 52.0, 58.0])
def test_the_best_estimate_is_the_tyre_at_the_stated_temperature(warming: Built, T: float):
    """A plain file takes part of the warming up: added to it, the temperature would count twice."""
    conditions = drawn(200, alpha=9.5, gamma=4.0, loads=(800.0, 3400.0))
    found = warming.predict(**conditions, T_degC=T)
    Fy, _ = brush(np.radians(conditions.alpha_deg), np.radians(conditions.gamma_deg), conditions.Fz_N)
    error = found.Fy_best_N - Fy * (1.0 - 0.01 * (T - 50.0))
    assert np.sqrt(np.mean(error**2)) < 0.01 * np.max(np.abs(Fy))
    assert np.mean(np.abs(error) < COVERAGE_FACTOR_95 * found.u_Fy_best_N) > 0.9


def test_temperature_acts_as_far_as_it_was_tested(warming: Built):
    """Beyond, prediction and file stay at the nearest tested temperature, and both say so."""
    conditions = drawn(20, alpha=9.5, gamma=4.0, loads=(800.0, 3400.0))
    low, high = warming.result.fit.temperature.T_range
    file = tir.read(warming.folder / "brush-at-temperature.tir")
    for beyond, end in ((20.0, low), (90.0, high)):
        at_end = warming.predict(**conditions, T_degC=end)
        with pytest.warns(
            tir.TirWarning, match=f"T_degC is outside the tested temperatures, {low:.4g} to {high:.4g}"
        ):
            further = warming.predict(**conditions, T_degC=beyond)
        np.testing.assert_allclose(further.Fy_best_N, at_end.Fy_best_N, rtol=1e-12)
        np.testing.assert_allclose(
            of_file(file.at_temperature(beyond), conditions),
            of_file(file.at_temperature(end), conditions),
            rtol=1e-5,
        )


def test_prediction_and_file_move_alike_with_temperature(warming: Built):
    """They differ by the model error; this hardly moves, because the tyre is a brush whose side force falls as a whole."""
    conditions = drawn(200, alpha=9.5, gamma=4.0, loads=(800.0, 3400.0))
    file = tir.read(warming.folder / "brush-at-temperature.tir")
    best = [warming.predict(**conditions, T_degC=T).Fy_best_N for T in (46.0, 58.0)]
    own = [of_file(file.at_temperature(T), conditions) for T in (46.0, 58.0)]
    moved, size = best[1] - best[0] - (own[1] - own[0]), np.abs(own[1] - own[0])
    assert np.sqrt(np.mean(moved**2)) < 0.15 * np.sqrt(np.mean(size**2))


def test_the_path_of_a_belt_is_straight(foreign: Built):
    conditions = pd.DataFrame(
        {"alpha_deg": [8.0] * 3, "gamma_deg": 0.0, "Fz_N": 3000.0, "phi_t_per_m": [-0.5, 0.0, np.nan]}
    )
    on_belt = foreign.predict(**conditions)
    assert on_belt.Fy_best_N.to_numpy() == pytest.approx(on_belt.Fy_best_N[0])
