"""The notes of a fleet: when each is written, and with which numbers."""

from __future__ import annotations

import re
from types import SimpleNamespace

import pytest

from mffit.pipeline.fleet_notes import fleet_notes
from mffit.pipeline.fleets import priors_of_fleet
from mffit.quantities import CHANNELS
from mffit.rig_errors import RIG_ERRORS, words_of


def rig(F0_N=0.0):
    """A joint estimate whose load-cell offset is declared as 0 +- 10 N."""
    return SimpleNamespace(
        rig={"F0_N": (F0_N, 1.0), "gamma_0_deg": (0.0, 0.1)}, declared={"F0_N": (0.0, 10.0), "gamma_0_deg": (0.0, 0.5)}
    )  # fmt: skip


def row(name="a", load=1400.0, readings=(), **strain):
    specimen = SimpleNamespace(
        name=name, conditions=(load, 250e3), size="120/70ZR17", readings=frozenset(readings)
    )
    return SimpleNamespace(specimen=specimen, strain=strain)


def test_a_fleet_that_agrees_has_no_notes():
    assert fleet_notes([row(F0_N=2.0, gamma_0_deg=-2.0), row("b")], [rig(F0_N=20.0)]) == []


def test_builds_that_share_recordings_are_named():
    rows = [row(readings=["1", "2", "3"]), row("b", readings=["4"]), row("c", readings=["3", "2"])]
    (note,) = fleet_notes(rows, [rig()])
    assert note.startswith(
        "a and c have 2 recordings in common: the joint estimate counts their readings twice"
    )


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_rig_far_from_its_declaration_is_reported_in_declared_deviations(sign):
    (note,) = fleet_notes([row(), row("b")], [rig(F0_N=sign * 60.0)])
    assert f"{words_of('F0_N')}, 6 standard deviations" in note
    assert "direct method" in note


@pytest.mark.parametrize("error", RIG_ERRORS, ids=lambda error: error.name)
def test_every_error_of_the_rig_has_words_of_the_field(error):
    assert error.words
    assert not ({"alpha", "gamma", "kappa", *error.acts_on} - {*CHANNELS, "Fz"}) & {
        *re.findall(r"\w+", error.words)
    }


def test_a_tyre_on_a_changed_rig_is_named_with_its_worst_error():
    (note,) = fleet_notes([row(F0_N=-5.0, gamma_0_deg=9.0), row("b", F0_N=1.0)], [rig()])
    assert note.startswith(f"a: its own error of the rig, {words_of('gamma_0_deg')}, lies 9 standard")


def test_a_rig_far_from_its_declaration_does_not_blame_single_tyres():
    (note,) = fleet_notes([row(F0_N=-9.0), row("b", F0_N=9.0)], [rig(F0_N=60.0)])
    assert note.startswith("All tyres together")


def test_several_rigs_are_reported_and_have_no_priors():
    (note,) = fleet_notes([row(), row("b")], [rig(), None])
    assert "2 different rigs" in note
    assert "priors.json is not written" in note
    assert priors_of_fleet(SimpleNamespace(rigs=(rig(), rig()), rows=(row(),), kinds=[0])) is None


def test_unlike_tyres_are_named_first_with_their_conditions_and_have_no_priors():
    rows = [row(), row("b", load=1500.0), row("c")]
    (note,) = fleet_notes(rows, [rig()])
    assert "2 kinds: a and c (120/70ZR17, 1400 N, 250 kPa); b (120/70ZR17, 1500 N, 250 kPa)" in note
    assert note.endswith("is not written.")
    first, *_ = fleet_notes(rows, [rig(), rig()])
    assert "2 kinds" in first
    assert "priors.json" not in first
    assert priors_of_fleet(SimpleNamespace(rigs=(rig(),), rows=tuple(rows), kinds=[0, 1, 0])) is None
