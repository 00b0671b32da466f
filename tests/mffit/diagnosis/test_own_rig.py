"""Effects and causes of a rig that is written from the definitions; diagnosis_study.py hides all of them."""

from __future__ import annotations

import own_rig


def test_an_effect_three_to_ten_times_its_detection_limit_is_named_first():
    verdict = own_rig.judge(*own_rig.library_set("wear", seed=100))
    assert verdict.named[:1] == ("wear",)
    assert not verdict.extra
    assert verdict.shrink > 1.0
