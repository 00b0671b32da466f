"""Units that a recording does not state are decided for related columns together; doubts are reported."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from mffit import pipeline
from mffit.errors import InputError
from mffit.points.stretch import StretchNote, stretch_table
from mffit.recordings import Stated, project_text, sniff
from mffit.recordings.guess import ColumnChoice, corrected, guesses
from mffit.report import text
from mffit.sweeps.raw_table import RawTable

N = 2000
STEP = 0.01  # s
WAVE = np.sin(np.linspace(0.0, 40.0, N))
GIVEN = {"unloaded_radius": 0.2, "nominal_load": 1500.0}


def columns(**other) -> dict[str, np.ndarray]:
    """A sweep to 9 deg and back at 11 m/s and 83 kPa, in SI except for deg and kPa."""
    usual = {
        "ET": 30.0 + STEP * np.arange(N), "V": np.full(N, 11.0), "SA": 9.0 * WAVE, "IA": np.full(N, 1.0), "P": np.full(N, 83.0),
        "FX": 60.0 * WAVE, "FY": -2300.0 * WAVE, "FZ": np.full(N, 2500.0), "MX": 30.0 * WAVE, "MZ": 60.0 * WAVE,
        "TSTC": np.full(N, 60.0),
    }  # fmt: skip
    return {name: values for name, values in (usual | other).items() if values is not None}


def guessed(units=None, radius=None, **other):
    held = columns(**other)
    raw = RawTable(
        headings=tuple(held),
        units=tuple((units or {}).get(name, "") for name in held),
        cells=tuple(held.values()),
        lines=range(2, N + 2),
        path=Path("a.csv"),
        heading_line=1,
    )
    found = guesses(raw, unloaded_radius=radius)
    return found._replace(remarks=tuple(map(str, found.remarks)))


def units(**other) -> dict[str, str]:
    return {name: guess.unit for name, guess in guessed(**other).found.items()}


def test_uncertainties_are_in_the_unit_of_their_readings():
    """Whether a user names the column or chooses it; a chosen unit holds."""
    raw = RawTable(
        headings=("FY", "MZ", "uFy", "uMz"),
        units=("daN", "Nm", "", "mNm"),
        cells=(-230.0 * WAVE, 60.0 * WAVE, np.full(N, 2.0), np.full(N, 900.0)),
        lines=range(2, N + 2),
        path=Path("a.csv"),
        heading_line=1,
    )
    named = guesses(raw, named={"u_Fy_N": "uFy", "u_Mz_Nm": "uMz"})
    assert named.found["u_Fy_N"].why == "taken in daN, like FY"
    assert (named.found["u_Fy_N"].column.unit, named.found["u_Mz_Nm"].column.unit) == ("daN", None)
    for typed, unit in (("", "daN"), ("N", "N")):
        chosen = corrected(guesses(raw), raw, [ColumnChoice("uFy", "u_Fy_N", typed, minus=False)])
        assert chosen.found["u_Fy_N"].column.unit == unit


def test_a_heading_may_state_its_unit_itself():
    """As tables of standards ("Fy / kN"), Germans ("Fy in kN") and programs ("Fy_kN") write it."""
    for between in (" / ", ", ", " in ", "_"):
        named = {
            f"Fy{between}kN": -2.3 * WAVE,
            f"camber{between}rad": np.full(N, 0.02),
            f"alpha{between}V": WAVE,
        }
        found = guessed(FY=None, IA=None, **named).found
        assert (found["Fy_N"].column.unit, found["gamma_deg"].column.unit) == ("kN", "rad")
        assert found["Fy_N"].why == "as the heading says"
        assert not found["Fy_N"].assumed
        assert found["alpha_deg"].heading == "SA"  # volts are no angle


def test_a_unit_that_is_not_known_is_asked_about():
    found, remarks = guessed(units={"P": "kPa abs", "FZ": "N"})
    assert found["p_kPa"].unit == "kPa"
    assert (
        sum('the unit "kPa abs" of P is not known, so it is taken as kPa' in remark for remark in remarks)
        == 1
    )


def test_angles_forces_and_moments_share_their_units():
    found = units()
    assert {found["alpha_deg"], found["gamma_deg"]} == {"deg"}
    assert {found["Fx_N"], found["Fy_N"], found["Fz_N"]} == {"N"}
    assert {found["Mx_Nm"], found["Mz_Nm"]} == {"N m"}
    in_rad = units(SA=np.radians(9.0 * WAVE), IA=np.radians(np.full(N, 1.0)))
    assert {in_rad["alpha_deg"], in_rad["gamma_deg"]} == {"rad"}
    usual = columns()
    thousandth = {name: usual[name] / 1e3 for name in ("FX", "FY", "FZ", "MX", "MZ")}
    in_kN = units(**thousandth)
    assert {in_kN["Fx_N"], in_kN["Fy_N"], in_kN["Fz_N"]} == {"kN"}
    assert {in_kN["Mx_Nm"], in_kN["Mz_Nm"]} == {"kN m"}


def test_readings_of_zero_are_in_the_units_of_the_contract():
    """They would be plausible in any unit."""
    found = units(MX=np.zeros(N), MZ=np.zeros(N), SA=np.zeros(N), IA=np.zeros(N))
    assert (found["Mz_Nm"], found["alpha_deg"]) == ("N m", "deg")


def test_a_load_in_kN_beside_forces_in_N_is_recognised_by_the_grip():
    found = units(FZ=np.full(N, 2.5))
    assert (found["Fz_N"], found["Fy_N"], found["Fx_N"]) == ("kN", "N", "N")


@pytest.mark.parametrize(("grip", "load_unit"), [(3.8, "N"), (4.2, "kN")])
def test_no_tyre_has_a_grip_of_four(grip, load_unit):
    found = units(FZ=np.full(N, 60.0), FY=grip * 60.0 * WAVE)
    assert (found["Fz_N"], found["Fy_N"]) == (load_unit, "N")


def test_a_column_gets_the_unit_that_another_of_its_kind_states():
    found = guessed(units={"FZ": "lbf", "SA": "rad"}).found
    assert (found["Fy_N"].unit, found["gamma_deg"].unit, found["Fz_N"].unit) == ("lbf", "rad", "")
    assert "like FZ" in found["Fy_N"].why


@pytest.mark.parametrize(
    ("pressure", "load", "unit", "also"),
    [
        (10.0, 2500.0, "psi", "bar"),
        (2.2, 4000.0, "bar", ""),
        (0.83, 2500.0, "bar", ""),
        (32.0, 4000.0, "psi", ""),
        (83.0, 2500.0, "kPa", "psi"),
        (230.0, 4000.0, "kPa", ""),
        (83e3, 2500.0, "Pa", ""),
        (8.0, 30_000.0, "bar", "psi"),
    ],
)
def test_the_unit_gives_the_pressure_of_a_tyre_and_alternatives_are_named(pressure, load, unit, also):
    guess = guessed(P=np.full(N, pressure), FZ=np.full(N, load)).found["p_kPa"]
    assert guess.unit == unit
    assert also in guess.why


@pytest.mark.parametrize(("factor", "unit"), [(1.0, "s"), (1e3, "ms"), (1e6, "us")])
def test_the_unit_of_time_gives_a_usual_rate_of_steering(factor, unit):
    assert units(ET=factor * STEP * np.arange(N))["time_s"] == unit


def test_a_unit_of_time_is_explained_by_the_speed_of_the_angle():
    """Up and down between -6 and 6 deg, a second each way."""
    seconds = STEP * np.arange(N)
    found = guessed(ET=1e3 * seconds, SA=6.0 - 12.0 * np.abs(seconds % 2.0 - 1.0)).found["time_s"]
    assert "ms, in which the angle moves at 12 deg/s" in found.why


def test_the_rate_of_steering_distinguishes_steps_of_a_second_and_a_millisecond():
    slow = 9.0 * np.sin(np.linspace(0.0, 2.0, N))
    assert units(ET=np.arange(N), SA=slow)["time_s"] == "ms"
    assert units(ET=np.arange(N), SA=9.0 * np.sin(np.linspace(0.0, 200.0, N)))["time_s"] == "s"


def test_rows_that_are_seconds_apart_are_finished_points_also_without_a_unit(tmp_path):
    """Thirteen rows that are 20 apart are no recording of a quarter of a second."""
    few = np.linspace(-8.0, 8.0, 13)
    rows = {
        "ET": 20.0 * np.arange(13),
        "SA": few,
        "IA": 0.0 * few,
        "FZ": 900.0,
        "FY": -300.0 * few,
        "MZ": 3.0 * few,
    }
    pd.DataFrame(rows).to_csv(tmp_path / "a.csv", index=False)
    (found,) = sniff([tmp_path / "a.csv"]).recordings
    assert found.guesses["t_s"].unit == "s"
    assert "time_s" not in found.guesses


def test_a_time_that_fits_no_unit_is_called_unknown():
    assert "not known" in guessed(ET=1e9 * STEP * np.arange(N)).found["time_s"].why
    assert "not known" in guessed(SA=np.zeros(N)).found["time_s"].why


def test_one_american_unit_casts_doubt_on_unstated_ones():
    remark = " ".join(guessed(P=np.full(N, 12.0)).remarks)
    for words in ("P is in psi", "FZ (N or lbf)", "MZ (N m or ft-lb)", "mph", "degF", 'unit = "lbf"'):
        assert words in remark
    assert not guessed().remarks
    stated = {"FZ": "N", "MZ": "N-m", "V": "kph", "TSTC": "deg C"}
    assert not any(
        "lbf" in remark or "mph" in remark for remark in guessed(units=stated | {"P": "psi"}).remarks
    )


def test_a_speed_of_rotation_is_kept_only_if_it_agrees_with_the_speed():
    turning = 11.0 / 0.195  # rad/s
    assert units(N=np.full(N, turning))["omega_radps"] == "rad/s"
    assert units(N=np.full(N, turning * 60.0 / (2.0 * np.pi)))["omega_radps"] == "rpm"
    for wrong in ({"N": 0.4 * WAVE}, {"N": np.full(N, turning), "V": None}):
        found = guessed(**wrong)
        assert "omega_radps" not in found.found
        assert any("N" in remark and "left out" in remark for remark in found.remarks)
    assert "omega_radps" in guessed(N=np.full(N, turning), units={"N": "rad/s"}, radius=0.2).found
    assert "omega_radps" not in guessed(N=np.full(N, turning), units={"N": "rad/s"}, radius=0.4).found


@pytest.mark.parametrize(("unit", "metres"), [("m/s", 1.0), ("km/h", 1.0 / 3.6), ("mph", 0.44704)])
@pytest.mark.parametrize("rotation", ["rad/s", "rpm"])
@pytest.mark.parametrize("speed", [5.0, 20.0])
def test_the_speed_is_in_the_unit_in_which_the_wheel_turns(unit, metres, rotation, speed):
    """Speed over rotation is the radius of the wheel: 25 mph were read as km/h, and the rotation was blamed."""
    turns = speed / 0.205 * (1.0 if rotation == "rad/s" else 60.0 / (2.0 * np.pi))
    for known in ({"radius": 0.2057}, {"RL": np.full(N, 0.19), "units": {"RL": "m"}}):
        found = units(V=np.full(N, speed / metres), N=np.full(N, turns), **known)
        assert (found["V_mps"], found["omega_radps"]) == (unit, rotation)


def test_a_missing_moment_names_columns_in_a_unit_of_moments():
    found = guessed(MZ=None, Torque=60.0 * WAVE, units={"Torque": "in-lb", "FZ": "N"})
    assert any("Mz_Nm" in remark and "Torque" in remark for remark in found.remarks)
    found = guessed(MZ=None, Torque=60.0 * WAVE, units={"Torque": "in-lb", "MX": "N-m"})
    (remark,) = (remark for remark in found.remarks if "Mz_Nm" in remark)
    assert 'unused columns in a unit of moment: "Torque" [in-lb];' in remark  # MX is used


def test_a_speed_is_recognised_or_asked_for_by_its_unit():
    road = np.full(N, 60.0)
    assert (
        guessed(V=None, **{"Roadway Speed": road}, units={"Roadway Speed": "km/h"}).found["V_mps"].heading
        == "Roadway Speed"
    )
    found = guessed(V=None, **{"Zug": road}, units={"Zug": "km/h"})
    (remark,) = [remark for remark in found.remarks if "V_mps" in remark]
    assert remark.startswith("Zug [km/h] is taken as V_mps")
    assert not [remark for remark in guessed().remarks if "V_mps" in remark]


def test_a_column_without_readings_or_of_another_dimension_is_no_channel():
    assert "p_kPa" not in guessed(units={"P": "deg C"}).found
    assert "p_kPa" not in guessed(P=np.full(N, np.nan)).found
    assert guessed(units={"P": "deg C"}, Reifendruck=np.full(N, 83.0)).found["p_kPa"].heading == "Reifendruck"


def test_the_table_of_stretches_has_as_many_digits_as_rigs_resolve():
    note = StretchNote(
        file="a", sweep="a:01", kind="sweep", swept="alpha_deg", begin_s=1.23456, end_s=2.34567, first_line=2,
        last_line=9, alpha_from_deg=-8.12345, alpha_to_deg=8.23456, kappa_from=-0.123456, kappa_to=0.1, gamma_deg=2.34567,
        Fz_N=1500.678, p_kPa=83.456, T_degC=61.567, points=7, dropped="",
    )  # fmt: skip
    assert stretch_table([note]).iloc[0].tolist() == [
        "a", "a:01", "sweep", "alpha_deg", 1.235, 2.346, 2, 9, -8.12, 8.23, -0.1235, 0.1, 2.35, 1501.0, 83.5, 61.6, 7,
        "",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("heading", "channel"),
    [
        ("Self aligning torque", "Mz_Nm"), ("Surface temp", "T_degC"), ("Reifendruck", "p_kPa"), ("Kippmoment", "Mx_Nm"),
        ("Längskraft", "Fx_N"), ("MTS Running Time", "time_s"),
    ],
)  # fmt: skip
def test_headings_of_laboratories(heading, channel):
    without = {"Mz_Nm": "MZ", "T_degC": "TSTC", "p_kPa": "P", "Mx_Nm": "MX", "Fx_N": "FX", "time_s": "ET"}[
        channel
    ]
    held = columns()
    assert guessed(**{without: None, heading: held[without]}).found[channel].heading == heading


def table(**other) -> str:
    """Finished points as CSV in SAE axes; cells are written unchanged."""
    alpha = np.repeat(np.linspace(-8.0, 8.0, 9), 2)
    load = np.tile([1000.0, 2000.0], 9)
    held = {
        "SA": alpha, "IA": 2.0 + 0.0 * alpha, "FZ": -load, "FY": -load * np.sin(np.arctan(0.2 * alpha)) + 5.0,
        "MZ": 0.02 * load * np.sin(0.15 * alpha), **other,
    }  # fmt: skip
    held = {name: np.broadcast_to(values, len(alpha)) for name, values in held.items()}
    rows = [",".join(str(cell) for cell in row) for row in zip(*held.values(), strict=True)]
    return "\n".join([",".join(held), *rows]) + "\n"


def test_a_missing_pressure_is_reported_and_asked_for(tmp_path):
    (tmp_path / "a.csv").write_text(table())
    found = sniff([tmp_path / "a.csv"])
    assert found.conditions["pressure"] == ()
    assert found.conditions["load"]
    assert text.sniff_summary(found).count("not measured") == 2  # nor is a speed
    with pytest.raises(InputError, match="--nominal-pressure"):
        pipeline.init_from([tmp_path / "a.csv"], tmp_path / "p", **GIVEN)
    assert not (tmp_path / "p").exists()


def test_only_measured_pressures_count(tmp_path):
    """Two files without pressure beside one with it: the placeholder for the others does not count as a measurement."""
    for name, more in (("a", {}), ("b", {}), ("c", {"P": 83.0})):
        (tmp_path / f"{name}.csv").write_text(table(**more))
    found = sniff([f"{tmp_path}/*.csv"])
    assert [(round(level.value), level.points) for level in found.conditions["pressure"]] == [(83_000, 18)]
    assert "nominal_pressure = 83 " in project_text(
        found, tmp_path, Stated(unloaded_radius=0.2, nominal_load=1500.0)
    )


def test_rows_without_time_are_reported_as_points(tmp_path):
    (tmp_path / "a.csv").write_text(table())
    found = sniff([tmp_path / "a.csv"])
    for said in (
        text.sniff_summary(found).replace("\n  ", " "),
        project_text(found, tmp_path),
    ):
        assert "no time: each row is treated as a finished point" in said


def test_a_remark_on_some_of_the_recordings_is_written_once_with_their_number(tmp_path):
    for name, own in (("a", {}), ("b", {"ET": 90.0 * np.arange(18)}), ("c", {}), ("d", {})):
        (tmp_path / f"{name}.csv").write_text(table(**own))
    written = project_text(sniff(sorted(tmp_path.glob("*.csv"))), tmp_path)
    (remark,) = (line for line in written.splitlines() if "no time" in line)
    assert remark.endswith(" (also 2 files below)")


def test_a_time_elapsed_and_a_pressure_of_inflation_are_known_by_these_words_alone(tmp_path):
    (tmp_path / "a.csv").write_text(table(Elapsed=90.0 * np.arange(18), Inflation=83.0))
    found = sniff([tmp_path / "a.csv"]).recordings[0].guesses
    assert (found["t_s"].heading, found["p_kPa"].heading) == ("Elapsed", "Inflation")


@pytest.mark.parametrize(
    ("option", "value", "hint"),
    [
        ("unloaded_radius", 205.7, "millimetres"),
        ("unloaded_radius", 8.1, "inches"),
        ("nominal_load", 1.5, "kilonewtons"),
        ("nominal_pressure", 0.83, "bar"),
        ("nominal_pressure", 12.0, "psi"),
        ("name", "a/b", "cannot name"),
    ],
)
def test_a_value_that_a_build_would_refuse_is_refused_before_reading(tmp_path, option, value, hint):
    with pytest.raises(InputError, match=hint) as caught:
        pipeline.init_from([tmp_path / "none.csv"], tmp_path / "p", **{**GIVEN, option: value})
    assert caught.value.key == f"--{option.replace('_', '-')}"


def test_files_are_named_by_pattern_and_a_folder_is_refused_with_its_pattern(tmp_path):
    for name in "ba":
        (tmp_path / f"{name}.dat").write_text(table(P=83.0))
    assert [r.path.name for r in sniff([f"{tmp_path}/*.dat"]).recordings] == ["a.dat", "b.dat"]
    with pytest.raises(InputError, match="no file matches"):
        sniff([f"{tmp_path}/*.mat"])
    with pytest.raises(InputError, match=r"is a folder; name the files in it, for example .*\*\.dat"):
        sniff([tmp_path])
    with pytest.raises(InputError, match=r"no such file; correct its name$"):
        sniff([tmp_path / "nosuch.mat"])


@pytest.mark.parametrize(
    ("title", "size"),
    [
        ("Prüfstand Müller, Messung vom 3.4.2024", None),
        ("Prüfstand Müller Reifen: 16x7.5-10", "16x7.5-10"),
        ("title=Belt Tire=Maker 16x7.5-10", "Maker 16x7.5-10"),
        ("Tire: Maker 16x7.5-10\n[DATA]", "Maker 16x7.5-10"),
        ("Tire:\n[DATA]", None),
    ],
)
def test_a_title_names_a_tyre_only_after_the_word_tyre(tmp_path, title, size):
    (tmp_path / "a.csv").write_text(f"{title.replace(',', ' ')}\n{table(P=83.0)}", encoding="utf-8")
    written = project_text(
        sniff([tmp_path / "a.csv"]), tmp_path, Stated(unloaded_radius=0.2, nominal_load=1500.0)
    )
    assert (f'size = "{size}"' in written) if size else "\nsize" not in written


def test_a_column_of_doubtful_unit_is_left_out_and_the_rest_is_read(tmp_path):
    """A temperature of 300 is impossible in degC; it must not end sniff."""
    (tmp_path / "a.csv").write_text(table(P=83.0, TSTC=300.0))
    found = sniff([tmp_path / "a.csv"])
    assert "T_degC" not in found.recordings[0].guesses
    assert "p_kPa" in found.recordings[0].guesses
    (remark,) = [r for r in found.recordings[0].remarks if "TSTC" in r]
    assert remark.startswith("TSTC (300 to 300) is left out: in degC it is not within -60 to 250 degC")
    written = project_text(found, tmp_path, Stated(unloaded_radius=0.2, nominal_load=1500.0))
    assert "# TSTC (300 to 300) is left out" in written
    assert "T_degC" not in tomllib.loads(written)["columns"]


def test_a_spike_in_a_recording_casts_no_doubt_on_its_unit():
    spike = np.full(N, 60.0)
    spike[7] = 3000.0
    assert guessed(TSTC=spike).found["T_degC"].heading == "TSTC"
    spike[: N // 10] = 3000.0
    assert "T_degC" not in guessed(TSTC=spike).found


def test_an_angle_held_at_zero_is_in_the_unit_in_which_other_recordings_move_it(tmp_path):
    """Noise of 0.01 would be 0.01 rad, too; an angle that moves in either unit keeps its own."""
    noise = np.random.default_rng(2).normal(0.0, 0.01, (2, N))
    braked = {"SA": noise[0], "IA": noise[1], "SL": 0.1 * WAVE, "FX": 2300.0 * WAVE, "FY": 20.0 * WAVE}
    in_radians = {"SA": 0.15 * WAVE, "IA": np.full(N, 0.02)}
    for name, other in {"swept": {}, "braked": braked, "radians": in_radians}.items():
        pd.DataFrame(columns(**other)).to_csv(tmp_path / f"{name}.csv", index=False)

    def found(*names: str) -> list[str]:
        recordings = sniff([tmp_path / f"{name}.csv" for name in names]).recordings
        return [one.guesses["alpha_deg"].unit for one in recordings]

    assert found("swept", "braked") == ["deg", "deg"]
    assert found("radians", "swept") == ["rad", "deg"]


WRITTEN = """\
# From the recordings below, as `mffit sniff` reads them. The comments say where each value comes from.

[tyre]
name = "project"
# unloaded_radius =   # m: fill this in
# nominal_load =   # N, FNOMIN: fill this in
nominal_pressure = 83  # kPa, NOMPRES: the most frequent pressure
nominal_speed = 11.1  # m/s, LONGVL: the most frequent speed

[rig]
type = "flat-track"  # a straight path; for a disc, give path_centre and path_radius as well
axes = "sae"  # from the negative load

[columns]  # of all files
# no time: each row is treated as a finished point; if rows are samples of a recording, name its time under \
[columns], for example time_s = "..."
alpha_deg = { column = "SA", unit = "deg" }  # the file states no unit: -8 to 8 look like deg; SA, IA share a unit
gamma_deg = { column = "IA", unit = "deg" }  # the file states no unit: 2 to 2 look like deg; SA, IA share a unit
Fz_N = { column = "FZ", unit = "N" }  # the file states no unit: -2e+03 to -1e+03 look like N; FZ, FY share a unit
Fy_N = { column = "FY", unit = "N" }  # the file states no unit: -1.69e+03 to 1.7e+03 look like N; FZ, FY share a unit
Mz_Nm = { column = "MZ", unit = "N m" }  # the file states no unit: -37.3 to 37.3 look like N m
p_kPa = { column = "P", unit = "kPa" }  # the file states no unit: 83 to 83 look like kPa, less likely psi (572 kPa)
V_mps = { column = "V", unit = "km/h" }  # the file states no unit: 40 to 40 look like km/h (11 m/s), less likely mph (18 m/s)

[[sweep]]
file = "../a b.csv"

[[sweep]]
# N (3 to 3) is left out: at the speed in V, in m/s, km/h or mph, no wheel of this size turns at this rate
# P is in psi, so columns without a stated unit may be in American units, too: FZ (N or lbf), FY (N or lbf), MZ (N m or \
ft-lb), V (km/h or mph); if they are, write the unit under [columns], for example Fz_N = { column = "FZ", unit = "lbf" }
file = "../c.csv"
[sweep.columns]
alpha_deg = "alpha_deg"
p_kPa = { column = "P", unit = "psi" }  # the file states no unit: 12 to 14 look like psi (83 kPa), less likely bar (1200 kPa)
"""
"""The project file of the two recordings below: shared columns once, what differs below the file that has it."""


def two_recordings(folder: Path) -> list[Path]:
    """One with a constant pressure in kPa; one with two pressures in psi, another heading and a column of no wheel."""
    (folder / "a b.csv").write_text(table(P=83.0, V=40.0))
    other = table(P=np.repeat([12.0, 12.0, 14.0], 6), V=np.repeat([60.0, 40.0, 60.0], 6), N=3.0)
    (folder / "c.csv").write_text(other.replace("SA,", "alpha_deg,"))
    return [folder / "a b.csv", folder / "c.csv"]


def test_the_project_file_of_two_different_recordings(tmp_path):
    found = sniff(two_recordings(tmp_path))
    assert project_text(found, tmp_path / "project") == WRITTEN
    given = {"unloaded_radius": 0.2, "nominal_load": 1500.0, "nominal_pressure": 90.0, "name": 'q"'}
    lines = project_text(found, tmp_path / "project", Stated(**given)).splitlines()
    assert lines[3:7] == [
        'name = "q\\""', "unloaded_radius = 0.2  # m", "nominal_load = 1500  # N, FNOMIN",
        "nominal_pressure = 90  # kPa, NOMPRES",
    ]  # fmt: skip


def test_the_conditions_of_two_different_recordings_are_counted(tmp_path):
    found = sniff(two_recordings(tmp_path)).conditions
    rounded = {
        name: [(round(level.value, 2), level.points) for level in levels] for name, levels in found.items()
    }
    assert rounded == {
        "load": [(1000.0, 18), (2000.0, 18)],
        "camber": [(0.03, 36)],  # 2 deg
        "pressure": [(83_000.0, 30), (96_526.6, 6)],
        "speed": [(11.11, 24), (16.67, 12)],
    }


AMERICAN = {
    "FX": 60.0 / 4.448 * WAVE, "FY": -2300.0 / 4.448 * WAVE, "FZ": np.full(N, 2500.0 / 4.448),
    "MX": 30.0 / 1.3558 * WAVE, "MZ": 60.0 / 1.3558 * WAVE, "P": np.full(N, 35.0), "V": np.full(N, 24.6),
    "TSTC": np.full(N, 140.0), "RL": np.full(N, 11.2),
}  # fmt: skip
"""The sweep of ``columns`` in lbf, ft-lb, psi, mph, degF and inches."""


def test_a_tread_that_is_hot_only_in_fahrenheit_shows_american_units():
    found = units(**AMERICAN)
    assert (found["Fz_N"], found["Fy_N"], found["V_mps"], found["T_degC"]) == ("lbf", "lbf", "mph", "degF")
    assert (found["Mz_Nm"], found["p_kPa"], found["RL_m"]) == ("ft-lb", "psi", "in")
    assert units(**AMERICAN | {"MZ": 12.0 * AMERICAN["MZ"], "MX": 12.0 * AMERICAN["MX"]})["Mz_Nm"] == "in-lb"
    assert not [remark for remark in guessed(**AMERICAN).remarks if "American" in remark]


def test_a_pressure_in_kPa_beside_a_hot_tread_leaves_the_forces_in_newtons():
    found = units(TSTC=np.full(N, 140.0))
    assert (found["Fz_N"], found["T_degC"], found["p_kPa"]) == ("N", "degF", "kPa")


def test_a_hot_tread_that_is_stated_in_degC_is_noticed():
    remarks = guessed({"TSTC": "deg C"}, TSTC=np.full(N, 166.0)).remarks
    assert any("TSTC (166 to 166) is stated in deg C, but no tread stays as hot" in r for r in remarks)


def test_a_loaded_radius_in_inches_does_not_end_the_reading():
    assert units(RL=np.full(N, 285.0))["RL_m"] == "mm"
    doubtful = guessed(RL=np.full(N, 11.2))
    assert "RL_m" not in doubtful.found
    assert any("RL (11.2 to 11.2) is left out: it may be in cm or in;" in r for r in doubtful.remarks)
    assert guessed(RL=np.full(N, 11.2), radius=0.3).found["RL_m"].unit == "in"


def test_a_nominal_load_above_all_loads_is_noticed(tmp_path):
    (tmp_path / "a.csv").write_text(table(P=83.0))
    found = sniff([tmp_path / "a.csv"])
    for nominal, is_noticed in ((2000.0, False), (3000.0, True)):
        written = project_text(found, tmp_path, Stated(unloaded_radius=0.2, nominal_load=nominal))
        assert ("above the highest load of 2000 N: check the unit of the load (N)" in written) == is_noticed


def test_the_heading_of_a_section_is_no_title(tmp_path):
    (tmp_path / "a.csv").write_text(f"[DATA]\n{table(P=83.0)}")
    found = sniff([tmp_path / "a.csv"])
    assert "DATA" not in project_text(found, tmp_path, Stated(unloaded_radius=0.2, nominal_load=1500.0))
    assert "DATA" not in text.sniff_summary(found)


def test_a_radius_that_fits_only_in_inches_shows_american_units_and_a_gauge_in_psi_does_not():
    found = units(**AMERICAN | {"TSTC": None}, radius=0.285)
    assert (found["RL_m"], found["Fz_N"], found["V_mps"]) == ("in", "lbf", "mph")
    gauge = guessed({"P": "psi"}, P=np.full(N, 12.0)).found
    assert (gauge["Fz_N"].unit, gauge["V_mps"].unit) == ("N", "m/s")


def test_a_rotation_under_the_name_of_the_contract_is_never_left_out():
    assert "omega_radps" in guessed(omega_radps=0.4 * WAVE).found


@pytest.mark.parametrize("silent", [{"SA": None}, {"ET": np.zeros(N)}])
def test_the_unit_of_a_time_that_shows_no_steering_is_called_unknown(silent):
    assert "not known" in guessed(**silent).found["time_s"].why


@pytest.mark.parametrize(("moment", "unit"), [(60.0, "ft-lb"), (720.0, "in-lb")])
def test_moments_too_large_in_newtons_show_american_units_with_a_gauge_in_psi(moment, unit):
    """60 ft-lb at 562 lbf have an arm of 33 mm, and 60 N m at 562 N one that exceeds half the radius of a kart's tyre."""
    american = {
        "P": np.full(N, 12.0),
        "FZ": np.full(N, 562.0),
        "FY": -517.0 * WAVE,
        "MZ": moment * WAVE,
        "MX": None,
        "FX": None,
    }
    found = units(radius=0.14, **american)
    assert (found["Fz_N"], found["Fy_N"], found["Mz_Nm"], found["V_mps"]) == ("lbf", "lbf", unit, "mph")
    assert units(radius=0.14, **american | {"MZ": 20.0 * WAVE})["Fz_N"] == "N"
    assert units(radius=0.14, **american | {"P": np.full(N, 83.0)})["Fz_N"] == "N"
