"""The tyre at another temperature: which factors move, that a second change counts from the first, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tir

FRONT = Path(__file__).parent / "vectors" / "moto_front.tir"
TERMS = {
    "rig.k_T_grip_per_K": tir.Quantity(-0.005, 0.0002, "1/K"),
    "rig.k_T_stiffness_per_K": tir.Quantity(-0.002, 0.0003, "1/K"),
    "rig.T_ref_degC": tir.Quantity(60.0, 0.0, "degC"),
    "T_min_degC": tir.Quantity(45.0, 0.0, "degC"),
    "T_max_degC": tir.Quantity(75.0, 0.0, "degC"),
}


@pytest.fixture
def tyre(tmp_path) -> tir.Tyre:
    """A file with terms, as it is read back."""
    tir.read(FRONT).annotate(measured=TERMS).write(tmp_path / "front-at-temperature.tir")
    return tir.read(tmp_path / "front-at-temperature.tir")


def test_friction_and_cornering_stiffness_change_by_their_terms(tyre):
    warm = tyre.at_temperature(70.0)
    assert warm["LMUY"] == pytest.approx(0.95 * tyre["LMUY"])
    assert warm["LKY"] == pytest.approx(0.98 * tyre["LKY"])
    assert warm["LKYC"] == tyre["LKYC"]  # without a term
    assert warm.state(1500.0).K_ya == pytest.approx(0.98 * tyre.state(1500.0).K_ya)


def test_the_reference_temperature_changes_nothing(tyre):
    assert tyre.at_temperature(60.0) == tyre


def test_a_second_change_of_temperature_counts_from_the_first(tyre):
    twice, once = tyre.at_temperature(72.0).at_temperature(50.0), tyre.at_temperature(50.0)
    for name in ("LMUY", "LKY"):
        assert twice[name] == pytest.approx(once[name], rel=1e-12)
    term = twice.measured["rig.k_T_grip_per_K"]
    assert term.value == pytest.approx(once.measured["rig.k_T_grip_per_K"].value, rel=1e-12)


def test_the_term_of_a_warmer_file_is_uncertain_by_what_the_term_moves_it(tyre):
    """By differences: k' = k / (1 + k dT)."""
    k, u, *_ = TERMS["rig.k_T_grip_per_K"]
    ends = [(k + s) / (1.0 + (k + s) * 12.0) for s in (1e-7, -1e-7)]
    assert tyre.at_temperature(72.0).measured["rig.k_T_grip_per_K"].u == pytest.approx(
        u * (ends[0] - ends[1]) / 2e-7, rel=1e-5
    )


def test_a_warm_tyre_is_written_and_read(tyre, tmp_path):
    warm = tyre.at_temperature(70.0)
    warm.write(tmp_path / "warm.tir")
    again = tir.read(tmp_path / "warm.tir")
    assert again == warm
    assert again.at_temperature(60.0)["LMUY"] == pytest.approx(tyre["LMUY"])
    np.testing.assert_allclose(again(1500.0, alpha=0.1).Fy, warm(1500.0, alpha=0.1).Fy)


@pytest.mark.parametrize(("T_degC", "warned"), [(45.0, False), (75.0, False), (44.0, True), (90.0, True)])
def test_a_temperature_outside_the_measured_range_is_said(tyre, T_degC, warned):
    said = " ".join(problem.sentence for problem in tyre.at_temperature(T_degC).problems)
    assert ("outside 45 to 75 degC" in said) == warned


def test_a_file_without_terms_is_refused_with_its_name():
    with pytest.raises(tir.TirError, match=r"moto_front\.tir: the file has no temperature terms"):
        tir.read(FRONT).at_temperature(70.0)


def test_terms_without_their_reference_are_none():
    """A diagnosis may state a term beside a model that holds at another temperature."""
    stated = {name: q for name, q in TERMS.items() if name != "rig.T_ref_degC"}
    with pytest.raises(tir.TirError, match="no temperature terms"):
        tir.read(FRONT).annotate(measured=stated).at_temperature(70.0)


@pytest.mark.parametrize(("T_degC", "end"), [(-10.0, 45.0), (300.0, 75.0)])
def test_a_temperature_outside_the_measured_range_is_the_nearest_of_it(tyre, T_degC, end):
    beyond, at_end = tyre.at_temperature(T_degC), tyre.at_temperature(end)
    assert beyond == at_end
    assert beyond.measured["rig.T_ref_degC"].value == end
    assert any(f"the tyre is that at {end:g} degC" in problem.sentence for problem in beyond.problems)


def test_a_temperature_that_leaves_no_friction_is_refused():
    endless = {name: q for name, q in TERMS.items() if name not in ("T_min_degC", "T_max_degC")}
    with pytest.raises(tir.TirError, match="at 300 degC"):
        tir.read(FRONT).annotate(measured=endless).at_temperature(300.0)


CURVED = TERMS | {"rig.k_T_grip_per_K2": tir.Quantity(-2e-4, 1e-5, "1/K^2")}


def test_a_quadratic_term_of_friction_adds_to_the_linear_one():
    warm = tir.read(FRONT).annotate(measured=CURVED).at_temperature(70.0)
    assert warm["LMUY"] == pytest.approx((1.0 - 0.05 - 0.02) * tir.read(FRONT)["LMUY"])
    assert warm["LKY"] == pytest.approx(0.98 * tir.read(FRONT)["LKY"])


def test_a_second_change_of_temperature_follows_the_same_parabola():
    file = tir.read(FRONT).annotate(measured=CURVED)
    twice, once = file.at_temperature(72.0).at_temperature(50.0), file.at_temperature(50.0)
    assert twice["LMUY"] == pytest.approx(once["LMUY"], rel=1e-12)
    for name in ("rig.k_T_grip_per_K", "rig.k_T_grip_per_K2"):
        assert twice.measured[name].value == pytest.approx(once.measured[name].value, rel=1e-9)


def test_the_uncertainty_of_moved_terms_is_that_of_drawn_ones():
    rng, names = np.random.default_rng(5), ("rig.k_T_grip_per_K", "rig.k_T_grip_per_K2")
    file = tir.read(FRONT).annotate(measured=CURVED)
    drawn = [[CURVED[n].value + CURVED[n].u * rng.standard_normal() for n in names] for _ in range(400)]
    moved = [
        file.annotate(measured={n: CURVED[n]._replace(value=x) for n, x in zip(names, row, strict=True)})
        .at_temperature(80.0)
        .measured
        for row in drawn
    ]
    stated = file.at_temperature(80.0).measured
    for name in names:
        assert np.std([terms[name].value for terms in moved]) == pytest.approx(stated[name].u, rel=0.12)


def test_the_uncertainty_of_both_moved_terms_is_propagated_from_both():
    """By central differences of the moved terms, with a linear term so uncertain that it matters to the quadratic one."""
    wide = CURVED | {"rig.k_T_grip_per_K": tir.Quantity(-0.005, 0.004, "1/K")}
    names = ("rig.k_T_grip_per_K", "rig.k_T_grip_per_K2")

    def moved(**changes: float) -> dict[str, float]:
        terms = {
            n: q._replace(value=q.value + changes.get(n.removeprefix("rig."), 0.0)) for n, q in wide.items()
        }
        found = tir.read(FRONT).annotate(measured=terms).at_temperature(80.0).measured
        return {name: found[name].value for name in names}

    stated = tir.read(FRONT).annotate(measured=wide).at_temperature(80.0).measured
    steps = {"k_T_grip_per_K": 1e-6, "k_T_grip_per_K2": 1e-9}
    for name in names:
        parts = [
            (moved(**{term: h})[name] - moved(**{term: -h})[name]) / (2.0 * h) * wide[f"rig.{term}"].u
            for term, h in steps.items()
        ]
        assert min(map(abs, parts)) > 0.05 * max(map(abs, parts))  # each of them counts
        assert stated[name].u == pytest.approx(np.hypot(*parts), rel=1e-5)
