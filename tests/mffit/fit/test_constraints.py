"""Each physical limit is broken exactly where the factor of the equations exceeds it."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import tir
from mffit.fit.constraints import Envelope, limits, violations
from tir.derivatives import traced

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


def test_a_limit_announces_where_the_cornering_stiffness_jumps(sound):
    """At 1 + PPY2 dpi = 0 the stiffness changes its sign from one value to the next: a search must see it coming."""
    dpi = 300e3 / sound["NOMPRES"] - 1.0
    near, far = (sound.replace(PPY2=-share / dpi) for share in (0.995, 0.9))
    beyond = sound.replace(PPY2=-1.005 / dpi)
    K_near, K_beyond = (tyre.state(1500.0, p=300e3).K_ya for tyre in (near, beyond))
    assert K_near * K_beyond < 0.0
    assert np.any(violations(near.p, ENVELOPE))
    assert not np.any(violations(far.p, ENVELOPE))


@pytest.mark.parametrize("factor", ["E_y", "E_t"])
def test_the_violation_grows_with_the_factor(sound, factor):
    name = {"E_y": "PEY1", "E_t": "QEZ1"}[factor]
    low, high = (violations(sound.replace(**{name: value}).p, ENVELOPE).max() for value in (1.1, 1.3))
    assert high - low == pytest.approx(0.2, rel=1e-9)


def test_the_limit_applies_to_the_scaled_curvature(sound):
    """With LEY = 0.5 the E_y of the force is 0.75, although PEY1 is 1.5."""
    assert not np.any(violations(sound.replace(PEY1=1.5, LEY=0.5).p, ENVELOPE))


DRIVEN = ENVELOPE._replace(kappa=0.15)
CALM = dict.fromkeys(
    ("PEX2", "PEX3", "PEX4", "PHX1", "PHX2", "PVX1", "PVX2", "RBX3", "RBY4", "REX2", "REY2"), 0.0
)
CALM |= {"PCX1": 1.5, "PDX1": 1.2, "PDX2": 0.0, "PEX1": 0.5, "PKX1": 25.0, "PKX2": 0.0, "PKX3": 0.0}
CALM |= {
    "RBX1": 10.0,
    "RBX2": 9.0,
    "RCX1": 1.0,
    "REX1": 0.0,
    "RBY1": 10.0,
    "RBY2": 9.0,
    "RCY1": 1.0,
    "REY1": 0.0,
}


@pytest.fixture(scope="module")
def driven(sound) -> tir.Tyre:
    """A tyre that keeps every limit of longitudinal and combined slip too."""
    tyre = sound.replace(**CALM)
    assert not np.any(violations(tyre.p, DRIVEN))
    return tyre


@pytest.mark.parametrize(
    "change",
    [
        {"PDX1": 0.05},
        {"PKX1": 0.5},
        {"PKX1": 1.2},  # far below the cornering stiffness
        {"PKX1": 400.0},
        {"PEX1": 1.2},
        {"PEX1": 0.9, "PEX4": 0.3},
        {"PEX1": 0.9, "PEX4": -0.3},
        {"PVX1": -1.2},  # the driven wheel is pulled back
        {"PVX1": 1.2},
        {"RCX1": 1.6, "RBX1": 30.0},  # G_xa falls below 0
        {"RHX1": 0.1, "RBX1": 30.0},  # and its peak above 1
        {"RBX1": -12.0, "RBX3": 1.0},
        {"REX1": 1.2},
        {"RCY1": 1.6, "RBY1": 40.0},
        {"RHY1": 0.1, "RBY1": 30.0},
        {"RBY1": -12.0},
        {"REY1": 1.2},
        {"RVY1": 0.3, "RVY5": 1.9, "RVY6": 20.0},  # the ellipse has a dent near free rolling
    ],
)
def test_a_broken_limit_under_slip_is_a_violation_where_slip_was_run(driven, change):
    broken = driven.replace(**change).p
    assert np.any(violations(broken, DRIVEN))
    assert not np.any(violations(broken, ENVELOPE))


def test_limits_under_slip_have_exact_derivatives(driven):
    names = ("PDX1", "PEX1", "PKX3", "RBX1", "RBX3", "REX2", "RHX1", "RBY2", "RCY1", "RHY2", "PVX1", "RVY1")
    values = {name: float(driven[name]) for name in names}
    free = traced(values)
    slope = limits(SimpleNamespace(**{**driven.values, **free}), DRIVEN, list(free.values()))[1]
    for k, name in enumerate(names):
        step = 1e-6
        two = [limits(driven.replace(**{name: values[name] + h}).p, DRIVEN)[0] for h in (-step, step)]
        assert slope[:, k] == pytest.approx((two[1] - two[0]) / (2.0 * step), abs=1e-5)
