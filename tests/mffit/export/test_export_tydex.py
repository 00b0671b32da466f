"""Points written as TYDEX are read back unchanged, and the files have the fixed columns of the format."""

from __future__ import annotations

import numpy as np
import pytest
from disc_project import disc_project

from mffit import config as configuration
from mffit import points
from mffit.errors import InputError
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
    source, _ = points.load(configuration.load(project.folder / "tyre.toml"))
    project.config["rig"]["axes"] = "iso"
    entries = project.config["sweep"]
    for entry, path in zip(entries, written, strict=True):
        assert path.stem == entry["file"].removesuffix(".csv")
        entry["file"] = f"../tydex/{path.name}"
    project.config["columns"] = COLUMNS
    again, _ = points.load(configuration.load(project.write()))
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
    assert any("turn slip" in line for line in lines)


def test_a_channel_that_was_not_measured_is_left_out(project, tmp_path):
    assert "MXW" not in read_tydex(write_tydex(project.write(), tmp_path / "tydex")[0]).headings


def test_two_sweeps_of_one_name_are_refused(project, tmp_path):
    table = project.tables[project.config["sweep"][0]["file"]]
    project.add("b c.csv", table.assign(Fy_N=table["Fy_N"] + 1.0, Mz_Nm=table["Mz_Nm"] + 0.1))
    project.add("b_c.csv", table.assign(Fy_N=table["Fy_N"] - 1.0, Mz_Nm=table["Mz_Nm"] - 0.1))
    with pytest.raises(InputError, match="two sweeps have the same file name"):
        write_tydex(project.write(), tmp_path / "tydex")
    assert not (tmp_path / "tydex").exists()
