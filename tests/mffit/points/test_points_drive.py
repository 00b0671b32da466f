"""Sweeps of longitudinal slip become points, with the force that belongs to the slip."""

from __future__ import annotations

from itertools import count

import numpy as np
import pytest
from flat_belt import (
    LOADS,
    RATE,
    SPEED,
    drive_recording,
    loaded_radius,
    longitudinal_force,
    recording,
    rolling_radius,
    write_mat73,
)

from mffit import config as configuration
from mffit import points
from mffit.config.models import FitTable
from mffit.errors import InputError
from mffit.points.stretch import SWEEP

NUMBERS = count()
COLUMNS = {
    "time_s": "ET", "alpha_deg": "SA", "gamma_deg": "IA", "Fz_N": "FZ", "Fy_N": "FY", "Mz_Nm": "MZ", "p_kPa": "P", "V_mps": "V",
    "T_degC": "TSTC", "kappa": "SL", "Fx_N": "FX",
}  # fmt: skip


@pytest.fixture(scope="module")
def configured(tmp_path_factory):
    folder = tmp_path_factory.mktemp("drive")

    def of(table, columns=COLUMNS):
        tyre = {"name": "x", "unloaded_radius": 0.228, "nominal_load": 1500.0, "nominal_pressure": 83.0}
        return configuration.load(
            {
                "tyre": tyre,
                "rig": {"type": "flat-track", "axes": "sae"},
                "columns": columns,
                "sweep": [{"file": str(write_mat73(table, folder / f"{next(NUMBERS)}.mat"))}],
            }
        )

    return of


@pytest.fixture(scope="module")
def plain(configured):
    """The reading of the usual recording."""
    return points.read(configured(drive_recording()))


def sweeps(found):
    return [note for note in found.stretches if note.kind == SWEEP and not note.dropped]


@pytest.mark.parametrize("gaps", [True, False])
def test_every_condition_of_a_drive_recording_is_a_sweep_of_slip(configured, plain, gaps):
    notes = sweeps(plain if gaps else points.read(configured(drive_recording(gaps=False))))
    assert {note.swept for note in notes} == {"kappa"}
    conditions = {
        (
            min(LOADS, key=lambda load: abs(load - note.Fz_N)),  # a brake moves it by some per cent
            round(note.gamma_deg),
            round(note.alpha_from_deg + 0.05),
        )
        for note in notes
    }
    assert conditions == {(load, camber, slip) for load in LOADS for camber in (0, 3) for slip in (0, -3)}
    assert len(notes) == 12
    assert all(note.kappa_from < -0.14 and note.kappa_to > 0.14 for note in notes)


def test_the_points_of_a_slip_sweep_have_slip_and_force_of_the_same_moment(plain):
    found = plain.points
    kappa, Fx = found.kappa, found.Fx
    truth = longitudinal_force(kappa, found.alpha, found.Fz)
    assert (
        np.sqrt(np.mean((Fx - truth) ** 2)) < 10.0
    )  # 15 N per sample, ten samples, and the bend of the curve
    assert np.ptp(kappa) > 0.28
    assert np.median(np.abs(np.diff(kappa))) < 0.014  # what it moves in one turn of the wheel


def test_a_wheel_that_is_not_round_leaves_no_ripple_in_the_points(configured, plain):
    """40 N once per turn, of 7.8 turns a second: means over seven samples, 0.007 of slip, would keep 16 N rms of it."""
    table = drive_recording()
    turned = np.cumsum(table["N"].to_numpy()) * 2.0 * np.pi / 60.0 / RATE
    rippled = table.assign(FX=table["FX"] + 40.0 * np.sin(turned))
    for more in ({}, {"omega_radps": "N"}):  # by the radius, or by the wheel's speed
        found = points.read(configured(rippled, COLUMNS | more)).points
        assert len(found) == pytest.approx(len(plain.points), rel=0.03)
        smooth = longitudinal_force(found.kappa, found.alpha, found.Fz)
        assert np.std(found.Fx - smooth) < 8.0


def test_no_point_is_a_mean_over_a_part_of_a_turn(configured, plain):
    """Behind the last whole turn of a sweep, and where its points are left out by hand, fewer samples remain than a turn has."""
    found, config = plain.points, configured(drive_recording())
    samples = found.last_line - found.line + 1
    assert samples.min() >= samples.max() - 2
    for sweep in (0, 3, 7):  # the first begins with the recording
        gone = found.sweep == sweep
        lines = f"{found.line[gone].min()}-{found.last_line[gone].max()}"
        out = FitTable(exclude=({"file": config.sweep[0].file, "lines": lines, "why": "x"},))
        left = points.read(config.model_copy(update={"fit": out})).points
        np.testing.assert_array_equal(left.line, found.line[~gone])
        np.testing.assert_allclose(left.Fx, found.Fx[~gone])


def test_the_points_of_a_fast_sweep_lie_on_the_curve(configured):
    """Two sweeps a second between slips of 0.1: a mean over 0.02 of slip would cut the bends by 20 N and more."""
    table = drive_recording(sideslips=(0.0,), cambers=(0.0,), swing=0.0)
    slip = 0.1 * np.sin(4.0 * np.pi * np.arange(len(table)) / RATE)
    Fz = -table["FZ"].to_numpy()
    fast = table.assign(
        SL=slip,
        FX=longitudinal_force(slip, 0.0 * slip, Fz),
        N=(1.0 + slip) * SPEED / rolling_radius(Fz, 0.228) * 60.0 / (2.0 * np.pi),
    )
    found = points.read(configured(fast)).points
    off = found.Fx - longitudinal_force(found.kappa, found.alpha, found.Fz)
    assert len(found) > 100
    assert np.max(np.abs(off) / found.Fz) < 0.006


def test_load_that_swings_with_the_force_is_one_condition(configured):
    """Belts hold the load less well while the wheel is driven; a swing of a tenth is no other set-point."""
    table = drive_recording(swing=0.1, sideslips=(0.0,), cambers=(0.0,))
    assert len(sweeps(points.read(configured(table)))) == 3


def test_slip_that_wanders_along_a_sideslip_sweep_changes_nothing(configured):
    table = recording(pressures=(83.0,), cambers=(0.0,), loads=(600.0, 1500.0))
    still = points.read(configured(table)).points
    random = np.random.default_rng(2)
    table["SL"] = 0.003 * np.sin(np.radians(10.0 * table["SA"])) + 0.001 * random.standard_normal(len(table))
    found = points.read(configured(table))
    assert {note.swept for note in sweeps(found)} == {"alpha_deg"}
    assert np.array_equal(found.points.Fy, still.Fy)


def test_sideslip_may_be_swept_at_a_slip_that_is_held(configured):
    table = recording(pressures=(83.0,), cambers=(0.0,), loads=(600.0, 1500.0), gaps=True)
    table["SL"] = -0.05
    found = points.read(configured(table))
    assert {note.swept for note in sweeps(found)} == {"alpha_deg"}
    assert np.allclose(found.points.kappa, -0.05)


def test_without_a_longitudinal_force_only_free_rolling_is_kept(configured):
    columns = {name: heading for name, heading in COLUMNS.items() if name != "Fx_N"}
    found = points.read(configured(drive_recording(gaps=False, cambers=(0.0,)), columns))
    assert np.all(np.abs(found.points.kappa) < 0.02)
    assert any("Fx was not measured" in warning for warning in found.warnings)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda slip: slip + 0.3, "no radius explains"),
        (lambda slip: -slip, "scale = -1"),
        (lambda slip: 20.0 * slip, "per cent"),
    ],
)
def test_slip_of_another_sign_unit_or_zero_is_refused_with_the_remedy(configured, change, said):
    table = drive_recording(cambers=(0.0,), sideslips=(0.0,))
    table["SL"] = change(table["SL"])
    with pytest.raises(InputError, match=said):
        points.read(configured(table))


def test_a_force_of_the_other_sign_is_refused_as_such_if_the_speeds_confirm_the_slip(configured):
    table = drive_recording(cambers=(0.0,), sideslips=(0.0,))
    with pytest.raises(InputError, match="scale = -1 for Fx_N"):
        points.read(configured(table.assign(FX=-table["FX"]), {**COLUMNS, "omega_radps": "N"}))


def test_a_longitudinal_force_in_kilonewtons_is_refused_with_the_remedy(configured):
    table = drive_recording(cambers=(0.0,), sideslips=(0.0,))
    table[COLUMNS["Fx_N"]] *= 1e-3
    with pytest.raises(
        InputError, match=r'looks like kN; write newtons, or Fx_N = . column = "FX", unit = "kN" .'
    ):
        points.read(configured(table))


def test_slip_against_the_loaded_radius_is_shifted_by_load(configured, plain):
    """As the speed of the wheel and the radius of free rolling give it: no formula of the reader."""
    table = drive_recording()
    truth = plain.points.kappa
    stated = {"column": "SR", "against": "loaded-radius"}
    for given in ("SR", stated):
        found = points.read(configured(table, {**COLUMNS, "kappa": given}))
        assert np.max(np.abs(found.points.kappa - truth)) < 0.0025
        said = found.notes if given is stated else found.warnings  # a shift that nobody declared is warned of
        (sentence,) = [one for one in said if "loaded radius" in one]
        said = [float(word.strip(",")) for word in sentence.split() if word[0] in "+-"]
        assert np.allclose(
            said, [loaded_radius(load) / rolling_radius(load) - 1.0 for load in LOADS], atol=1e-3
        )
    with_radius = {**COLUMNS, "kappa": stated, "RL_m": {"column": "RL", "unit": "cm"}}
    found = points.read(configured(table, with_radius))
    assert np.sqrt(np.mean((found.points.kappa - truth) ** 2)) < 0.0006  # noise of slip and of the zero
    written = found.points.table  # of points.csv: as reported, and as used
    assert np.allclose(written["kappa_free_rolling"], found.points.kappa)
    assert not np.allclose(written["kappa"], found.points.kappa, atol=0.005)
    kept = points.read(configured(table, {**COLUMNS, "kappa": {**stated, "against": "free-rolling"}}))
    assert np.min(kept.points.kappa) < np.min(truth) - 0.015
    assert any("declared against free rolling" in warning for warning in kept.warnings)


def test_samples_without_slip_are_not_taken_for_free_rolling(configured):
    table = drive_recording(cambers=(0.0,), sideslips=(0.0,))
    table.loc[300:420, "SL"] = np.nan
    found = points.read(configured(table))
    assert any("no reading of kappa" in warning for warning in found.warnings)
    truth = longitudinal_force(found.points.kappa, found.points.alpha, found.points.Fz)
    assert np.max(np.abs(found.points.Fx - truth)) < 60.0


def test_slip_against_free_rolling_is_said_and_left_alone(plain):
    (sentence,) = [note for note in plain.notes if "SL is against free rolling" in note]
    assert float(sentence.split("within ")[1].split()[0]) < 0.0006
    assert np.allclose(plain.points.kappa, plain.points.table["kappa"])


@pytest.mark.parametrize("heading", ["FX", "FY"])
def test_samples_lost_here_and_there_cost_no_points(configured, plain, heading):
    table = drive_recording()
    lost = np.random.default_rng(4).random(len(table)) < 0.05
    found = points.read(configured(table.assign(**{heading: table[heading].where(~lost)}))).points
    assert len(found) > 0.95 * len(plain.points)
