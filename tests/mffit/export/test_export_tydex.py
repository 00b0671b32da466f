"""Points written as TYDEX are read back unchanged, and the files have the fixed columns of the format."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from disc_project import disc_project

from mffit import config as configuration
from mffit import points
from mffit.errors import InputError
from mffit.export.tydex import tydex_texts
from mffit.pipeline.exporting import write_tydex
from mffit.sweeps.tydex import read_tydex

COLUMNS = {
    "alpha_deg": {"column": "SLIPANGL", "unit": "rad"},
    "gamma_deg": {"column": "INCLANGL", "unit": "rad"},
    "Fz_N": "FZW",
    "Fy_N": "FYW",
    "Mz_Nm": "MZW",
    "p_kPa": {"column": "INFLPRES", "unit": "Pa"},
    "V_mps": "TRAJVELW",
}


@pytest.fixture
def project(tmp_path):
    """A rig that reports in adapted SAE axes: the files are in ISO axes anyway."""
    found = disc_project(tmp_path / "rig")
    found.config["rig"]["axes"] = "adapted-sae"
    found.each(Fy_N=-1.0, Mz_Nm=-1.0)
    return found


def test_points_are_read_back_to_rounding(project, tmp_path):
    written = write_tydex(project.write(), tmp_path / "tydex")
    source = points.read(configuration.load(project.folder / "tyre.toml")).points
    project.config["rig"]["axes"] = "iso"
    entries = project.config["sweep"]
    for entry, path in zip(entries, written, strict=True):
        assert path.stem == entry["file"].removesuffix(".csv")
        entry["file"] = f"../tydex/{path.name}"
    project.config["columns"] = COLUMNS
    again = points.read(configuration.load(project.write())).points
    for name in ("alpha", "gamma", "Fz", "Fy", "Mz", "p", "V", "direction"):
        np.testing.assert_allclose(getattr(again, name), getattr(source, name), rtol=1e-15, err_msg=name)


def test_names_units_and_factors_are_in_the_columns_of_the_format(project, tmp_path):
    """Name in columns 1 to 10, description to 40, unit to 50, then factor and offsets: TYDEX-Format 1.3."""
    path = write_tydex(project.write(), tmp_path / "tydex")[0]
    raw = path.read_bytes()
    assert raw.count(b"\r\n") == raw.count(b"\n")
    lines = raw.decode("latin-1").splitlines()
    row = next(line for line in lines if line.startswith("FYW"))
    assert (row[:10].strip(), row[10:40].strip(), row[40:50].strip(), row[50:]) == (
        "FYW", "lateral force", "N", "1 0 0",
    )  # fmt: skip
    sections = [line.split()[0] for line in lines if line.startswith("**")]
    assert sections == ["**HEADER", "**COMMENTS", "**CONSTANTS", "**MEASURCHANNELS", "**MEASURDATA", "**END"]
    rows = lines[lines.index("**MEASURDATA") + 1 : lines.index("**END")]
    assert len(rows) == len(read_tydex(path).lines) == len(project.tables[f"{path.stem}.csv"])


def said(project) -> dict[str, list[str]]:
    """The remarks of each file."""
    config = configuration.load(project.write())
    texts = tydex_texts(points.read(config).points, config)
    return {
        name: [line.removeprefix("! ") for line in text.splitlines() if line.startswith("!")]
        for name, text in texts.items()
    }


@pytest.mark.parametrize(("centre", "turn_slip"), [("left", "-0.755858"), ("right", "+0.755858")])
def test_what_tydex_has_no_channels_for_is_in_the_remarks(project, centre, turn_slip):
    """1/1.323 m is 0.755858 1/m; a path that curves to the left has negative turn slip."""
    project.config["rig"]["path_centre"] = centre
    remarks = said(project)
    path = f"on a path of 1.323 m radius, turn slip {turn_slip} 1/m"
    assert remarks["forward_1000"][1:] == ["rolling forwards", path]
    assert remarks["backward_1000"][1:] == ["rolling backwards", path]


def test_a_turned_tyre_and_a_straight_path_are_in_the_remarks(project):
    project.config["rig"] = {"type": "flat-track", "axes": "iso"}
    project.config["sweep"][0]["mount"] = "flipped"
    remarks = said(project)
    assert remarks["sideslip_1000"][1:] == ["rolling forwards", "tyre turned on its rim"]
    assert remarks["camber_1000"][1:] == ["rolling forwards"]


def test_a_sweep_of_both_directions_becomes_two_files(project):
    """Nothing in a row says its direction, so rows of both in one file would be lost for every reader."""
    forward, backward = (project.tables[f"{way}_1000.csv"] for way in ("forward", "backward"))
    both = pd.concat([forward.assign(direction="forward"), backward.assign(direction="backward")])
    project.add("both.csv", both.sample(frac=1.0, random_state=1).assign(Fy_N=lambda t: t["Fy_N"] + 0.5))
    config = configuration.load(project.write())
    texts = tydex_texts(points.read(config).points, config)
    assert "both" not in texts
    for way, rows in (("forward", len(forward)), ("backward", len(backward))):
        lines = texts[f"both-{way}"].splitlines()
        assert f"! rolling {way}s" in lines
        assert lines.index("**END") - lines.index("**MEASURDATA") - 1 == rows


def test_the_overall_diameter_is_twice_the_unloaded_radius(project):
    config = configuration.load(project.write())
    text = tydex_texts(points.read(config).points, config)["sideslip_1000"]
    row = next(line for line in text.splitlines() if line.startswith("OVALLDIA"))
    assert (row[40:50].strip(), float(row[50:])) == ("m", 0.6)


def test_a_channel_that_was_not_measured_is_left_out(project, tmp_path):
    assert "MXW" not in read_tydex(write_tydex(project.write(), tmp_path / "tydex")[0]).headings


def test_two_sweeps_of_one_name_are_refused(project, tmp_path):
    table = project.tables[project.config["sweep"][0]["file"]]
    project.add("b c.csv", table.assign(Fy_N=table["Fy_N"] + 1.0, Mz_Nm=table["Mz_Nm"] + 0.1))
    project.add("b_c.csv", table.assign(Fy_N=table["Fy_N"] - 1.0, Mz_Nm=table["Mz_Nm"] - 0.1))
    with pytest.raises(InputError, match="two sweeps have the same file name"):
        write_tydex(project.write(), tmp_path / "tydex")
    assert not (tmp_path / "tydex").exists()
