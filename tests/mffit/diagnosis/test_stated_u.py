"""What a tie leaves open of the numbers of the other effects is in their uncertainty."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import softmax

from mffit.diagnosis import answer
from mffit.diagnosis.answer import Judgement
from mffit.diagnosis.inexact import correlated


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
        predicted={},
        confidence=lambda effect: 0.9,
    )
    share = softmax([-5.0, -6.7, -7.2])[0]
    judged = answer._judged(found, chosen.effects[0])
    assert judged.tied == ()
    assert judged.confidence == judged.together == pytest.approx(answer.tempered(0.9 * share))


def test_coefficients_far_from_the_file_are_a_surprise_along_their_covariance_only():
    covariance = np.array([[1.0, 0.99], [0.99, 1.0]])
    prior = correlated(["PKY1", "PKY2"], np.array([10.0, 20.0]), covariance)
    together, apart = {"PKY1": 11.0, "PKY2": 21.0}, {"PKY1": 11.0, "PKY2": 19.0}
    assert prior.surprise(together) < 1.0
    assert prior.surprise(apart) > 30.0
    assert prior.surprise({"PKY1": 11.0}) == pytest.approx(prior.surprise({"PKY2": 19.0}))
