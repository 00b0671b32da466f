"""Joint estimate of many tyres of one rig: against the explicit normal distribution, and on drawn fleets with known truth."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from mffit.fleet import estimate
from mffit.fleet.record import Fleet, scatter_of
from mffit.numbers import Numbers, from_json, to_json
from tir import Quantity

OWN = ("PDY1", "PKY6", "PECP1")
RIG = ("F0_N", "gamma_0_deg")
EXPECTED = np.array([1.1, -1.2, 0.0, 0.0, 0.0])
SPREAD = np.array([0.3, 0.4, math.inf, 10.0, 0.5])
POINTS = 12


def drawn(rng, x, theta, *, noise=1.0, slopes=None) -> Numbers:
    """Numbers of points whose readings are linear in the numbers."""
    J = rng.standard_normal((POINTS, 5)) / SLOPES if slopes is None else slopes
    truth = np.concatenate([x, theta])
    y = J @ truth + noise * rng.standard_normal(POINTS)
    at = truth + rng.standard_normal(5) * 0.1  # where a build happened to end says nothing
    residual = (J @ at - y) / noise
    return Numbers((*OWN, *RIG), at, J.T @ J / noise**2, -J.T @ residual / noise, EXPECTED, SPREAD)


def told(names, values, matrix, vector, expected, spread) -> Numbers:
    """Numbers whose log-likelihood is ``vector x - x matrix x / 2``."""
    return Numbers(names, values, matrix, vector - matrix @ values, expected, spread)


def pull(one: Numbers) -> np.ndarray:
    """The score of the readings at zero."""
    return one.information @ one.values + one.score


SLOPES = np.array([0.1, 0.1, 0.1, 5.0, 0.3])


def fleet(seed: int, tyres: int, scatter=(0.05, 0.05, 0.08), weak=True):
    """Tyres of one rig; with ``weak`` their points hardly separate eps_gamma from the rig's offset."""
    rng = np.random.default_rng(seed)
    theta = rng.standard_normal(2) * SPREAD[3:]
    own = np.array([1.2, -1.3, -0.1]) + rng.standard_normal((tyres, 3)) * scatter
    out = []
    for x in own:
        J = rng.standard_normal((POINTS, 5)) / SLOPES
        if weak:
            J[:, 3] = J[:, 2] * 0.1 / 5.0 + 0.15 * J[:, 3]
        out.append(drawn(rng, x, theta, slopes=J))
    return out, own, theta


def test_three_tyres_agree_with_the_explicit_normal_distribution():
    """Numbers (x_1, x_2, x_3, theta, mu) in one precision matrix; three tyres are too few to learn a scatter."""
    found, _, _ = fleet(1, 3)
    k, n = 3, 3
    size = n * k + 2 + k
    P, b = np.zeros((size, size)), np.zeros(size)
    theta, mu = [9, 10], [11, 12, 13]
    general = np.array([0.3, 0.4, 0.3])  # eps_gamma: a tenth of the width of its bounds, -1.5 to 1.5
    known = np.array([0.3, 0.4, 3.0])
    for i, one in enumerate(found):
        rows = [*range(3 * i, 3 * i + 3), *theta]
        P[np.ix_(rows, rows)] += one.information
        b[rows] += pull(one)
        for j in range(k):
            pair = [3 * i + j, mu[j]]
            P[np.ix_(pair, pair)] += np.array([[1, -1], [-1, 1]]) / general[j] ** 2
    P[theta, theta] += SPREAD[3:] ** -2.0
    P[mu, mu] += known**-2.0
    b[mu] += EXPECTED[:3] * known**-2.0
    covariance = np.linalg.inv(P)
    mean = covariance @ b
    together = estimate(found)
    for i, tyre in enumerate(together.tyres):
        np.testing.assert_allclose(tyre.values, mean[3 * i : 3 * i + 3], rtol=1e-8)
        np.testing.assert_allclose(
            tyre.covariance, covariance[3 * i : 3 * i + 3, 3 * i : 3 * i + 3], rtol=1e-7
        )
    assert together.rig["F0_N"] == pytest.approx((mean[9], math.sqrt(covariance[9, 9])), rel=1e-8)
    for name, row in (("PDY1", 11), ("PKY6", 12)):
        common = together.population[name]
        assert (common.mean, common.u_mean) == pytest.approx(
            (mean[row], math.sqrt(covariance[row, row])), rel=1e-8
        )


def test_one_tyre_alone_has_the_posterior_of_its_points_and_priors():
    (one,), _, _ = fleet(2, 1)
    known = np.array([0.3, 0.4, 3.0, *SPREAD[3:]])  # eps_gamma has only the width of its bounds
    covariance = np.linalg.inv(one.information + np.diag(known**-2.0))
    mean = covariance @ (pull(one) + EXPECTED * known**-2.0)
    (tyre,) = estimate([one]).tyres
    np.testing.assert_allclose(tyre.values, mean[:3], rtol=1e-6)
    np.testing.assert_allclose(tyre.covariance, covariance[:3, :3], rtol=1e-5)
    assert tyre.strain == {}
    assert estimate([one]).population == {}


@pytest.mark.parametrize("unknown", [("F0_N",), ("PECP1", "gamma_0_deg"), ("PECP1",), ()])
def test_without_some_numbers_the_others_are_as_well_known_as_beside_them(unknown):
    """With and without a prior of their own, each by the whole covariance."""
    (one,), _, _ = fleet(2, 1)
    prior = SPREAD**-2.0
    covariance = np.linalg.inv(one.information + np.diag(prior))
    mean = covariance @ (pull(one) + EXPECTED * prior)
    found = one.without(unknown)
    kept = [i for i, name in enumerate(one.names) if name in found.names]
    assert len(kept) == 5 - len(unknown)
    own = np.linalg.inv(found.information + np.diag(found.spread**-2.0))
    np.testing.assert_allclose(own, covariance[np.ix_(kept, kept)], rtol=1e-8)
    np.testing.assert_allclose(
        own @ (pull(found) + found.expected * found.spread**-2.0), mean[kept], rtol=1e-8
    )


@pytest.mark.parametrize(("expected", "spread"), [(0.0, 1.0), (0.4, 1.0), (-3.0, 3.0)])
def test_a_number_without_bounds_or_prior_is_known_to_its_own_size(expected, spread):
    """And to 1 at least: a centre of 0 says nothing about the size."""
    one = fleet(2, 1)[0][0]
    unbound = replace(
        one, names=("PDY1", "PKY6", "Q_FCY2", *RIG), expected=np.r_[EXPECTED[:2], expected, EXPECTED[3:]]
    )
    known = np.array([0.3, 0.4, spread, *SPREAD[3:]])
    covariance = np.linalg.inv(one.information + np.diag(known**-2.0))
    mean = covariance @ (pull(one) + unbound.expected * known**-2.0)
    (tyre,) = estimate([unbound]).tyres
    np.testing.assert_allclose(tyre.values, mean[:3], rtol=1e-6)
    np.testing.assert_allclose(tyre.covariance, covariance[:3, :3], rtol=1e-5)


@pytest.mark.parametrize(("share", "informed"), [(0.81, False), (0.79, True)])
def test_points_inform_a_coefficient_if_they_take_a_fifth_off_its_prior_variance(share, informed):
    found = [
        replace(i, information=np.diag([100.0, (1.0 / share - 1.0) / SPREAD[1] ** 2, 100.0, 1.0, 1.0]))
        for i in fleet(5, 2)[0]
    ]
    assert ("PKY6" in estimate(found).population) == informed


def test_a_population_needs_two_tyres_that_inform_a_coefficient():
    """A number may be free although the points do not inform it, as turn slip on a straight path."""
    found, _, _ = fleet(5, 3)
    silent = np.eye(5)
    silent[1, 1] = 0.0
    found[1:] = [
        replace(i, information=silent @ i.information @ silent, score=silent @ i.score) for i in found[1:]
    ]
    whole = estimate(found)
    assert set(whole.population) == {"PDY1", "PECP1"}
    assert all(p.tyres == 3 and p.assumed for p in whole.population.values())
    assert not estimate(fleet(6, 4)[0]).population["PKY6"].assumed


def test_joint_estimates_are_nearer_to_the_truth_and_their_uncertainty_is_right():
    alone, together, pulls = [], [], []
    for seed in range(15):
        found, own, _ = fleet(seed, 8)
        whole = estimate(found)
        for one, tyre, x in zip(found, whole.tyres, own, strict=True):
            alone.append(estimate([one]).tyres[0].number("PECP1")[0] - x[2])
            value, u = tyre.number("PECP1")
            together.append(value - x[2])
            pulls.append((value - x[2]) / u)
    assert np.std(together) < 0.7 * np.std(alone)
    assert 0.8 < np.std(pulls) < 1.2
    assert 0.90 < np.mean(np.abs(pulls) < 1.96) < 0.99


def test_the_scatter_of_the_population_is_found():
    """Within a quarter over five fleets of thirty: a standard deviation of thirty is itself 13 % uncertain."""
    found = np.array(
        [[estimate(fleet(seed, 30, weak=False)[0]).population[n].scatter for n in OWN] for seed in range(5)]
    )
    np.testing.assert_allclose(found.mean(axis=0), [0.05, 0.05, 0.08], rtol=0.25)


@pytest.mark.parametrize(("tyres", "u", "sd"), [(5, 0.1, 0.2), (8, 0.1, 0.15), (8, 0.02, 0.1)])
def test_the_scatter_of_equally_well_measured_tyres_has_a_closed_form(tyres, u, sd):
    """With V = tau^2 + u^2, the fixed point of (n - 1) tau^2 = sum E[(x_i - mu)^2] is (V - u^2) (V - sd^2) = V^2 / (n - 1)."""
    measured = np.linspace(-1.0, 1.0, tyres)
    measured *= sd / np.std(measured, ddof=1)
    found = [
        told(
            ("PECP1",),
            np.array([y]),
            np.array([[u**-2.0]]),
            np.array([y * u**-2.0]),
            np.zeros(1),
            np.array([math.inf]),
        )
        for y in measured
    ]
    V = max(np.roots([1.0 - 1.0 / (tyres - 1), -(u**2 + sd**2), u**2 * sd**2]).real)
    found_scatter = estimate(found).population["PECP1"].scatter
    assert found_scatter == pytest.approx(min(math.sqrt(V - u**2), 0.3), rel=0.02)


def test_many_tyres_determine_the_rig_better_and_the_declaration_counts_once():
    by_number = {n: estimate(fleet(3, n)[0]).rig["F0_N"][1] for n in (1, 4, 16)}
    assert by_number[16] < 0.6 * by_number[4] < 0.4 * by_number[1] < 0.4 * 10.0
    nothing = [replace(one, information=0 * one.information, score=0 * one.score) for one in fleet(4, 6)[0]]
    assert estimate(nothing).rig["F0_N"] == pytest.approx((0.0, 10.0))


def test_only_a_tyre_of_another_rig_is_strained():
    found, own, theta = fleet(5, 6, weak=False)
    found[2] = drawn(np.random.default_rng(6), own[2], theta + np.array([60.0, 0.0]))
    strain = [abs(tyre.strain["F0_N"]) for tyre in estimate(found).tyres]
    assert strain[2] > 4.0
    assert max(s for i, s in enumerate(strain) if i != 2) < 4.0


def test_the_strain_is_the_surprise_at_a_tyre_that_is_left_out():
    """By hand for a rig error that no number of the tyres resembles: known as 0 +- 10 N, to 5 N by one, to 2 N by the other.

    What the others say of the error predicts the reading of a tyre, whose own uncertainty is added.
    """
    known, (u_one, u_other), (one, other) = 10.0, (5.0, 2.0), (14.0, -3.0)
    found = [
        told(
            names=("PDY1", "F0_N"),
            values=np.array([1.2, F0]),
            matrix=np.diag([100.0, u**-2.0]),
            vector=np.array([120.0, F0 * u**-2.0]),
            expected=np.array([1.1, 0.0]),
            spread=np.array([0.3, known]),
        )
        for F0, u in ((one, u_one), (other, u_other))
    ]
    tyres = estimate(found).tyres
    for tyre, (own, u), (rest, u_rest) in (
        (tyres[0], (one, u_one), (other, u_other)),
        (tyres[1], (other, u_other), (one, u_one)),
    ):
        shrunk = u_rest**-2.0 / (u_rest**-2.0 + known**-2.0)
        variance = shrunk * u_rest**2 + u**2
        assert tyre.strain["F0_N"] == pytest.approx((own - shrunk * rest) / math.sqrt(variance), rel=1e-6)


@pytest.mark.parametrize(("u", "strained"), [(21.0, False), (19.0, True)])
def test_a_tyre_whose_points_do_not_inform_an_error_of_the_rig_has_no_strain(u, strained):
    """They must take a fifth off the declared variance: a quarter of its information, u below twice the declared 10 N."""
    one = told(
        ("PDY1", "F0_N"),
        np.ones(2),
        np.diag([100.0, u**-2.0]),
        np.zeros(2),
        np.zeros(2),
        np.array([0.3, 10.0]),
    )
    assert ("F0_N" in estimate([one, one]).tyres[0].strain) == strained


def test_the_scatter_between_tyres_is_that_of_a_sample():
    """Values 1, 2 and 6: mean 3, variance (4 + 1 + 9)/2; of which u^2 = (1 + 1 + 4)/3 is uncertainty."""
    found = scatter_of([Quantity(value, u, "-") for value, u in ((1.0, 1.0), (2.0, 1.0), (6.0, 2.0))])
    assert (found.mean, found.sd, found.u, found.tyres) == pytest.approx(
        (3.0, math.sqrt(7.0), math.sqrt(2.0), 3)
    )
    assert found.beyond == pytest.approx(math.sqrt(5.0))
    assert scatter_of([Quantity(value, 1.0, "-") for value in (1.0, 1.1)]).beyond == 0.0


def test_one_tyre_has_no_scatter():
    rows = [of_size(numbers={"C_alpha": Quantity(value, 1.0, "N/rad")}) for value in (1e4, 2e4)]
    assert Fleet((*rows[:1], of_size(numbers={})), (), ()).scatter("C_alpha") is None
    assert Fleet(tuple(rows), (), ()).scatter("C_alpha").mean == 15e3


def of_size(size="", load=1400.0, **content):
    """A row of a tyre of a size and a nominal load."""
    return SimpleNamespace(specimen=SimpleNamespace(size=size, conditions=(load, 250e3)), **content)


@pytest.mark.parametrize(
    ("sizes", "loads", "kinds"),
    [
        ("AAB", (1.0, 1.0, 1.0), [0, 0, 1]),
        ("AAA", (1.0, 2.0, 1.0), [0, 1, 0]),
        (("A", "", "B"), (1.0, 1.0, 1.0), [0, 0, 0]),  # a size that is not stated decides nothing
    ],
)
def test_tyres_of_one_size_and_one_nominal_load_are_of_one_kind(sizes, loads, kinds):
    assert Fleet(tuple(map(of_size, sizes, loads)), (), ()).kinds == kinds


def test_unlike_tyres_scatter_within_their_kind():
    """Values 1 and 2 of one kind, 101 and 104 of another, 7 alone: squares 0.5 and 4.5 with one degree of freedom each."""
    rows = [
        of_size(load=load, numbers={"C_alpha": Quantity(x, 1.0, "N/rad")})
        for load, x in ((1.0, 1.0), (2.0, 101.0), (1.0, 2.0), (2.0, 104.0), (3.0, 7.0))
    ]
    found = Fleet(tuple(rows), (), ()).scatter("C_alpha")
    assert (found.mean, found.sd, found.tyres) == (None, pytest.approx(math.sqrt(2.5)), 4)
    assert found.chance == pytest.approx(math.exp(-2.5))  # of chi-square 5 with two degrees of freedom
    assert Fleet((rows[0], rows[1], rows[4]), (), ()).scatter("C_alpha") is None


def test_unlike_tyres_share_no_population():
    """Without errors of the rig, each kind has the estimate that it has by itself."""
    one, other = ([only(tyre, [0, 1]) for tyre in fleet(seed, 3)[0]] for seed in (5, 6))
    kinds = [
        [tyre.renamed([f"{n}@{k}" for n in tyre.names]) for tyre in of] for k, of in enumerate((one, other))
    ]
    mixed = estimate([*kinds[0], *kinds[1]])
    apart = [tyre for of in (one, other) for tyre in estimate(of).tyres]
    assert mixed.population == {}
    for tyre, alone in zip(mixed.tyres, apart, strict=True):
        assert tyre.names == alone.names
        assert tyre.values == pytest.approx(alone.values, rel=1e-9)
        assert tyre.covariance == pytest.approx(alone.covariance, rel=1e-9)


def only(one: Numbers, keep: list[int]) -> Numbers:
    """The information about some numbers, given the others."""
    return told(
        tuple(one.names[i] for i in keep),
        one.values[keep],
        one.information[np.ix_(keep, keep)],
        pull(one)[keep],
        one.expected[keep],
        one.spread[keep],
    )


def test_tyres_of_a_straight_path_have_a_population_and_no_rig():
    whole = estimate([only(one, [0, 1]) for one in fleet(9, 5)[0]])
    assert whole.rig == {}
    assert set(whole.population) == {"PDY1", "PKY6"}
    assert all(tyre.number("PECP1") is None and tyre.strain == {} for tyre in whole.tyres)


def test_tyres_need_not_have_the_same_numbers():
    found, _, _ = fleet(7, 4)
    found[1] = only(found[1], [0, 2, 3, 4])
    whole = estimate(found)
    assert whole.tyres[1].number("PKY6") is None
    assert whole.population["PKY6"].tyres == 3
    assert whole.population["PDY1"].tyres == 4


def test_information_is_read_back_as_it_was():
    one = fleet(8, 1)[0][0]
    again = from_json(json.loads(json.dumps(to_json(one))))
    assert again.names == one.names
    for name in ("values", "information", "score", "expected", "spread"):
        np.testing.assert_array_equal(getattr(again, name), getattr(one, name))
    with pytest.raises(ValueError, match="one length"):
        from_json({**to_json(one), "score": [1.0]})
