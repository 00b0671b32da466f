"""The table of columns is complete, and headings are guessed from usual spellings."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from mffit import config as configuration
from mffit import sweeps as files
from mffit.errors import InputError
from mffit.export.tydex import TYDEX_CHANNELS
from mffit.sweeps.about import simplified
from mffit.sweeps.channels import BY_NAME, SWEEP_CHANNELS, nearest_channel, nearest_heading
from mffit.sweeps.units import UnknownUnitError, converted, is_unit, spellings

CONTRACT = [
    "alpha_deg", "gamma_deg", "Fz_N", "Fy_N", "Mz_Nm", "Mx_Nm", "My_Nm", "p_kPa", "V_mps", "T_degC",
    "direction", "u_Fy_N", "u_Mz_Nm", "point", "time_s", "t_s", "run", "iteration",
    "kappa", "Fx_N", "RL_m", "omega_radps",
    "u_Fx_N", "u_Mx_Nm", "u_My_Nm", "u_RL_m", "u_omega_radps",
]  # fmt: skip


def test_the_columns_are_those_of_the_contract():
    assert sorted(BY_NAME) == sorted(CONTRACT)
    assert [c.name for c in SWEEP_CHANNELS if c.required] == ["alpha_deg", "gamma_deg", "Fz_N", "Fy_N"]


def test_every_row_is_complete():
    names = [n for channel in SWEEP_CHANNELS for n in set(map(simplified, (channel.name, *channel.aliases)))]
    assert len(set(names)) == len(names)
    for channel in SWEEP_CHANNELS:
        assert channel.kind in ("number", "label", "direction")
        assert channel.lower < channel.upper
        assert channel.description
        if channel.unit:
            same = converted(np.array([1.0, 2.0]), channel.unit, channel.unit)
            np.testing.assert_allclose(same, [1.0, 2.0])


@pytest.mark.parametrize(
    ("name", "headings", "near"),
    [
        ("Fy_N", ["time", "FY", "FZ"], "FY"),
        ("alpha_deg", ["SLIPANGL", "INCLANGL"], "SLIPANGL"),
        ("gamma_deg", ["alpha_deg", "gama_deg"], "gama_deg"),
        ("Fz_N", ["Fz_kN"], "Fz_kN"),
        ("Fz_N", ["torque"], ""),
    ],
)
def test_the_heading_that_was_meant_is_guessed(name, headings, near):
    assert nearest_heading(BY_NAME[name], headings) == near


@pytest.mark.parametrize("written", sorted(spellings()))
def test_every_spelling_of_a_laboratory_is_a_unit(written):
    assert is_unit(written)
    assert is_unit(written.upper()) or written.upper() == written


def test_every_spelling_is_in_the_documentation():
    page = (Path(__file__).parents[3] / "docs" / "recordings.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `([^`]*)` \| (`.*`) \|$", page, re.MULTILINE))
    listed = {
        word.replace("␣", " "): unit.replace("(none)", "")
        for unit, words in rows.items()
        for word in re.findall("`([^`]*)`", words)
    }
    assert {written: listed.get(written) for written in spellings()} == spellings()


@pytest.mark.parametrize(
    "text", ["FY", "heavy", "forward", "left", "a**9**9**9", "m**99", "1500.0", "N" * 99, "()"]
)
def test_a_text_that_is_not_a_unit_is_not_parsed(text):
    """pint's parser also evaluates arithmetic: a tower of powers would never return."""
    assert not is_unit(text)


def test_a_misspelt_channel_is_guessed_and_a_foreign_heading_is_not():
    assert nearest_channel("mz_nm", likeness=0.8) == "Mz_Nm"
    assert nearest_channel("operator", likeness=0.8) == ""


@pytest.mark.parametrize(
    ("value", "unit", "target", "expected"),
    [
        (1.5, "kN", "N", 1500.0),
        (1.0, "lbf", "N", 4.4482216152605),
        (1.0, "kgf", "N", 9.80665),
        (100.0, "Nm", "N m", 100.0),
        (1500.0, "Nmm", "N m", 1.5),
        (1.0, "N-m", "N m", 1.0),
        (1.0, "kp", "N", 9.80665),
        (1.0, "in-lb", "N m", 0.1129848290276167),
        (1.0, "psi", "kPa", 6.894757293168361),
        (1.0, "Grad", "deg", 1.0),
        (36.0, "kph", "m/s", 10.0),
        (25.0, "deg C", "degC", 25.0),
        (12.0, "%", "", 0.12),
        (0.12, "none", "", 0.12),
        (20.0, "cm", "m", 0.2),
        (2.0, "kNm", "N m", 2000.0),
        (2.5, "bar", "kPa", 250.0),
        (36.0, "psi", "kPa", 248.2112626),
        (36.0, "km/h", "m/s", 10.0),
        (212.0, "degF", "degC", 100.0),
        (np.pi, "rad", "deg", 180.0),
    ],
)
def test_units_of_rigs_are_converted(value, unit, target, expected):
    assert converted(np.array([value]), unit, target)[0] == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("unit", ["N m", "furlong per", "kPa kPa", "", "?", "3 +", "__import__"])
def test_other_units_are_refused(unit):
    with pytest.raises(UnknownUnitError):
        converted(np.array([1.0]), unit, "N")


@pytest.mark.parametrize("written", TYDEX_CHANNELS, ids=lambda written: written.name)
def test_a_name_that_tydex_export_writes_is_known_to_its_reader(written):
    """The alias belongs to the channel from which the numbers come, and the unit can be converted."""
    fields = ("alpha", "gamma", "kappa", "Fz", "Fx", "Fy", "Mx", "My", "Mz", "omega", "p", "V", "T")
    source = written.of(SimpleNamespace(**{field: field for field in fields}))
    (channel,) = [channel for channel in SWEEP_CHANNELS if written.name in channel.aliases]
    assert (channel.name.rpartition("_")[0] or channel.name) == source
    assert np.isfinite(converted(np.ones(1), written.unit, channel.unit)).all()


ONE = {
    "tyre": {"name": "a", "unloaded_radius": 0.3, "nominal_load": 1400, "nominal_pressure": 250},
    "rig": {"type": "flat-track"},
    "sweep": [{"file": "a.csv"}],
}


def test_all_missing_columns_are_named_at_once_with_what_to_write(tmp_path):
    """What the sentence says to write makes the file readable."""
    headings = {
        "alpha_deg": "Schräglaufwinkel [Grad]", "gamma_deg": "Sturz [Grad]", "Fz_N": "Radlast [kN]", "Fy_N": "Seitenkraft [N]",
    }  # fmt: skip
    rows = "\n".join(f"{a};0;1,4;{-200 * a}" for a in range(-5, 6))
    (tmp_path / "a.csv").write_text(";".join(headings.values()) + f"\n{rows}\n", encoding="utf-8")
    content = dict(ONE)
    with pytest.raises(InputError) as caught:
        files.load(configuration.load(content, folder=tmp_path))
    said = str(caught.value)
    assert said.count("is missing") == 1
    entries = re.findall(r"(\w+) = (\{ column = [^}]*\})", said)
    assert [name for name, _ in entries] == list(headings)
    content["columns"] = tomllib.loads("\n".join(f"{name} = {entry}" for name, entry in entries))
    (sweep,) = files.load(configuration.load(content, folder=tmp_path)).sweeps
    assert sweep.Fz == pytest.approx(1400.0)
    assert np.degrees(sweep.alpha) == pytest.approx(np.arange(-5.0, 6.0))


def test_a_unit_of_another_quantity_is_not_offered(tmp_path):
    """A column in mm holds no side force; one whose unit is unknown may, in the unit that the channel has."""
    for heading, offered in (
        ("fy_path [mm]", ""),
        ("fy_path [kN]", '{ column = "fy_path", unit = "kN" }'),
        ("fy_path [raw]", '{ column = "fy_path [raw]", unit = "N" }'),
    ):
        (tmp_path / "a.csv").write_text(f"alpha_deg,gamma_deg,Fz_N,{heading}\n0,0,1400,1\n1,0,1400,2\n")
        with pytest.raises(InputError) as caught:
            files.load(configuration.load(ONE, folder=tmp_path))
        said = str(caught.value)
        assert (f"Fy_N = {offered}" if offered else "add Fy_N (") in said
        assert 'mm"' not in said
