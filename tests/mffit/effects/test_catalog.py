"""The library is complete, consistent with the property file's table, and its pages are current."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from mffit import reference
from mffit.effects import CATALOG, NEEDS
from mffit.rig_errors import BY_NAME as RIG_ERRORS
from tir.parameters import BY_NAME

PROMISED = Path(__file__).with_name("promised_effects.csv")
"""Ids of effects that files and scripts of users rely on, and the numbers that each at least frees."""


def ids(effects=CATALOG):
    return [effect.id for effect in effects]


def test_every_id_is_there_once():
    assert len(set(ids())) == len(ids())


def test_promised_effects_are_there_and_free_what_is_promised():
    with PROMISED.open(encoding="utf-8", newline="") as file:
        promised = {row["id"]: set(row["frees"].split()) for row in csv.DictReader(file)}
    found = {effect.id: set(effect.parameters) for effect in CATALOG}
    broken = sorted(name for name, frees in promised.items() if not frees <= found.get(name, set()))
    assert not broken, f"scripts of users rely on {', '.join(broken)}"


@pytest.mark.parametrize("effect", CATALOG, ids=ids())
def test_a_record_says_what_a_reader_needs(effect):
    assert effect.name
    assert effect.physics.endswith(".")
    assert effect.kind in {"tyre", "rig", "environment"}
    assert set(effect.needs) <= set(NEEDS)


@pytest.mark.parametrize("effect", CATALOG, ids=ids())
def test_freed_numbers_exist_and_can_be_started_from(effect):
    for free in effect.free:
        assert free.name in (*BY_NAME, *RIG_ERRORS, "turn_slip")
        assert effect.kind == "tyre" or free.name in RIG_ERRORS
        assert free.spread > 0.0
        assert free.lower < free.upper
        if free.name in BY_NAME:
            assert free.lower <= BY_NAME[free.name].default <= free.upper or free.relative
            assert (free.lower, free.upper) == BY_NAME[free.name].bounds or free.name == "PECP1"


def test_numbers_of_the_rig_are_all_described():
    rows = [line.replace(r"\|", "|") for line in reference.page("rig-errors.md").splitlines()]
    for error in RIG_ERRORS.values():
        assert any(
            row.startswith(f"| `{error.name}`") and f"| {error.unit} | {error.meaning} |" in row
            for row in rows
        )
