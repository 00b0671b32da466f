"""rig.toml: what is refused, and in which words."""

from __future__ import annotations

import pytest
from small_plan import SMALL_PLAN

from mffit.errors import InputError
from mffit.virtual_rig import load_plan, simulate
from mffit.virtual_rig.plan import angles
from mffit.virtual_rig.settings import settings_of


@pytest.fixture
def written(tmp_path):
    def write(old: str = "", new: str = ""):
        assert old in SMALL_PLAN
        path = tmp_path / "rig.toml"
        path.write_text(SMALL_PLAN.replace(old, new, 1))
        return path

    return write


def test_a_range_includes_both_ends():
    assert angles({"from": -1, "to": 1, "step": 0.5}) == (-1.0, -0.5, 0.0, 0.5, 1.0)
    assert angles({"from": 2, "to": 0, "step": -1}) == (2.0, 1.0, 0.0)
    assert angles(3) == (3.0,)


def test_a_plan_is_read(written):
    plan = load_plan(written())
    assert plan.declared.rig.path_radius == 1.323
    assert set(settings_of(plan)[0].p) == {250e3}
    assert plan.phi_t_sign == -1


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("load_N = 1400\n", "", "rig.toml:13: sweep[1].load_N: is missing; add it to [[sweep]]"),
        ("alpha_deg =", "alfa_deg =", 'sweep[1].alfa_deg: is unknown; did you mean "alpha_deg"?'),
        ("unloaded_radius =", "unloded_radius =", 'tyre.unloded_radius: is unknown; did you mean "unloaded'),
        ("path_radius = 1.323", "path_radius = 1323", "rig.toml:11: rig.path_radius: 1323 m is outside"),
        ('"sideslip.csv"', '"../sideslip.csv"', "not a plain file name"),
        ("[-2, 0, 2]", "{ from = -2, to = 2, step = 0 }", "correct step"),
        ("[-2, 0, 2]", "{ from = -2, to = 2, step = 0.3 }", "correct step"),
        ("[-2, 0, 2]", "{ from = -2, to = 2 }", "needs the numbers from, to and step"),
        ("[truth]", "[truth", "rig.toml:1: is not valid TOML"),
        ("[-2, 0, 2]", '["a"]', "sweep[1].alpha_deg"),
        ("[-2, 0, 2]", "[]", "sweep[1].alpha_deg: is empty; give at least one"),
        ("[tyre]", "[niose]\nFy_N = 1\n[tyre]", 'rig.toml:4: niose: is unknown; did you mean "noise"?'),
        ("[tyre]", "[noise]\ngain = 1.0\n[tyre]", "rig.toml:5: noise.gain: is unknown here; move it to [faults]"),
        ("[tyre]", "[noise]\nMy_Nm = -1.0\n[tyre]", "rig.toml:5: noise.My_Nm: -1 is below 0; correct it"),
        ("[truth]", "[faults]\ngain = 0.0\n[truth]", "rig.toml:2: faults.gain: 0 is outside 0.5 to 2; correct it"),
    ],
)  # fmt: skip
def test_a_mistake_is_named_with_its_place(written, old, new, sentence):
    with pytest.raises(InputError) as caught:
        load_plan(written(old, new))
    assert sentence in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_flat_track_has_no_disc_to_turn(written):
    path = written("path_radius = 1.323\n", 'type = "flat-track"\n[[rolling_radius]]\nload_N = 1400\n')
    with pytest.raises(InputError, match="no disc to turn"):
        load_plan(path)


def test_a_flat_track_has_no_path_radius(content, folder, tmp_path):
    content |= {"rig": {"type": "flat-track"}, "rolling_radius": [], "faults": {"path_radius_m": 1.3}}
    with pytest.raises(InputError, match="no path radius"):
        simulate(load_plan(content, folder=folder), tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("rig.toml", None, "there is no such file; `mffit init --sample"),
        ("rig.toml", SMALL_PLAN.encode("utf-16"), "is not UTF-8 text"),
        ("tyre.tir", b"$ a comment", "is a property file, not a rig.toml"),
        ("run.csv", b"alpha_deg,gamma_deg\n0,0\n", "is not a rig.toml"),
    ],
)
def test_another_file_is_named_for_what_it_is(tmp_path, name, content, sentence):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError) as caught:
        load_plan(tmp_path / name)
    assert sentence in str(caught.value)
