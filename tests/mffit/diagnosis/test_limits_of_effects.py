"""How large an effect that was not named can be, on readings of three unit uncertainties."""

from __future__ import annotations

from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest

from mffit.diagnosis.limits import limits

RESIDUAL = np.zeros(3)


class Unnamed(NamedTuple):
    id: str
    switches: bool = False


def found(columns, known=(), residual=RESIDUAL):
    """Limits of effects whose columns are given by id, each a list with one array (3, k) per start."""
    effects = [Unnamed(name) for name in columns]
    problem = SimpleNamespace(
        columns=lambda state, of: {one: columns[one.id] for one in of},
        noise=SimpleNamespace(whiten=lambda x: x),
    )
    chosen = SimpleNamespace(axes=np.zeros((3, 0)), state=None, residual=residual)
    return {row.effect.id: row for row in limits(problem, chosen, effects, known)}


def column(size: float, row: int = 0) -> np.ndarray:
    out = np.zeros((3, 1))
    out[row] = size
    return out


def test_the_start_at_which_an_even_effect_is_seen_best_counts():
    """A column of length s leaves 1/sqrt(s^2 + 1) of the usual size: 0.1 from one start, 0.5 from the other."""
    weak, strong = column(np.sqrt(3.0)), column(np.sqrt(99.0), row=1)
    for starts in ([weak, strong], [strong, weak]):
        assert found({"bend": starts})["bend"].share == pytest.approx(0.2)


def test_what_the_readings_show_adds_to_the_limit():
    quiet = found({"bend": [column(3.0)]})["bend"].share
    moved = found({"bend": [column(3.0)]}, residual=np.array([-2.0, 0.0, 0.0]))["bend"].share
    assert moved - quiet == pytest.approx(3.0 * 2.0 / 10.0)


def test_named_effects_have_no_limit_and_the_smallest_comes_first():
    rows = found({"a": [column(0.1)], "b": [column(9.0)], "c": [column(3.0)]}, known=("c",))
    assert list(rows) == ["b", "a"]
    assert [row.ruled_out for row in rows.values()] == [True, False]
