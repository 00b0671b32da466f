"""Residuals of the fit by arithmetic, and their derivatives by differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_rigs import truth

from mffit.fit.constraints import Envelope
from mffit.fit.problem import FitProblem
from mffit.measured import RadiusReading
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.rig_errors import NO_FAULTS

N = 12
ENVELOPE = Envelope(Fz=(900.0, 2100.0), gamma=0.5, alpha=0.14, pressure=(2e5, 3e5))
RADII = (RadiusReading(900.0, 0.2960, 2e-4, True), RadiusReading(2100.0, 0.2935, 4e-4, False))


@pytest.fixture(scope="module")
def problem() -> FitProblem:
    rng = np.random.default_rng(4)
    tyre = truth()
    points = make_points(
        rng.uniform(-0.1, 0.1, N), rng.uniform(-0.4, 0.4, N), rng.uniform(900.0, 2000.0, N), p=250e3, V=6.0, phi_t=-1 / 1.323
    )  # fmt: skip
    Fy, Mz = Simulation.of(tyre).readings(points).values()
    Mz = Mz.copy()
    Mz[3] = np.nan
    points = points.replace(Fy=Fy, Mz=Mz)
    sigma_Fy, sigma_Mz = np.full(N, 6.0), np.full(N, 0.6)
    sigma_Fy[5] = np.inf
    simulation = Simulation(dict(tyre.values), NO_FAULTS)
    return FitProblem(points, simulation, {"Fy": sigma_Fy, "Mz": sigma_Mz}, None, RADII, 6.0)


def in_a_row(by_channel) -> np.ndarray:
    return np.concatenate([by_channel["Fy"], by_channel["Mz"]])


def test_the_misfit_is_in_units_of_the_uncertainty(problem):
    assert in_a_row(problem.misfit()) == pytest.approx(np.zeros(2 * N), abs=1e-9)
    off = in_a_row(problem.with_values({"F0_N": 12.0, "M0_Nm": -0.3}).misfit())
    expected = np.concatenate([np.full(N, 2.0), np.full(N, -0.5)])
    expected[[5, N + 3]] = 0.0  # not used, not measured
    assert off == pytest.approx(expected)


def test_the_side_force_in_Mx_is_the_one_that_was_read(problem):
    """A wrong cornering stiffness leaves Mx where it is, and no Mx asks for another one; without a reading of Fy it does."""
    tyre = truth().replace(QSX1=0.01, QSX2=0.4, QSX3=0.05, QSX13=0.02)
    Mx = Simulation.of(tyre).readings(problem.points, ["Mx"]).Mx
    sigma = {**problem.sigma, "Mx": np.full(N, 2.0)}
    simulation = Simulation({**tyre.values, "PKY1": 1.3 * tyre["PKY1"], "QSX1": 0.02}, NO_FAULTS)
    off = replace(problem, points=problem.points.replace(Mx=Mx), simulation=simulation, sigma=sigma, radii=())
    rows = np.arange(N) != 5  # where Fy has no weight
    R0, load = tyre["UNLOADED_RADIUS"], problem.points.Fz
    misfit = off.misfit()
    assert np.max(np.abs(misfit["Fy"])) > 10.0
    assert misfit["Mx"][rows] == pytest.approx((R0 * load * 0.01 / 2.0)[rows], rel=1e-6)
    names = ["PKY1", "QSX3", "QSX13", "F0_N"]
    residual, slope = off.rows(names)
    of_Mx = list(off.sigma).index("Mx") * N + np.arange(N)
    assert residual[of_Mx] == pytest.approx(misfit["Mx"])
    assert np.max(np.abs(slope[of_Mx, 0][rows])) < 1e-9 * np.abs(tyre["PKY1"])
    assert abs(slope[of_Mx[5], 0]) > 1e-4
    Fy = problem.points.Fy
    assert slope[of_Mx, 1][rows] == pytest.approx((R0 * load / tyre["FNOMIN"] * Fy / 2.0)[rows])
    for k, name in enumerate(names):
        step = 1e-4
        up, down = (off.with_values({name: off.value(name) + s}).misfit()["Mx"] for s in (step, -step))
        assert slope[of_Mx, k] == pytest.approx((up - down) / (2.0 * step), rel=1e-4, abs=1e-6)


def test_a_measured_radius_counts_as_a_reading(problem):
    """A radius from a revolution of the disc is proportional to the path radius; a given one is not."""
    Re = problem.simulation.values, truth().state(np.array([900.0, 2100.0]), Vx=6.0).Re
    residual, _ = problem.free(["path_radius_m"]).residual(np.array([1.323]))
    assert residual[2 * N :] == pytest.approx((Re[1] - [0.2960, 0.2935]) / [2e-4, 4e-4])
    wider, _ = problem.free(["path_radius_m"]).residual(np.array([1.323 * 1.001]))
    assert wider[2 * N :] - residual[2 * N :] == pytest.approx([-0.2960 * 0.001 / 2e-4, 0.0], abs=1e-9)


@pytest.mark.parametrize(
    "name",
    [
        "PKY1",
        "PKY6",
        "PEY1",
        "QDZ1",
        "QEZ1",
        "Q_RE0",
        "PECP1",
        "path_radius_m",
        "alpha_0_deg",
        "gamma_0_deg",
        "F0_N",
    ],
)
def test_derivatives_are_the_differences_of_the_residuals(problem, name):
    """Broken limits too: the curvature exceeds 1 on purpose."""
    bent = replace(problem.with_values({"PEY1": 1.1, "QEZ1": 1.2}), envelope=ENVELOPE)
    chosen = bent.free([name, "PCY1"])
    x = np.array([bent.simulation.number(name, bent.points), 1.4])
    here, h = chosen.linear(x), 1e-6
    up, down = (chosen.residual(x + np.array([s, 0.0])) for s in (h, -h))
    for found, high, low in zip((here.slope, here.limits_slope), up, down, strict=True):
        expected = (high - low) / (2.0 * h)
        assert found[:, 0] == pytest.approx(expected, abs=1e-4 * (1.0 + np.max(np.abs(expected))))
    assert here.data == pytest.approx(chosen.residual(x)[0])
    assert here.limits == pytest.approx(chosen.residual(x)[1])
    assert np.any(here.limits > 0.0)


def test_selected_points_keep_their_weights(problem):
    part = problem.select(np.array([5, 7]))
    assert list(part.sigma["Fy"]) == [np.inf, 6.0]
    assert len(part.points) == 2
    assert part.points.Fz[1] == problem.points.Fz[7]
