"""Builds share the zeros of a set-up only if rig and set-up are named alike; repeated set-ups of a tyre show their scatter."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mffit.fleet import Information, Specimen, estimate, within_tyres
from mffit.fleet.specimen import _of_setups
from mffit.pipeline.fleet_notes import notes_on_setups
from mffit.pipeline.fleets import _estimated
from tir import Quantity, Tyre

NAMES = ("PKY6", "PECP1", "F0_N", "path_radius_m")
SPREAD = np.array([0.4, math.inf, 10.0, 0.002])


def specimen(name, rng=None, *, rig=None, setups=(), names=NAMES, epsilon=0.0, of_setups=()):
    """A build that tells eps_gamma and a load-cell offset of 6 N apart only weakly."""
    truth = np.array([-1.2, epsilon, 6.0, 1.323, *(0.0 for _ in names[4:])])
    rng = rng or np.random.default_rng(1)
    J = np.column_stack([rng.standard_normal((40, len(names)))])
    J[:, 2] = 0.01 * J[:, 1] + 0.003 * J[:, 2]
    matrix = J.T @ J / 0.05**2
    vector = matrix @ truth + J.T @ (0.05 * rng.standard_normal(40)) / 0.05**2
    expected = np.array([-1.2, 0.0, 0.0, 1.323, *(0.0 for _ in names[4:])])
    spread = np.concatenate([SPREAD, np.full(len(names) - 4, 10.0)])
    return Specimen(
        name=name, folder=Path(name), tyre=Tyre.from_values({}), file="a.tir", on_disc=True, rig=rig or {},
        information=Information(tuple(names), truth, matrix, vector, expected, spread),
        epsilon_gamma=Quantity(epsilon, 0.04, "-"), misfit={}, warnings=(), setups=setups, epsilon_of_setups=of_setups,
    )  # fmt: skip


NAMED = {"name": "disc"}


def builds(**how):
    rng = np.random.default_rng(4)
    return [specimen(f"tyre {k}", rng, **how) for k in range(6)]


def test_tyres_of_a_declared_set_up_share_its_zeros():
    found = builds(rig=NAMED, setups=("may",))
    together = _estimated(found)
    assert set(together.rig) == {"F0_N", "path_radius_m"}
    plain = estimate([one.information for one in found])
    assert together.rig["F0_N"] == pytest.approx(plain.rig["F0_N"])
    assert not notes_on_setups(found, [0] * 6, None)


@pytest.mark.parametrize(("rig", "setups"), [({}, ()), ({}, ("may",)), (NAMED, ())])
def test_without_the_declaration_every_build_has_zeros_of_its_own(rig, setups):
    found = builds(rig=rig, setups=setups)
    together, shared = _estimated(found), _estimated(builds(rig=NAMED, setups=("may",)))
    assert set(together.rig) == {"path_radius_m"}
    for own, with_others in zip(together.tyres, shared.tyres, strict=True):
        assert own.number("PECP1")[1] > 1.2 * with_others.number("PECP1")[1]
        assert set(own.strain) <= {"path_radius_m"}
    (note,) = notes_on_setups(found, [0] * 6, None)
    assert "tyre 0, tyre 1, tyre 2 and others" in note
    assert "give [rig] the same name" in note


def test_of_several_set_ups_only_the_named_ones_are_shared():
    names = (*NAMES[:2], "F0_N@may", "path_radius_m", "F0_N@june")
    rows = [
        specimen("a", rig=NAMED, setups=("may", "june"), names=names),
        specimen("b", rig=NAMED, setups=("june",)),
    ]
    a, b = (row.information_of_setups.names for row in rows)
    assert a == names
    assert b[2] == "F0_N@june"
    bare = replace(rows[1], setups=())
    assert bare.information_of_setups.names[2] == "F0_N@b"


def test_scatter_within_tyres_is_pooled_and_the_larger_one_counts():
    """Two tyres, two set-ups each, 0.10 and 0.06 apart: s^2 = (0.10^2 / 2 + 0.06^2 / 2) / 2."""
    u = [Quantity(x, 0.03, "-") for x in (0.0, 0.10, -0.2, -0.14)]
    rows = [
        specimen("a", of_setups=tuple(u[:2])),
        specimen("b", epsilon=-0.2),
        specimen("b", epsilon=-0.14),
        specimen("c"),
    ]
    found = within_tyres([rows[0], *rows[1:]])
    assert found.sd == pytest.approx(math.sqrt((0.10**2 / 2 + 0.06**2 / 2) / 2))
    assert (found.degrees_of_freedom, found.tyres) == (2, 2)
    assert found.u == pytest.approx(math.sqrt((2 * 0.03**2 + 2 * 0.04**2) / 4))
    assert found.inflation == pytest.approx(found.sd / found.u)
    note = notes_on_setups(rows, [0] * 4, found)[-1]
    assert "scatters by 0.058" in note
    assert "2 degrees of freedom" in note
    assert within_tyres(rows[-1:]) is None


def test_a_scatter_within_the_stated_uncertainty_changes_nothing():
    assert within_tyres([specimen("a"), specimen("a", epsilon=0.01)]).inflation == 1.0


def test_set_ups_on_two_paths_count_once():
    rows = [
        {"setup": setup, "epsilon_gamma": value, "u_epsilon_gamma": 0.04}
        for setup, value in (("A", 0.0), ("A", 0.02), ("B", 0.1))
    ]
    assert [q.value for q in _of_setups(rows)] == pytest.approx([0.01, 0.1])
    assert _of_setups(rows[:2]) == ()
