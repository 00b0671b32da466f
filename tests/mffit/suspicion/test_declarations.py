"""The declaration against the data: every wrong declaration is refused by name, and no right one is."""

from __future__ import annotations

import itertools
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from disc_project import SIDESLIP, disc_project, rows
from flat_belt import recording
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mffit import config as configuration
from mffit.errors import InputError
from mffit.pipeline import build
from mffit.pipeline.inputs import read_points
from mffit.points import make_points
from mffit.recordings import sniff
from mffit.suspicion.all_files import angles_exchanged, moment_reversed
from mffit.suspicion.single_files import unusual_file
from tir.conventions import FLIPPED

SAMPLES = Path(__file__).parents[3] / "samples"
COLUMNS = {"alpha": "alpha_deg", "Fy": "Fy_N", "Mz": "Mz_Nm"}


def report_in(project, axes: str) -> None:
    """Let the rig report in other axes, loads as positive magnitudes."""
    project.each(**{COLUMNS[channel]: -1.0 for channel in FLIPPED[axes] if channel in COLUMNS})


def load(project):
    return read_points(configuration.load(project.write()))[:2]


def refusal(project) -> InputError:
    with pytest.raises(InputError) as caught:
        load(project)
    return caught.value


@pytest.mark.parametrize(("true", "declared"), list(itertools.permutations(FLIPPED, 2)))
def test_wrong_axes_are_refused_and_the_right_ones_named(project, true, declared):
    report_in(project, true)
    project.config["rig"]["axes"] = declared
    error = refusal(project)
    assert error.key == "rig.axes"
    assert f'agree with axes = "{true}"' in str(error)


@pytest.mark.parametrize("axes", list(FLIPPED))
def test_all_axes_give_the_same_points(project, axes):
    reference, _ = load(project)
    report_in(project, axes)
    project.config["rig"]["axes"] = axes
    found, warnings = load(project)
    assert warnings == ()
    for name in ("alpha", "gamma", "Fz", "Fy", "Mz"):
        np.testing.assert_array_equal(getattr(found, name), getattr(reference, name))


@pytest.mark.parametrize("axes", list(FLIPPED))
def test_the_wrong_path_centre_is_refused_by_name(project, axes):
    report_in(project, axes)
    project.config["rig"] |= {"axes": axes, "path_centre": "right"}
    error = refusal(project)
    assert error.key == "rig.path_centre"
    assert 'agree with path_centre = "left"' in str(error)


def test_wrong_axes_and_path_centre_together_are_both_named(project):
    report_in(project, "sae")
    project.config["rig"] |= {"path_centre": "right"}
    assert 'axes = "sae" and path_centre = "left"' in str(refusal(project))


@pytest.mark.parametrize("vertical", [False, True], ids=["load along wheel", "vertical load"])
@pytest.mark.parametrize("declared", ["W", "C"])
def test_forces_in_the_other_frame_are_asked_for_by_name(project, declared, vertical):
    """Signs agree in both frames; the camber thrust is about 1 larger or smaller in the wrong one."""
    true = "C" if declared == "W" else "W"
    if true == "C":
        lean_forces(project, vertical)
    project.config["rig"]["force_frame"] = declared
    _, warnings = load(project)
    (said,) = (one for one in warnings if "Fz tan(gamma)" in one)
    assert f'with force_frame = "{true}"' in said
    project.config["rig"]["force_frame"] = true
    assert not any("Fz tan(gamma)" in one for one in load(project)[1])


@pytest.mark.parametrize("vertical", [False, True], ids=["load along wheel", "vertical load"])
def test_frame_c_gives_the_points_of_frame_w(project, vertical):
    reference, _ = load(project)
    lean_forces(project, vertical)
    project.config["rig"]["force_frame"] = "C"
    found, warnings = load(project)
    np.testing.assert_allclose(found.Fy, reference.Fy, atol=1e-6)
    np.testing.assert_allclose(found.Fz, reference.Fz, atol=1e-6)
    np.testing.assert_allclose(found.Mz, reference.Mz, atol=1e-6)
    assert vertical == any("vertical load" in sentence for sentence in warnings)


def lean_forces(project, vertical: bool) -> None:
    """Report what cells in the wheel carrier read, from unit vectors of the leaning wheel."""
    for table in project.tables.values():
        gamma = np.radians(table["gamma_deg"])
        force = np.column_stack([table["Fy_N"], table["Fz_N"]])
        # Top of the wheel to -y with gamma > 0.
        upwards = np.column_stack([-np.sin(gamma), np.cos(gamma)])
        sideways = np.column_stack([np.cos(gamma), np.sin(gamma)])
        table["Fy_N"] = np.sum(force * sideways, axis=1)
        if not vertical:
            table["Fz_N"] = np.sum(force * upwards, axis=1)
        table["Mz_Nm"] *= np.cos(gamma)  # Mz along the leaning axis; My is zero here


def test_a_moment_of_the_wrong_sign_is_refused_by_name(project):
    project.each(Mz_Nm=-1.0)
    assert "Mz_Nm" in str(refusal(project))
    assert "scale = -1" in str(refusal(project))


def test_backward_runs_labelled_forward_in_their_angles_are_refused(project):
    for Fz in (1000, 1500):
        project.tables[f"backward_{Fz}.csv"]["alpha_deg"] *= -1.0
    assert "backward" in str(refusal(project))


@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    shift=st.floats(-1.0, 1.0),
    offset=st.floats(-40.0, 40.0),
    camber=st.floats(-1.0, 1.0),
    noise=st.floats(0.0, 25.0),
    seed=st.integers(0, 10_000),
)
def test_rig_faults_are_not_taken_for_wrong_axes(tmp_path_factory, shift, offset, camber, noise, seed):
    """A sideslip axis up to a degree out, camber zero, load-cell zero and noise: backward runs are there."""
    project = disc_project(tmp_path_factory.mktemp("rig"))
    for number, (name, table) in enumerate(list(project.tables.items())):
        way = -1 if name.startswith("backward") else 1
        true = rows(
            table["alpha_deg"] + shift, table["gamma_deg"] + camber, table["Fz_N"].iloc[0],
            direction=way, noise=noise, seed=seed + number,
        )  # fmt: skip
        project.tables[name] = table.assign(Fy_N=true["Fy_N"] + offset, Mz_Nm=true["Mz_Nm"])
    load(project)


def test_with_backward_runs_a_force_reversed_by_misalignment_is_not_taken_for_a_wrong_centre(project):
    """1 deg at 13 Fz/rad is 0.227 Fz, against a turn-slip force of 0.22 Fz."""
    for name, table in project.tables.items():
        way = -1 if name.startswith("backward") else 1
        true = rows(table["alpha_deg"] - 1.1, table["gamma_deg"], table["Fz_N"].iloc[0], direction=way)
        project.tables[name] = table.assign(Fy_N=true["Fy_N"], Mz_Nm=true["Mz_Nm"])
    found, _ = load(project)
    zero = (found.alpha == 0.0) & (found.gamma == 0.0) & (found.direction > 0)
    assert np.all(found.Fy[zero] * found.phi_t[zero] < 0.0)  # the premise: it points inwards


def test_without_backward_runs_misalignment_is_named_beside_the_path_centre(project):
    project.keep(*(name for name in project.tables if not name.startswith("backward")))
    project.config["rig"]["path_centre"] = "right"
    text = str(refusal(project))
    assert 'path_centre = "left"' in text
    assert "backward runs would show" in text


@pytest.mark.parametrize("column", ["alpha_deg", "gamma_deg"])
def test_angles_in_radians_are_refused_with_file_and_column(project, column):
    name = "sideslip_1500.csv" if column == "alpha_deg" else "camber_1500.csv"
    project.tables[name][column] = np.radians(project.tables[name][column])
    error = refusal(project)
    assert error.column == column
    assert error.file.name == name
    assert 'unit = "rad"' in str(error)


@pytest.mark.parametrize("span", [0.3, 0.15, 0.05])
def test_small_angles_are_not_taken_for_radians(project, span):
    """An alignment file of a few hundredths of a degree, with 5 N of noise."""
    project.add("fine.csv", rows(np.linspace(-span, span, 9), 0.0, seed=9))
    load(project)


def test_side_forces_in_kilonewtons_are_refused(project):
    project.each(Fy_N=1e-3)
    error = refusal(project)
    assert error.column == "Fy_N"
    assert 'unit = "kN"' in str(error)


def test_moments_in_newton_millimetres_are_refused(project):
    project.each(Mz_Nm=1e3)
    assert "N mm" in str(refusal(project))


@pytest.mark.parametrize("column", ["alpha_deg", "gamma_deg"])
def test_a_disc_needs_both_signs(project, column):
    for name, table in project.tables.items():
        project.tables[name] = table[table[column] >= 0.0]
    error = refusal(project)
    assert error.column == column
    assert "mirrored" in str(error)


def test_a_disc_needs_a_forward_zero(project):
    for name, table in project.tables.items():
        if not name.startswith("backward"):
            project.tables[name] = table[(table["alpha_deg"].abs() > 0.4) | (table["gamma_deg"].abs() > 1)]
    assert "no forward point" in str(refusal(project))


def test_a_flat_track_needs_no_mirrors_and_no_zero(project):
    project.config["rig"] = {"type": "flat-track"}
    project.tables.clear()
    project.config["sweep"].clear()
    table = rows(SIDESLIP[SIDESLIP > 0.5], 2.0, side=0.0)
    project.add("half.csv", table)
    found, warnings = load(project)
    assert np.all(found.phi_t == 0.0)
    assert len(warnings) == 1
    assert "one load" in warnings[0]


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda p: p.keep("sideslip_1500.csv", "camber_1500.csv", "backward_1500.csv"), "one load"),
        (lambda p: p.keep(*(n for n in p.tables if "backward" not in n)), "no backward runs"),
        (
            lambda p: [t.pop("Mz_Nm") for t in p.tables.values()],
            "Mz_Nm was not measured: the coefficients of the self-aligning moment",
        ),
    ],
)
def test_thin_programmes_cause_warnings_only(project, spoil, said):
    spoil(project)
    _, warnings = load(project)
    assert any(said in sentence for sentence in warnings)


def test_evenly_spread_loads_are_not_one_load(project):
    """Each was within 8 % of the next, and all were called one load."""
    project.config["rig"] = {"type": "flat-track", "axes": "iso"}
    project.keep()
    alpha, loads = np.tile(SIDESLIP, 30), np.linspace(800.0, 2200.0, 30 * len(SIDESLIP))
    project.add("spread.csv", rows(alpha, 0.0, loads, side=0.0))
    _, warnings = load(project)
    assert not any("one load" in sentence for sentence in warnings)


@pytest.mark.parametrize("declared", ["contact", "wheel-centre"])
def test_moments_about_another_point_than_declared_are_refused_by_name(project, declared):
    """A tyre of 0.3 m whose overturning moment about the contact point is a hundredth of the side force."""
    true = {"contact": "wheel-centre", "wheel-centre": "contact"}[declared]
    for table in project.tables.values():
        gamma = np.radians(table["gamma_deg"])
        lever = np.cos(gamma) * table["Fy_N"] + np.sin(gamma) * table["Fz_N"]
        table["Mx_Nm"] = -0.01 * table["Fy_N"] + (0.3 * lever if true == "wheel-centre" else 0.0)
    project.config["rig"]["moments"] = declared
    error = refusal(project)
    assert error.key == "rig.moments"
    assert f'agree with moments = "{true}"' in str(error)
    project.config["rig"]["moments"] = true
    found, _ = load(project)
    assert np.max(np.abs(found.Mx + 0.01 * found.Fy)) < 5.0


@pytest.mark.parametrize("qsx3", [0.03, 0.1193791, -0.1])
@pytest.mark.parametrize("driven", [False, True])
def test_mx_of_the_wrong_sign_is_told_by_camber_whatever_sideslip_does(qsx3, driven):
    """Coefficients of a public tyre, MagicFormula61.tir, whose Mx rises with sideslip; the book's Mx = R0 Fz (...)."""
    alpha, gamma, Fz = (
        x.ravel() for x in np.meshgrid(np.radians(np.linspace(-8, 8, 33)), np.radians([0, 2, 4]), [2e3, 4e3])
    )
    Fy = -1.1 * Fz * np.tanh(12.0 * alpha) - 0.7 * Fz * gamma
    Mx = 0.3 * Fz * (-0.00055 - 2.178564 * gamma - qsx3 * Fy / 4e3) - 10.0
    kappa = np.tile([0.1, -0.1], len(alpha) // 2) if driven else 0.0
    config = configuration.load(
        {
            "tyre": {"name": "t", "unloaded_radius": 0.3, "nominal_load": 4000, "nominal_pressure": 200},
            "rig": {"type": "flat-track"},
            "sweep": [{"file": "any.csv"}],
        }
    )
    found = []
    for sign in (1.0, -1.0):
        points = make_points(alpha, gamma, Fz, p=2e5, V=10.0, phi_t=0.0, Fy=Fy, Mx=sign * Mx, kappa=kappa)
        found.append([moment_reversed.said(facts) for facts in moment_reversed.find(points, config)])
    assert found[0] == []
    assert "scale = -1 for Mx_Nm" in found[1][0]


def test_a_recording_with_mx_of_the_wrong_sign_is_told_so(tmp_path):
    table = recording(pressures=(83.0,))
    table["MX"] += -0.2 * table["FZ"].abs() * np.radians(table["IA"])
    for sign in (1.0, -1.0):
        table.assign(MX=sign * table["MX"]).to_csv(tmp_path / "a.csv", index=False)
        said = [
            one for one in sniff([tmp_path / "a.csv"]).reading.warnings if "Mx_Nm has the wrong sign" in one
        ]
        assert bool(said) is (sign < 0.0)


@pytest.mark.parametrize("exchanged", [False, True])
def test_sideslip_and_camber_exchanged_in_all_files_are_asked_for(project, exchanged):
    """The tables of a disc keep both directions and zeros, which are the same in both angles."""
    config = configuration.load(project.write())
    points = read_points(config).points
    points = points.replace(alpha=points.gamma, gamma=points.alpha) if exchanged else points
    said = [angles_exchanged.said(facts) for facts in angles_exchanged.find(points, config)]
    assert [bool(re.search(r"Fy_N changes \d+ times as fast with gamma_deg", one)) for one in said] == [
        True
    ] * exchanged


def test_angles_exchanged_in_all_files_are_named_because_a_fit_agrees_with_them_exchanged(tmp_path):
    path = tmp_path / "belt" / "tyre.toml"
    shutil.copytree(SAMPLES / "flat-track", path.parent)
    columns = '[columns]\nalpha_deg = "gamma_deg"\ngamma_deg = "alpha_deg"\n\n'
    path.write_text(path.read_text(encoding="utf-8").replace("[[sweep]]", f"{columns}[[sweep]]", 1))
    with pytest.raises(InputError, match=r"are exchanged: .* falls from \d\d\.\d to 7\.\d+ N") as caught:
        build(path)
    assert caught.value.column == "alpha_deg"


def test_the_angles_of_a_zero_exchanged_may_be_what_makes_it_steep_in_camber(project):
    points = read_points(configuration.load(project.write())).points
    zeros = points.select((points.gamma == 0.0) & (np.abs(points.alpha) <= np.radians(1.0)))
    config = configuration.load(project.write())
    swapped = zeros.replace(alpha=zeros.gamma, gamma=zeros.alpha)
    facts = next(iter(unusual_file.find(swapped, config)))
    assert "its camber in rad" in facts["looks"]
    assert facts["looks"].endswith(
        "Or it looks like sideslip and camber exchanged: correct the headings alpha_deg and gamma_deg"
    )
