"""Recordings of a disc are never taken for those of a belt in silence; files of one campaign become one entry."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from flat_belt import recording

from mffit import config as configuration
from mffit.cli import main
from mffit.pipeline import init_from
from mffit.points import make_points
from mffit.points.loading import read
from mffit.recordings import DiscPath, disc_signs, sniff
from mffit.recordings.disc import zero_of_upright
from mffit.recordings.project_file import _of_size
from mffit.recordings.recording import rolls_backward
from mffit.report.text import sniff_summary

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
        (
            ["--disc", "--path-radius", "0", "--path-centre", "left"],
            "--path-radius: 0 m is outside 0.2 to 100 m",
        ),
        (["--disc", "--path-radius", "1323", "--path-centre", "left"], "millimetres, write metres"),
        (
            ["--disc", "--path-radius", "nan", "--path-centre", "left"],
            "--path-radius: nan is not a finite number",
        ),
        (["--disc", "--path-radius", "1.323", "--path-centre", "right"], '--path-centre: with axes = "iso"'),
    ],
)
def test_half_a_disc_is_refused(tmp_path, capsys, options, word):
    assert run("init", "--from", *DISC, tmp_path / "p", *TYRE, *options) == 2
    assert word in capsys.readouterr().err


def test_a_wrong_centre_is_refused_with_the_sentence_of_a_build(tmp_path, capsys):
    options = ["--disc", "--path-radius", "1.323", "--path-centre"]
    assert run("init", "--from", *DISC, tmp_path / "p", *TYRE, *options, "left") == 0
    toml = tmp_path / "p" / "tyre.toml"
    toml.write_text(toml.read_text().replace('path_centre = "left"', 'path_centre = "right"'))
    assert run("build", toml, "--out", tmp_path / "out") == 2
    of_build = capsys.readouterr().err
    assert run("init", "--from", *DISC, tmp_path / "q", *TYRE, *options, "right") == 2
    of_init = capsys.readouterr().err
    assert of_init.partition("--path-centre: ")[2] == of_build.partition("rig.path_centre: ")[2]
    assert 'the data agree with path_centre = "left"' in of_init
    assert not (tmp_path / "q").exists()


def test_the_path_decides_between_axes_that_camber_leaves_open(tmp_path):
    """Without camber, a disc at the left in ISO signs gives the readings of a disc at the right in SAE signs."""
    upright = [file for file in DISC if "camber" not in file.name]
    options = ["--disc", "--path-radius", "1.323", "--path-centre"]
    for centre, axes in (("left", "iso"), ("right", "sae")):
        assert run("init", "--from", *upright, tmp_path / centre, *TYRE, *options, centre) == 0
        assert configuration.load(tmp_path / centre / "tyre.toml").rig.axes == axes


def test_what_a_build_refuses_otherwise_is_a_warning_of_init(tmp_path, capsys):
    """The project is written, because its user can change it: on a disc, moving sweeps give no points."""
    moving = recording(loads=(1500.0,), cambers=(0.0,), pressures=(83.0,), sweep_s=4.0, rest_s=0.2)
    moving.to_csv(tmp_path / "a.csv", index=False)
    options = ["--disc", "--path-radius", "1.323", "--path-centre", "left"]
    assert run("init", "--from", tmp_path / "a.csv", tmp_path / "p", *TYRE, *options) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "mffit build refuses these recordings: no sweep rests long enough" in said
    assert run("build", tmp_path / "p" / "tyre.toml", "--out", tmp_path / "out") == 2
    refused = capsys.readouterr().err
    assert "no sweep rests long enough" in refused
    assert "pairs of like rests; hold every set-point" in refused
    assert "leave out column time_s" not in refused  # samples in motion are no finished points


def test_sniff_leaves_the_path_of_a_disc_open(capsys):
    """So that nothing is built before somebody has filled it in."""
    assert run("sniff", *DISC) == 0
    text = capsys.readouterr().out
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
     ("rück_1500.csv", True), ("1500-rueck.csv", True), ("Ruecklauf 3.csv", True), ("zuru\u0308ck2.csv", True),
     ("Rückstellmoment.csv", False), ("truck.csv", False), ("previous.csv", False), ("revision2.csv", False),
     ("zero.csv", False)],
)  # fmt: skip
def test_names_that_say_backward(name, backward):
    assert rolls_backward(Path(name)) is backward


def test_the_zero_is_where_the_force_vanishes():
    """A straight line of force over load whose zero is at 1.5 deg at any load, and points that must not count."""
    alpha = np.radians([-2.0, -1.0, 0.0, 1.0, 2.0, 0.0, 8.0])
    gamma = np.radians([0.0, 0.0, 0.0, 0.0, 0.0, 30.0, 0.0])
    Fz = np.array([500.0, 1000.0, 2000.0, 800.0, 1500.0, 1000.0, 1000.0])
    Fy = -15.0 * (alpha - np.radians(1.5)) * Fz
    Fy[5:] = 5000.0
    points = make_points(alpha, gamma, Fz, p=2e5, V=10.0, phi_t=0.0, Fy=Fy)
    assert zero_of_upright(points) == pytest.approx(1.5)
    assert np.isnan(zero_of_upright(points.select(np.arange(2))))


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


GERMAN = {
    "alpha_deg": ("Schraeglaufwinkel", "Grad", 1.0), "gamma_deg": ("Sturzwinkel", "Grad", 1.0), "Fz_N": ("Radlast", "kN", 1e-3),
    "Fy_N": ("Seitenkraft", "N", 1.0), "Mz_Nm": ("Rückstellmoment", "Nm", 1.0), "p_kPa": ("Reifeninnendruck", "bar", 0.01),
    "T_degC": ("Laufflächentemperatur", "°C", 1.0), "V_mps": ("Bahngeschwindigkeit", "km/h", 3.6), "t_s": ("Zeit", "s", 1.0),
    "time_s": ("Zeit", "s", 1.0),
}  # fmt: skip
"""Heading, unit and the factor to it of a laboratory's tables."""


def in_german(path: Path, folder: Path) -> Path:
    """A sample's file as a German laboratory would save it: title, semicolons, decimal commas, other headings and units."""
    table = pd.read_csv(path, comment="#")
    taken = [name for name in table if name in GERMAN]
    lines = [
        "Reifen: 120/70 ZR17;Prüfer: Mü",
        *(";".join(f"{GERMAN[name][k]}" for name in taken) for k in (0, 1)),
        *(
            ";".join(f"{GERMAN[name][2] * row[name]:.8g}".replace(".", ",") for name in taken)
            for row in table.to_dict("records")
        ),
    ]
    copy = folder / path.name.replace(".csv.gz", ".csv")
    copy.write_text("\n".join(lines), encoding="latin-1")
    return copy


@pytest.fixture(scope="module")
def german_disc(tmp_path_factory):
    """Sniffed campaign and its configuration; one of its files is a recording, all others are tables of points."""
    names = (
        "camber_1400N",
        "coupled_1400N_10deg",
        "zero_900N_forward",
        "zero_1400N_forward",
        "zero_1400N_backward",
    )
    folder = tmp_path_factory.mktemp("lab")
    files = [in_german(SAMPLES / "front-120-70" / f"{name}.csv", folder) for name in names]
    series = pd.read_csv(SAMPLES / "front-120-70" / "sideslip_2100N_series.csv.gz")[:2500]
    series.to_csv(folder / "raw.csv", index=False)
    files.append(in_german(folder / "raw.csv", folder))
    sniffed, (toml, *_) = init_from(
        files,
        folder / "front-wheel",
        unloaded_radius=0.2992,
        nominal_load=1400.0,
        disc=DiscPath(1.323, "left"),
    )
    return sniffed, toml.read_text(encoding="utf-8"), configuration.load(toml)


def test_finished_points_with_their_time_are_no_recording(german_disc):
    """Every row of the sample's tables is a point, although the heading of their time is that of the recording's."""
    _, _, config = german_disc
    found = read(config).points
    rows = {name: int(np.sum(found.file == k)) for k, name in enumerate(Path(f).stem for f in found.files)}
    sample = SAMPLES / "front-120-70"
    for name in rows.keys() - {"raw"}:
        table = pd.read_csv(sample / f"{name}.csv", comment="#")
        at = np.flatnonzero([Path(found.files[k]).stem == name for k in found.file])
        assert found.Fy[at] == pytest.approx(table["Fy_N"].to_numpy(), rel=1e-6)
        assert found.p[at] == pytest.approx(1e3 * table["p_kPa"].to_numpy())
    assert 3 <= rows["raw"] <= 6


def test_the_project_names_the_tyre_alone_and_what_a_disc_needs(german_disc):
    _, text, config = german_disc
    assert (config.tyre.name, config.tyre.size) == ("front-wheel", "120/70 ZR17")
    assert (config.tyre.width, config.tyre.rim_radius) == (0.12, 0.2159)
    assert "rows are 90 s apart, so each is a finished point" in text
    assert "# [[rolling_radius]]" in text


def test_files_with_the_same_columns_share_a_table(german_disc):
    sniffed, _, _ = german_disc
    said = sniff_summary(sniffed)
    assert said.count("Schraeglaufwinkel") == 2
    assert said.count("rows, each a finished point") == 5
    (loads,) = (line for line in said.splitlines() if line.startswith("load"))
    assert loads.split()[2::2] == ["900", "1400", "2100"]


@pytest.mark.parametrize(
    ("tyre", "width", "rim"),
    [("Hoosier 43075 16x7.5-10 LCO, 7 inch rim", 0.1905, 0.127), ("225/45R17 91W", 0.225, 0.2159), ("120/70-17", 0.12, 0.2159)],
)  # fmt: skip
def test_width_and_rim_as_the_size_says(tyre, width, rim):
    assert _of_size(tyre) == (width, rim)
    assert _of_size("test 7 of 2024-11-02") == (None, None)
