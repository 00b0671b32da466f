"""The least-squares solver against answers in closed form and against scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares, minimize

from mffit.least_squares import FreeNumber, LeastSquaresProblem, Linear, solve

RNG = np.random.default_rng(5)
A = RNG.normal(size=(30, 3))
TRUE = np.array([1.0, -2.0, 0.5])
DATA = A @ TRUE + 0.1 * RNG.normal(size=30)


def linear_problem(limit: float = np.inf) -> LeastSquaresProblem:
    """A problem that is linear in three numbers, with a limit of the first one as a steep penalty."""

    def limits(x):
        return np.array([1e4 * max(x[0] - limit, 0.0)])

    def linear(x):
        slope = np.array([[1e4 if x[0] > limit else 0.0, 0.0, 0.0]])
        return Linear(A @ x - DATA, A, limits(x), slope)

    return LeastSquaresProblem(lambda x: (A @ x - DATA, limits(x)), linear)


def numbers(**changes) -> list[FreeNumber]:
    return [FreeNumber(name, 0.0, **changes.get(name, {})) for name in ("a", "b", "c")]


def test_a_linear_problem_gives_the_normal_equations():
    found = solve(linear_problem(), numbers())
    assert list(found.values.values()) == pytest.approx(np.linalg.lstsq(A, DATA, rcond=None)[0], abs=1e-6)
    assert found.covariance == pytest.approx(np.linalg.inv(A.T @ A), rel=1e-9)
    assert not found.at_bound | found.at_limit


def test_a_prior_counts_as_one_more_reading():
    found = solve(linear_problem(), numbers(b={"expected": 4.0, "spread": 0.01}), tolerance=1e-12)
    rows = np.vstack([A, [0.0, 100.0, 0.0]])
    assert list(found.values.values()) == pytest.approx(
        np.linalg.lstsq(rows, np.append(DATA, 400.0), rcond=None)[0], abs=1e-6
    )
    assert found.covariance == pytest.approx(np.linalg.inv(rows.T @ rows), rel=1e-9)


def test_a_number_at_its_bound_stays_there_beside_numbers_without_bounds():
    numbers = [FreeNumber("a", 0.4, -3.0, 0.4), FreeNumber("b", 0.0), FreeNumber("c", 0.0)]
    found = solve(linear_problem(), numbers, tolerance=1e-12)
    rest, *_ = np.linalg.lstsq(A[:, 1:], DATA - 0.4 * A[:, 0], rcond=None)
    assert list(found.values.values()) == pytest.approx([0.4, *rest], abs=1e-8)


def test_a_bound_holds_and_is_reported():
    found = solve(linear_problem(), numbers(a={"lower": -3.0, "upper": 0.4}), tolerance=1e-12)
    bounded = least_squares(
        lambda x: A @ x - DATA, np.zeros(3), bounds=([-3, -9, -9], [0.4, 9, 9]), xtol=1e-14
    )
    assert found.at_bound == {"a"}
    assert list(found.values.values()) == pytest.approx(bounded.x, abs=1e-5)


def test_a_limit_holds_is_reported_and_does_not_enter_the_covariance():
    found = solve(linear_problem(limit=0.4), numbers(), tolerance=1e-12)
    assert found.values["a"] == pytest.approx(0.4, abs=1e-3)
    assert found.at_limit == {"a"}
    assert found.covariance == pytest.approx(np.linalg.inv(A.T @ A), rel=1e-9)


def test_a_curved_problem_ends_where_scipy_ends():
    x = np.linspace(0.1, 3.0, 40)
    y = 2.0 * np.sin(1.3 * np.arctan(1.7 * x)) + 0.02 * RNG.normal(size=40)

    def residual(v):
        return v[0] * np.sin(v[1] * np.arctan(v[2] * x)) - y

    def linear(v):
        inner = np.arctan(v[2] * x)
        slope = np.column_stack(
            [
                np.sin(v[1] * inner),
                v[0] * inner * np.cos(v[1] * inner),
                v[0] * v[1] * np.cos(v[1] * inner) * x / (1.0 + (v[2] * x) ** 2),
            ]
        )
        return Linear(residual(v), slope, np.zeros(0), np.zeros((0, 3)))

    start = [FreeNumber("D", 1.0), FreeNumber("C", 1.0), FreeNumber("B", 1.0)]
    found = solve(LeastSquaresProblem(lambda v: (residual(v), np.zeros(0)), linear), start, tolerance=1e-12)
    assert list(found.values.values()) == pytest.approx(least_squares(residual, np.ones(3)).x, abs=1e-4)


def test_steps_that_look_at_kept_limits_and_bounds_arrive_at_once():
    """The nearest place to (2, 2, 2) with x + y <= 1 and z <= 0.5 is (0.5, 0.5, 0.5)."""
    weight, normal = 3000.0, np.array([1.0, 1.0, 0.0])

    def limit(x):
        return np.array([weight * (normal @ x - 1.0)])

    problem = LeastSquaresProblem(
        lambda x: (x - 2.0, limit(x)),
        lambda x: Linear(x - 2.0, np.eye(3), limit(x), weight * normal[None, :]),
    )
    starts = [
        FreeNumber(name, -3.0 - k, upper=0.5 if name == "z" else np.inf) for k, name in enumerate("xyz")
    ]
    found = solve(problem, starts, tolerance=1e-12)
    assert list(found.values.values()) == pytest.approx([0.5, 0.5, 0.5], abs=1e-5)
    assert found.steps <= 12


@pytest.mark.parametrize("seed", range(20))
def test_many_bounds_and_limits_that_act_together_hold_at_the_lowest_place(seed):
    """A convex problem with random bounds and steep limits, against scipy's bounded quasi-Newton method."""
    random = np.random.default_rng(seed)
    k, many = int(random.integers(2, 12)), int(random.integers(1, 30))
    J, r = random.normal(size=(20, k)), 3.0 * random.normal(size=20)
    S, v = 30.0 * random.normal(size=(many, k)), random.normal(size=many) - 1.0
    lower, upper = (np.where(random.random(k) < 0.3, np.inf, random.exponential(size=k)) for _ in range(2))
    lower = -lower

    def half(x):
        left, over = r + J @ x, np.maximum(v + S @ x, 0.0)
        return 0.5 * (left @ left + over @ over), J.T @ left + S.T @ over

    problem = LeastSquaresProblem(
        lambda x: (r + J @ x, v + S @ x), lambda x: Linear(r + J @ x, J, v + S @ x, S)
    )
    numbers = [FreeNumber(f"x{i}", 0.0, lower[i], upper[i]) for i in range(k)]
    found = solve(problem, numbers, tolerance=1e-12)
    lowest = minimize(half, np.zeros(k), jac=True, bounds=list(zip(lower, upper, strict=True)), tol=1e-14)
    assert found.cost <= 2.0 * lowest.fun * (1.0 + 1e-7)
    assert found.left < 1e-9 * found.cost


def cliff(x: np.ndarray) -> np.ndarray:
    """Residuals with their minimum at (3, 1), in a narrow valley, and a wall at x = 1 that no derivative announces."""
    wall = 1e6 if x[0] > 1.0 else 0.0
    return np.array([x[0] - 3.0, 1e3 * (x[0] - x[1] - 2.0), wall])


def test_a_search_that_is_stuck_says_so():
    """At a wall every step is rejected until damping makes it tiny: its gain is small, and what is left is not."""

    def linear(x):
        return Linear(
            cliff(x), np.array([[1.0, 0.0], [1e3, -1e3], [0.0, 0.0]]), np.zeros(0), np.zeros((0, 2))
        )

    problem = LeastSquaresProblem(lambda x: (cliff(x), np.zeros(0)), linear)
    found = solve(problem, [FreeNumber("x", 0.0), FreeNumber("y", 0.0)])
    assert found.values["x"] < 1.001
    assert found.left == pytest.approx(found.cost, rel=0.01)


@pytest.mark.parametrize(("steepness", "noise", "tolerance"), [(30.0, 100.0, 1e-5), (100.0, 1000.0, 1e-7)])
def test_a_small_gain_of_a_damped_step_does_not_end_a_search(steepness, noise, tolerance):
    """Rosenbrock's valley from its usual start: the minimum is (1, 1), and damped steps on the way there gain little."""

    def residual(x):
        return np.array([steepness * (x[1] - x[0] ** 2), 1.0 - x[0], noise])

    def linear(x):
        slope = np.array([[-2.0 * steepness * x[0], steepness], [-1.0, 0.0], [0.0, 0.0]])
        return Linear(residual(x), slope, np.zeros(0), np.zeros((0, 2)))

    problem = LeastSquaresProblem(lambda x: (residual(x), np.zeros(0)), linear)
    found = solve(problem, [FreeNumber("x", -1.2), FreeNumber("y", 1.0)], tolerance=tolerance)
    assert found.cost - noise**2 < 2.0 * tolerance * noise**2
    assert found.left < tolerance * noise**2


@pytest.mark.parametrize("noise", [0.0, 1.0, 100.0, 1000.0])
def test_an_answer_is_exact_however_little_it_gains(noise):
    """A constant under scatter of mean zero: the answer is the mean, whatever share of the sum of squares it explains."""
    data = 0.5 + noise * np.tile([1.0, -1.0, 3.0, -3.0], 10)

    def linear(x):
        return Linear(x[0] - data, np.ones((40, 1)), np.zeros(0), np.zeros((0, 1)))

    problem = LeastSquaresProblem(lambda x: (x[0] - data, np.zeros(0)), linear)
    found = solve(problem, [FreeNumber("a", 0.0)])
    assert found.values["a"] == pytest.approx(0.5, rel=1e-6)


def test_residuals_that_stay_large_do_not_slow_a_search_down():
    """Brown and Dennis's function, no. 16 of Moré, Garbow and Hillstrom 1981: its second derivatives rule at the minimum."""
    t = np.arange(1, 21) / 5.0

    def both(x):
        return x[0] + t * x[1] - np.exp(t), x[2] + x[3] * np.sin(t) - np.cos(t)

    def residual(x):
        return sum(part**2 for part in both(x))

    def linear(x):
        a, b = both(x)
        slope = 2.0 * np.column_stack([a, a * t, b, b * np.sin(t)])
        return Linear(residual(x), slope, np.zeros(0), np.zeros((0, 4)))

    problem = LeastSquaresProblem(lambda x: (residual(x), np.zeros(0)), linear)
    start = zip("abcd", (25.0, 5.0, -5.0, -1.0), strict=True)
    found = solve(problem, [FreeNumber(*one) for one in start], tolerance=1e-9)
    assert found.cost == pytest.approx(85822.2, abs=0.1)
    assert found.steps < 40


def test_numbers_at_the_zero_of_an_even_function_do_not_end_a_search():
    """Rosenbrock's valley, and three numbers that enter squared: their derivatives vanish at the minimum, near 0.

    Their priors pull them away, and damping that holds them holds the numbers in the valley as well.
    """

    def residual(x):
        return np.array([100.0 * (x[1] - x[0] ** 2), 1.0 - x[0], *(1000.0 * x[2:] ** 2), 100.0])

    def linear(x):
        slope = np.zeros((6, 5))
        slope[:2, :2] = [[-200.0 * x[0], 100.0], [-1.0, 0.0]]
        slope[2:5, 2:] = np.diag(2000.0 * x[2:])
        return Linear(residual(x), slope, np.zeros(0), np.zeros((0, 5)))

    problem = LeastSquaresProblem(lambda x: (residual(x), np.zeros(0)), linear)
    even = [FreeNumber(f"even {k}", 0.05 * k, expected=10.0, spread=10.0) for k in (1, 2, 3)]
    found = solve(problem, [FreeNumber("x", -1.2), FreeNumber("y", 1.0), *even], tolerance=1e-6)
    assert found.left < 1e-6 * found.cost
    assert found.values["x"] == pytest.approx(1.0, abs=0.15)
