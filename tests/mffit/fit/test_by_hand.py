"""``[coefficients]`` in the fit: what is held, bounded or known beforehand, and the uncertainty of everything else."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
import small_rigs
from plain_pages import without_pictures

import mffit
import tir
from mffit import config, pipeline
from mffit.cli import main
from mffit.errors import InputError
from mffit.fit.priors import scatter
from mffit.report.text import plan_summary

TRUTH = small_rigs.truth()


@pytest.fixture(scope="module")
def belt(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("belt")
    small_rigs.simulated(small_rigs.flat(), folder)
    return folder


def fitted(folder: Path, *coefficients: str):
    return mffit.build(config.load(folder / "tyre.toml", coefficients=coefficients))


@pytest.fixture(scope="module")
def free():
    return small_rigs.sound(small_rigs.flat)


@pytest.fixture(scope="module")
def held(belt):
    return fitted(belt, f"PCY1={TRUTH['PCY1']!r}")


def test_a_held_coefficient_has_its_value_and_no_uncertainty(held):
    found = held.fit.coefficients["PCY1"]
    assert found.value == held.tyre["PCY1"] == TRUTH["PCY1"]
    assert (found.held, found.fixed, found.stderr, found.interval) == (True, True, None, None)
    assert "PCY1" not in held.fit.posterior.names
    assert not [w for w in held.warnings if "PCY1" in w]


def test_the_others_have_the_uncertainty_under_the_condition_of_the_held_one(free, held):
    """The Schur complement of the free fit's covariance, and its conditional mean."""
    names, C = list(free.fit.posterior.names), free.fit.posterior.covariance
    k = names.index("PCY1")
    slope = C[:, k] / C[k, k]
    conditional = np.sqrt(np.diag(C) - slope * C[:, k])
    off = TRUTH["PCY1"] - free.fit.coefficients["PCY1"].value
    for name in ("PDY1", "PEY1", "PKY1"):
        i, found = names.index(name), held.fit.coefficients[name]
        assert found.stderr == pytest.approx(conditional[i], rel=0.1)
        assert found.value == pytest.approx(
            free.fit.coefficients[name].value + slope[i] * off, abs=0.3 * found.stderr
        )
        assert abs(found.value - TRUTH[name]) < 3.0 * found.stderr
    i = names.index("PEY1")
    assert conditional[i] < 0.8 * np.sqrt(C[i, i])


def test_a_wrong_value_is_held_too_and_contradicted(belt):
    wrong = fitted(belt, "PCY1=1.85")
    assert wrong.fit.tyre["PCY1"] == 1.85
    assert any("contradict what [coefficients] sets for PCY1" in w for w in wrong.warnings)


def test_a_prior_is_averaged_with_the_points_by_information(belt, free):
    """PVY1 acts linearly: the posterior has the sum of the precisions and the mean that they weight."""
    name, expected, u = "PVY1", 0.0035, 0.001
    known = fitted(belt, f"{name}={{value={expected}, u={u}}}").fit.coefficients[name]
    before, base = free.fit.coefficients[name], float(tir.read(belt / "base.tir")[name])
    usual = scatter(name, base, from_base=True, curved=False) ** -2.0
    precision = before.stderr**-2.0 - usual + u**-2.0
    mean = (before.stderr**-2.0 * before.value - usual * base + u**-2.0 * expected) / precision
    assert known.stderr == pytest.approx(precision**-0.5, rel=0.03)
    assert known.value == pytest.approx(mean, abs=0.1 * known.stderr)
    assert abs(known.value - expected) < 0.3 * abs(before.value - expected)  # the prior does pull
    assert (known.by_hand, known.prior) == ("prior by hand", (expected, u))


@pytest.fixture(scope="module")
def disc(tmp_path_factory) -> Path:
    """The folder of a build on a disc with coefficients of all kinds set on the command line."""
    folder = tmp_path_factory.mktemp("disc")
    small_rigs.simulated(small_rigs.disc(), folder)
    words = (
        "PKY3=base",
        "PDX1=1.5",
        "RBX3=155",
        "QSY1=0.02",
        "Q_RE0=0.99",
        "PEY1={max=-0.95}",
        "PPY1={value=-0.3, u=0.1}",
    )
    with without_pictures():
        main(["build", str(folder / "tyre.toml"), *(part for word in words for part in ("--set", word))])
    return folder


@pytest.fixture(scope="module")
def result(disc) -> dict:
    return json.loads((disc / "out" / "result.json").read_text(encoding="utf-8"))


def test_every_file_has_what_is_held(disc, result):
    base = tir.read(disc / "base.tir")
    for name in result["files"].values():
        file = tir.read(disc / "out" / name)
        assert (file["PDX1"], file["QSY1"], file["Q_RE0"], file["PKY3"]) == (1.5, 0.02, 0.99, base["PKY3"])
        assert file.status["PDX1"] == file.status["QSY1"] == "held by hand"
        assert file.status["PKY3"] == "from base, held by hand"
        assert "PDX1 held at 1.5" in file.provenance["set by hand"]


def test_a_bound_is_kept_to_the_last_digit(result):
    found = result["fit"]["coefficients"]["PEY1"]
    assert found["value"] == -0.95
    assert found["at_bound"]
    assert found["bounds"] == [-10.0, -0.95]
    assert found["interval_95"][1] == -0.95
    assert found["origin"].endswith("bounds by hand, at bound")
    assert any("PEY1 is at a limit: [coefficients] allows -10 to -0.95" in w for w in result["warnings"])


def test_a_rare_value_is_held_with_a_warning(disc, result):
    """MFeval's own tyre has RBX3 186."""
    assert tir.read(disc / "out" / result["tir"])["RBX3"] == 155.0
    assert "RBX3 is held in [coefficients] outside the range of usual tyres" in result["warnings"]
    assert not any("PDX1 is held" in text for text in result["warnings"])


def test_the_json_marks_what_was_set_by_hand(result):
    found = result["fit"]["coefficients"]
    marked = {name for name, row in found.items() if row["by"] == "hand"}
    assert marked == {"PKY3", "PDX1", "RBX3", "QSY1", "Q_RE0", "PEY1", "PPY1"}
    assert {name for name, row in found.items() if row["held"]} == {"PKY3", "PDX1", "RBX3", "QSY1", "Q_RE0"}
    assert all(found[name]["stderr"] is None for name, row in found.items() if row["held"])
    assert (found["PKY3"]["status"], found["PDX1"]["status"]) == ("base", "given")
    assert found["PPY1"]["prior"] == {"value": -0.3, "u": 0.1}


def test_a_prior_counts_where_the_points_show_nothing(result):
    """One pressure was run: PPY1 keeps the value that is known, and its uncertainty is part of the posterior."""
    assert result["fit"]["coefficients"]["PPY1"]["value"] == -0.3
    names, covariance = (
        result["fit"]["posterior"]["names"],
        np.array(result["fit"]["posterior"]["covariance"]),
    )
    assert covariance[names.index("PPY1"), names.index("PPY1")] == pytest.approx(0.1**2)
    assert any(
        "PPY1 is set in [coefficients], but the points do not free it" in w for w in result["warnings"]
    )


def test_the_page_names_what_was_set_by_hand(disc):
    page = (disc / "out" / "report.html").read_text(encoding="utf-8")
    assert "Set by hand in [coefficients]" in page
    assert page.count(">held by hand<") == 4
    assert page.count(">bounds by hand<") == 1


def test_no_run_makes_a_held_coefficient_more_certain(disc):
    with pytest.raises(InputError, match="holds PKY3, so that no run makes it more certain"):
        pipeline.plan(disc / "out" / "resolved.toml", "PKY3")


def test_a_plan_predicts_the_uncertainty_of_the_build(disc, result):
    found = pipeline.plan(disc / "out" / "resolved.toml", "PDY1", runs=1)
    # The build's error also contains how far its value is from the most probable one with errors that runs share.
    assert found.now == pytest.approx(result["fit"]["coefficients"]["PDY1"]["stderr"], rel=0.05)
    free = {name for row in found.identified.cover for name in row.free}
    assert "PKY3" not in free
    assert "; held by hand: PKY3." in plan_summary(found).replace("\n", " ")


def test_a_base_file_without_the_coefficient_is_refused(belt, tmp_path):
    text = (belt / "tyre.toml").read_text(encoding="utf-8")
    for file in belt.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    base = (belt / "base.tir").read_text(encoding="utf-8").splitlines(keepends=True)
    (tmp_path / "base.tir").write_text("".join(line for line in base if not line.startswith("PDX1")))
    (tmp_path / "tyre.toml").write_text(f'{text}\n[coefficients]\nPDX1 = "base"\n', encoding="utf-8")
    with pytest.raises(InputError, match="does not state PDX1; write its value") as caught:
        mffit.build(tmp_path / "tyre.toml")
    assert caught.value.line == len(text.splitlines()) + 3


def test_no_estimate_replaces_a_held_value(belt):
    """Without a base file, sections that a cornering test does not measure are estimated from what is known."""
    content = tomllib.loads((belt / "tyre.toml").read_text(encoding="utf-8"))
    del content["tyre"]["base"]
    content["coefficients"] = {"PDX1": 1.5, "RBX1": 9.0}
    found = mffit.build(config.load(content, folder=belt))
    assert (found.tyre["PDX1"], found.tyre["RBX1"]) == (1.5, 9.0)
    assert found.tyre.status["PDX1"] == "held by hand"
    assert found.tyre.status["PDX2"].startswith("estimate")
