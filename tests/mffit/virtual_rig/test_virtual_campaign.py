"""The whole campaign in memory: chance, faults drawn from declared uncertainties, truth."""

from __future__ import annotations

import dataclasses
import tomllib

import numpy as np
import pytest

from mffit import config, virtual_rig
from mffit.errors import InputError
from mffit.virtual_rig import load_plan
from mffit.virtual_rig.campaign import faults_in_setups
from mffit.virtual_rig.settings import settings_of
from mffit.virtual_rig.simulate import configuration_text
from mffit.virtual_rig.truth import direct_truth

NOISE = {"Fy_N": 6.0, "Mz_Nm": 0.6}
DRAW = {"draw": True}
SHORT = [{"file": "zero.csv", "load_N": 1400, "alpha_deg": [0]}]
"""Sweeps of campaigns of which only the radii are asked."""


def test_the_same_seed_gives_the_same_tables(run):
    first, second, other = (run(seed, noise=NOISE, faults=DRAW) for seed in (4, 4, 5))
    assert first.truth == second.truth
    for name, table in first.tables.items():
        assert table.equals(second.tables[name])
        assert not table.equals(other.tables[name])


def test_a_sweep_more_leaves_the_others_as_they_were(run, content):
    extra = {"file": "extra.csv", "load_N": 900, "gamma_deg": [0, 10]}
    before, after = run(1, noise=NOISE), run(1, noise=NOISE, sweep=[*content["sweep"], extra])
    for name, table in before.tables.items():
        assert table.equals(after.tables[name])


def test_scatter_has_the_size_that_is_declared(run, content):
    many = [{"file": "many.csv", "load_N": 1400, "alpha_deg": [0] * 4000}]
    table, still = run(noise=NOISE, sweep=many).tables["many.csv"], run(sweep=many).tables["many.csv"]
    assert (table["Fy_N"] - still["Fy_N"]).std() == pytest.approx(6.0, rel=0.05)
    assert (table["Mz_Nm"] - still["Mz_Nm"]).std() == pytest.approx(0.6, rel=0.05)
    assert (table["u_Fy_N"] == 6.0).all()
    assert (table["u_Mz_Nm"] == 0.6).all()


@pytest.mark.parametrize(
    ("noise", "stated"),
    [
        ({"Fy_N": 6.0, "Mz_Nm": 0.0}, (6.0, 0.0)),
        ({"Fy_N": 0.0, "Mz_Nm": 0.6}, (0.0, 0.6)),
        ({"Fy_N": 0.0, "Mz_Nm": 0.0}, None),
        (NOISE | {"declared": False}, None),
    ],
)
def test_the_rig_states_its_scatter_if_it_has_any_and_declares_it(run, noise, stated):
    table = run(noise=noise).tables["sideslip.csv"]
    found = (table["u_Fy_N"][0], table["u_Mz_Nm"][0]) if "u_Fy_N" in table else None
    assert found == stated


def decimals(values) -> int:
    """The fewest decimals with which all values are written in full."""
    return next(k for k in range(6) if np.allclose(np.round(values, k), values, rtol=0.0, atol=1e-9))


def test_tables_have_as_many_decimals_as_a_rig_resolves(run, content):
    odd = {
        "load_N": 1400.1234,
        "alpha_deg": [-1.23456, 2.34567],
        "gamma_deg": [1.23456],
        "V_mps": 6.2468,
        "p_kPa": 250.4321,
    }
    sweep = odd | {"file": "a.csv", "T_degC": [20.1234, 30.1234]}
    noise = NOISE | {"My_Nm": 0.1}
    points = run(sweep=[sweep], noise=noise, conditions={"seconds_per_point": 7.654}).tables["a.csv"]
    assert {name: decimals(points[name]) for name in points if not name.startswith("u_")} == {
        "alpha_deg": 3, "gamma_deg": 3, "Fz_N": 1, "p_kPa": 1, "V_mps": 2, "T_degC": 1, "Fy_N": 2, "Mz_Nm": 3, "My_Nm": 3,
        "t_s": 1,
    }  # fmt: skip
    recording = {"recording": {"rate_Hz": 64.0, "noise_Fz_N": 5.0, "noise_My_Nm": 0.3}}
    series = run(sweep=[sweep | recording], noise=noise).tables["a.csv"]
    assert {name: decimals(series[name]) for name in series} == {
        "time_s": 3, "alpha_deg": 2, "gamma_deg": 2, "Fz_N": 0, "p_kPa": 1, "V_mps": 2, "T_degC": 1, "Fy_N": 0, "Mz_Nm": 1,
        "My_Nm": 1,
    }  # fmt: skip


def test_the_wheel_rolls_in_the_direction_of_its_sweep(content, folder):
    *forward, backward = settings_of(load_plan(content, folder=folder))
    assert all(np.all(settings.Vx == settings.V) for settings in forward)
    assert np.all(backward.Vx == -backward.V)
    assert backward.V.min() > 0.0


def test_the_project_file_names_only_what_differs_from_the_usual(run, content):
    mounted = content["sweep"][1] | {"mount": "flipped"}
    made = run(sweep=[content["sweep"][0], mounted, content["sweep"][3]]).configuration
    assert made["sweep"] == [
        {"file": "sideslip.csv"}, {"file": "camber.csv", "mount": "flipped"}, {"file": "backward.csv", "direction": "backward"},
    ]  # fmt: skip
    assert list(made)[:3] == ["tyre", "rig", "rolling_radius"]
    assert list(made)[-1] == "sweep"


@pytest.mark.parametrize("seed", [-1, 0])
def test_a_seed_is_not_negative(run, seed):
    if seed < 0:
        with pytest.raises(InputError, match="the seed is -1; give a whole number, 0 or larger"):
            run(seed)
    else:
        assert run(seed).truth.seed == 0


def test_drawn_faults_scatter_as_declared(content, folder, tyre):
    plan = load_plan(content | {"faults": DRAW}, folder=folder)
    rng = np.random.default_rng(0)
    drawn = [faults_in_setups(plan, tyre, rng)[plan.setups[0]] for _ in range(1500)]
    C_alpha = abs(tyre.state(1400.0, Vx=6.0).K_ya)
    expected = {
        "alpha_0_deg": (0.0, np.degrees(25.0 / C_alpha)),
        "gamma_0_deg": (0.0, 0.5),
        "F0_N": (0.0, 10.0),
        "path_radius_m": (1.323, 0.0018),
    }
    for name, (mean, u) in expected.items():
        values = [faults[name] for faults in drawn]
        # 1500 draws: u to 1.8 %, the mean to 0.026 u
        assert np.std(values) == pytest.approx(u, rel=0.08)
        assert np.mean(values) == pytest.approx(mean, abs=0.1 * u)


def test_a_fault_that_is_given_is_not_drawn_and_leaves_the_others_alone(content, folder, tyre):
    def faults(**table):
        plan = load_plan(content | {"faults": DRAW | table}, folder=folder)
        return faults_in_setups(plan, tyre, np.random.default_rng(7))[plan.setups[0]]

    free, fixed = faults(), faults(gamma_0_deg=0.25, gain=1.02)
    assert fixed["gamma_0_deg"] == 0.25
    assert fixed["gain"] == 1.02
    assert (fixed["alpha_0_deg"], fixed["F0_N"]) == (free["alpha_0_deg"], free["F0_N"])


def test_a_sweep_may_have_errors_of_its_own(run):
    """What a load cell that is zeroed anew before a run adds to that run, and to no other."""
    sweeps = [{"file": f"{name}.csv", "load_N": 1400, "alpha_deg": [-2.0, 2.0]} for name in "ab"]
    plain = run(sweep=sweeps)
    shifted = run(sweep=[sweeps[0], sweeps[1] | {"faults": {"F0_N": 7.0, "M0_Nm": -0.5}}])
    for channel, added in (("Fy_N", 7.0), ("Mz_Nm", -0.5)):
        assert np.allclose(shifted.tables["a.csv"][channel], plain.tables["a.csv"][channel])
        assert np.allclose(
            shifted.tables["b.csv"][channel] - plain.tables["b.csv"][channel], added, atol=0.011
        )
    assert shifted.truth.to_json()["faults_of_sweeps"] == {"b.csv": {"F0_N": 7.0, "M0_Nm": -0.5}}


def test_the_disc_revolution_gives_the_true_radius_within_its_uncertainty(run):
    campaign = run(sweep=SHORT, rolling_radius=[{"load_N": 1400}] * 200)
    rows = [config.RollingRadiusTable(**row) for row in campaign.configuration["rolling_radius"]]
    errors = [config.effective_radius(row, 1.323) - campaign.truth.nominal.r_e_m for row in rows]
    r_e, turn = 0.2924, 2 * np.pi * 1.323 / 0.2924
    # (18): two angles of 1 deg and two arcs of 1 mm
    u = r_e * np.hypot(np.sqrt(2) * np.radians(1.0) / turn, np.sqrt(2) * 0.001 / (2 * np.pi * 1.323))
    assert np.std(errors) == pytest.approx(u, rel=0.15)
    assert np.mean(errors) == pytest.approx(0.0, abs=0.2 * u)


def test_a_given_radius_is_off_by_its_uncertainty(run):
    radius = {"load_N": 1400, "u_effective_radius": 0.0005}
    rows = run(rolling_radius=[radius] * 200, sweep=SHORT).configuration["rolling_radius"]
    assert np.std([row["effective_radius"] for row in rows]) == pytest.approx(0.0005, rel=0.2)


def test_the_true_epsilon_is_the_tyres_own_coefficient(tyre):
    unshifted = tyre.replace(PHY1=0.0, PHY2=0.0, PVY1=0.0, PVY2=0.0)
    truth = direct_truth(unshifted, 1400.0, speed=6.0, pressure=250e3, phi_t=-1 / 1.323, R=1.323)
    assert truth.epsilon_gamma == pytest.approx(tyre["PECP1"], abs=1e-6)
    R0, K = tyre["UNLOADED_RADIUS"], truth.C_gamma_N_per_rad
    assert truth.C_phit_Nm == pytest.approx(R0 * abs(K) / (1 - tyre["PECP1"]), rel=1e-6)
    assert truth.C_gamma_turn_slip_N_per_rad == pytest.approx(K * R0 / truth.r_e_m, rel=1e-6)
    assert truth.C_phit_secant_Nm == pytest.approx(-truth.F_phit_N * truth.R_m)


def test_truth_over_load_follows_pecp2(run, tyre, content):
    sweeps = [{"file": f"{load}.csv", "load_N": load} for load in (900, 1400, 2100)]
    for row in run(sweep=sweeps).truth.per_load:
        dfz = row.load_N / 1400.0 - 1.0
        expected = tyre["PECP1"] * (1 + tyre["PECP2"] * dfz)
        # The shifts of this tyre move the slopes at zero by some 1e-5.
        assert row.epsilon_gamma == pytest.approx(expected, abs=1e-4)


def test_the_configuration_is_one_that_build_accepts(run, folder):
    content = run(noise=NOISE, faults=DRAW).configuration
    loaded = config.load(content, folder=folder)
    assert [sweep.file for sweep in loaded.sweep] == [
        "sideslip.csv",
        "camber.csv",
        "forward.csv",
        "backward.csv",
    ]
    assert loaded.sweep[3].direction == "backward"
    assert loaded.rig.path_radius == 1.323


def test_every_table_of_the_declaration_reaches_tyre_toml(content, folder, tyre):
    class Extended(config.Config):
        """A configuration with tables that the virtual rig has never heard of."""

        comment: str = ""
        later: dict[str, float] = {}  # noqa: RUF012
        steps: tuple[dict[str, int], ...] = ()

    plan = load_plan(content | {"spin": {"exact": "turn-slip"}}, folder=folder)
    known = {name: getattr(plan.declared, name) for name in plan.declared.model_fields_set}
    declared = Extended.model_construct(**known, comment="new", later={"a": 1.5}, steps=({"b": 1}, {"b": 2}))
    declared._folder = folder
    made = virtual_rig.run(dataclasses.replace(plan, declared=declared), tyre).configuration
    written = tomllib.loads(configuration_text(made))
    assert written["comment"] == "new"
    assert written["later"] == {"a": 1.5}
    assert written["steps"] == [{"b": 1}, {"b": 2}]
    assert written["spin"] == {"exact": "turn-slip"}
    assert list(written)[-1] == "sweep"


def test_time_runs_on_from_sweep_to_sweep(run):
    tables = run(conditions={"seconds_per_point": 60}).tables
    t = np.concatenate([table["t_s"] for table in tables.values()])
    np.testing.assert_allclose(np.diff(t), 60.0)


def test_temperature_runs_from_the_first_to_the_last_point(run, content):
    sweep = content["sweep"][0] | {"T_degC": [20, 50]}
    table = run(sweep=[sweep], faults={"k_T_per_K": -0.01}).tables["sideslip.csv"]
    cold = run(sweep=[content["sweep"][0]]).tables["sideslip.csv"]
    assert (table["T_degC"].iloc[0], table["T_degC"].iloc[-1]) == (20.0, 50.0)
    np.testing.assert_allclose(table["Fy_N"] / cold["Fy_N"], 1 - 0.01 * (table["T_degC"] - 25.0), atol=1e-3)
