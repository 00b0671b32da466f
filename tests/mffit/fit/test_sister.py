"""Longitudinal and combined slip of a sister tyre, scaled by the measured side force."""

from __future__ import annotations

import json
import shutil
import tomllib
from pathlib import Path

import numpy as np
import pytest
import tomli_w

import mffit
import tir
from mffit.errors import InputError
from mffit.fit.borrowed.sister import LENT, Sister, _scaled
from mffit.report.build_view import view_of
from mffit.report.figures.bands import bands as picture_of_bands

SAMPLE = Path(__file__).parents[3] / "samples" / "flat-track-combined"
FRICTION, STIFFNESS = 1.08, 0.9
"""This tyre over its sister."""


def similar(tyre: tir.Tyre, friction: float, stiffness: float) -> dict[str, float]:
    """Values of a tyre with Fx(kappa) = friction Fx_0(kappa stiffness / friction), and the same sideways and combined."""
    v = {name: x for name, x in tyre.values.items() if isinstance(x, float)}
    slip = stiffness / friction
    for name in ("PDX1", "PDX2", "PVX1", "PVX2", "PDY1", "PDY2", "PVY1", "PVY2"):
        v[name] *= friction
    for name in ("PKX1", "PKX2", "PKY1"):
        v[name] *= stiffness
    for name in ("RBX1", "RBX2", "RBX3", "RBY1", "RBY2", "RBY4", "RVY4", "RVY6"):
        v[name] *= slip
    for name in ("PHX1", "PHX2", "PHY1", "PHY2", "RHX1", "RHY1", "RHY2", "RBY3"):
        v[name] /= slip
    return v


def write_project(folder: Path, sweeps: tuple[str, ...], **base: str) -> Path:
    """The sample's project with these sweeps only, whose base file ``base="sister.tir"`` gives Fx."""
    content = tomllib.loads((SAMPLE / "tyre.toml").read_text())
    content["tyre"] |= {"name": "front", **base}
    for name in sweeps:
        shutil.copy(SAMPLE / f"{name}.csv", folder)
    content |= {"sister": {"Fx": "scaled"}, "sweep": [{"file": f"{name}.csv"} for name in sweeps]}
    (folder / "tyre.toml").write_text(tomli_w.dumps(content))
    return folder / "tyre.toml"


SIDEWAYS = tuple(f"sideslip_{load}N" for load in (2000, 4200, 6500))


@pytest.fixture(scope="module")
def truth() -> tir.Tyre:
    return tir.read(SAMPLE / "true.tir")


@pytest.fixture(scope="module")
def sister(truth) -> tir.Tyre:
    """A similar tyre whose file has another nominal load and pressure."""
    values = similar(truth, 1.0 / FRICTION, 1.0 / STIFFNESS)
    return truth.replace(**values)


@pytest.fixture(scope="module")
def built(tmp_path_factory, sister):
    folder = tmp_path_factory.mktemp("sister")
    sister.write(folder / "sister.tir")
    out = folder / "out"
    toml = write_project(folder, SIDEWAYS, base="sister.tir")
    return mffit.build(toml, out, ensemble=12, with_report=False), out


def test_forces_at_all_slips_are_those_of_the_tyre_itself(built, truth):
    """Both tyres are similar, so that the scaled file is the truth to within what the side force was measured."""
    rng = np.random.default_rng(1)
    n = 200
    Fz, alpha, kappa = (
        rng.uniform(2000, 6500, n),
        np.radians(rng.uniform(-8, 8, n)),
        rng.uniform(-0.2, 0.2, n),
    )
    found, expected = (t(Fz, alpha, 0.0, kappa, turn_slip=False) for t in (built[0].tyre, truth))
    assert np.sqrt(np.mean((found.Fx - expected.Fx) ** 2)) < 0.01 * np.sqrt(np.mean(expected.Fx**2))
    assert np.sqrt(np.mean((found.Fy - expected.Fy) ** 2)) < 0.02 * np.sqrt(np.mean(expected.Fy**2))


def test_longitudinal_friction_follows_the_ratio_of_lateral_frictions_over_load(truth):
    """PDX1 and PDX2 are the line through the sister's friction times that ratio at every load."""
    other = truth.replace(PDY1=1.1 * truth["PDY1"], PDY2=truth["PDY2"] - 0.2)
    loads = np.linspace(2000.0, 6500.0, 9)
    sister = Sister("sister.tir", truth, 0.05, 0.25, loads, 240e3, None)
    found = _scaled(other.values, {name: truth[name] for name in LENT}, sister).values
    dfz = loads / 4200.0 - 1.0
    ratio = (other["PDY1"] + other["PDY2"] * dfz) / (truth["PDY1"] + truth["PDY2"] * dfz)
    slope, middle = np.polyfit(dfz, (truth["PDX1"] + truth["PDX2"] * dfz) * ratio, 1)
    assert (found["PDX1"], found["PDX2"]) == pytest.approx((middle, slope))
    assert found["PKX1"] == pytest.approx(truth["PKX1"])


def test_every_borrowed_coefficient_says_where_it_comes_from(built, truth):
    _, out = built
    found = json.loads((out / "result.json").read_text())["fit"]
    assert found["sister"]["friction"] == pytest.approx(FRICTION, rel=0.01)
    assert found["sister"]["stiffness"] == pytest.approx(STIFFNESS, rel=0.02)
    assert found["coefficients"]["PDX1"]["stderr"] == pytest.approx(0.05 * truth["PDX1"], rel=0.1)
    assert {"PCX1", "PDX1", "PKX1", "RBX1", "RBY1", "RVY4", "SSZ1"} <= set(found["sister"]["coefficients"])
    assert {found["coefficients"][name]["status"] for name in found["sister"]["coefficients"]} == {"sister"}
    assert tir.read(out / "front.tir").status["RBX1"].startswith("from sister, scaled +- ")


def test_drawn_tyres_scatter_as_stated(built):
    """Friction of the members: mean and spread of 12 draws, within what chance does in 99.9 %."""
    result = built[0]
    drawn = np.array([member["PDX1"] for member in result.members])
    q = result.fit.lent.found["PDX1"]
    assert np.mean(drawn) == pytest.approx(q.value, abs=3.3 * q.u / np.sqrt(12))
    assert 0.4 < np.std(drawn, ddof=1) / q.u < 1.8
    kappa = np.linspace(0.01, 0.1, 10)
    assert all(np.all(member(4200.0, kappa=kappa, turn_slip=False).Fx > 0.0) for member in result.members)


def test_the_report_draws_the_borrowed_force_with_its_band(built):
    """The band at the peak is at least as wide as the uncertainty of friction alone makes it."""
    sheet = picture_of_bands(view_of(built[0]))
    bands = sheet.rows[-1][0].series
    assert len(bands) == 3
    for band in bands:
        k = int(np.argmax(np.abs(band.y)))
        assert band.half[k] > 1.9 * 0.05 * abs(band.y[k])


def test_stated_uncertainties_cover_tyres_that_differ_from_their_sister(built, truth):
    """Draw tyres whose ratios of Fx scatter about those of Fy as stated: the stated u of PDX1 and PKX1 covers them."""
    lent, rng = built[0].fit.lent, np.random.default_rng(3)
    z = {name: [] for name in ("PDX1", "PKX1")}
    for _ in range(400):
        e = rng.standard_normal(2) * (0.05, 0.25)
        for name, error in (("PDX1", e[0]), ("PKX1", e[1])):
            true = truth[name] * np.exp(error)
            z[name].append((lent.found[name].value - true) / lent.found[name].u)
    for name, rows in z.items():
        assert 0.90 < np.mean(np.abs(rows) < 1.96) <= 0.99, name


def test_contradictions_are_refused_with_their_line(tmp_path, sister):
    sister.write(tmp_path / "sister.tir")
    with pytest.raises(InputError, match=r"tyre\.toml:\d+: sister\.Fx: .*names no base file"):
        mffit.build(write_project(tmp_path, SIDEWAYS[:1]))
    toml = write_project(tmp_path, (*SIDEWAYS, "drive_4200N"), base="sister.tir")
    line = toml.read_text().splitlines().index('Fx = "scaled"') + 1
    with pytest.raises(InputError, match=rf"tyre\.toml:{line}: sister\.Fx: .*drive_4200N\.csv measures it"):
        mffit.build(toml)
    text = (tmp_path / "sister.tir").read_text()
    (tmp_path / "sister.tir").write_text(
        "\n".join(row for row in text.splitlines() if not row.startswith("PKX1"))
    )
    with pytest.raises(InputError, match=r"sister\.tir does not state PKX1"):
        mffit.build(write_project(tmp_path, SIDEWAYS, base="sister.tir"))
