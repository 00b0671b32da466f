"""Each physical limit is broken exactly where the factor of the equations exceeds it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tir
from mffit.fit.constraints import Envelope, violations

SAMPLES = Path(__file__).parents[3] / "samples"
ENVELOPE = Envelope(Fz=(900.0, 2100.0), gamma=0.6, alpha=0.15, pressure=(200e3, 300e3))
FLAT = dict.fromkeys(("PEY2", "PEY3", "PEY4", "PEY5", "QEZ2", "QEZ3", "QEZ4", "QEZ5"), 0.0)


@pytest.fixture(scope="module")
def sound() -> tir.Tyre:
    """A tyre that keeps every limit."""
    tyre = tir.read(SAMPLES / "front-120-70" / "true.tir").replace(
        **FLAT, PEY1=0.5, QEZ1=0.5, QBZ4=0.0, QBZ5=0.0
    )
    assert not np.any(violations(tyre.p, ENVELOPE))
    return tyre


@pytest.mark.parametrize(
    "change",
    [
        {"PDY1": 0.05, "PDY2": 0.0},
        {"PKY1": 5.0},
        {"PEY1": 1.2},
        {"PEY1": 0.9, "PEY3": 0.3},
        {"PEY1": 0.9, "PEY3": -0.3},
        {"QEZ1": 1.2},
        {"QEZ1": 0.9, "QEZ4": 0.5},
        {"QEZ1": 0.9, "QEZ4": -0.5},
        {"QBZ1": 0.1, "QBZ2": 0.0, "QBZ3": 0.0},
        {"QDZ1": -0.01, "QDZ2": 0.0},
        {"PPZ1": 6.0},
    ],
)
def test_a_broken_limit_is_a_violation(sound, change):
    assert np.any(violations(sound.replace(**change).p, ENVELOPE))


@pytest.mark.parametrize("factor", ["E_y", "E_t"])
def test_the_violation_grows_with_the_factor(sound, factor):
    name = {"E_y": "PEY1", "E_t": "QEZ1"}[factor]
    low, high = (violations(sound.replace(**{name: value}).p, ENVELOPE).max() for value in (1.1, 1.3))
    assert high - low == pytest.approx(0.2, rel=1e-9)


def test_the_limit_applies_to_the_scaled_curvature(sound):
    """With LEY = 0.5 the E_y of the force is 0.75, although PEY1 is 1.5."""
    assert not np.any(violations(sound.replace(PEY1=1.5, LEY=0.5).p, ENVELOPE))
