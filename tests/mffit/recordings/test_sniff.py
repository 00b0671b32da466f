"""From a recording to a property file, given only radius and load."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from disc_project import side_force
from flat_belt import CAMBERS, LOADS, recording, write_mat, write_mat73

from mffit import config as configuration
from mffit import pipeline
from mffit.cli import main
from mffit.errors import InputError
from mffit.recordings import sniff
from mffit.report import text

GIVEN = {"unloaded_radius": 0.2057, "nominal_load": 1500.0}


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    return write_mat(recording(sigma=0.3), tmp_path_factory.mktemp("machine") / "cornering.mat")


def test_conditions_axes_and_columns_are_found(machine):
    found = sniff([machine])
    assert found.axes == ("sae",)
    values = {name: [level.value for level in levels] for name, levels in found.conditions.items()}
    np.testing.assert_allclose(values["load"], LOADS, rtol=0.01)
    np.testing.assert_allclose(np.degrees(values["camber"]), CAMBERS, atol=0.05)
    np.testing.assert_allclose(values["pressure"], [83e3, 97e3], rtol=0.01)
    np.testing.assert_allclose(values["speed"], [11.0], rtol=0.01)
    guesses = found.recordings[0].guesses
    assert {name: guesses[name].heading for name in ("alpha_deg", "Fz_N", "T_degC", "kappa")} == {
        "alpha_deg": "SA", "Fz_N": "FZ", "T_degC": "TSTC", "kappa": "SL",
    }  # fmt: skip
    assert found.recordings[0].rate == pytest.approx(100.0)
    assert found.recordings[0].samples == 18 * 1500  # conditions, of 15 s each
    assert found.recordings[0].seconds == pytest.approx(18 * 15.0 - 0.01)
    assert found.recordings[0].gaps == 0
    said = text.sniff_summary(found)
    for word in ("SA", "alpha_deg", "kph", "axes: sae", "Tyre A", "100 samples per second"):
        assert word in said


def test_gaps_in_time_are_counted(tmp_path):
    table = recording(loads=(600.0, 1500.0), cambers=(0.0, 2.0), pressures=(83.0,), gaps=True)
    (found,) = sniff([write_mat73(table, tmp_path / "a.mat")]).recordings
    assert (found.gaps, found.rate) == (3, pytest.approx(100.0))
    assert found.seconds == pytest.approx(4 * 15.0 - 3.0 - 0.01)  # the first rest is cut off


def iso(table: pd.DataFrame) -> pd.DataFrame:
    return table.assign(SA=-table["SA"], FY=-table["FY"], FZ=-table["FZ"], MZ=-table["MZ"])


@pytest.mark.parametrize(
    ("turned", "axes"),
    [
        (lambda t: t, ("sae",)),
        (iso, ("iso",)),
        (lambda t: iso(t).assign(FY=t["FY"], MZ=t["MZ"]), ("adapted-sae",)),
        (lambda t: t.assign(FZ=-t["FZ"]), ("sae",)),
        (lambda t: t.assign(FY=-t["FY"]), ()),
    ],
)
def test_the_axes_follow_from_physics(tmp_path, turned, axes):
    assert sniff([write_mat73(turned(recording(pressures=(83.0,))), tmp_path / "a.mat")]).axes == axes


def test_without_camber_the_axes_stay_open_with_a_remark(tmp_path):
    table = iso(recording(cambers=(0.0,), pressures=(83.0,)))
    found = sniff([write_mat73(table, tmp_path / "a.mat")])
    assert found.axes == ("iso", "sae")  # first those that the sign of the load suggests
    said = text.sniff_summary(found)
    assert '"sae" would fit, too, as camber does not change' in said
    assert "camber thrust" not in said
    assert "from the slope of side force over sideslip and" in said


def test_the_evidence_for_the_axes_is_what_the_recording_holds(tmp_path):
    """A negative load and camber are evidence only where they are recorded."""

    def reason(table) -> str:
        return text.sniff_summary(sniff([write_mat73(table, tmp_path / "a.mat")])).partition("axes: ")[2]

    whole = recording(pressures=(83.0,))
    assert reason(whole).startswith("sae (from the slope of side force over sideslip")
    assert "the slope of side force over camber" in reason(whole).partition("\n")[0]
    assert "and the negative load)" in reason(whole)
    assert "load" not in reason(iso(whole)).partition("\n")[0]
    assert "moment" not in reason(whole.drop(columns="MZ")).partition("\n")[0]


def test_units_that_a_file_does_not_state_are_marked_as_assumed(tmp_path):
    table = recording(pressures=(83.0,))
    table = table.assign(P=table["P"] / 100.0, FZ=table["FZ"] / 1e3, V=table["V"] / 3.6)
    table.to_csv(tmp_path / "a.csv", index=False)
    _, written = pipeline.init_from([tmp_path / "a.csv"], tmp_path / "project", **GIVEN)
    assert configuration.load(written[0]).tyre.name == "project"
    _, beside = pipeline.init_from([tmp_path / "a.csv"], tmp_path, **GIVEN)
    assert configuration.load(beside[0]).tyre.name == "a"
    content = tomllib.loads(written[0].read_text())
    assert content["columns"]["Fz_N"] == {"column": "FZ", "unit": "kN"}
    assert content["columns"]["p_kPa"] == {"column": "P", "unit": "bar"}
    assert content["columns"]["V_mps"] == {"column": "V", "unit": "m/s"}
    assert "the file states no unit" in written[0].read_text()
    assert "# u_slip_alignment_N = 25  # side force" in written[0].read_text()
    assert "about 0.1 deg of this tyre" in written[0].read_text()
    assert content["tyre"]["nominal_pressure"] == pytest.approx(83, abs=1)


def test_recordings_whose_names_differ_by_a_sign_have_a_picture_each(tmp_path):
    files = [tmp_path / "run_+4.csv", tmp_path / "run_-4.csv"]
    for file in files:
        recording(cambers=CAMBERS[:1], pressures=(83.0,)).to_csv(file, index=False)
    _, written = pipeline.init_from(files, tmp_path / "project", **GIVEN)
    assert sorted(path.name for path in written if path.suffix == ".png") == ["run_-4-1.png", "run_-4-2.png"]


def test_from_the_recording_to_the_property_file(tmp_path, capsys):
    """The tyre's own curve, which lags and scatters in the recording, to 3 % of the load."""
    machine = write_mat(
        recording(sigma=0.3, cambers=CAMBERS[:2], pressures=(83.0,)), tmp_path / "cornering.mat"
    )
    project = tmp_path / "project"
    options = ["--unloaded-radius", "0.2057", "--nominal-load", "1500"]
    main(["init", "--from", str(machine), str(project), *options])
    assert "written" in capsys.readouterr().out
    content = tomllib.loads((project / "tyre.toml").read_text())
    assert content["tyre"]["name"] == "project"
    assert content["tyre"]["size"] == "Tyre A, 7 inch"
    assert content["rig"] == {"type": "flat-track", "axes": "sae"}
    assert (project / "cornering.png").stat().st_size > 10_000
    stretches = pd.read_csv(project / "stretches.csv")
    assert (stretches["points"] > 0).sum() >= 6
    result = pipeline.build(project / "tyre.toml", project / "out", with_report=False)
    alpha = np.radians(np.linspace(-8.0, 8.0, 33))
    for load in LOADS:
        truth = side_force(alpha, 0.0, load, side=0.0)
        assert (
            np.sqrt(np.mean((result.tyre(load, alpha=alpha, p=83e3, Vx=11.0).Fy - truth) ** 2)) < 0.03 * load
        )
    points = pd.read_csv(project / "out" / "points.csv")
    assert set(points["sweep"]) >= {"cornering:01", "cornering:06"}
    assert {"file", "line", "direction", "mount", "T_degC"} <= set(points)
    pd.testing.assert_frame_equal(
        pd.read_csv(project / "out" / "stretches.csv")[["points"]], stretches[["points"]]
    )


def test_the_written_project_is_valid_and_its_resolved_form_too(machine, tmp_path):
    _, written = pipeline.init_from([machine], tmp_path / "p", nominal_pressure=90.0, name="a-b", **GIVEN)
    found = configuration.load(written[0])
    assert (found.tyre.name, found.tyre.nominal_pressure) == ("a-b", 90.0)
    again = configuration.load(configuration.resolved(found, folder=tmp_path / "p"), folder=tmp_path / "p")
    assert again.columns == found.columns


def test_a_value_that_recordings_do_not_state_is_asked_for(machine, tmp_path):
    with pytest.raises(InputError, match="--unloaded-radius"):
        pipeline.init_from([machine], tmp_path / "p", unloaded_radius=None, nominal_load=1500.0)
    with pytest.raises(InputError, match="free radius and the nominal load of the tyre"):
        pipeline.init_from([machine], tmp_path / "p", unloaded_radius=None, nominal_load=None)
    assert not (tmp_path / "p").exists()


def test_nothing_is_overwritten(machine, tmp_path):
    (tmp_path / "tyre.toml").write_text("mine")
    with pytest.raises(InputError, match="there already"):
        pipeline.init_from([machine], tmp_path, **GIVEN)
    assert (tmp_path / "tyre.toml").read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["tyre.toml"]


def test_a_driven_recording_without_its_force_is_described_but_gives_no_project(tmp_path):
    table = recording(pressures=(83.0,)).drop(columns="FX")
    table["SL"] = 0.1 * np.sin(np.arange(len(table)) / 50.0)
    table["SL"] += 0.2
    path = write_mat73(table, tmp_path / "drive.mat")
    found = sniff([path])
    assert "driven or braked" in text.sniff_summary(found)
    with pytest.raises(InputError, match="driven or braked"):
        pipeline.init_from([path], tmp_path / "p", **GIVEN)


@pytest.mark.parametrize("hostile", ['a"b', "x\ny", "[[sweep]]", "<script>", "\\", "# no"])
def test_texts_of_a_file_stay_texts(tmp_path, hostile):
    path = write_mat73(recording(loads=(1500.0,), pressures=(83.0,)), tmp_path / "a.mat", tireid=hostile)
    _, written = pipeline.init_from([path], tmp_path / "p", **GIVEN)
    content = tomllib.loads(written[0].read_text())
    assert content["tyre"].get("size", hostile) == hostile
    assert set(content) == {"tyre", "rig", "columns", "sweep"}


def test_the_command_prints_the_project_file(machine, capsys):
    main(["sniff", str(machine)])
    printed = capsys.readouterr().out
    start = printed.index("[tyre]")
    assert tomllib.loads(printed[start:])["columns"]["alpha_deg"] == "SA"


def test_recordings_behind_the_folder_are_put_right(tmp_path, capsys):
    (tmp_path / "run.csv").write_text("alpha_deg\n0\n")
    with pytest.raises(SystemExit):
        main(["init", str(tmp_path / "project"), "--from", str(tmp_path / "run.csv")])
    said = " ".join(capsys.readouterr().err.split())
    assert f"mffit init --from {tmp_path / 'run.csv'} {tmp_path / 'project'}" in said


@pytest.mark.parametrize(
    "arguments", [["init", "--from", "only-one"], ["init", "a", "b"], ["sniff", "missing.mat"]]
)
def test_bad_usage_is_one_sentence(arguments, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    error = capsys.readouterr().err
    assert error.startswith("mffit: ")
    assert error.count("\n") == 1


def test_negative_speeds_are_rolling_backwards_if_the_forces_say_so(tmp_path):
    """Backwards, the slip force of a reading turns, and camber thrust does not; a belt that counts backwards turns nothing."""
    table = iso(recording(loads=(600.0, 1500.0), cambers=(0.0, 4.0), pressures=(83.0,)))
    alpha, gamma = np.radians(table["SA"]), np.radians(table["IA"])
    slip = side_force(alpha, 0.0 * gamma, table["FZ"], side=0.0)
    lean = side_force(0.0 * alpha, gamma, table["FZ"], side=0.0)
    belt = table.assign(V=-table["V"])
    back = belt.assign(FY=lean - slip)
    for name, one, backward in (("belt", belt, False), ("wheel", back, True)):
        (recorded,) = sniff([write_mat(one, tmp_path / f"{name}.mat")]).recordings
        assert recorded.backward == backward
        assert recorded.guesses["V_mps"].scale == -1.0
    _, written = pipeline.init_from([tmp_path / "wheel.mat"], tmp_path / "p", **GIVEN, belt=True)
    content = written[0].read_text()
    assert 'direction = "backward"  # from the sign of the speed' in content
    found = pipeline.inputs.read_points(configuration.load(written[0])).points
    assert np.all(found.direction == -1)
    assert np.median(found.V) == pytest.approx(11.0, rel=0.01)


def signed(path: Path, reversed_columns: tuple[str, ...]) -> Path:
    """Finished points of a tyre in ISO signs, Fy falls with both angles and Mz rises with sideslip, with columns reversed."""
    alpha, gamma, Fz = (x.ravel() for x in np.meshgrid(np.arange(-6.0, 7.0), (-3.0, 0.0, 3.0), (2e3, 4e3)))
    Fy = -Fz * np.tanh(12.0 * np.radians(alpha) + np.radians(gamma))
    table = pd.DataFrame({"SA": alpha, "IA": gamma, "FZ": Fz, "FY": Fy, "MZ": -0.03 * Fy, "P": 200.0})
    for heading in reversed_columns:
        table[heading] *= -1.0
    units = {"SA": "deg", "IA": "deg", "FZ": "N", "FY": "N", "MZ": "Nm", "P": "kPa"}
    table.rename(columns=lambda name: f"{name} [{units[name]}]").to_csv(path, index=False)
    return path


@pytest.mark.parametrize("reversed_columns", [("FZ",), ("SA",), ("MZ",), ("SA", "IA", "FZ"), ("FY",)])
def test_a_single_reversed_column_is_named_with_the_axes(tmp_path, reversed_columns):
    """Each cure is tried: without this column's sign the axes agree."""
    headings = {"Fz_N": "FZ", "alpha_deg": "SA", "gamma_deg": "IA", "Fy_N": "FY", "Mz_Nm": "MZ"}
    found = sniff([signed(tmp_path / "a.csv", reversed_columns)])
    assert not found.axes
    assert found.reversible
    for (name,), axes in found.reversible:
        turned = {headings[name]} ^ set(reversed_columns)
        assert axes in sniff([signed(tmp_path / "b.csv", tuple(turned))]).axes
        said = f'{name} = {{ column = "{headings[name]}", scale = -1 }} under [columns] with axes = "{axes}"'
        assert said in text.sniff_summary(found)
        with pytest.raises(InputError, match="all signs agree with"):
            pipeline.init_from([tmp_path / "a.csv"], tmp_path / "p", unloaded_radius=0.3, nominal_load=3e3)
    if reversed_columns == ("FZ",):
        assert found.reversible[0] == (("Fz_N",), "iso")


def test_two_reversed_columns_are_named_with_the_axes(tmp_path):
    found = sniff([signed(tmp_path / "a.csv", ("FY", "FZ"))])
    assert not found.axes
    assert (("Fz_N", "Fy_N"), "iso") in found.reversible
    assert all(len(names) == 2 for names, _ in found.reversible)
    said = 'Fz_N = { column = "FZ", scale = -1 } and Fy_N = { column = "FY", scale = -1 } under [columns] with axes = "iso"'
    assert said in " ".join(text.sniff_summary(found).split())


@pytest.mark.parametrize("heading", ["RunNo", "Run", "Test No.", "Versuch", "run_nr"])
def test_a_column_of_runs_is_known_by_its_usual_names(tmp_path, heading):
    path = signed(tmp_path / "a.csv", ())
    table = pd.read_csv(path)
    table.assign(**{heading: np.arange(len(table)) * 2 // len(table)}).to_csv(path, index=False)
    assert sniff([path]).recordings[0].guesses["run"].heading == heading
    table.assign(**{heading: np.arange(len(table))}).to_csv(path, index=False)  # numbers of rows
    assert "run" not in sniff([path]).recordings[0].guesses


def test_points_of_a_camber_sweep_are_not_counted_as_upright(tmp_path):
    at = [*((0, gamma) for gamma in range(-50, 51, 10)), *((alpha, 0) for alpha in np.arange(-5, 5.1, 0.5))]
    rows = [f"{alpha},{gamma},900,{-150 * alpha - 10 * gamma}" for alpha, gamma in at]
    (tmp_path / "a.csv").write_text("alpha_deg,gamma_deg,Fz_N,Fy_N\n" + "\n".join(rows) + "\n")
    held, swept = sniff([tmp_path / "a.csv"]).conditions["camber"]
    assert (held.value, held.points, held.upper) == (0.0, 22, None)
    assert np.degrees([swept.value, swept.upper]) == pytest.approx([-50.0, 50.0])
    assert swept.points == 10
