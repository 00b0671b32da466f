"""TYDEX axes C, H and W: one campaign written in each, by vectors of a leaning wheel, is read as the same points."""

from __future__ import annotations

import tomllib
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from disc_project import moment, side_force

from mffit import config, pipeline, points
from mffit.errors import InputError
from mffit.recordings import sniff

R0 = 0.3
MAPPED = ("Fx_N", "Fy_N", "Fz_N", "Mx_Nm", "My_Nm", "Mz_Nm")


def wheel(gamma: float) -> tuple[np.ndarray, np.ndarray]:
    """y and z axis of the wheel carrier: TYDEX turns it about x, and gamma > 0 leans the top of the wheel to -y."""
    return np.array([0.0, np.cos(gamma), np.sin(gamma)]), np.array([0.0, -np.sin(gamma), np.cos(gamma)])


def campaign(cambers: tuple[float, ...] = (0.0, -15.0, 25.0)) -> list[dict[str, Any]]:
    """Points with force and moment as vectors in W, about the contact point."""
    out = []
    for load, camber, sideslip in product((1200.0, 3000.0), cambers, np.linspace(-8.0, 8.0, 9)):
        alpha, gamma = np.radians(sideslip), np.radians(camber)
        Fy = side_force(alpha, gamma, load, side=0.0)
        out.append(
            {
                "alpha": sideslip,
                "gamma": camber,
                "radius": R0 - load / 2e5,
                "force": np.array([-0.012 * load - 0.1 * abs(Fy * alpha), Fy, load]),
                "moment": np.array([0.01 * Fy - 5.0, 0.002 * load, moment(alpha, gamma, load, side=0.0)]),
            }
        )
    return out


def in_axes(point: dict[str, Any], letter: str) -> tuple[np.ndarray, np.ndarray]:
    """Force and moment as TYDEX defines them for a letter."""
    force, torque = point["force"], point["moment"]
    if letter == "W":
        return force, torque
    y, z = wheel(np.radians(point["gamma"]))
    about_centre = torque - np.cross(
        point["radius"] * z, force
    )  # at the centre, z * radius above the contact
    if letter == "H":
        return force, about_centre
    x = np.array([1.0, 0.0, 0.0])
    return np.array([force @ x, force @ y, force @ z]), np.array(
        [about_centre @ x, about_centre @ y, about_centre @ z]
    )


def written(
    path: Path,
    rows: list[dict[str, Any]],
    forces: str,
    moments: str = "",
    *,
    load: str = "",
    without: tuple[str, ...] = (),
) -> Path:
    """A TYDEX file as KIT's drum writes it: degrees, slip in per cent, pressure as a constant."""
    moments = moments or forces
    values: dict[str, list[float]] = {}
    for point in rows:
        force, torque = in_axes(point, forces)[0], in_axes(point, moments)[1]
        row = {"SLIPANGL": point["alpha"], "INCLANGL": point["gamma"], "TRAJVELW": 60.0, "LONGSLIP": 0.0}
        row |= {f"F{axis}{forces}": float(force[k]) for k, axis in enumerate("XYZ")}
        row |= {f"FZ{load}": float(in_axes(point, load)[0][2])} if load else {}
        row |= {f"M{axis}{moments}": float(torque[k]) for k, axis in enumerate("XYZ")}
        row |= {"RL": point["radius"]}
        for name, value in row.items():
            values.setdefault(name, []).append(value)
    without = (*without, *([f"FZ{forces}"] if load else []))
    values = {name: column for name, column in values.items() if name not in without}
    units = {"SLIPANGL": "deg", "INCLANGL": "deg", "TRAJVELW": "km/h", "LONGSLIP": "%", "RL": "m"}
    lines = ["**HEADER", f"{'RELEASE':<10}{'Release of TYDEX':<30}{'':<10}1.3", "**CONSTANTS"]
    lines += [f"{'INFLPRES':<10}{'inflation pressure':<30}{'bar':<10}2.4", "**MEASURCHANNELS"]
    for name in values:
        unit = units.get(name, "N" if name.startswith("F") else "Nm")
        lines.append(f"{name:<10}{'a channel':<30}{unit:<10}1 0 0")
    lines.append("**MEASURDATA")
    lines += [" ".join(repr(float(x)) for x in row) for row in zip(*values.values(), strict=True)]
    path.write_text("\n".join([*lines, "**END", ""]), encoding="latin-1")
    return path


def read(path: Path, **rig: Any) -> tuple[points.Points, tuple[str, ...]]:
    """The points of a project that maps the headings of the file and says nothing of axes."""
    heads = [
        line.split()[0] for line in path.read_text().split("**MEASURCHANNELS")[1].split("\n")[1:] if line
    ]
    heads = [*heads[: heads.index("**MEASURDATA")], "INFLPRES"]
    names = {
        "SLIPANGL": "alpha_deg",
        "INCLANGL": "gamma_deg",
        "TRAJVELW": "V_mps",
        "RL": "RL_m",
        "INFLPRES": "p_kPa",
    }
    columns = {names[head]: head for head in heads if head in names}
    columns |= {name: head for name in MAPPED for head in heads if head[:2] == name[0] + name[1].upper()}
    given = {
        "tyre": {"name": "t", "unloaded_radius": R0, "nominal_load": 3000.0, "nominal_pressure": 240.0},
        "rig": {"type": "flat-track", **rig},
        "columns": columns,
        "sweep": [{"file": path.name}],
    }
    return points.read(config.load(given, folder=path.parent))[:2]


def errors(found: points.Points, rows: list[dict[str, Any]]) -> np.ndarray:
    """Largest error of Fx, Fy, Fz [N] and Mx, My, Mz [Nm]."""
    true = np.array([np.r_[row["force"], row["moment"]] for row in rows]).T
    return np.array(
        [
            np.max(np.abs(getattr(found, name.partition("_")[0]) - values))
            for name, values in zip(MAPPED, true, strict=True)
        ]
    )


@pytest.mark.parametrize(("forces", "moments"), [("W", ""), ("H", ""), ("C", ""), ("W", "H"), ("H", "C")])
def test_the_letters_of_the_headings_decide_axes_and_reference_point(tmp_path, forces, moments):
    rows = campaign()
    found, warnings = read(written(tmp_path / "a.tdx", rows, forces, moments))
    assert errors(found, rows) == pytest.approx(0.0, abs=1e-8)
    assert not [sentence for sentence in warnings if "axes" in sentence or "frame" in sentence]


def test_a_side_force_in_c_beside_a_vertical_load(tmp_path):
    rows = campaign()
    assert errors(read(written(tmp_path / "a.tdx", rows, "C", load="W"))[0], rows) == pytest.approx(
        0.0, abs=1e-8
    )
    with pytest.raises(InputError, match="FYW and FZC are in different axes"):
        read(written(tmp_path / "b.tdx", rows, "W", load="C"))


def test_the_letter_holds_against_a_declaration_and_it_is_said(tmp_path):
    rows = campaign()
    path = written(tmp_path / "a.tdx", rows, "C")
    found, warnings = read(path, force_frame="W", moments="contact")
    assert errors(found, rows) == pytest.approx(0.0, abs=1e-8)
    (said,) = [sentence for sentence in warnings if "[rig]" in sentence]
    for word in ('force_frame = "W"', 'moments = "contact"', "FYC", "a.tdx"):
        assert word in said
    assert not [sentence for sentence in read(path, force_frame="C")[1] if "[rig]" in sentence]


def test_what_cannot_be_moved_is_said(tmp_path):
    rows = campaign()
    no_radius = read(written(tmp_path / "a.tdx", rows, "H", without=("RL",)))
    assert any("RL_m is missing" in sentence for sentence in no_radius[1])
    off = errors(no_radius[0], rows)
    assert off[:3] == pytest.approx(0.0, abs=1e-8)
    assert off[3] > 10.0  # the deflection times the side force
    no_fx = read(written(tmp_path / "b.tdx", rows, "H", without=("FXH",)))
    assert any("Fx_N is missing" in sentence for sentence in no_fx[1])
    no_my = read(written(tmp_path / "c.tdx", rows, "C", without=("MYC",)))
    assert any("My_Nm is missing" in sentence for sentence in no_my[1])
    at_contact = read(written(tmp_path / "d.tdx", rows, "W", without=("RL", "FXW", "MYW")))
    assert not [sentence for sentence in at_contact[1] if "missing" in sentence]


def test_moments_of_two_axes_in_one_file_are_refused(tmp_path):
    path = written(tmp_path / "a.tdx", campaign(), "W")
    path.write_text(path.read_text().replace("MXW", "MXC"))
    with pytest.raises(InputError, match="MXC and MYW and MZW are in different axes"):
        read(path)


def test_horizontal_axes_without_camber_are_iso_and_become_a_project(tmp_path):
    """The channels of KIT's open set; nothing but the format tells iso from sae here."""
    rows = campaign(cambers=(0.0,))
    path = written(tmp_path / "KIT_SIDE_1.TDX", rows, "H", without=("MXH", "MYH", "RL"))
    assert sniff([path]).axes == ("iso",)
    _, files = pipeline.init_from([path], tmp_path / "p", unloaded_radius=R0, nominal_load=3000.0)
    text = files[0].read_text()
    content = tomllib.loads(text)
    assert content["rig"]["axes"] == "iso"
    assert "as TYDEX prescribes" in text
    assert "FZH, FYH, MZH: horizontal, about the wheel centre" in text or "FYH, FZH, MZH: horizontal" in text
    found = points.read(config.load(files[0])).points
    true = np.array([np.r_[row["force"], row["moment"][2]] for row in rows]).T
    np.testing.assert_allclose([found.Fx, found.Fy, found.Fz, found.Mz], true, atol=1e-8)


def test_a_leaning_wheel_in_c_is_recognised_by_its_letters(tmp_path):
    rows = campaign()
    path = written(tmp_path / "a.tdx", rows, "C")
    _, files = pipeline.init_from([path], tmp_path / "p", unloaded_radius=R0, nominal_load=3000.0)
    assert "turned with the wheel carrier" in files[0].read_text()
    assert errors(points.read(config.load(files[0])).points, rows) == pytest.approx(0.0, abs=1e-8)


def test_the_radius_under_its_tydex_name_is_the_lever_of_moments_about_the_centre(tmp_path):
    """DSTGRWHC, the distance of ground and wheel centre, is the heading of TYDEX 1.3 for what others call RL."""
    rows = campaign()
    path = written(tmp_path / "a.tdx", rows, "C")
    text = path.read_text(encoding="latin-1").replace(f"{'RL':<10}", f"{'DSTGRWHC':<10}")
    path.write_text(text, encoding="latin-1")
    _, files = pipeline.init_from([path], tmp_path / "p", unloaded_radius=R0, nominal_load=3000.0)
    found, warnings = points.read(config.load(files[0]))[:2]
    assert found.Mx == pytest.approx([row["moment"][0] for row in rows], abs=1e-8)
    assert not [sentence for sentence in warnings if "RL_m" in sentence]
