"""Builds share the zeros of a set-up only if rig and set-up are named alike; repeated set-ups of a tyre show their scatter."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mffit.fleet import Specimen, estimate
from mffit.numbers import Numbers
from mffit.pipeline.fleet_notes import note_on_sharing
from mffit.pipeline.fleets import _estimated
from tir import Quantity, Tyre

NAMES = ("PKY6", "PECP1", "F0_N", "path_radius_m")
SPREAD = np.array([0.4, math.inf, 10.0, 0.002])


def specimen(name, rng=None, *, rig=None, setups=(), names=NAMES, epsilon=0.0):
    """A build that tells eps_gamma and a load-cell offset of 6 N apart only weakly."""
    truth = np.array([-1.2, epsilon, 6.0, 1.323, *(0.0 for _ in names[4:])])
    rng = rng or np.random.default_rng(1)
    J = np.column_stack([rng.standard_normal((40, len(names)))])
    J[:, 2] = 0.01 * J[:, 1] + 0.003 * J[:, 2]
    score = J.T @ (0.05 * rng.standard_normal(40)) / 0.05**2
    expected = np.array([-1.2, 0.0, 0.0, 1.323, *(0.0 for _ in names[4:])])
    spread = np.concatenate([SPREAD, np.full(len(names) - 4, 10.0)])
    return Specimen(
        name=name, folder=Path(name), tyre=Tyre.from_values({}), file="a.tir", on_disc=True, rig=rig or {},
        numbers=Numbers(tuple(names), truth, J.T @ J / 0.05**2, score, expected, spread),
        epsilon_gamma=Quantity(epsilon, 0.04, "-"), epsilon_direct=Quantity(epsilon, 0.04, "-"),
        misfit={}, warnings=(), setups=setups,
    )  # fmt: skip


NAMED = {"name": "disc"}


def builds(**how):
    rng = np.random.default_rng(4)
    return [specimen(f"tyre {k}", rng, **how) for k in range(6)]


def test_tyres_of_a_declared_set_up_share_its_zeros():
    found = builds(rig=NAMED, setups=("may",))
    together = _estimated(found)
    assert set(together.rig) == {"F0_N", "path_radius_m"}
    plain = estimate([one.numbers for one in found])
    assert together.rig["F0_N"] == pytest.approx(plain.rig["F0_N"])
    assert not note_on_sharing(found, [0] * 6)


@pytest.mark.parametrize(("rig", "setups"), [({}, ()), ({}, ("may",)), (NAMED, ())])
def test_without_the_declaration_every_build_has_zeros_of_its_own(rig, setups):
    found = builds(rig=rig, setups=setups)
    together, shared = _estimated(found), _estimated(builds(rig=NAMED, setups=("may",)))
    assert set(together.rig) == {"path_radius_m"}
    for own, with_others in zip(together.tyres, shared.tyres, strict=True):
        assert own.number("PECP1")[1] > 1.2 * with_others.number("PECP1")[1]
        assert set(own.strain) <= {"path_radius_m"}
    (note,) = note_on_sharing(found, [0] * 6)
    assert "tyre 0, tyre 1, tyre 2 and others" in note
    assert "give [rig] the same name" in note


def test_of_several_set_ups_only_the_named_ones_are_shared():
    names = (*NAMES[:2], "F0_N@may", "path_radius_m", "F0_N@june")
    rows = [
        specimen("a", rig=NAMED, setups=("may", "june"), names=names),
        specimen("b", rig=NAMED, setups=("june",)),
    ]
    a, b = (row.numbers_of_setups.names for row in rows)
    assert a == names
    assert b[2] == "F0_N@june"
    bare = replace(rows[1], setups=())
    assert bare.numbers_of_setups.names[2] == "F0_N@b"
