"""Effects and causes of a rig that is written from the definitions; diagnosis_study.py hides all of them."""

from __future__ import annotations

import own_rig
import pytest


@pytest.mark.parametrize("cause", ["hysteresis", "wear"])
def test_an_effect_three_to_ten_times_its_detection_limit_is_named_first(cause):
    verdict = own_rig.judge(*own_rig.library_set(cause, seed=100))
    assert verdict.named[:1] == (cause,)
    assert not verdict.extra
    assert verdict.shrink > 1.0


def test_a_cause_outside_the_library_is_called_unexplained():
    verdict = own_rig.judge(*own_rig.outside_set("friction that falls with sliding", seed=100))
    assert verdict.unexplained
    assert verdict.named == ()
