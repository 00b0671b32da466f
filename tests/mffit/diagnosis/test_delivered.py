"""The property file that is delivered is the tyre, however many errors the rig has.

More draws, and the rates: ``tests/studies/corrected_study.py``.
"""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from blind_corrected import PLAIN_CHI2, Plan, draw, misses, scored
from blind_set import write_case
from plain_pages import without_pictures

import mffit
from mffit.diagnosis.rest import Answer
from mffit.effects import CATALOG
from mffit.pipeline.diagnosing import write_diagnosis
from mffit.report import text


@pytest.mark.parametrize(
    "plan",
    [
        # As practice/corrected r0: alone, each of the four looks like another effect.
        Plan("four", 4, ("camber-grip",), ("sideslip-misalignment", "camber-misalignment", "loadcell-offset-fy"), True, "white"),
        Plan("gain", 8, ("load-cornering-stiffness",), ("loadcell-gain", "temperature"), False, "AR 0.5"),
        pytest.param(
            Plan("play", 11, ("load-grip",), ("camber-misalignment", "backlash"), True, "AR 0.9"), marks=pytest.mark.slow
        ),
        pytest.param(
            Plan("torque", 6, ("spin-torque", "pressure"), ("sideslip-misalignment", "steering-compliance"), True, "white"),
            marks=pytest.mark.slow,
        ),
    ],
    ids=lambda plan: plan.name,
)  # fmt: skip
def test_the_delivered_file_is_the_tyre(plan):
    with without_pictures():
        score = scored(plan)
    assert set(score.causes) <= score.known, score.line()
    assert not score.false, score.line()
    assert score.new_file
    assert score.ratio < 0.15, score.line()
    assert score.trusted


@pytest.fixture(scope="module")
def of_the_rig(tmp_path_factory):
    """A right model, and two errors of the rig: the diagnosis, its folder and the given file."""
    folder = tmp_path_factory.mktemp("rig")
    case, _ = draw(Plan("rig", 9, (), ("sideslip-misalignment", "loadcell-offset-mz"), True, "white"))
    write_case(case, folder / "case", folder / "truth.json")
    out = folder / "case" / "out" / "diagnosis"
    with without_pictures():
        found = mffit.diagnose(folder / "case" / "tyre.toml", folder / "case" / "given.tir", out=out)
    return found, out, folder / "case" / "given.tir"


def test_errors_of_the_rig_change_no_file(of_the_rig):
    found, out, given = of_the_rig
    assert found.answer is Answer.FOUND
    assert {one.effect.id for one in found.effects} == {"sideslip-misalignment", "loadcell-offset-mz"}
    assert not list(out.glob("*.tir"))
    written = json.loads((out / "diagnosis.json").read_text())
    assert (out / written["model_after"]).resolve() == given.resolve()
    assert written["apart"] == []
    file, rig = written["advice"]
    assert file.startswith("Keep given.tir")
    assert rig.startswith("The rest is your rig: ")


def test_sentences_say_the_bare_name_of_the_file(of_the_rig):
    """Who reads the terminal is in another folder than the output, from which the path of JSON starts."""
    found, out, _ = of_the_rig
    for said in (text.diagnosis_summary(found), (out / "diagnosis.html").read_text(encoding="utf-8")):
        assert "given.tir" in said
        assert "../given.tir" not in said


def test_a_corrected_file_of_an_earlier_run_does_not_stay(of_the_rig):
    """It would pass as this run's answer, whatever the run looks for: here a single effect."""
    found, out, given = of_the_rig
    with without_pictures():
        write_diagnosis(replace(found, delivers=True), out)
        assert list(out.glob("*.tir"))
        mffit.diagnose(given.parent / "tyre.toml", given, out=out, effects=CATALOG[:1])
    assert not list(out.glob("*.tir"))


def test_the_study_measures_the_distance_from_the_tyre():
    case, (size,) = draw(Plan("size", 4, ("camber-grip",), (), True, "white"))
    assert size > PLAIN_CHI2
    assert misses(case.true, case.true) == (0.0, 0.0)
    assert min(misses(case.given, case.true)) > 1.0
