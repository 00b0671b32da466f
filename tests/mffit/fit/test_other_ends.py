"""Other ends of a search that fit as well, and signs that change no force."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from mffit.fit.other_ends import other_ends
from mffit.fit.same_curve import SAME_CURVE, with_expected_signs
from mffit.least_squares import FreeNumber, of_model, solve
from mffit.points import make_points
from tests.mffit.fit import combined_programme as belt

WEIGHT = {"RCY1": 1.05, "RBY1": 11.0, "REY1": 0.16}
STIFFNESS = {"PKX1": 22.0, "PKX2": 2.0, "PKX3": 0.25}


@dataclass(frozen=True)
class Problem:
    """As much of a problem as the search for other ends needs."""

    points: object
    simulation: object
    of: object

    def free(self, names):
        return self.of(names)


def weight(p, kappa):
    """G_yk at zero sideslip, by Pacejka's equation 4.E61 in other words."""
    x = p["RBY1"] * kappa
    return np.cos(p["RCY1"] * np.arctan((1.0 - p["REY1"]) * x + p["REY1"] * np.arctan(x)))


def stiffness(p, Fz):
    dfz = Fz / 1400.0 - 1.0
    return Fz * (p["PKX1"] + p["PKX2"] * dfz) * np.exp(p["PKX3"] * dfz)


def searched(model, truth, x, noise, points, seed):
    """The end at which a search from the truth arrives, and what the other ends add."""
    measured = model(truth, x) + noise * np.random.default_rng(seed).standard_normal(len(x))
    numbers = [FreeNumber(name, value, -100.0, 100.0) for name, value in truth.items()]
    simulation = SimpleNamespace(values={"FNOMIN": 1400.0, "LFZO": 1.0})
    problem = Problem(
        points, simulation, lambda names: of_model(lambda p: model(p, x), names, measured, noise)
    )
    solution = solve(problem.free(list(truth)), numbers, tolerance=1e-9)
    return numbers, solution, other_ends(problem, numbers, solution)


@pytest.fixture(scope="module")
def kappa():
    return np.repeat(np.linspace(-0.2, 0.2, 21), 3)


def test_the_interval_of_a_weight_contains_both_ends(kappa):
    """The same slope and the same value at the largest slip: a large shape factor with much curvature fits as well."""
    points = make_points(0.0, 0.0, 1400.0, kappa=kappa, p=250e3, V=16.0, phi_t=0.0)
    _, solution, found = searched(weight, WEIGHT, kappa, 0.002, points, seed=1)
    u = float(np.sqrt(solution.covariance[0, 0]))
    high = found.intervals["RCY1"][1]
    for name, true in WEIGHT.items():
        assert found.intervals[name][0] < true < found.intervals[name][1]
    # The best fits with the shape factor held: as good at the other end, and worse in between.
    measured = weight(WEIGHT, kappa) + 0.002 * np.random.default_rng(1).standard_normal(len(kappa))

    def rise(C):
        rest = [FreeNumber("RBY1", 11.0 * 1.05 / C), FreeNumber("REY1", 0.16 if C < 1.2 else 0.75)]
        held = of_model(lambda p: weight({**p, "RCY1": C}, kappa), ["RBY1", "REY1"], measured, 0.002)
        return solve(held, rest, tolerance=1e-9).cost - solution.cost

    assert high > solution.values["RCY1"] + 15.0 * u
    assert min(rise(C) for C in np.linspace(high - 0.06, high, 4)) < 3.84
    assert rise(1.2) > 3.84


def test_little_noise_leaves_one_end(kappa):
    points = make_points(0.0, 0.0, 1400.0, kappa=kappa, p=250e3, V=16.0, phi_t=0.0)
    assert not searched(weight, WEIGHT, kappa, 1e-4, points, seed=1)[2].intervals


def test_three_loads_give_two_pairs_of_slip_stiffness_over_load():
    Fz = np.repeat([700.0, 1400.0, 2100.0], 8)
    points = make_points(0.0, 0.0, Fz, kappa=0.1, p=250e3, V=16.0, phi_t=0.0)
    _, solution, found = searched(stiffness, STIFFNESS, Fz, 60.0, points, seed=3)
    low, high = found.intervals["PKX3"]
    u = float(np.sqrt(solution.covariance[2, 2]))
    assert max(high - solution.values["PKX3"], solution.values["PKX3"] - low) > 3.0 * u
    dfz = Fz / 1400.0 - 1.0
    line = Fz[:, None] * np.column_stack([np.ones(24), dfz])
    other = min((low, high), key=lambda x: -abs(x - solution.values["PKX3"]))

    def missed(exponent):
        """Relative rms difference of the best slip stiffness with another exponent, at the three loads."""
        design, K = line * np.exp(exponent * dfz)[:, None], stiffness(solution.values, Fz)
        return np.sqrt(np.mean((design @ np.linalg.lstsq(design, K, rcond=None)[0] / K - 1.0) ** 2))

    between = np.linspace(solution.values["PKX3"], other, 30)
    assert max(map(missed, between)) < 0.01


def test_signs_that_change_no_force_are_those_that_are_expected():
    true = belt.truth()
    rng = np.random.default_rng(4)
    alpha, kappa, gamma = rng.uniform(-0.1, 0.1, 50), rng.uniform(-0.2, 0.2, 50), rng.uniform(-0.1, 0.1, 50)

    def forces(tyre):
        return [
            np.array(tyre(load, alpha, gamma, kappa, phi_t, p=250e3, turn_slip=on)) for on in (False, True)
        ]

    load, phi_t = rng.uniform(500.0, 2500.0, 50), rng.uniform(-0.3, 0.3, 50)
    drawn = {name: rng.uniform(0.1, 0.3) for group in SAME_CURVE for name in group if not true[name]}
    true = true.replace(**drawn)  # so that every sign counts
    for group in SAME_CURVE:
        other = true.replace(**{name: -true[name] for name in group})
        for found, expected in zip(forces(other), forces(true), strict=True):
            np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-8, err_msg=str(group))
        assert with_expected_signs(other.values, dict(true.values)) == {name: true[name] for name in group}
    assert with_expected_signs(true.values, dict(true.values)) == {}
