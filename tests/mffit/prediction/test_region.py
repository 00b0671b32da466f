"""Where the formula misses a channel most, and its sentence."""

from __future__ import annotations

import shutil

import numpy as np
import pytest
from conftest import CAMBERS, LOADS, Built, brush

import tir
from mffit import rounding
from mffit.pipeline.fleets import fleet
from mffit.prediction import MissedAtReadings, missed_sentence, region
from mffit.prediction.region import SIDES, MissedRegion, _clearest, _Seen, missed_at_readings
from mffit.prediction.slopes import MissedSlope
from mffit.quantities import CHARACTERISTICS
from mffit.report.verdict import headlines

NAMES = ("Fz", "p")
PLAN = [(load, pressure) for load in (500.0, 1500.0, 2500.0) for pressure in (7e4, 1e5) for _ in range(4)]


def sweeps(up, down, seed: int, scatter: float = 0.02) -> dict[str, list[_Seen]]:
    """Shares by side of a plan whose positive and negative forces are missed by ``up`` and ``down`` of load and pressure."""
    random = np.random.default_rng(seed)
    seen = {side: [] for side in SIDES}
    for load, pressure in PLAN:
        one, other = up(load, pressure), down(load, pressure) + scatter * random.standard_normal()
        one += scatter * random.standard_normal()
        shares = (0.5 * (one + other), one, other, one - other)
        u = scatter * np.array([0.5**0.5, 1.0, 1.0, 2.0**0.5])
        for side, share, own in zip(SIDES, shares, u, strict=True):
            seen[side].append(_Seen(np.array([load, pressure]), share, own))
    return seen


def test_a_miss_at_light_load_is_that_alone():
    """Neither a pressure nor a sign is needed to say where it is."""

    def light(load, pressure):
        return 0.09 + 0.02 * (pressure > 8e4) if load < 1000.0 else 0.0

    found = _clearest(NAMES, sweeps(light, light, seed=1))
    assert found is not None
    assert (found.side, dict(found.over), found.sweeps) == ("", {"Fz_N": (500.0, 500.0)}, 8)
    assert found.lower < 0.10 < found.upper < 0.15


def test_a_miss_of_one_sign_under_one_condition_is_said_with_both():
    """Driving, at high load and high pressure, is 10 % too high in the formula; elsewhere runs scatter around it."""

    def driving(load, pressure):
        return -0.1 if load > 2000.0 and pressure > 8e4 else 0.0

    found = _clearest(NAMES, sweeps(driving, lambda load, pressure: 0.0, seed=2, scatter=0.002))
    assert found is not None
    assert set(found.over) == {"Fz_N", "p_kPa"}
    assert found.sweeps == 4
    assert found.upper < 0.0


def test_driving_above_braking_is_said_as_their_difference():
    """Each alone is within the scatter of runs that both share: only what they differ by is alike in all."""
    random = np.random.default_rng(3)
    common = iter(np.repeat(0.1 * random.standard_normal(len(PLAN)), 2))
    found = _clearest(
        NAMES, sweeps(lambda *_: 0.11 + next(common), lambda *_: -0.11 + next(common), 3, scatter=0.01)
    )
    assert found is not None
    assert (found.side, dict(found.over), found.sweeps) == ("apart", {}, len(PLAN))
    assert found.lower < 0.22 < found.upper


@pytest.mark.parametrize("seed", range(3))
def test_scatter_of_runs_is_no_region(seed):
    """100 plans each whose runs scatter by 5 %; per plan one in a thousand may be taken for a miss."""
    nothing = [
        _clearest(NAMES, sweeps(lambda *_: 0.0, lambda *_: 0.0, 1000 * seed + k, 0.05)) for k in range(100)
    ]
    assert sum(one is not None for one in nothing) <= 2


def test_the_grip_of_a_foreign_tyre_is_missed_by_what_is_said(foreign: Built):
    """The brush tyre's true grip against that of the written file, in the region that the build names."""
    found = foreign.result.missed["Fy"]
    assert found.is_grip
    assert found.region is not None
    tyre = tir.read(foreign.folder / "brush.tir")
    alpha = np.radians(np.linspace(-10.0, 10.0, 201))
    shares = []
    low, high = found.region.over.get("Fz_N", (min(LOADS), max(LOADS)))
    for load in (load for load in LOADS if low - 1.0 < load < high + 1.0):
        for camber in np.radians(CAMBERS):
            true, _ = brush(alpha, camber, load)
            file = tyre(load, alpha=alpha, gamma=camber).Fy
            shares.append(np.max(np.abs(true)) / np.max(np.abs(file)) - 1.0)
    middle = 0.5 * (found.region.lower + found.region.upper)
    assert np.mean(shares) == pytest.approx(middle, abs=0.03)
    assert np.sign(np.mean(shares)) == np.sign(middle)


def test_the_slopes_of_a_foreign_tyre_are_missed_by_what_is_said(foreign: Built):
    """The brush tyre's true slope at zero sideslip against that of the written file; 0.8 deg apart, its readings smooth it.

    At small loads the readings do not tell the slopes well enough.
    """
    tyre, end = tir.read(foreign.folder / "brush.tir"), np.radians([-0.4, 0.4])
    slopes = foreign.result.missed["Fy"].slopes
    assert [one.load for one in slopes] == pytest.approx(LOADS[-len(slopes) :])
    assert len(slopes) >= 3
    for one in slopes:
        true = np.diff(brush(end, 0.0, one.load)[0]) / np.diff(tyre(one.load, alpha=end).Fy) - 1.0
        assert 0.35 < one.share / float(true[0]) < 1.3


def test_slopes_at_zero_slip_are_said_with_their_load():
    found = MissedAtReadings(
        "Fy", 33.4, 3340.0, True, None, (MissedSlope(530.0, 0.1), MissedSlope(1650.0, -0.023))
    )
    assert missed_sentence(found).endswith(
        "1.0 % of the largest Fy; its slope at zero slip is 10 % too low at 530 N and 2.3 % too high at 1650 N"
    )


def said(channel: str, is_grip: bool, side: str, lower: float, upper: float, **over) -> str:
    region = MissedRegion(side, over, lower, upper, 14)
    return missed_sentence(MissedAtReadings(channel, 33.4, 3340.0, is_grip, region))


def test_the_sentence_says_size_region_and_why():
    assert said("Fy", True, "", 0.072, 0.113, Fz_N=(460.0, 620.0)) == (
        "what limits Fy is the formula, not the readings: alike in all sweeps it misses 33.4 N rms, 1.0 % of the largest Fy; its "
        "grip at 460 to 620 N of load is 7.2 to 11 % too low in all 14 sweeps there, because the formula's grip is linear in the "
        "load"
    )


@pytest.mark.parametrize(
    ("lower", "upper", "order"),
    [(0.21, 0.24, "driving exceeds that braking"), (-0.24, -0.21, "braking exceeds that driving")],
)
def test_the_sentence_says_which_side_is_larger(lower, upper, order):
    """Why it differs is no matter of the load at which it does."""
    sentence = said("Fx", True, "apart", lower, upper, alpha_deg=(4.8, 4.8), Fz_N=(1646.0, 2730.0))
    assert sentence.endswith(
        f"its grip {order} at 4.8 deg of sideslip and 1646 to 2730 N of load by 21 to 24 % more than in the file in all 14 "
        "sweeps there, because the formula's grip is the same driving and braking"
    )


def test_no_cause_is_said_of_what_is_no_grip():
    sentence = said("Fy", False, "positive", -0.12, -0.09, Fz_N=(500.0, 500.0))
    assert sentence.endswith(
        "its largest Fy at negative sideslip at 500 N of load is 9 to 12 % too high in all 14 sweeps there"
    )


def test_a_sweep_in_which_a_channel_was_not_read_is_no_region(foreign: Built):
    result = foreign.result
    points, model = result.points, result.fit.model
    part = points.replace(Fy=np.where(points.sweep == 0, np.nan, points.Fy))
    found = missed_at_readings(result.prediction, result.fit.tyre, part, model, {"Fy"})
    assert found["Fy"].size == pytest.approx(result.fit.left_by_formula.channels["Fy"].size, rel=0.3)


def test_a_difference_of_the_two_signs_is_as_uncertain_as_both_together(foreign: Built, monkeypatch):
    """Readings of one sign scatter on their own, so variances add."""
    seen: dict[str, list[_Seen]] = {}
    monkeypatch.setattr(region, "_clearest", lambda names, found: seen.update(found))
    result = foreign.result
    missed_at_readings(result.prediction, result.fit.tyre, result.points, result.fit.model, {"Fy"})
    assert len(seen["apart"]) == len(LOADS) * len(CAMBERS)
    for up, down, apart in zip(seen["positive"], seen["negative"], seen["apart"], strict=True):
        assert apart.share == pytest.approx(up.share - down.share)
        assert apart.u**2 == pytest.approx(up.u**2 + down.u**2)


def test_a_fleet_states_what_the_build_states(foreign: Built, tmp_path):
    """The coefficients alone do not know by how much the formula misses the slope of a tyre that is not of it."""
    shutil.copytree(foreign.folder, tmp_path / "again")
    stated = {one.name.rpartition(" ")[2]: one for one in headlines(foreign.result)}
    row, _ = fleet([foreign.folder.parent, tmp_path / "again"]).rows
    for key, name in (("C_gamma_N_per_rad", "C_gamma0"), ("mu_y", "mu_y")):
        assert rounding.stated(row.numbers[key], CHARACTERISTICS[key].unit_behind) == stated[name].value
    beside = foreign.result.measured.nominal.C_alpha_straight  # at the tested load that is nearest
    assert row.numbers["C_alpha_N_per_rad"].u == pytest.approx(beside.u, rel=0.5)
