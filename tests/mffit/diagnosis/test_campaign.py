"""A campaign with a rig's fault: what to do about it is said; a misread sweep is named."""

from __future__ import annotations

import csv
import json

import pytest
from blind_set import draw_case, write_case
from plain_pages import without_pictures

from mffit import pipeline
from mffit.diagnosis.answer import tempered
from mffit.rounding import to_uncertainty
from mffit.suspicion import Misread


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    """A campaign with a misaligned camber axis, and the folder of its diagnosis."""
    folder = tmp_path_factory.mktemp("corrected")
    case = draw_case("rig", ("camber-misalignment",), "large", 11)
    write_case(case, folder / "rig", folder / "truth.json")
    with without_pictures():
        found = pipeline.diagnose(
            folder / "rig" / "tyre.toml", folder / "rig" / "given.tir", out=folder / "out"
        )
    return case, folder, found


def test_a_rig_effect_has_values_before_and_after_and_a_remedy(campaign):
    case, folder, found = campaign
    effect = json.loads((folder / "out" / "diagnosis.json").read_text())["effects"][0]
    row = effect["parameters"]["gamma_0_deg"]
    assert row["was"] == 0.0
    assert row["value"] == pytest.approx(case.machine.gamma_0_deg, abs=4.0 * row["stderr"])
    # true camber = reading + gamma_0: at its zero the wheel leans by gamma_0 and has to be leaned back
    assert f"lean the wheel by {to_uncertainty(-row['value'], row['stderr'], '+')} deg" in effect["to_do"]
    assert all(limit.ruled_out for limit in found.limits if limit.effect.id == "loadcell-gain")


def test_a_sweep_with_a_wrong_load_is_named_and_left_out(campaign, tmp_path):
    case = campaign[0]
    write_case(case, tmp_path / "rig", tmp_path / "truth.json")
    path = next(path for path in sorted((tmp_path / "rig").glob("sideslip_*_200kPa.csv")))
    with path.open(newline="") as source:
        rows = list(csv.DictReader(source))
    right = rows[0]["Fz_N"]
    for row in rows:
        row["Fz_N"] = str(2.0 * float(right))
    with path.open("w", newline="") as target:
        writer = csv.DictWriter(target, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    found = pipeline.diagnose(tmp_path / "rig" / "tyre.toml", tmp_path / "rig" / "given.tir")
    (wrong,) = [note for note in found.notes if isinstance(note, Misread)]
    assert wrong.file == path.name
    assert wrong.looks == f"run at a load of {float(right):.4g} N"
    assert [one.effect.id for one in found.effects] == ["camber-misalignment"]
    assert path.stem not in {found.points.sweep_names[k] for k in found.points.sweep}


def test_confidence_is_below_the_weight_of_evidence_and_keeps_its_order():
    said = [tempered(w) for w in (0.0, 0.1, 0.5, 0.9, 0.99, 1.0)]
    assert said == sorted(said)
    assert said[0] == 0.0
    assert said[-1] == 1.0
    assert said[2] == pytest.approx(0.5)
    assert 0.5 < said[3] < 0.9
    assert tempered(0.2) == pytest.approx(1.0 - tempered(0.8))
