"""The one sweep that a simulation misses because it was recorded wrongly, on a tyre of one line."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from mffit.points import Points, make_points
from mffit.points.points import concatenate
from mffit.rig import Readings
from mffit.suspicion.groups import confirmed_by_others
from mffit.suspicion.misread import misread
from mffit.suspicion.others import Doubt, Error, contradicting_sweep, doubtful_sweep
from mffit.suspicion.rereadings import MISTAKES

ISO = dict.fromkeys(("alpha", "gamma", "Fz", "Fy", "Mz"), 1.0)
ALL = ("Fx", "Fy", "Mx", "My", "Mz")
ALPHA = np.radians([-6.0, -4.0, -2.0, -1.0, 1.0, 2.0, 4.0, 6.0])


def readings(points: Points, channels=("Fy", "Mz")) -> Readings:
    """Side force that grows less than the load, and with pressure; the trail falls with sideslip."""
    slip = 12.0 * points.direction * points.alpha + 1.1 * points.gamma
    Fy = -points.Fz * points.p / 250e3 * (1.2 - 1e-4 * points.Fz) * np.tanh(slip)
    Mz = -0.03 * Fy * np.exp(-((10.0 * points.alpha) ** 2)) + 2.0 * points.mount
    out = {"Fy": Fy, "Mz": Mz, "Fx": -0.02 * points.Fz, "Mx": 0.04 * Fy + 5.0, "My": -0.004 * points.Fz}
    return Readings(**{name: out[name] for name in channels})


TYRE = SimpleNamespace(readings=readings)
CONDITIONS = [
    {"Fz": 1000.0},
    {"Fz": 1500.0},
    {"Fz": 2200.0},
    {"Fz": 1500.0, "gamma_deg": 20.0},
    {"Fz": 1500.0, "p": 200e3},
    {"Fz": 1500.0, "direction": -1},
]


def campaign(n: int = 6, points: int = 8, channels=("Fy", "Mz")) -> list[Points]:
    """Sound sweeps of sideslip, one per condition and file."""
    out = []
    for condition in CONDITIONS[:n]:
        settings = {"p": 250e3, "direction": 1, "gamma_deg": 0.0, **condition}
        sweep = make_points(
            ALPHA[-points:], np.radians(settings.pop("gamma_deg")), settings.pop("Fz"), V=6.0, phi_t=0.0, **settings
        )  # fmt: skip
        true = readings(sweep, channels)
        out.append(sweep.replace(**true))
    return out


def numbered(sweeps: list[Points]) -> Points:
    """The sweeps together, called a, b, c ..."""
    number = np.repeat(np.arange(len(sweeps)), [len(sweep) for sweep in sweeps])
    names = tuple("abcdefghijkl"[: len(sweeps)])
    files = tuple(f"{name}.csv" for name in names)
    return concatenate(sweeps).replace(sweep=number, file=number, sweep_names=names, files=files)


def seen(sweeps: list[Points], signs=ISO):
    return misread(numbered(sweeps), TYRE, signs)


def with_one(change, k: int = 3, **sizes: int) -> list[Points]:
    sweeps = campaign(**sizes)
    sweeps[k] = change(sweeps[k])
    return sweeps


def times(**factors: float):
    return lambda sweep: sweep.replace(**{n: f * getattr(sweep, n) for n, f in factors.items()})


def exchanged(sweep: Points) -> Points:
    return sweep.replace(alpha=sweep.gamma, gamma=sweep.alpha)


MADE = {
    "its sideslip reversed": times(alpha=-1.0),
    "its camber reversed": times(gamma=-1.0),
    "its side force reversed": times(Fy=-1.0),
    "its moment reversed": times(Mz=-1.0),
    "sideslip and camber exchanged": exchanged,
    "side force and moment exchanged": lambda sweep: sweep.replace(Fy=sweep.Mz, Mz=sweep.Fy),
    "the direction of rolling undeclared or wrong": times(direction=-1),
    "side force and moment in other axes": times(Fy=-1.0, Mz=-1.0),
    "sideslip, side force and moment in other axes": times(alpha=-1.0, Fy=-1.0, Mz=-1.0),
    "the tyre turned on its rim": times(mount=-1),
    "its load in kgf": times(Fz=1.0 / 9.80665),
    "its load in lbf": times(Fz=1.0 / 4.4482216),
    "its side force in kN": times(Fy=1e-3),
    "its side force in kgf": times(Fy=1.0 / 9.80665),
    "its side force in lbf": times(Fy=1.0 / 4.4482216),
    "its moment in N mm": times(Mz=1e3),
    "its moment in kN m": times(Mz=1e-3),
    "its moment in lbf ft": times(Mz=1.0 / 1.3558179),
    **{
        f"{what} reversed": times(**{channel: -1.0})
        for channel, what in (
            ("Fx", "its longitudinal force"),
            ("Mx", "its overturning moment"),
            ("My", "its rolling resistance moment"),
        )
    },
    "its longitudinal force in kN": times(Fx=1e-3),
    "its longitudinal force in kgf": times(Fx=1.0 / 9.80665),
    "its longitudinal force in lbf": times(Fx=1.0 / 4.4482216),
    "its overturning moment in N mm": times(Mx=1e3),
    "its overturning moment in kN m": times(Mx=1e-3),
    "its overturning moment in lbf ft": times(Mx=1.0 / 1.3558179),
    "its rolling resistance moment in N mm": times(My=1e3),
    "its rolling resistance moment in kN m": times(My=1e-3),
    "its rolling resistance moment in lbf ft": times(My=1.0 / 1.3558179),
    "its sideslip in rad": times(alpha=np.pi / 180.0),
    "its camber in rad": times(gamma=np.pi / 180.0),
    "its pressure in psi": times(p=1.0 / 6.894757),
}
"""What each mistake does to the readings of a sound sweep."""


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.looks)
def test_a_mistake_undone_gives_the_sound_sweep_back(mistake):
    (sound,) = campaign(4, channels=ALL)[3:]
    broken = MADE[mistake.looks](sound)
    undone = mistake.undone(broken, ISO)
    for name in ("alpha", "gamma", "Fz", "p", *ALL, "direction", "mount"):
        assert getattr(undone, name) == pytest.approx(getattr(sound, name), rel=1e-7), name


def test_every_mistake_is_made_here_once():
    assert sorted(MADE) == sorted(mistake.looks for mistake in MISTAKES)


def test_exchanged_headings_are_undone_in_the_axes_of_the_rig():
    """A rig with its camber reversed reports -gamma under the heading of sideslip."""
    signs = ISO | {"gamma": -1.0}
    (sound,) = campaign(4)[3:]
    broken = sound.replace(alpha=-sound.gamma, gamma=-sound.alpha)
    (mistake,) = (m for m in MISTAKES if m.looks == "sideslip and camber exchanged")
    assert mistake.undone(broken, signs).alpha == pytest.approx(sound.alpha)
    assert mistake.undone(broken, signs).gamma == pytest.approx(sound.gamma)


DISTINCT = [
    "its sideslip reversed",
    "its camber reversed",
    "its moment reversed",
    "its side force in kN",
    "its load in kgf",
    "its moment in N mm",
    "its sideslip in rad",
]


@pytest.mark.parametrize("looks", DISTINCT)
def test_the_misread_sweep_is_found_by_what_was_done_to_it(looks):
    found = seen(with_one(MADE[looks]))
    assert (found.sweep, found.file) == ("d", "d.csv")
    assert found.looks == looks
    assert found.before > 0.15
    assert found.after == pytest.approx(0.0, abs=1e-9)
    assert looks in found.sentence


def test_a_reversed_overturning_moment_is_found_where_it_is_simulated():
    sweeps = campaign(channels=("Fy", "Mx", "Mz"))
    sweeps[3] = MADE["its overturning moment reversed"](sweeps[3])
    found = misread(numbered(sweeps), TYRE, ISO, ("Fy", "Mx", "Mz"))
    assert (found.sweep, found.looks, found.column) == ("d", "its overturning moment reversed", "Mx_Nm")


def test_sound_sweeps_are_not_misread():
    assert seen(campaign()) is None


@pytest.mark.parametrize("signs", [ISO, ISO | {"gamma": -1.0, "Fz": -1.0}], ids=["iso", "reversed"])
@pytest.mark.parametrize(
    ("k", "label", "column", "said", "reversed_said"),
    [
        (0, {"Fz": 1500.0}, "Fz_N", "load of 1000 N", "load of 1000 N"),
        (3, {"gamma": 0.0}, "gamma_deg", "camber of 20 deg", "camber of -20 deg"),
        (4, {"p": 250e3}, "p_kPa", "pressure of 200 kPa", "pressure of 200 kPa"),
    ],
)
def test_a_sweep_with_the_label_of_another_is_named_with_what_it_was_run_at(
    k, label, column, said, reversed_said, signs
):
    """In the axes of the rig; a load is a positive number in all of them."""
    sweeps = [*campaign(), *campaign()]
    sweeps[k] = sweeps[k].replace(**label)
    found = seen(sweeps, signs)
    expected = reversed_said if signs["gamma"] < 0.0 else said
    assert (found.sweep, found.column) == ("abcdefghijkl"[k], column)
    assert found.looks == f"run at a {expected}"
    assert found.remedy == f"write the {expected.replace(' of ', ' that was run, ')}"


def test_two_misread_sweeps_are_the_models_fault():
    sweeps = with_one(MADE["its sideslip reversed"])
    sweeps[1] = MADE["its sideslip reversed"](sweeps[1])
    assert seen(sweeps) is None


def test_an_error_that_no_mistake_explains_is_not_misread():
    assert seen(with_one(lambda sweep: sweep.replace(Fy=np.roll(sweep.Fy, 3)))) is None


@pytest.mark.parametrize(
    ("sweeps", "points", "found"), [(4, 8, True), (3, 8, False), (4, 4, True), (4, 3, False)]
)
def test_four_sweeps_of_four_points_are_needed(sweeps, points, found):
    broken = with_one(MADE["its side force reversed"], k=1, n=sweeps, points=points)
    assert (seen(broken) is not None) == found


def found_with(
    label: float, others: float = 0.0, one: float = 0.0, left: float = 0.0, confirmed: bool = True
) -> bool:
    """Whether a sweep at 1500 N is found whose load says ``label`` times less.

    Parameters
    ----------
    label : the load that was run over the one written
    others, one : relative error of the force of four other sweeps, and of a fifth
    left : relative error of the sweep itself, with its label corrected
    confirmed : whether other sweeps were run at the load that is written
    """
    alpha = np.radians([-3.0, 3.0] * 4)
    loads = np.array([1500.0, 1500.0 / label, 1500.0, 1500.0 / label, 1500.0, 1500.0])
    loads = loads if confirmed else np.full(6, 1500.0)
    errors = [left, others, others, others, others, max(one, others)]
    sweeps = []
    for load, error in zip(loads, errors, strict=True):
        sweeps.append(
            make_points(
                alpha, 0.0, load, p=250e3, V=6.0, phi_t=0.0, Fy=-load * np.sign(alpha) * (1.0 + error)
            )
        )
    sweeps[0] = sweeps[0].replace(Fz=sweeps[0].Fz / label)
    tyre = SimpleNamespace(
        readings=lambda at, channels: Readings(Fy=-at.Fz * np.sign(at.alpha), Mz=0.0 * at.Fz)
    )
    return misread(numbered(sweeps), tyre, ISO) is not None


NORMAL = 1.4826
"""Standard deviation over median of the absolute error, by which errors are stated."""


@pytest.mark.parametrize(
    ("siblings", "found"), [((200e3,), True), ((170e3, 230e3), True), ((), False), ((230e3,), False)]
)
def test_a_small_error_is_a_wrong_label_where_others_confirm_the_model(siblings, found):
    """A sweep at 250 kPa labelled 200 kPa: 5 % of the force. Without others there, the model may be wrong at that pressure."""
    rng = np.random.default_rng(2)
    alpha = np.radians([-6.0, -4.0, -2.0, -1.0, 1.0, 2.0, 4.0, 6.0])

    def force(at):
        return -at.Fz * (1.0 + 1e-6 * (at.p - 250e3)) * np.tanh(12.0 * at.alpha)

    sweeps = []
    for p in (250e3, 250e3, 250e3, *siblings, 250e3):
        sweep = make_points(alpha, 0.0, 1500.0, p=p, V=6.0, phi_t=0.0)
        sweeps.append(sweep.replace(Fy=force(sweep) + rng.normal(0.0, 5.0, 8)))
    sweeps[0] = sweeps[0].replace(p=200e3)
    tyre = SimpleNamespace(readings=lambda at, _: Readings(Fy=force(at), Mz=0.0 * at.Fz))
    wrong = misread(numbered(sweeps), tyre, ISO)
    assert (wrong is not None) == found
    assert wrong is None or wrong.looks == "run at a pressure of 250 kPa"


def test_an_error_of_ten_per_cent_is_the_least_that_is_looked_at_without_them():
    assert found_with(label=1.0 + 0.151 / NORMAL)
    assert not found_with(label=1.0 + 0.099 / NORMAL, confirmed=False)


def test_it_is_one_and_a_half_times_the_error_of_any_other_sweep():
    assert found_with(label=1.5, one=0.5 / 1.6)
    assert not found_with(label=1.5, one=0.5 / 1.4)


def test_a_corrected_sweep_is_as_good_as_others():
    """Within 10 % if these are good, within one and a half times the usual error if not."""
    assert found_with(label=1.8, left=0.099 / NORMAL)
    assert not found_with(label=1.8, left=0.101 / NORMAL)
    assert found_with(label=1.8, others=0.2, left=1.49 * 0.2)
    assert not found_with(label=1.8, others=0.2, left=1.51 * 0.2)


def test_two_sweeps_that_look_misread_are_no_mistake_of_one():
    """One is far off in the side force, the other in the moment: then the model or the rig is at fault."""
    in_kilonewtons, in_millimetres = times(Fy=1e-3), times(Mz=1e3)
    sweeps = campaign()
    one = [*sweeps[:1], in_kilonewtons(sweeps[1]), *sweeps[2:]]
    assert seen(one).sweep == "b"
    assert seen([*one[:4], in_millimetres(one[4]), *one[5:]]) is None


def trail_of_one_load(k: int, *more: int) -> list[Points]:
    """Sweeps of which that at one load has a trail 1.356 times as long as its formula says, and repeats of some sweeps."""
    sweeps = campaign()
    sweeps[k] = MADE["its moment in lbf ft"](sweeps[k])
    return [*sweeps, *(campaign()[other] for other in more)]


def test_a_trail_of_its_own_at_one_load_is_no_other_unit():
    """A trail that does not depend on the load is 4/3 of what MF draws between two loads: no other sweep at 2200 N objects."""
    assert seen(trail_of_one_load(2)) is None


def test_a_moment_in_foot_pounds_is_found_where_another_sweep_was_run():
    assert seen(trail_of_one_load(2, 2)).looks == "its moment in lbf ft"


@pytest.mark.parametrize(
    ("sweep", "others", "confirmed"),
    [
        pytest.param(2, [0, 1, 3, 4], False, id="a load of its own"),
        pytest.param(2, [0, 1, 2, 3], True, id="a load of others"),
        pytest.param(3, [0, 1, 2], False, id="a camber of its own"),
        pytest.param(4, [0, 1, 2], False, id="a pressure of its own"),
        pytest.param(1, [0, 2], False, id="between two loads"),
    ],
)
def test_a_sweep_is_confirmed_by_sweeps_at_its_settings(sweep, others, confirmed):
    sweeps = campaign()
    assert confirmed_by_others(sweeps[sweep], numbered([sweeps[k] for k in others])) == confirmed


def test_between_the_outer_ones_of_four_loads_readings_show_the_course():
    others = numbered([times(Fz=f)(campaign()[0]) for f in (1.0, 1.3, 2.0, 2.6)])
    assert confirmed_by_others(times(Fz=1.6)(campaign()[0]), others)
    assert not confirmed_by_others(times(Fz=3.0)(campaign()[0]), others)


@pytest.mark.parametrize("confirmed", [True, False])
def test_only_readings_refuse_a_sweep_and_a_formula_asks(confirmed):
    """A trail that does not depend on the load vanishes where MF extends it to the triple load: an error of its whole size."""
    error = Error(channel="Mz", rms=30.0, ratio=40.0, share=1.0, chance=0.0, vague=0.02)
    doubt = Doubt("c", "c.csv", np.arange(8), (error,), confirmed=confirmed)
    assert len(list(contradicting_sweep.find([doubt]))) == confirmed
    assert list(doubtful_sweep.find([doubt])) == [doubt]
