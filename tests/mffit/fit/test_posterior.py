"""Uncertainty of a fit: bands, draws and bent valleys, against finite differences, counting and a banana in closed form."""

from __future__ import annotations

import numpy as np
import pytest

import mffit
from mffit.fit import ensemble
from mffit.fit.profile import follow
from mffit.least_squares import FreeNumber, LeastSquaresProblem, Linear, solve
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.rig_errors import BY_NAME as RIG_ERRORS


@pytest.fixture(scope="module")
def fitted(tmp_path_factory):
    from drawn_rigs import SAMPLE, plan_content

    from mffit import virtual_rig

    content = plan_content(thin=True)
    folder = tmp_path_factory.mktemp("thin")
    virtual_rig.simulate(virtual_rig.load_plan(content, folder=SAMPLE), folder, seed=3)
    return mffit.build(folder / "tyre.toml").fit


def test_the_band_is_the_propagated_covariance(fitted):
    posterior, tyre = fitted.posterior, fitted.tyre
    alpha, gamma, Fz = (
        np.radians([0.0, 3.0, -6.0]),
        np.radians([20.0, 0.0, 5.0]),
        np.array([1400.0, 900.0, 2000.0]),
    )
    where = make_points(alpha, gamma, Fz, p=250e3, V=10.0, phi_t=0.0)
    half = posterior.band(Simulation.of(tyre), where)
    names = [n for n in posterior.names if n not in RIG_ERRORS]
    rows = [posterior.names.index(n) for n in names]

    def forces(**changed):
        out = tyre.replace(**changed)(Fz, alpha, gamma, Vx=10.0, p=250e3, turn_slip=True)
        return np.array([out.Fy, out.Mz])

    step = {n: 1e-5 * max(abs(tyre[n]), 0.1) for n in names}
    slopes = np.array(
        [(forces(**{n: tyre[n] + h}) - forces(**{n: tyre[n] - h})) / (2 * h) for n, h in step.items()]
    )
    variance = np.einsum("icn,ij,jcn->cn", slopes, posterior.covariance[np.ix_(rows, rows)], slopes)
    assert np.array(list(half.values())) == pytest.approx(1.96 * np.sqrt(variance), rel=1e-3)


def test_draws_scatter_by_the_standard_errors(fitted):
    members = ensemble(fitted.search, 8, seed=1)
    assert len(members) == 8
    names = [n for n, c in fitted.coefficients.items() if c.stderr and not c.at_bound and n in members[0]]
    pulls = np.array(
        [[(m[n] - fitted.tyre[n]) / fitted.coefficients[n].stderr for n in names] for m in members]
    )
    assert len(names) > 50
    assert np.sqrt(np.mean(pulls**2)) == pytest.approx(1.0, abs=0.25)
    assert abs(np.mean(pulls)) < 0.25


def test_the_same_seed_draws_the_same_tyres(fitted):
    assert ensemble(fitted.search, 1, seed=4) == ensemble(fitted.search, 1, seed=4)
    assert ensemble(fitted.search, 1, seed=4) != ensemble(fitted.search, 1, seed=5)


class Banana:
    """x is known to 1, y = x^2 to 0.05: good fits lie along a parabola that no ellipse describes."""

    def __init__(self, **held: float) -> None:
        self.held, self.points = held, np.zeros(2)

    def select(self, index):
        return self

    def with_values(self, values):
        return Banana(**{**self.held, **values})

    def free(self, names) -> LeastSquaresProblem:
        def linear(at) -> Linear:
            now = {**self.held, **dict(zip(names, at, strict=True))}
            x, y = now["x"], now["y"]
            slopes = {"x": [1.0, -2.0 * x / 0.05], "y": [0.0, 1.0 / 0.05]}
            slope = np.array([slopes[n] for n in names]).T
            return Linear(np.array([x, (y - x * x) / 0.05]), slope, np.zeros(0), np.zeros((0, len(names))))

        return LeastSquaresProblem(lambda at: (linear(at).data, np.zeros(0)), linear)


def test_a_bent_valley_is_followed_to_the_ends_of_the_95_per_cent_interval():
    numbers = [
        FreeNumber("x", 0.1, -50.0, 50.0, spread=100.0),
        FreeNumber("y", 0.0, -50.0, 50.0, spread=100.0),
    ]
    problem = Banana()
    best = solve(problem.free(["x", "y"]), numbers, tolerance=1e-10)
    valley = follow(problem.with_values(best.values), numbers, best, {"x", "y"})
    assert valley is not None
    assert valley.along == ("x",)
    low, high = valley.intervals["y"]
    assert high == pytest.approx(1.96**2, rel=0.15)
    assert low == pytest.approx(-0.1, abs=0.02)
    assert set(valley.intervals) == {"y"}  # x is known to 1, bent or not
    assert valley.better == {}


def test_an_interval_ends_at_the_bound_of_its_number():
    """Where x ends, at 1, the valley is at y = 1, and the width across it would reach further."""
    numbers = [FreeNumber("x", 0.1, -50.0, 1.0, spread=100.0), FreeNumber("y", 0.0, -0.05, 1.0, spread=100.0)]
    best = solve(Banana().free(["x", "y"]), numbers, tolerance=1e-10)
    valley = follow(Banana().with_values(best.values), numbers, best, {"x", "y"})
    assert valley.intervals["y"] == pytest.approx((-0.05, 1.0))


def test_numbers_that_the_points_do_not_determine_are_not_moved():
    numbers = [
        FreeNumber("x", 0.1, -50.0, 50.0, spread=100.0),
        FreeNumber("y", 0.0, -50.0, 50.0, spread=100.0),
    ]
    best = solve(Banana().free(["x", "y"]), numbers, tolerance=1e-10)
    assert follow(Banana().with_values(best.values), numbers, best, set()) is None


class Hills(Banana):
    """Along the parabola the sum of squares is sin(x)^2 + (2.2 - 0.07 x)^2: each dip is lower than the one before."""

    def with_values(self, values):
        return Hills(**{**self.held, **values})

    def free(self, names) -> LeastSquaresProblem:
        def linear(at) -> Linear:
            now = {**self.held, **dict(zip(names, at, strict=True))}
            x, y = now["x"], now["y"]
            slopes = {"x": [np.cos(x), -0.07, -2.0 * x / 0.05], "y": [0.0, 0.0, 1.0 / 0.05]}
            data = np.array([np.sin(x), 2.2 - 0.07 * x, (y - x * x) / 0.05])
            return Linear(
                data, np.array([slopes[n] for n in names]).T, np.zeros(0), np.zeros((0, len(names)))
            )

        return LeastSquaresProblem(lambda at: (linear(at).data, np.zeros(0)), linear)


def test_a_better_fit_behind_a_low_ridge_is_reported():
    numbers = [
        FreeNumber("x", 0.0, -50.0, 50.0, spread=100.0),
        FreeNumber("y", 0.0, -50.0, 50.0, spread=100.0),
    ]
    best = solve(Hills().free(["x", "y"]), numbers, tolerance=1e-10)
    valley = follow(Hills().with_values(best.values), numbers, best, {"x", "y"})
    assert abs(best.values["x"]) < 0.5
    assert valley.better["x"] > 2.0
    assert valley.better["y"] == pytest.approx(valley.better["x"] ** 2, rel=0.05)


def test_a_straight_valley_keeps_the_interval_of_the_covariance():
    class Line(Banana):
        def free(self, names) -> LeastSquaresProblem:
            def linear(at) -> Linear:
                slope = np.array([[1.0, 1.0], [0.0, 20.0]])
                return Linear(slope @ at, slope, np.zeros(0), np.zeros((0, 2)))

            return LeastSquaresProblem(lambda at: (linear(at).data, np.zeros(0)), linear)

    numbers = [
        FreeNumber("x", 0.1, -50.0, 50.0, spread=100.0),
        FreeNumber("y", 0.0, -50.0, 50.0, spread=100.0),
    ]
    best = solve(Line().free(["x", "y"]), numbers)
    assert follow(Line(), numbers, best, {"x", "y"}) is None


def test_a_valley_that_only_widens_is_followed_too():
    """Below its best value a shape has residuals 14 x; above it they end at 1.3, which no data contradict."""
    end, slope = 1.3, 14.0

    class Soft(Banana):
        def free(self, names) -> LeastSquaresProblem:
            def linear(at) -> Linear:
                x = {**self.held, **dict(zip(names, at, strict=True))}["QEZ1"]
                fading = np.exp(-slope * max(x, 0.0) / end)
                data = np.array([end * (1.0 - fading) if x > 0.0 else slope * x])
                return Linear(
                    data,
                    np.array([[slope * fading]])[:, : len(names)],
                    np.zeros(0),
                    np.zeros((0, len(names))),
                )

            return LeastSquaresProblem(lambda at: (linear(at).data, np.zeros(0)), linear)

        def with_values(self, values):
            return Soft(**{**self.held, **values})

        def thinned(self, stride):
            return self

        def without_limits(self):
            return self

    number = FreeNumber("QEZ1", 0.0, -15.0, 1.0e3, spread=10.0)
    best = solve(Soft().free(["QEZ1"]), [number])
    valley = follow(Soft(), [number], best, {"QEZ1"})
    assert valley is not None
    assert valley.along == ("QEZ1",)
    low, high = valley.intervals["QEZ1"]
    assert low == pytest.approx(-1.96 / slope, rel=0.02)
    assert high > 10.0 / slope
