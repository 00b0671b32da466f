"""Every rule before the fit applies just beyond its limit, and not just within it."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from mffit.constants import STRAIGHT, UPRIGHT
from mffit.points import Points, make_points
from mffit.suspicion import RULES, contradictions, signatures
from mffit.suspicion.slopes import SlopeWithError, slope

CONFIG = SimpleNamespace(
    tyre=SimpleNamespace(nominal_pressure=250.0, nominal_load=1500.0, unloaded_radius=0.3),
    rig=SimpleNamespace(on_disc=True, moments="contact"),
    path=None,
    line_of=lambda key: None,
)
DEG = np.radians(1.0)
ALPHA = np.radians([-6.0, -3.0, -1.0, 0.0, 1.0, 3.0, 6.0])


def tyre(alpha=ALPHA, gamma=0.0, Fz=1500.0, **fields) -> Points:
    """Points of a plain tyre; fields are overridden."""
    alpha, gamma, Fz = np.broadcast_arrays(alpha, gamma, Fz)
    Fy = -Fz * np.tanh(12.0 * np.asarray(alpha) + np.asarray(gamma))
    return make_points(
        alpha, gamma, Fz, **{"p": 250e3, "V": 6.0, "phi_t": 0.0, "Fy": Fy, "Mz": -0.03 * Fy} | fields
    )


def found(rule: str, points: Points, *, asked: bool | None = None) -> int:
    """Number of cases in which a rule applies, or of those that it only asks for or refuses."""
    (one,) = (each for each in RULES if each.id == rule)
    return sum(asked in (None, one.only_asks(facts)) for facts in one.find(points, CONFIG))


def changed(values: np.ndarray, rows: list[int], to: float) -> np.ndarray:
    values = np.array(values, dtype=float)
    values[rows] = to
    return values


SOUND = tyre()
FEW = SOUND.select(np.arange(3))
FORCE = SOUND.Fy
CAMBER = np.radians([-8.0, -7.0, -6.0, 0.0, 6.0, 7.0, 8.0])
LOADS = np.full(7, 1500.0)
SINGLE_FILES = [
    ("dead-channel", tyre(Mz=3.7), tyre(Mz=changed(np.full(7, 3.7), [2], 3.8))),
    ("dead-channel", tyre(Fy=-80.0), tyre(alpha=0.02, Fy=-80.0, Mz=2.0)),
    ("dead-channel", tyre(alpha=ALPHA[:4], Mz=3.7), tyre(alpha=ALPHA[:3], Mz=3.7)),
    ("lone-load", tyre(Fz=changed(LOADS, [2], 4510.0), Fy=FORCE), tyre(Fz=changed(LOADS, [2], 4490.0), Fy=FORCE)),
    ("lone-load", tyre(alpha=ALPHA[:4], Fz=[1e3, 1e3, 1e3, 6e3]), tyre(alpha=ALPHA[:3], Fz=[1e3, 1e3, 6e3])),
    ("wild-force", tyre(Fy=changed(FORCE, [1, 2], 6010.0)), tyre(Fy=changed(FORCE, [1, 2], 5990.0))),
    ("wild-force", tyre(Fy=changed(FORCE, [1, 2], 6010.0)), tyre(Fy=changed(FORCE, [1, 2, 3, 4], 6010.0))),
    ("unusual-file", tyre(Fy=-1500.0 * 125.0 * ALPHA), tyre(Fy=-1500.0 * 38.0 * ALPHA)),
    ("unusual-file", tyre(gamma=ALPHA, alpha=0.0, Fy=-18000.0 * ALPHA), tyre(gamma=ALPHA, alpha=0.0, Fy=-16500.0 * ALPHA)),
    ("unusual-file", tyre(Mz=228.0 * np.sign(ALPHA)), tyre(Mz=222.0 * np.sign(ALPHA))),
    ("unusual-file", tyre(Mx=1810.0 * np.sign(ALPHA)), tyre(Mx=1790.0 * np.sign(ALPHA))),
    ("unusual-file", tyre(Mz=228.0 * (ALPHA > 0.0)[[0, 1, 2, 4, 4, 5, 6]]), tyre(Mz=228.0 * (ALPHA > 0.0))),
    ("unusual-file", tyre(Fy=28.0 * np.sign(ALPHA)), tyre(Fy=32.0 * np.sign(ALPHA))),
    ("unusual-file", tyre(alpha=ALPHA[[0, 1, 0, 1]], Fy=28.0), tyre(alpha=ALPHA[[0, 1, 0]], Fy=28.0)),
    ("unusual-file", tyre(alpha=[DEG * 3.1] * 4, Fy=28.0), tyre(alpha=[DEG * 2.9] * 4, Fy=28.0)),
    ("unusual-file", tyre(0.0, [DEG * 5.8] * 4, Fy=28.0), tyre(0.0, [DEG * 5.6] * 4, Fy=28.0)),
    ("unusual-file", tyre(Fy=changed(FORCE, [1, 2, 3, 4], 6010.0)), tyre(Fy=changed(FORCE, [1, 2, 3], 6010.0))),
    ("unusual-file", tyre(p=83e3), tyre(p=84e3)),
    ("unusual-file", tyre(p=505e3), tyre(p=495e3)),
    ("unusual-file", tyre(alpha=3.1 * ALPHA, Fy=-440.0 * np.sign(ALPHA)), tyre(alpha=3.1 * ALPHA, Fy=-460.0 * np.sign(ALPHA))),
]  # fmt: skip
AS_A_MISTAKE = [
    (SOUND.replace(alpha=np.radians(ALPHA)), "its sideslip in rad"),
    (tyre(0.0, np.radians(CAMBER), Fy=-1500.0 * CAMBER), "its camber in rad"),
    (tyre(p=36.4e3), "its pressure in psi"),
    (tyre(Fy=1e-3 * FORCE), "its side force in kN"),
    (tyre(Fy=0.03 * FORCE, Mz=FORCE), "side force and moment exchanged"),
    (tyre(0.0, CAMBER, Fy=60.0 * np.sin(CAMBER), Mz=1200.0 * np.sin(CAMBER)), "side force and moment exchanged"),
    (tyre(0.0, CAMBER, Fy=1.2 * np.sin(CAMBER), Mz=30.0 * np.sin(CAMBER)), "its side force in kN"),
    (tyre(Fz=1500.0 / 9.80665, Fy=FORCE, Mz=-0.03 * FORCE), "its load in kgf or lbf"),
    (tyre(Mz=-30.0 * FORCE), "its moment in N mm"),
    (tyre(Mx=30.0 * FORCE), "its overturning moment in N mm"),
]  # fmt: skip


@pytest.mark.parametrize(("points", "looks"), AS_A_MISTAKE, ids=lambda x: x if isinstance(x, str) else "")
def test_an_impossible_file_looks_like_the_mistake_without_which_it_is_possible(points, looks):
    assert f"it looks like {looks}: " in sentence("unusual-file", points)


def test_of_two_mistakes_the_first_is_named():
    assert "it looks like its pressure in psi" in sentence("unusual-file", tyre(Fy=1e-3 * FORCE, p=36.4e3))


def test_an_impossible_file_that_no_mistake_makes_possible_is_told_without_a_guess():
    strong = tyre(Fy=-1500.0 * 50.0 * np.sign(ALPHA), Mz=10.0 * ALPHA)
    assert "no single unit or exchanged heading explains it" in sentence("unusual-file", strong)


UNUSUAL = [
    tyre(p=80e3),  # deflated: 552 kPa would be as far from the nominal 250 kPa
    tyre(p=600e3),
]


def test_a_heavy_load_that_the_side_force_shows_is_only_asked_for():
    """A tyre has less than the proportional force at five times the load, but far more than at the other loads."""
    Fz = changed(LOADS, [2], 7500.0)
    seen = tyre(Fz=Fz, Fy=changed(FORCE, [2], 3.0 * FORCE[2]))
    assert found("lone-load", seen, asked=False) == 0
    assert found("lone-load", seen, asked=True) == 1


@pytest.mark.parametrize("points", UNUSUAL)
def test_what_is_unusual_and_looks_like_no_mistake_is_asked_for(points):
    assert found("unusual-file", points, asked=False) == 0
    assert found("unusual-file", points, asked=True) == 1


@pytest.mark.parametrize("steepness", [2.9, 5.1])
def test_a_racing_tyre_is_as_steep_over_camber_as_it_is(steepness):
    gamma = np.radians([-4.0, -2.0, 0.0, 2.0, 4.0])
    racing = tyre(0.0, gamma, Fy=-1500.0 * steepness * gamma)
    assert not contradictions(signatures(racing))
    assert found("unusual-file", racing) == 0


def test_where_camber_stands_still_nothing_is_said_of_its_slope():
    """Camber follows the force by 0.01 deg, as a rig yields: the slope over it would be that of the rig."""
    alpha = np.repeat(ALPHA, 3)
    Fy = -1500.0 * np.tanh(12.0 * alpha)
    yielding = tyre(alpha, np.radians(1e-5) * Fy, Fy=Fy)
    assert np.isnan(signatures(yielding).camber.value)
    assert found("unusual-file", yielding) == 0


def test_loads_that_a_cell_hardly_shows_say_nothing_of_friction():
    light = tyre(Fz=changed(LOADS, [0, 1, 2, 4], 100.0), Fy=FORCE)
    assert found("unusual-file", light) == found("wild-force", light) == 0


@pytest.mark.parametrize(("rule", "beyond", "within"), SINGLE_FILES)
def test_a_file_is_suspected_beyond_the_limit_only(rule, beyond, within):
    assert found(rule, beyond) >= 1
    assert found(rule, within) == 0


@pytest.mark.parametrize("rule", sorted({rule for rule, *_ in SINGLE_FILES}))
def test_a_sound_file_is_not_suspected(rule):
    assert found(rule, SOUND) == 0


def test_a_slope_is_significant_beyond_the_chance_of_a_false_alarm():
    """3.29 standard errors of many readings."""
    assert SlopeWithError(value=3.30, error=1.0, freedom=10**6, scatter=1.0).sign == 1
    assert SlopeWithError(value=-3.30, error=1.0, freedom=10**6, scatter=1.0).sign == -1
    assert SlopeWithError(value=3.28, error=1.0, freedom=10**6, scatter=1.0).sign == 0


def test_a_slope_needs_four_points_and_two_angles():
    one_angle = tyre(alpha=np.full(7, 0.01))
    assert np.isfinite(slope(SOUND, SOUND.Fy, "alpha", np.arange(7) < 4).value)
    assert np.isnan(slope(one_angle, one_angle.Fy, "alpha", np.arange(7) < 7).value)
    assert np.isnan(slope(SOUND, SOUND.Fy, "alpha", np.arange(7) < 3).value)


@pytest.mark.parametrize(
    ("name", "angle", "limit"),
    [
        ("cornering", "alpha", 3.0),
        ("cornering", "gamma", 0.8),
        ("camber", "gamma", 20.0),
        ("camber", "alpha", 0.4),
        ("aligning", "alpha", 3.0),
        ("aligning", "gamma", 0.8),
    ],
)
def test_slopes_are_read_from_small_angles_only(name, angle, limit):
    """One more point adds a degree of freedom if it is within the limit."""
    alpha, gamma = np.tile(np.radians([-0.3, 0.0, 0.3]), 3), np.repeat(np.radians([-0.6, 0.0, 0.6]), 3)

    def freedom(degrees: float) -> int:
        one = {"alpha": 0.0, "gamma": 0.0} | {angle: np.radians(degrees)}
        points = tyre(np.append(alpha, one["alpha"]), np.append(gamma, one["gamma"]))
        return getattr(signatures(points), name).freedom

    plain = getattr(signatures(tyre(alpha, gamma)), name).freedom
    assert (freedom(limit + 0.05), freedom(limit - 0.05)) == (plain, plain + 1)


def sweeps(*parts: Points) -> Points:
    """Several sweeps, a file each."""
    number = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    names = tuple(f"s{k}" for k in range(len(parts)))
    arrays = {
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in ("alpha", "gamma", "Fz", "p", "V", "phi_t", "Fy", "Mz", "Mx", "direction")
    }
    return make_points(**arrays, sweep=number, file=number, sweep_names=names, files=names)


def test_four_equal_rows_in_any_order_are_a_copy_and_three_are_not():
    assert found("copied-sweep", sweeps(SOUND, SOUND.select([3, 1, 0, 2, 6, 5, 4]))) == 1
    four = SOUND.select(np.arange(4))
    assert found("copied-sweep", sweeps(four, four)) == 1
    assert found("copied-sweep", sweeps(FEW, FEW)) == 0
    assert found("copied-sweep", sweeps(SOUND, SOUND.replace(Fy=changed(FORCE, [2], 300.0)))) == 0


def test_a_file_pasted_into_itself_is_named_and_a_repeated_condition_is_not():
    """Twice the same readings would halve the variance of everything; a condition run again has readings of its own."""
    twice = np.tile(np.arange(len(SOUND)), 2)
    assert found("repeated-rows", SOUND.select(twice)) == 1
    assert found("repeated-rows", SOUND.select(twice[:-1])) == 0
    again = SOUND.select(twice)
    again = again.replace(Fy=again.Fy + np.where(np.arange(len(again)) < len(SOUND), 0.0, 0.01))
    assert found("repeated-rows", again) == 0


@pytest.mark.parametrize(("load", "cases"), [(1380.0, 1), (1400.0, 0), (2000.0, 0)])
def test_a_nominal_load_above_all_measured_ones_is_pointed_out(load, cases):
    """The mean of a level of load decides, not one reading above it."""
    Fz = changed(np.full(40, load), [3], 1.05 * load)
    assert found("nominal-load-of-other-loads", tyre(alpha=np.linspace(-0.1, 0.1, 40), Fz=Fz)) == cases


@pytest.mark.parametrize(
    ("loads", "cases"),
    [((1000.0, 1500.0, 2000.0), 0), ((4400.0, 5200.0), 0), ((9000.0, 21000.0), 1), ((150.0, 300.0), 1)],
)
def test_a_nominal_load_of_other_loads_is_asked_for(loads, cases):
    """The nominal load is 1500 N: a digit is missing in it, or in the loads."""
    Fz = np.repeat(loads, 20)
    assert found("nominal-load-of-other-loads", tyre(alpha=np.linspace(-0.1, 0.1, len(Fz)), Fz=Fz)) == cases


@pytest.mark.parametrize(("degrees", "cases"), [(166.0, 1), (108.0, 0), (np.nan, 0)])
def test_a_tread_that_stays_hotter_than_any_is_pointed_out(degrees, cases):
    """One hot reading is no sign; of two files it is enough that one is hot."""
    assert found("hot-tread", tyre(T=degrees)) == cases
    assert found("hot-tread", tyre(T=changed(np.full(7, 60.0), [2], 166.0))) == 0


@pytest.mark.parametrize(("share", "cases"), [(0.009, 1), (0.011, 0), (-0.5, 1)])
def test_a_turn_slip_force_is_weak_below_a_hundredth_of_the_load(share, cases):
    zero = tyre(alpha=[0.0], Fy=-share * 1500.0, phi_t=-0.76)
    assert found("weak-turn-slip-force", zero) == cases


def test_without_a_path_there_is_no_turn_slip_force_to_be_weak():
    assert found("weak-turn-slip-force", SOUND) == 0


@pytest.mark.parametrize(("lever", "cases"), [(0.16, 1), (-0.16, 1), (0.14, 0)])
def test_moments_follow_the_force_with_half_the_radius_only_about_another_point(lever, cases):
    ten = tyre(alpha=np.r_[ALPHA, ALPHA[:3]], gamma=0.7 * DEG)
    assert found("moments-about-another-point", ten.replace(Mx=lever * ten.Fy)) == cases
    few = ten.select(np.array([0, 3, 6]))
    leaning = ten.replace(gamma=0.9 * DEG)
    for other in (few, leaning):
        assert found("moments-about-another-point", other.replace(Mx=lever * other.Fy)) == 0
    # A lever beside which the moments scatter is not known.
    noise = 300.0 * np.tile([1.0, -1.0], 5)
    assert found("moments-about-another-point", ten.replace(Mx=lever * ten.Fy + noise)) == 0


def test_a_disc_needs_both_signs():
    assert found("one-sided-on-a-disc", SOUND) == 0
    for side in (1.0, -1.0):
        assert found("one-sided-on-a-disc", tyre(alpha=side * ALPHA[2:])) == 0
        assert found("one-sided-on-a-disc", tyre(alpha=side * ALPHA[3:])) == 1
        assert found("one-sided-on-a-disc", tyre(gamma=side * np.radians(np.arange(7.0)))) == 1


def test_a_disc_needs_a_zero_that_is_straight_and_upright():
    assert found("no-zero-on-a-disc", SOUND) == 0
    assert found("no-zero-on-a-disc", SOUND.replace(direction=-1)) == 1
    for share, missing in ((0.98, 0), (1.02, 1)):
        assert found("no-zero-on-a-disc", tyre(alpha=np.array([-0.1, share * STRAIGHT.rad]))) == missing
        assert found("no-zero-on-a-disc", tyre(gamma=share * UPRIGHT.rad)) == missing


def sentence(rule: str, points: Points) -> str:
    """What a refusal says about the first case that a rule finds."""
    (one,) = (each for each in RULES if each.id == rule)
    return one.said(next(iter(one.find(points, CONFIG))))


@pytest.mark.parametrize(
    ("rule", "points", "facts"),
    [
        ("unusual-file", tyre(p=36.46e3), "is 36.5 kPa, far from the nominal 250 kPa; it looks like its"),
        ("dead-channel", tyre(Mz=3.7), "is 3.7 in every row"),
        (
            "unusual-file",
            tyre(Fy=-1500.0 * 125.0 * ALPHA),
            "spans only 6 deg, yet the side force changes by 125 times the load per radian",
        ),
        (
            "unusual-file",
            tyre(Fy=30.0 * np.sign(ALPHA), Mz=1200.0 * np.sign(ALPHA)),
            "Mz_Nm reaches 0.8 m times the load, where no tyre exceeds 0.15 m",
        ),
        ("unusual-file", tyre(Fy=1.5 * np.sign(ALPHA)), "is at most 1.5 N at loads of 1500 N"),
        (
            "lone-load",
            tyre(Fz=changed(changed(LOADS, [0, 1], 900.0), [2], 7510.0), Fy=FORCE),
            "7510 N is far above all other loads of the file, which are at most 1500 N",
        ),
        ("wild-force", tyre(Fy=changed(FORCE, [1, 2], -7500.0)), "-7500 N is 5 times the load"),
        (
            "unusual-file",
            tyre(Fy=changed(FORCE, [1, 2, 3, 4], 7500.0)),
            "reaches 5 times the load, where no tyre exceeds 4",
        ),
        ("one-sided-on-a-disc", tyre(alpha=ALPHA[3:]), "runs only from 0 to 6 deg"),
        ("weak-turn-slip-force", tyre(alpha=[0.0], Fy=-7.5, phi_t=-0.76), "is 0.5 % of the load"),
        (
            "moments-about-another-point",
            tyre(alpha=np.r_[ALPHA, ALPHA[:3]], Mx=0.2 * tyre(np.r_[ALPHA, ALPHA[:3]]).Fy),
            "changes by 0.20 m times Fy_N",
        ),
        (
            "nominal-load-of-other-loads",
            tyre(Fz=1300.0),
            "the nominal load of 1500 N is above the measured loads of 1300 to 1300 N",
        ),
        (
            "nominal-load-of-other-loads",
            tyre(Fz=15000.0),
            "the nominal load of 1500 N is far below the measured loads of 15000 to 15000 N",
        ),
        ("hot-tread", tyre(T=166.0), "T_degC is 166 degC in the middle in"),
        ("copied-sweep", sweeps(SOUND, SOUND), "holds exactly the readings of s0"),
        (
            "repeated-rows",
            SOUND.select(np.tile(np.arange(len(SOUND)), 2)),
            "holds rows twice, with the same readings (7 copies)",
        ),
    ],
)
def test_a_refusal_says_its_numbers(rule, points, facts):
    assert facts in sentence(rule, points)
