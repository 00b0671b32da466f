"""What a tie leaves open of the numbers of the other effects is in their uncertainty."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import softmax
from small_programme import LOADS, TYRE, U_FY, U_MZ

from mffit.config import RigTable
from mffit.diagnosis import Asked, answer, diagnose
from mffit.diagnosis.answer import Judgement
from mffit.effects import Effect, Free
from mffit.points import make_points
from mffit.rig import Simulation


def explained(numbers, stderr=None):
    """An explanation by a, whose place is tied, and b."""
    fitted = SimpleNamespace(effects=("a", "b"), numbers=numbers, stderr=stderr or {})
    return SimpleNamespace(chosen=fitted, refined=fitted)


@pytest.mark.parametrize(("weight", "expected"), [(1.0, (0.5 * 0.6**2 + 0.2**2) ** 0.5), (0.0, 0.2)])
def test_numbers_are_as_uncertain_as_the_tied_explanations_are_apart(monkeypatch, weight, expected):
    """With r in the place of a, as likely as a or excluded, b is 1.6 and not 1."""
    rival = SimpleNamespace(numbers={"r": 0.3, "b": 1.6})
    judged = {"a": Judgement([rival], [weight], 0.5, 1.0), "b": Judgement([], [], 1.0, 1.0)}
    monkeypatch.setattr(answer, "_judged", lambda found, effect: judged[effect])
    found = explained({"a": 2.0, "b": 1.0}, {"a": 0.1, "b": 0.2})
    assert answer._stated_u(found, found) == pytest.approx({"a": 0.1, "b": expected})


def test_the_confidence_in_an_effect_is_its_share_of_the_evidence_of_all_that_may_stand_in_its_place():
    """Rivals that the readings exclude, 1.7 and 2.2 behind in log evidence, of an effect that acts in nine of ten cases."""

    def explanation(name, evidence):
        return SimpleNamespace(
            effects=(SimpleNamespace(id=name),), ids=frozenset({name}), log_evidence=evidence,
            apart=lambda other: 100.0, excludes=lambda other, chance: True,
        )  # fmt: skip

    chosen, rivals = explanation("a", -5.0), [explanation("r", -6.7), explanation("s", -7.2)]
    found = SimpleNamespace(
        chosen=chosen,
        contests=[SimpleNamespace(fitted=[chosen, *rivals])],
        confidence=lambda effect: 0.9,
    )
    share = softmax([-5.0, -6.7, -7.2])[0]
    judged = answer._judged(found, chosen.effects[0])
    assert judged.tied == ()
    assert judged.confidence == judged.together == pytest.approx(answer.tempered(0.9 * share))


@pytest.mark.parametrize(("lead", "tied"), [(2.9, True), (3.1, False)])
def test_a_rival_that_is_likelier_than_chance_gives_is_no_tie_but_better(lead, tied):
    chosen, rival = (
        SimpleNamespace(log_evidence=x, apart=lambda _: 1.0, excludes=lambda *_: False) for x in (0.0, lead)
    )
    assert answer._tied(chosen, rival) is tied


GRIP = Effect("grip", "friction", "tyre", "Another friction.", (Free("LMUY", 0.1, (0.0,), 0.3, 2.0),))


@pytest.mark.parametrize("u_gain", [0.0, 0.02])
def test_a_number_is_as_uncertain_as_the_rig_declares_its_gain(u_gain):
    """Friction of 0.9 in readings of large angles, which a gain of the force changes as much."""
    rng = np.random.default_rng(3)
    rows = [(alpha, load) for load in LOADS for alpha in (-12.0, -11.0, -10.0, -9.0, 9.0, 10.0, 11.0, 12.0)]
    alpha, load = np.array(rows).T
    points = make_points(
        np.radians(alpha), 0.0, load, p=250e3, V=10.0, phi_t=0.0, u_Fy=U_FY, u_Mz=U_MZ,
        sweep=np.repeat(np.arange(len(LOADS)), 8), sweep_names=tuple(f"{x}" for x in LOADS),
    )  # fmt: skip
    Fy, Mz = Simulation.of(TYRE.replace(LMUY=0.9)).readings(points).values()
    noise = rng.standard_normal((2, len(points)))
    points = points.replace(Fy=Fy + U_FY * noise[0], Mz=Mz + U_MZ * noise[1])
    config = SimpleNamespace(
        tyre=SimpleNamespace(name="grip", nominal_load=1400.0),
        model=SimpleNamespace(turn_slip=True, star=False, u_coefficients=0.0),
        rig=RigTable(type="flat-track", u_Fy_gain=u_gain, u_Fz_gain=0.0, u_alpha_gain=0.0),
    )
    (named,) = diagnose(points, TYRE, config, Asked(effects=(GRIP,))).effects
    value, u = named.parameters["LMUY"]
    assert value == pytest.approx(0.9, abs=0.005)
    if u_gain:
        assert u == pytest.approx(0.9 * u_gain, rel=0.15)
    else:
        assert u < 0.004
