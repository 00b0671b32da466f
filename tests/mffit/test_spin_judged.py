"""`mffit spin` judges itself by the rules that need no fit, and the virtual rig's misaligned axes do not deceive it."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from disc_project import disc_project
from small_rigs import LOADS, built, disc, simulated

import mffit
from mffit.cli import main
from mffit.suspicion import RULES, When

ZEROS = [-0.5, 0, 0.5]


def spun(path: Path, out: Path, capsys) -> tuple[int, dict, str, str]:
    """Exit code, spin.json, standard output and error of the command."""
    code = 0
    try:
        main(["spin", str(path), "--out", str(out)])
    except SystemExit as end:
        code = int(end.code or 0)
    said = capsys.readouterr()
    return code, json.loads((out / "spin.json").read_text(encoding="utf-8")), said.out, said.err


def edited(folder: Path, edit) -> Path:
    """The written tyre.toml after a change of its content."""
    path = folder / "tyre.toml"
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    edit(content)
    path.write_text(tomli_w.dumps(content), encoding="utf-8")
    return path


def test_a_path_radius_that_gives_an_unpublished_factor_is_asked_for(tmp_path, capsys):
    """1 - eps = r_e C_gamma / (F R): with r_e given, 2.9 m for 1.323 m divides it by 2.2."""
    path = disc_project(tmp_path / "rig").write()
    code, sound, said, _ = spun(path, tmp_path / "sound", capsys)
    assert (code, sound["trusted"], sound["reasons"]) == (0, True, [])
    assert "NOT TO BE TRUSTED" not in said
    edited(path.parent, lambda content: content["rig"].update(path_radius=2.9))
    code, wrong, said, errors = spun(path, tmp_path / "wrong", capsys)
    assert 1.0 - wrong["epsilon_gamma"] == pytest.approx(
        (1.0 - sound["epsilon_gamma"]) * 1.323 / 2.9, rel=1e-6
    )
    assert (code, wrong["trusted"]) == (0, True)
    assert any("outside everything published" in warning for warning in wrong["warnings"])
    assert "outside everything published" in errors


def test_the_headline_names_its_load(tmp_path, capsys):
    path = disc_project(tmp_path / "rig").write()
    _, content, said, _ = spun(path, tmp_path / "out", capsys)
    first = said.splitlines()[0]
    assert first.startswith("eps_gamma")
    assert first.endswith(f"at {content['load_N']:.0f} N")


def test_spin_and_build_have_one_list_of_rules(tmp_path, capsys):
    """What spin holds against a measurement, a build of the same project does too, in the same words."""
    content = disc(loads=(1400,), rig={"path_radius": 1.323, "u_path_radius": 0.0018})
    simulated(content, tmp_path / "rig")
    path = edited(tmp_path / "rig", lambda config: config["rig"].update(path_radius=2.9))
    path = edited(
        path.parent,
        lambda config: config.update(
            rolling_radius=[{"effective_radius": 0.2923, "u_effective_radius": 5e-4}]
        ),
    )
    measured, result = mffit.spin(path), mffit.build(path, with_report=False)
    asked = [said.partition(" is outside")[2] for said in measured.warnings if " is outside" in said]
    assert asked
    assert set(asked) <= {said.partition(" is outside")[2] for said in result.warnings}
    assert {rule.id for rule in RULES if rule.when is When.MEASURED} == {
        "contradictory-sideslip-zeros",
        "drift-between-sweeps",
        "sweeps-of-one-way",
        "unpublished-camber-reduction",
    }


def without_backward(content: dict, load: int) -> dict:
    """The plan without the backward zeros of a load."""
    content["sweep"] = [s for s in content["sweep"] if s["file"] != f"backward_{load}.csv"]
    return content


@pytest.mark.parametrize("lacking", LOADS)
def test_a_drawn_axis_is_off_at_loads_without_backward_zeros_too(tmp_path, lacking):
    """Six rigs of the virtual rig, 0.35 deg off, with zeros both ways at two of three loads: the true force within 2 u."""
    pulls = []
    for seed in range(2):
        off = 0.35 * (-1) ** seed
        folder = tmp_path / str(seed)
        plan = without_backward(disc(faults={"alpha_0_deg": off}), lacking)
        truth = simulated(plan, folder, seed=seed)
        row = min(mffit.spin(folder / "tyre.toml").per_load, key=lambda r: abs(r.load - lacking))
        true = next(t for t in truth.per_load if t.load_N == lacking)
        pulls.append((row.F_phit.value - true.F_phit_N) / row.F_phit.u)
        assert abs(math.degrees(row.alpha_M.value) - off) < 0.08  # the sample's ply-steer is the rest
        assert row.F_phit.u < 35.0
    assert np.abs(pulls).max() < 2.0


def test_two_set_ups_that_are_declared_as_one_are_named(tmp_path, capsys):
    """Each side aligned by itself, 0.2 deg apart; written as one set-up, a common zero would cancel that does not exist."""
    plan = disc(loads=(1400,))
    plan["sweep"] += [
        {
            "file": f"right_{way}.csv",
            "load_N": 1400,
            "alpha_deg": ZEROS,
            "direction": way,
            "path_centre": "right",
        }
        for way in ("forward", "backward")
    ]
    plan["setup"] = {"right": {"alpha_0_deg": 0.2}}
    for sweep in plan["sweep"]:
        sweep["setup"] = "right" if "path_centre" in sweep else "left"
    simulated(plan, tmp_path / "rig")
    apart, content, _, _ = spun(tmp_path / "rig" / "tyre.toml", tmp_path / "apart", capsys)
    assert (apart, content["trusted"]) == (0, True)

    def as_one(config):
        for sweep in config["sweep"]:
            sweep["setup"] = "A"

    code, content, _, _ = spun(edited(tmp_path / "rig", as_one), tmp_path / "one", capsys)
    assert (code, content["trusted"]) == (3, False)
    (reason,) = content["reasons"]
    assert "the sideslip zeros of set-up A contradict each other" in reason
    assert "to the left" in reason
    assert "to the right" in reason
    assert "setups of different names" in reason


def test_a_build_names_the_loads_whose_zeros_contradict_each_other(tmp_path):
    """The axis moved by 0.35 deg before the sweeps of one load."""
    plan = disc()
    for sweep in plan["sweep"]:
        if sweep["load_N"] == 2100:
            sweep["faults"] = {"alpha_0_deg": 0.35}
    result = built(plan, tmp_path / "rig")
    reasons = [r for r in result.reasons if "sideslip zeros" in r]
    assert len(reasons) == 1
    assert "at 2100 N" in reasons[0]
