"""The straight road, between the two sides of a disc of which one was run."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
import pytest
from brush import Brush
from conftest import DISC, brush, build, disc_of_a_brush

import tir
from mffit.fit.coverage import UNSEEN
from mffit.measured import camber_of_no_spin
from mffit.report.text.prediction import prediction_summary
from mffit.rig import Simulation
from mffit.rig_errors import error_of
from mffit.rounding import AtLeast
from mffit.scatter import rms
from tir.evaluate import CONICITY

ODD = {"PEY3", "PHY1", "PHY2", "PVY1", "PVY2", "QBZ4", "QDZ3", "QDZ6", "QDZ7", "QEZ4", "QHZ1", "QHZ2"}
TYRE = Brush(mu=1.3, b=0.025, crown=0.5, reduction=0.1)


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    return build(disc_of_a_brush(tmp_path_factory.mktemp("brush") / "tyre", TYRE))


def errors(built, phi_t: float):
    """Error of the best estimate, and half of its 95 % interval, at conditions between those that were run [N]."""
    alpha, gamma, Fz = (
        x.ravel() for x in np.meshgrid((-7, -3.5, -1.5, 0, 1.5, 3.5, 7), (-25, 0, 25), (1350.0, 2150.0))
    )
    found = built.predict(alpha_deg=alpha, gamma_deg=gamma, Fz_N=Fz, phi_t_per_m=phi_t)
    true, _ = TYRE.forces(np.radians(alpha), np.radians(gamma), Fz, phi_t=phi_t)
    return found["Fy_best_N"] - true, 1.96 * found["u_Fy_best_N"], found["Fy_N"] - true


def test_where_the_formula_misses_one_side_of_a_disc_holds_the_asymmetries(built):
    held = {name for row in built.result.fit.coverage if UNSEEN in row.missing for name in row.held}
    assert held >= ODD
    assert all(built.result.fit.coefficients[name].value == 0.0 for name in ODD)


def test_a_tyre_turned_on_its_rim_shows_no_ply_steer(tmp_path):
    """On the same side of a disc it has the same ply-steer, and the formula misses it by the same."""
    flipped = ("sideslip", "forward_roll")
    found = build(disc_of_a_brush(tmp_path / "tyre", TYRE, flipped=flipped, conicity=0.02))
    assert all(found.result.fit.coefficients[name].value == 0.0 for name in ODD - {*CONICITY})
    assert found.result.fit.coefficients["PVY1"].value > 0.0


def test_errors_of_the_rig_that_the_model_error_hides_stay_as_declared(built):
    """Free ones would be stated as 0.1 +- 0.5 deg of camber skew, of which 0.1 is declared, and the path radius as +- 4 mm."""
    assert "camber_skew_deg" not in built.result.fit.rig
    assert built.result.fit.rig["path_radius_m"] == pytest.approx((DISC, 0.0018))


def test_noise_that_hides_what_the_formula_misses_does_not_free_the_asymmetries(tmp_path):
    """Free ones give the symmetric tyre a grip of 0.98 +- 0.02 to one side and of 1.05 +- 0.02 to the other."""
    found = build(disc_of_a_brush(tmp_path / "tyre", TYRE, noise=70.0)).result
    assert all(found.fit.coefficients[name].value == 0.0 for name in ODD)


def test_the_road_is_inside_the_interval_and_the_file_is_near_it(built):
    """With free asymmetries the file is more than 80 N off, and half of the road outside."""
    error, half, file = errors(built, 0.0)
    assert np.mean(np.abs(error) < half) >= 0.9
    assert rms(error) < 50.0
    assert rms(file) < 60.0
    assert rms(half) < 0.05 * 2.5e3  # of the largest force


class PlySteered(NamedTuple):
    """A tyre with a sideslip of its own when it rolls straight ahead."""

    tyre: Brush
    slip: float  #: [rad]

    def __getattr__(self, name: str):
        return getattr(self.tyre, name)

    def forces(self, alpha, gamma, Fz, phi_t=0.0, direction=1.0):
        return self.tyre.forces(alpha + direction * self.slip, gamma, Fz, phi_t=phi_t, direction=direction)


@pytest.mark.parametrize(("runs", "slip"), [(("forward_roll",), 0.0), (("sideslip", "forward_roll"), 0.004)])
def test_the_other_side_of_a_disc_shows_an_asymmetry_that_there_is(tmp_path, runs, slip):
    """A few zeros there do not make an asymmetry of what the formula misses on this side."""
    found = build(disc_of_a_brush(tmp_path / "tyre", PlySteered(TYRE, slip), runs))
    held = {name for row in found.result.fit.coverage if UNSEEN in row.missing for name in row.held}
    assert (held >= ODD) == (slip == 0.0)
    if slip:
        return
    road, none = found.result.road.upright, 0.0 * found.result.road.upright.sideslip
    true, _ = TYRE.forces(road.sideslip, none, none + found.result.road.load)
    assert np.mean(np.abs(road.best["Fy"] - true) < 1.96 * road.u["Fy"]) > 0.9


def test_a_temperature_that_rises_along_every_sweep_alike_takes_up_no_model_error(tmp_path):
    """Friction and stiffness of this tyre do not change with it."""
    project = disc_of_a_brush(tmp_path / "tyre", TYRE)
    for path in project.parent.glob("*.csv"):
        table = pd.read_csv(path)
        table.assign(T_degC=np.linspace(40.0, 49.0, len(table))).to_csv(path, index=False)
    assert build(project).result.fit.temperature is None


def test_the_road_is_known_no_better_than_what_the_coefficients_change_from_the_disc_to_it(built):
    """By the posterior of the fit: its readings on one path hold the forces there, but not each coefficient."""
    at = pd.DataFrame({"alpha_deg": np.linspace(-7.0, 7.0, 15), "gamma_deg": 20.0, "Fz_N": 1700.0})
    result = built.result
    known, tyre = result.prediction, result.tyres[result.fitted]
    names, simulation = known.names, Simulation.of(tyre, turn_slip=True)
    road, disc = (
        simulation.sensitivities(known.points(tyre, at.assign(phi_t_per_m=phi_t)), names, ["Mz"])[1].Mz
        for phi_t in (0.0, known.path)
    )
    least = result.fit.search.posterior.spread_of(road - disc, names)
    assert np.all(built.predict(**at, phi_t_per_m=0.0)["u_Mz_best_Nm"] >= 0.999 * least)


def test_the_disc_is_predicted_as_well_as_before(built):
    error, half, _ = errors(built, -1.0 / DISC)
    assert np.mean(np.abs(error) < half) >= 0.9
    assert rms(error) < 30.0


def test_the_other_side_of_the_disc_is_the_mirror_image(built):
    """Asymmetries are held at zero, so that the estimate is exactly that of the side that was run."""
    alpha, gamma, Fz = (x.ravel() for x in np.meshgrid((-5.0, 0.0, 5.0), (-20.0, 20.0), (1700.0,)))
    one = built.predict(alpha_deg=alpha, gamma_deg=gamma, Fz_N=Fz, phi_t_per_m=-1.0 / DISC)
    other = built.predict(alpha_deg=-alpha, gamma_deg=-gamma, Fz_N=Fz, phi_t_per_m=1.0 / DISC)
    assert one["Fy_best_N"].to_numpy() == pytest.approx(-other["Fy_best_N"].to_numpy(), abs=0.01)
    assert one["Mz_best_Nm"].to_numpy() == pytest.approx(-other["Mz_best_Nm"].to_numpy(), abs=0.001)


def test_without_a_path_the_prediction_is_on_that_of_the_readings(built):
    at = {"alpha_deg": [3.0] * 2, "gamma_deg": 10.0, "Fz_N": 1700.0}
    found = built.predict(**at, phi_t_per_m=[-1.0 / DISC, np.nan])
    assert found["Fy_best_N"][0] == pytest.approx(found["Fy_best_N"][1])
    unstated = built.predict(**at)
    assert unstated["phi_t_per_m"].to_numpy() == pytest.approx(-1.0 / DISC)
    assert "on a curved path, as on the disc: 2 of 2 conditions" in prediction_summary(unstated, Path("a"))
    straight = built.predict(**at, phi_t_per_m=0.0)
    assert "curved" not in prediction_summary(straight, Path("a"))


def test_beyond_the_curvature_of_the_disc_the_interval_grows_and_it_is_said(built):
    halves = [rms(errors(built, -1.0 / DISC)[1])]
    for sharper in (2.0, 4.0):
        with pytest.warns(tir.TirWarning, match="phi_t_per_m is outside the tested path curvature"):
            halves.append(rms(errors(built, -sharper / DISC)[1]))
    assert halves[0] < halves[1] < halves[2]


def test_the_road_of_a_build_is_that_of_predict(built):
    """Values and uncertainties: there is one estimate."""
    road = built.result.road
    for curve in road.curves.values():
        found = built.predict(
            alpha_deg=np.degrees(curve.sideslip),
            gamma_deg=np.degrees(curve.camber),
            Fz_N=road.load,
            p_kPa=road.pressure / 1e3,
            phi_t_per_m=0.0,
        )
        for name, heading in (("Fy", "Fy_best_N"), ("Mz", "Mz_best_Nm")):
            assert curve.best[name] == pytest.approx(found[heading].to_numpy(), rel=1e-4, abs=1e-3)
            assert curve.u[name] == pytest.approx(found[f"u_{heading}"].to_numpy(), rel=1e-3)


def test_the_numbers_of_the_road_hold(built):
    """True values by the brush itself, to both sides: forces, and the grip up to the largest sideslip."""
    road = built.result.road
    alpha = np.radians(np.linspace(0.0, np.degrees(road.upright.sideslip[-1]), 400))
    for side, sign in (("negative", -1.0), ("positive", 1.0)):
        Fy, Mz = TYRE.forces(sign * alpha, 0.0 * alpha, 0.0 * alpha + road.load, phi_t=0.0)
        at = [np.interp(road.sideslip, alpha, x) for x in (Fy, Mz)]
        true = {
            "Fy": at[0],
            "Mz": at[1],
            "mu_y": np.max(np.abs(Fy)) / road.load,
            "M_zmax": np.max(np.abs(Mz)),
        }
        for name, value in true.items():
            found = getattr(road.sides[side], name)
            assert abs(found.value - value) < 3.0 * found.u
            assert found.u < 0.2 * abs(value)


def test_a_largest_force_is_a_peak_if_the_curve_falls_behind_it(built):
    """The moment of a brush falls when it slides; its side force does not within the tested sideslip."""
    for side in built.result.road.sides.values():
        assert isinstance(side.mu_y, AtLeast)
        assert not isinstance(side.M_zmax, AtLeast)


def test_the_miss_of_the_file_for_turn_slip_off_is_that_of_the_written_file(built):
    road = built.result.road
    normal = tir.read(built.folder / built.result.files["normal"])
    for posture, curve in road.curves.items():
        forces = normal(road.load, alpha=curve.sideslip, gamma=curve.camber, p=road.pressure, turn_slip=False)
        for name, missed in road.missed[posture].items():
            off = rms(getattr(forces, name) - curve.best[name])
            assert missed.rms == pytest.approx(off, rel=1e-3)
            assert missed.share == pytest.approx(off / np.max(np.abs(road.upright.best[name])), rel=1e-3)


def test_what_would_help_names_the_camber_without_spin(built):
    """There, the disc and the tilted wheel turn alike: sin(gamma) / r_e (1 - eps_gamma) = -1/R."""
    epsilon = built.result.measured.epsilon_gamma.value
    camber = camber_of_no_spin(-1.0 / DISC, TYRE.r_e, epsilon)
    assert (1.0 - epsilon) * np.sin(camber) / TYRE.r_e == pytest.approx(-1.0 / DISC)
    assert any(f"{np.degrees(camber):.1f} deg" in text for text in built.result.road.better) != (
        abs(np.degrees(camber) + 15.0) < 0.8  # it was run
    )
    assert any("other side" in text for text in built.result.road.better)
    assert camber_of_no_spin(-1.0, 0.3, 0.9) is None


def test_a_tyre_that_is_declared_symmetric_is_better_known_on_the_road(built, tmp_path):
    """On one side of a disc, a torque of the tyre's own cannot be told from the moment of turn slip."""
    path = disc_of_a_brush(tmp_path / "tyre", TYRE)
    path.write_text(path.read_text().replace("[tyre]", '[tyre]\nside = "symmetric"'))
    road = build(path).result.road
    before = built.result.road
    assert road.upright.half_width("Mz") < 0.9 * before.upright.half_width("Mz")
    assert any("symmetric" in text for text in before.better)
    assert not any("symmetric" in text for text in road.better)
    true, _ = TYRE.forces(
        road.upright.sideslip, 0.0 * road.upright.sideslip, 0.0 * road.upright.sideslip + road.load
    )
    assert np.mean(np.abs(road.upright.best["Fy"] - true) < 1.96 * road.upright.u["Fy"]) > 0.9


def test_result_json_states_the_road(built):
    content = json.loads((built.folder / "result.json").read_text())["road"]
    road = built.result.road
    assert content["sides"]["negative"]["mu_y"]["at_least"] is True
    assert content["sides"]["positive"]["M_zmax_Nm"]["u"] == pytest.approx(road.sides["positive"].M_zmax.u)
    assert content["curves"]["leaned"]["gamma_deg"] == pytest.approx(np.degrees(road.leaned.camber))
    assert content["missed_by_normal"]["leaned"]["Fy"]["rms"] == pytest.approx(
        road.missed["leaned"]["Fy"].rms
    )


def test_after_a_flat_belt_the_road_was_measured(foreign):
    road = foreign.result.road
    assert road.better == ()
    assert road.missed == {}
    true, _ = brush(road.upright.sideslip, 0.0, road.load)
    assert np.mean(np.abs(road.upright.best["Fy"] - true) < 1.96 * road.upright.u["Fy"]) > 0.9


def test_the_least_known_coefficient_is_the_one_that_adds_most(built):
    """The same coefficient with a thousand times its uncertainty, if the force depends on it there."""
    known, tyre = built.result.prediction, built.result.fit.tyre
    own = known.channels["Fy"]
    assert error_of(known.least_known(tyre, "Fy")) is None
    for name in ("PKY1", "PKY6"):  # the path turns, so that stiffness moves the force of the upright wheel
        root = own.root.copy()
        root[len(own.missed) + known.names.index(name)] *= 1e3
        moved = replace(known, channels={"Fy": replace(own, root=root)})
        assert moved.least_known(tyre, "Fy") == name
