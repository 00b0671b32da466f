"""One file from two campaigns of one tyre: turn slip and Fy from a disc, Fx and combined slip from a belt."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import mffit
import tir
from mffit import virtual_rig
from mffit.errors import InputError
from mffit.report.build import planned
from mffit.report.build_view import view_of

SAMPLE = Path(__file__).parents[3] / "samples" / "front-120-70"
GRIP = 1.1
"""Friction of the disc's surface over that of the belt."""
BELT = """
seed = 5
[truth]
tyre = "belt.tir"
[noise]
Fx_N = 8.0
Fy_N = 6.0
Mz_Nm = 0.6
[tyre]
name = "belt"
size = "120/70ZR17"
unloaded_radius = 0.2992
width = 0.120
rim_radius = 0.2159
nominal_load = 1400
nominal_pressure = 250
[rig]
type = "flat-track"
axes = "iso"
"""
RUNS = """
[[sweep]]
file = "sideslip_{load}N.csv"
load_N = {load}
alpha_deg = {{ from = -10, to = 10, step = 2 }}
[[sweep]]
file = "drive_{load}N.csv"
load_N = {load}
kappa = {{ from = -0.2, to = 0.2, step = 0.02 }}
alpha_deg = [-4, 0, 4]
"""


def write_projects(folder: Path) -> Path:
    """A disc's project, which names that of a belt."""
    true = tir.read(SAMPLE / "true.tir")
    friction = {name: true[name] / GRIP for name in ("PDX1", "PDX2", "PDY1", "PDY2")}
    true.replace(**friction).write(folder / "belt.tir")
    (folder / "rig.toml").write_text(BELT + "".join(RUNS.format(load=load) for load in (900, 1400, 2100)))
    virtual_rig.simulate(virtual_rig.load_plan(folder / "rig.toml"), folder / "belt")
    for path in (*SAMPLE.glob("*.csv*"), SAMPLE / "base.tir"):
        shutil.copy(path, folder)
    text = (SAMPLE / "tyre.toml").read_text()
    (folder / "tyre.toml").write_text(f'{text}\n[[campaign]]\ntoml = "belt/tyre.toml"\n')
    return folder / "tyre.toml"


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Path:
    return write_projects(tmp_path_factory.mktemp("campaigns"))


@pytest.fixture(scope="module")
def built(project):
    out = project.parent / "out"
    return mffit.build(project, out, ensemble=3, with_report=False), out


def test_the_ratio_of_grips_is_found_with_its_uncertainty(built):
    found = json.loads((built[1] / "result.json").read_text())["fit"]["campaigns"][0]
    assert found["ratio_of_grips"] == pytest.approx(GRIP, abs=2.6 * found["u_ratio_of_grips"])
    assert found["u_ratio_of_grips"] < 0.05
    assert found["loads_N"] == pytest.approx([900.0, 1400.0, 2100.0])


def test_the_fit_of_the_other_campaign_is_stated_with_what_it_leaves_open(built):
    """Its misfit, which the table of this campaign lacks, and that slip was run at 4 deg of sideslip only."""
    (said,) = (text for text in built[0].fit.explanations if text.startswith("From the campaign"))
    assert "Its own fit leaves Fx rmse" in said
    assert "There longitudinal slip with sideslip was run at 4.0 deg only" in said


def test_the_joined_file_has_the_forces_of_the_tyre_on_the_surface_of_the_disc(built):
    true, found = tir.read(SAMPLE / "true.tir"), built[0].tyre
    Fz, kappa = np.meshgrid([900.0, 1400.0, 2100.0], [-0.15, -0.05, 0.03, 0.1])
    u = built[0].fit.joined[0].grip.u
    for alpha in (0.0, 0.06):
        here, there = (t(Fz, alpha, 0.0, kappa, turn_slip=False).Fx for t in (found, true))
        assert np.sqrt(np.mean((here - there) ** 2)) < (0.02 + 2.0 * u) * np.sqrt(np.mean(there**2))


def test_longitudinal_coefficients_say_where_they_come_from(built):
    rows = json.loads((built[1] / "result.json").read_text())["fit"]["coefficients"]
    assert {rows[name]["status"] for name in ("PCX1", "PDX1", "PKX1", "RBX1", "RBY1")} == {"campaign"}
    assert {rows[name]["status"] for name in ("PCY1", "PDY1", "PKY6", "PDYP1")} <= {"fitted", "regularised"}
    assert tir.read(built[1] / "front-120-70.tir").status["PDX1"].startswith("from another campaign +- ")
    assert built[0].tyre["KPUMAX"] == pytest.approx(0.2)
    members = np.array([member["PDX1"] for member in built[0].members])
    assert 0.0 < np.std(members) < 5.0 * rows["PDX1"]["stderr"]
    assert any("From the campaign belt/tyre.toml: longitudinal" in text for text in built[0].fit.explanations)


def test_campaigns_of_different_tyres_are_refused(project, tmp_path):
    shutil.copytree(project.parent, tmp_path / "other", ignore=shutil.ignore_patterns("out"))
    other = tmp_path / "other" / "belt" / "tyre.toml"
    text = other.read_text()
    other.write_text(text.replace("unloaded_radius = 0.2992", "unloaded_radius = 0.32"))
    with pytest.raises(InputError, match=r"tyre\.toml:\d+: campaign\.toml: .*unloaded_radius = 0\.32"):
        mffit.build(tmp_path / "other" / "tyre.toml")
    other.write_text(f'{text}\n[[campaign]]\ntoml = "../tyre.toml"\n')
    with pytest.raises(InputError, match="names campaigns itself"):
        mffit.build(tmp_path / "other" / "tyre.toml")
    other.unlink()
    with pytest.raises(InputError, match=r"campaign\.toml: there is no file"):
        mffit.build(tmp_path / "other" / "tyre.toml")


def test_the_report_shows_every_campaign_and_what_it_gave(built):
    """Pictures of the belt's own channels, its coefficients by name, and the points of both in one picture."""
    view = view_of(built[0])
    (belt,) = view.campaigns
    assert belt.name == "belt/tyre.toml"
    assert {"Fx", "Fy", "Mz"} <= set(belt.build.agreement)
    assert {"PCX1", "PDX1", "RBY1"} <= {row.name for row in belt.rows}
    assert {row.stage for row in view.rows if row.status == "campaign"} == {"belt/tyre.toml"}
    drawn = {one.name: one.make for one in planned(view)}
    assert {"campaign1_slip_Fx", "campaign1_friction_ellipse", "campaign1_weights", "campaigns"} <= set(drawn)
    slip = drawn["campaigns"]().rows[0][-1]
    run = {trace.name: trace.x for trace in slip.series}
    assert np.ptp(run["this project"]) == 0.0
    assert np.ptp(run["belt/tyre.toml"]) == pytest.approx(0.4)


def test_the_file_says_what_the_rigs_of_other_campaigns_read(built):
    found = built[0].tyre.measured["rig.Fx0_N@belt/tyre.toml"]
    assert abs(found.value) < 3.0 * found.u
