"""What a tie leaves open of the numbers of the other effects is in their uncertainty."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from mffit.diagnosis import answer
from mffit.diagnosis.answer import Judgement


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
