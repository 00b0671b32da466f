"""Recordings of a disc are never taken for those of a belt in silence; files of one campaign become one entry."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from mffit import config as configuration
from mffit.cli import main
from mffit.pipeline import init_from
from mffit.points import make_points
from mffit.recordings import DiscPath, disc_signs, sniff
from mffit.recordings.disc import rolls_backward, zero_of_upright

SAMPLES = Path(__file__).parents[3] / "samples"
DISC = [
    SAMPLES / "front-120-70" / f"{name}.csv"
    for name in ("sideslip_1400N", "camber_1400N", "zero_1400N_backward")
]
BELT = sorted((SAMPLES / "flat-track").glob("*.csv"))
TYRE = ["--unloaded-radius", "0.2992", "--nominal-load", "1400"]


def run(*arguments: object) -> int:
    try:
        main([str(argument) for argument in arguments])
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 1
    return 0


def test_a_disc_is_asked_for(tmp_path, capsys):
    assert run("init", "--from", *DISC, tmp_path / "p", *TYRE) == 2
    said = capsys.readouterr().err
    for word in (
        "look like those of a disc",
        "zero_1400N_backward.csv",
        "deg of sideslip",
        "--path-radius",
        "--belt",
    ):
        assert word in said
    assert not (tmp_path / "p").exists()


def test_the_zero_alone_speaks_for_a_disc():
    assert [sign[:40] for sign in disc_signs(sniff(DISC[:2]))] == ["the side force of the upright wheel vani"]
    assert disc_signs(sniff(BELT)) == []


def test_the_path_is_taken_from_the_options(tmp_path):
    options = ["--disc", "--path-radius", "1.323", "--path-centre", "left"]
    assert run("init", "--from", *DISC, tmp_path / "p", *TYRE, *options) == 0
    found = configuration.load(tmp_path / "p" / "tyre.toml")
    assert (found.rig.type, found.rig.path_radius, found.rig.path_centre) == ("rotating-disk", 1.323, "left")
    assert [sweep.direction for sweep in found.sweep] == [None, None, "backward"]


def test_a_belt_may_be_insisted_on(tmp_path):
    assert run("init", "--from", *DISC, tmp_path / "p", *TYRE, "--belt") == 0
    assert not configuration.load(tmp_path / "p" / "tyre.toml").rig.on_disc


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["--disc"], "needs --path-radius"),
        (["--path-radius", "1.3"], "--path-centre"),
        (["--disc", "--path-radius", "1.3", "--path-centre", "left", "--belt"], "exclude each other"),
        (["--disc", "--path-radius", "0", "--path-centre", "left"], "is no radius"),
    ],
)
def test_half_a_disc_is_refused(tmp_path, capsys, options, word):
    assert run("init", "--from", *DISC, tmp_path / "p", *TYRE, *options) == 2
    assert word in capsys.readouterr().err


def test_sniff_leaves_the_path_of_a_disc_open(tmp_path, capsys):
    """So that nothing is built before somebody has filled it in."""
    assert run("sniff", *DISC, "--out", tmp_path / "p") == 0
    text = (tmp_path / "p" / "tyre.toml").read_text(encoding="utf-8")
    assert 'type = "rotating-disk"  # it looks like a disc' in text
    assert "# path_radius =   # m: fill this in" in text


def test_a_column_of_directions_speaks_for_a_disc(tmp_path):
    table = pd.read_csv(BELT[0], comment="#")
    both = pd.concat([table.assign(direction="forward"), table.assign(direction="backward")])
    both.to_csv(tmp_path / "a.csv", index=False)
    assert "the wheel rolls both ways" in disc_signs(sniff([tmp_path / "a.csv"]))


@pytest.mark.parametrize(
    ("name", "backward"),
    [("zero_backward.csv", True), ("Nullpunkt-Rückwärts.csv", True), ("zero_rev.csv", True), ("reversed-run", True),
     ("previous.csv", False), ("revision2.csv", False), ("zero.csv", False)],
)  # fmt: skip
def test_names_that_say_backward(name, backward):
    assert rolls_backward(Path(name)) is backward


def test_the_zero_is_where_the_force_vanishes():
    """A straight line of force over load whose zero is at 1.5 deg, and points that must not count."""
    alpha = np.radians([-2.0, -1.0, 0.0, 1.0, 2.0, 0.0, 8.0])
    gamma = np.radians([0.0, 0.0, 0.0, 0.0, 0.0, 30.0, 0.0])
    Fy = -15.0 * (alpha - np.radians(1.5)) * 1000.0
    Fy[5:] = 5000.0
    points = make_points(alpha, gamma, 1000.0, p=2e5, V=10.0, phi_t=0.0, Fy=Fy)
    assert zero_of_upright(points) == pytest.approx(1.5)
    assert np.isnan(zero_of_upright(points.select(np.arange(2))))


def test_files_of_one_campaign_are_one_pattern(tmp_path):
    copies = [Path(shutil.copy(path, tmp_path)) for path in BELT]
    init_from(copies, tmp_path / "p", unloaded_radius=0.2992, nominal_load=1400.0, disc=None)
    text = (tmp_path / "p" / "tyre.toml").read_text(encoding="utf-8")
    assert text.count("[[sweep]]") == 1
    assert f'file = "../sideslip_*.csv"  # {len(BELT)} files' in text
    assert len(configuration.load(tmp_path / "p" / "tyre.toml").sweep) == len(BELT)
    assert text.count("no time: each") == 1


def test_a_pattern_takes_no_other_file(tmp_path):
    copies = [Path(shutil.copy(path, tmp_path)) for path in BELT]
    init_from(copies[1:], tmp_path / "p", unloaded_radius=0.2992, nominal_load=1400.0)
    found = configuration.load(tmp_path / "p" / "tyre.toml")
    assert sorted(Path(sweep.file).name for sweep in found.sweep) == sorted(path.name for path in copies[1:])


def test_files_of_two_directions_are_named_one_by_one(tmp_path):
    files = [
        *DISC[:1],
        *(SAMPLES / "front-120-70" / f"zero_{load}N_backward.csv" for load in (900, 1400, 2100)),
    ]
    copies = [Path(shutil.copy(path, tmp_path)) for path in files]
    given = {"unloaded_radius": 0.2992, "nominal_load": 1400.0, "disc": DiscPath(1.323, "left")}
    init_from(copies, tmp_path / "p", **given)
    found = configuration.load(tmp_path / "p" / "tyre.toml")
    assert [sweep.direction for sweep in found.sweep] == [None, "backward", "backward", "backward"]
