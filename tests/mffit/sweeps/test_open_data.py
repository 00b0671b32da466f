"""Files in the form of the open sets of docs/howto-open-data.md: a MATLAB structure with the conditions of each channel, and
TYDEX with slip in per cent and forces of the wheel's axes. The forces are those of a tyre that the readers never see."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.io
from flat_belt import recording
from small_rigs import truth

from mffit.recordings import sniff
from mffit.sweeps import formats

ALPHA = np.tile(np.arange(-6.0, 6.5, 1.0), 3)
LOAD = np.repeat([340.0, 400.0, 490.0], 13)


def structure(**other):
    forces = truth()(LOAD, np.radians(ALPHA))
    own = {"alphaFy": ALPHA, "alphaMz": ALPHA, "camber_Fy": 0.0 * ALPHA, "camber_Mz": 0.0 * ALPHA}
    own |= {"Fy": forces.Fy, "Mz": forces.Mz, "Pressure": np.full(39, 350.0), "Fz_Fy": LOAD, "Fz_Mz": LOAD}
    return {name: np.asarray(values)[:, None] for name, values in (own | other).items()}


def write_v7(path, content):
    scipy.io.savemat(path, {"S": content})


def write_v73(path, content):
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in content.items():
            file.create_dataset(f"S/{name}", data=values.T)
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file")


@pytest.mark.parametrize("write", [write_v7, write_v73])
def test_a_structure_with_the_conditions_of_each_channel_is_a_table(tmp_path, write):
    content = structure()
    write(tmp_path / "T11_camber0_p350.mat", content)
    table = formats.read(tmp_path / "T11_camber0_p350.mat")
    for heading, name in {
        "alpha": "alphaFy",
        "camber": "camber_Fy",
        "Fz": "Fz_Fy",
        "Fy": "Fy",
        "Mz": "Mz",
    }.items():
        np.testing.assert_array_equal(table.column(heading), content[name][:, 0], err_msg=heading)
    found = sniff([tmp_path / "T11_camber0_p350.mat"])
    assert set(found.recordings[0].guesses) >= {"alpha_deg", "gamma_deg", "Fz_N", "Fy_N", "Mz_Nm", "p_kPa"}


@pytest.mark.parametrize(
    "other",
    [
        {"alphaMz": (ALPHA + 0.1)[:, None]},
        {name: structure()[name][np.abs(ALPHA) < 3.5] for name in ("alphaMz", "camber_Mz", "Fz_Mz", "Mz")},
    ],
)
def test_a_channel_at_conditions_of_its_own_is_left_out_and_named(tmp_path, other):
    """Never paired with the sideslip of another channel."""
    write_v7(tmp_path / "a.mat", structure(**other))
    table = formats.read(tmp_path / "a.mat")
    assert "Mz" not in table.headings
    assert table.about["left out"].startswith("Mz")
    np.testing.assert_array_equal(table.column("alpha"), ALPHA)


HEAD = """**HEADER
RELEASE   Release of TYDEX-Format                 1.3
**CONSTANTS
INFLPRES  Inflation pressure            bar       2.4
**MEASURCHANNELS
RUNTIME   Time                          s         1         0         0
LONGSLIP  Longitudinal slip             %         1         0         0
SLIPANGL  Slip angle                    deg       1         0         0
INCLANGL  Inclination angle             deg       1         0         0
TRAJVELW  Trajectory velocity           km/h      1         0         0
FXH       Longitudinal force            N         1         0         0
FYH       Lateral force                 N         1         0         0
FZH       Vertical force                N         1         0         0
MZH       Aligning torque               Nm        1         0         0
**MEASURDATA
"""


def test_tydex_in_per_cent_about_the_wheel_centre_needs_no_hand(tmp_path):
    n = 400
    kappa = 0.2 * np.sin(np.linspace(0.0, 2.0 * np.pi, n))
    for name, alpha in (("LONG.TDA", 0.0), ("COMB.TDB", -4.0)):
        forces = truth()(1400.0, np.radians(alpha), kappa=kappa)
        columns = np.column_stack(
            np.broadcast_arrays(
                np.arange(n) / 50.0, 100.0 * kappa, alpha, 0.0, 60.0, forces.Fx, forces.Fy, 1400.0, forces.Mz
            )
        )
        rows = "\n".join("".join(f"{x:10.3f}" for x in row) for row in columns)
        (tmp_path / f"KIT_{name}").write_text(f"{HEAD}{rows}\n**END\n", encoding="ascii")
    found = sniff(sorted(tmp_path.glob("KIT_*")))
    assert found.axes == ("iso",)
    drawn = found.points
    reference = truth()(drawn.Fz, drawn.alpha, kappa=drawn.kappa)
    np.testing.assert_allclose(drawn.Fx, reference.Fx, atol=0.02 * np.max(np.abs(reference.Fx)))
    np.testing.assert_allclose(drawn.Fy, reference.Fy, atol=0.02 * np.max(np.abs(reference.Fx)))
    assert np.ptp(drawn.kappa) == pytest.approx(0.4, rel=0.1)
    assert np.degrees(np.min(drawn.alpha)) == pytest.approx(-4.0, abs=0.1)


def test_a_block_of_keys_and_values_stands_above_the_headings(tmp_path):
    """As MoTeC's programs export it: everything is quoted, and some keys have numbers."""
    table = recording(loads=(600.0,), cambers=(0.0,), pressures=(83.0,)).round(3)
    headings = {"ET": "s", "SA": "deg", "IA": "deg", "FZ": "N", "FY": "N", "MZ": "N.m", "V": "km/h"}
    rows = [
        ["Format", "MoTeC CSV File", "", "", "Workbook", "Rig", ""],
        ["Log Date", "12/03/2026", "", "", "Origin Time", "0.000", "s"],
        ["Range", "entire outing", "", "", "End Distance", "594", "m"],
        ["Beacon Markers", "6.0 12.0", *[""] * 5],
        [],
        list(headings),
        list(headings.values()),
        [],
        *table[list(headings)].to_numpy().tolist(),
    ]
    lines = [",".join(f'"{cell}"' for cell in row) for row in rows]
    (tmp_path / "a.csv").write_text("\r\n".join(lines) + "\r\n")
    raw = formats.read(tmp_path / "a.csv")
    assert dict(zip(raw.headings, raw.units, strict=True)) == headings
    assert (len(raw), raw.lines[0]) == (len(table), 9)
    np.testing.assert_allclose(raw.column("FY"), table["FY"])
