"""Frozen records, and their arrays."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from tir.frozen import ReadOnlyArrays


@dataclass(frozen=True, slots=True)
class Kept(ReadOnlyArrays):
    plain: np.ndarray
    by_name: dict[str, np.ndarray] = field(default_factory=dict)
    several: tuple[tuple[str, np.ndarray], ...] = ()
    word: str = ""


def test_no_array_of_a_record_can_be_written_and_the_makers_own_can():
    given = {name: np.zeros(2) for name in ("plain", "by_name", "several")}
    kept = Kept(given["plain"], {"a": given["by_name"]}, (("a", given["several"]),), "word")
    for held, own in zip((kept.plain, kept.by_name["a"], kept.several[0][1]), given.values(), strict=True):
        with pytest.raises(ValueError, match="read-only"):
            held[0] = 1.0
        own[0] = 2.0
        assert np.shares_memory(held, own)
    assert kept.word == "word"


def test_what_is_read_only_already_is_kept_as_it_is():
    kept = Kept(np.zeros(2), {"a": np.ones(1)}, (("a", np.ones(1)),))
    again = replace(kept, word="other")
    assert (again.plain is kept.plain, again.by_name is kept.by_name, again.several is kept.several) == (
        True,
    ) * 3
