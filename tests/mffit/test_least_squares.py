"""The least-squares solver against answers in closed form and against scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares

from mffit.least_squares import FreeNumber, Kept, LeastSquaresProblem, Linear, solve

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

    def linear(x, looks):
        value, slope = limit(x), weight * normal[None, :]
        broken = value > 0.0
        kept = Kept(value[~broken], slope[~broken]) if looks else None
        return Linear(x - 2.0, np.eye(3), np.where(broken, value, 0.0), slope * broken[:, None], kept)

    def steps(looks):
        problem = LeastSquaresProblem(
            lambda x: (x - 2.0, np.maximum(limit(x), 0.0)), lambda x: linear(x, looks)
        )
        numbers = [
            FreeNumber(name, -3.0 - k, upper=0.5 if name == "z" else np.inf) for k, name in enumerate("xyz")
        ]
        found = solve(problem, numbers, tolerance=1e-12)
        return found, found.steps

    found, needed = steps(True)
    assert list(found.values.values()) == pytest.approx([0.5, 0.5, 0.5], abs=1e-5)
    assert needed <= 12
    assert needed < steps(False)[1]
