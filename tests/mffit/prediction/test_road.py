"""The straight road, between the two sides of a disc of which one was run."""

from __future__ import annotations

import numpy as np
import pytest
from brush import Brush
from conftest import DISC, build, disc_of_a_brush

from mffit.fit.coverage import UNSEEN
from mffit.scatter import rms

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


def test_the_road_is_inside_the_interval_and_the_file_is_near_it(built):
    """With free asymmetries the file is more than 80 N off, and half of the road outside."""
    error, half, file = errors(built, 0.0)
    assert np.mean(np.abs(error) < half) >= 0.9
    assert rms(error) < 50.0
    assert rms(file) < 60.0
    assert rms(half) < 0.05 * 2.5e3  # of the largest force


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


def test_beyond_the_curvature_of_the_disc_the_interval_grows(built):
    halves = [rms(errors(built, phi_t)[1]) for phi_t in (-1.0 / DISC, -2.0 / DISC, -4.0 / DISC)]
    assert halves[0] < halves[1] < halves[2]
