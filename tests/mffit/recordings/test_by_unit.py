"""Unknown headings are taken or asked about by the unit that the file states for them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from mffit import config as configuration
from mffit import sweeps
from mffit.cli import projects
from mffit.errors import InputError
from mffit.pipeline import init_from
from mffit.recordings import sniff

ALPHA = np.radians(np.linspace(-10.0, 10.0, 21))
GIVEN = {"unloaded_radius": 0.3, "nominal_load": 1500.0}
UNKNOWN = {"p": "Druck [bar]", "V": "Tempo [km/h]", "Mz": "Rückstell [N m]"}


def table(path: Path, *, without=(), **more) -> Path:
    """A sideslip sweep at 2.5 bar and 36 km/h under German headings, with units; ISO signs."""
    columns = {
        "Schräglauf [deg]": np.degrees(ALPHA),
        "Sturz [deg]": 0.0 * ALPHA,
        "Radlast [N]": 0.0 * ALPHA + 1500.0,
        "Seitenkraft [kN]": -1.6 * np.sin(1.5 * np.arctan(8.0 * ALPHA)),
        UNKNOWN["p"]: 0.0 * ALPHA + 2.5,
        UNKNOWN["V"]: 0.0 * ALPHA + 36.0,
        UNKNOWN["Mz"]: 30.0 * np.sin(12.0 * ALPHA) * np.exp(-((6.0 * ALPHA) ** 2)),
    } | more
    kept = {name: values for name, values in columns.items() if name not in without}
    pd.DataFrame(kept).to_csv(path, index=False, sep=";", decimal=",")
    return path


def only(path: Path, **given):
    found = sniff([path], **given)
    return found.recordings[0]


def test_the_only_column_in_a_unit_of_pressure_or_speed_is_taken_with_a_question(tmp_path):
    path = table(tmp_path / "a.csv")
    _, (toml, *_) = init_from([path], tmp_path / "p", **GIVEN)
    config = configuration.load(toml)
    (sweep,) = sweeps.load(config).sweeps
    assert config.tyre.nominal_pressure == 250.0
    assert sweep.p == pytest.approx(250e3)
    assert pytest.approx(10.0) == sweep.V
    text = toml.read_text(encoding="utf-8")
    assert "# Druck [bar] is taken as p_kPa" in text
    assert (
        "p_kPa (inflation pressure), because no other unused column has a unit of pressure: is that right?"
        in text
    )
    assert 'p_kPa = "Druck"' in text


def test_several_columns_in_one_unit_are_asked_about_and_one_can_be_named(tmp_path):
    path = table(tmp_path / "a.csv", **{"Druck 2 [psi]": 0.0 * ALPHA + 30.0})
    assert "p_kPa" not in only(path).guesses
    asks = 'unused columns in a unit of pressure: "Druck" .bar., "Druck 2" .psi.*--column \'p_kPa=Druck\''
    with pytest.raises(InputError, match=f"{asks}.*or give --nominal-pressure"):
        init_from([path], tmp_path / "p", **GIVEN)
    named = only(path, headings={"p_kPa": "Druck 2"})
    assert named.guesses["p_kPa"].stated == "psi"
    assert not any("pressure" in remark for remark in named.remarks)


def test_without_any_column_of_pressure_none_is_measured(tmp_path):
    path = table(tmp_path / "a.csv", without=[UNKNOWN["p"]])
    with pytest.raises(InputError, match=r"no pressure is measured.*give --nominal-pressure KPA"):
        init_from([path], tmp_path / "p", **GIVEN)


@pytest.mark.parametrize(
    ("heading", "value"),
    [("Umgebungsdruck [mbar]", 1013.0), ("Kolben [bar]", 150.0), ("ambient [kPa]", 101.3)],
)
def test_a_pressure_that_cannot_be_the_tyres_is_not_taken(tmp_path, heading, value):
    path = table(tmp_path / "a.csv", without=[UNKNOWN["p"]], **{heading: 0.0 * ALPHA + value})
    found = only(path)
    assert "p_kPa" not in found.guesses
    assert any("p_kPa" in remark and heading.split()[0] in remark for remark in found.remarks)


def test_a_unit_that_leaves_several_channels_is_only_asked_about(tmp_path):
    warm = {"Temp A [°C]": 0.0 * ALPHA + 40.0}
    found = only(table(tmp_path / "a.csv", **warm))
    assert found.guesses.keys().isdisjoint({"T_degC", "Mz_Nm", "Mx_Nm", "My_Nm"})
    of_moments, of_temperature = (
        next(remark for remark in found.remarks if name in remark) for name in ("Mz_Nm", "T_degC")
    )
    assert '"Rückstell" [N m]' in of_moments
    assert '"Temp A" [°C]' in of_temperature
    assert 'T_degC = "Temp A" under [columns]' in of_temperature


@pytest.mark.parametrize(
    ("heading", "channel"),
    [
        ("brake force [N]", "Fx_N"),
        ("Bremskraft [kN]", "Fx_N"),
        ("Bremskraft", "Fx_N"),
        ("driving force", "Fx_N"),
        ("Antriebskraft [N]", "Fx_N"),
        ("Kippen [N m]", "Mx_Nm"),
        ("Rollwiderstand [N m]", "My_Nm"),
        ("tire surface temp", "T_degC"),
    ],
)
def test_a_column_whose_words_fit_a_channel_is_proposed_for_it(tmp_path, heading, channel):
    other = {"Kolbenkraft [N]": 0.0 * ALPHA + 3.0}
    found = only(table(tmp_path / "a.csv", **other, **{heading: 0.0 * ALPHA + 0.5}))
    name = heading.partition(" [")[0]
    assert channel not in found.guesses
    (asked,) = (remark for remark in found.remarks if f"--column '{channel}={name}'" in remark)
    assert "Kolbenkraft" not in asked


@pytest.mark.parametrize("heading", ["brake pressure [bar]", "Bremse", "drive", "Zugfahrzeug [-]"])
def test_a_word_of_a_channel_in_another_kind_proposes_nothing(tmp_path, heading):
    found = only(table(tmp_path / "a.csv", **{heading: 0.0 * ALPHA + 30.0}))
    assert not any("Fx_N=" in remark for remark in found.remarks)


@pytest.mark.parametrize(("times", "is_time"), [(np.arange(21.0), True), (np.arange(21.0)[::-1], False)])
def test_a_column_in_seconds_is_the_time_if_it_only_rises(tmp_path, times, is_time):
    found = only(table(tmp_path / "a.csv", **{"Zähler [ms]": times}))
    assert ("time_s" in found.guesses) == is_time


def test_a_share_is_no_angle(tmp_path):
    path = table(tmp_path / "a.csv", without=["Sturz [deg]"], **{"Feuchte [%]": 0.0 * ALPHA + 40.0})
    with pytest.raises(InputError, match="known to be gamma_deg") as refused:
        sniff([path])
    assert "gamma_deg may be" not in str(refused.value)


def test_of_a_required_channel_the_heading_with_its_words_is_proposed(tmp_path):
    more = {"Kraft 3 [kN]": 0.0 * ALPHA + 1.5, "Reifennormalkraft [kN]": 0.0 * ALPHA + 1.5}
    with pytest.raises(InputError, match=r"give --column 'Fz_N=Reifennormalkraft'"):
        sniff([table(tmp_path / "a.csv", without=["Radlast [N]"], **more)])


def test_a_required_channel_under_an_unknown_heading_can_be_named(tmp_path):
    path = table(tmp_path / "a.csv", **{"Kraft 3 [kN]": 0.0 * ALPHA + 1.5}, without=["Radlast [N]"])
    with pytest.raises(InputError, match=r"Fz_N may be Kraft 3.; give --column 'Fz_N=Kraft 3'"):
        sniff([path])
    project = tmp_path / "p"
    options = ["--unloaded-radius", "0.3", "--nominal-load", "1500", "--column", "Fz_N=Kraft 3"]
    found = CliRunner().invoke(projects.init, ["--from", str(path), str(project), *options])
    assert found.exit_code == 0, found.output
    (sweep,) = sweeps.load(configuration.load(project / "tyre.toml")).sweeps
    assert sweep.Fz == pytest.approx(1500.0)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"Fy": "Seitenkraft"}, 'is not a column of a sweep; did you mean "Fy_N"'),
        ({"Mz_Nm": "Rückstel"}, 'no file has the heading "Rückstel"; did you mean "Rückstell"'),
        ({"Mz_Nm": "Druck"}, "column Druck: cannot be Mz_Nm .*no numbers in a unit of moment"),
    ],
)
def test_a_wrong_name_is_refused(tmp_path, given, sentence):
    with pytest.raises(InputError, match=sentence):
        sniff([table(tmp_path / "a.csv")], headings=given)


def test_a_name_without_a_heading_is_refused(tmp_path):
    found = CliRunner().invoke(projects.sniff, [str(table(tmp_path / "a.csv")), "--column", "Mz_Nm"])
    assert isinstance(found.exception, InputError)
    assert "write p_kPa=Druck" in str(found.exception)


def test_headings_in_french_are_known(tmp_path):
    t = np.arange(0.0, 12.0, 0.05)
    alpha = 8.0 * np.sin(2.0 * np.pi * t / 12.0)
    table = {
        "Temps [s]": t, "Angle de dérive [deg]": alpha, "Carrossage [deg]": 0.0 * t, "Charge verticale [N]": 3000.0 + 0.0 * t,
        "Effort latéral [N]": -3000.0 * np.tanh(0.25 * alpha), "Pression [bar]": 2.4 + 0.0 * t, "Vitesse [m/s]": 15.0 + 0.0 * t,
    }  # fmt: skip
    pd.DataFrame(table).to_csv(tmp_path / "a.csv", index=False)
    found = sniff([tmp_path / "a.csv"]).recordings[0].guesses
    assert {"time_s", "alpha_deg", "gamma_deg", "Fz_N", "Fy_N", "p_kPa", "V_mps"} <= found.keys()
