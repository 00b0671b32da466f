"""Every check of a tyre applies just beyond its limit, and not just within it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tir
from tir.checking import check

VECTORS = Path(__file__).parent / "vectors"
TYRE = tir.read(VECTORS / "moto_front.tir")
R0, FNOMIN = TYRE["UNLOADED_RADIUS"], TYRE["FNOMIN"]
PLAIN = {
    **dict.fromkeys(("PDY2", "PDY3", "PPY3", "PPY4", "PEY2", "PEY3", "PEY4", "PEY5", "PECP2"), 0.0),
    "ALPMIN": -0.3, "ALPMAX": 0.3, "CAMMIN": -0.7, "CAMMAX": 0.7,
}  # fmt: skip
"""Friction, curvature and eps_gamma that are the same everywhere in usual ranges."""
RE_OVER_R0 = float(TYRE.state(FNOMIN).Re) / R0 - TYRE["Q_RE0"]
"""What deflection and speed add to the effective radius, per unloaded radius."""
HALF = {"PECP1": 0.5, "PECP2": 0.0}
LIMITS = [
    ("a radius in metres was expected", {"UNLOADED_RADIUS": 1.51}, {"UNLOADED_RADIUS": 1.49}),
    ("a radius in metres was expected", {"UNLOADED_RADIUS": 0.049}, {"UNLOADED_RADIUS": 0.051}),
    (
        "it looks like centimetres or millimetres; correct",
        {"UNLOADED_RADIUS": 50.1},
        {"UNLOADED_RADIUS": 49.9},
    ),
    ("it looks like millimetres; correct", {"UNLOADED_RADIUS": 150.1}, {"UNLOADED_RADIUS": 149.9}),
    ("it looks like centimetres; correct", {"UNLOADED_RADIUS": 32.0}, {"UNLOADED_RADIUS": 0.32}),
    ("it looks like kN", {"FNOMIN": 4.0, "FZMIN": 200.0, "FZMAX": 8000.0}, {"FNOMIN": 4000.0}),
    ("is not smaller than UNLOADED_RADIUS", {"RIM_RADIUS": R0}, {"RIM_RADIUS": 0.999 * R0}),
    (
        "deflect by more than its radius",
        {"VERTICAL_STIFFNESS": 0.99 * FNOMIN / R0},
        {"VERTICAL_STIFFNESS": 1.01 * FNOMIN / R0},
    ),
    ("it looks like millimetres or inches", {"WIDTH": 1.51}, {"WIDTH": 1.49}),
    ("it looks like kPa or bar", {"NOMPRES": 4.9e3}, {"NOMPRES": 5.1e3}),
    ("no tyre holds that pressure", {"NOMPRES": 1.01e7}, {"NOMPRES": 0.99e7}),
    ("one is in another unit", {"NOMPRES": 4.9e3, "INFLPRES": 5.1e3}, {"NOMPRES": 4.9e3, "INFLPRES": 4.9e3}),
    (
        "one is in another unit",
        {"NOMPRES": 0.99e7, "INFLPRES": 1.01e7},
        {"NOMPRES": 5.1e3, "INFLPRES": 0.99e7},
    ),
    ("ALPMAX is 1.71 rad: it looks like degrees", {"ALPMAX": 1.71}, {"ALPMAX": 1.69}),
    ("CAMMIN is -1.71 rad: it looks like degrees", {"CAMMIN": -1.71}, {"CAMMIN": -1.69}),
    ("MASS is -0.1 kg: it must not be negative", {"MASS": -0.1}, {"MASS": 0.0}),
    ("the relaxation length is divided by it", {"LATERAL_STIFFNESS": 0.0}, {"LATERAL_STIFFNESS": 1.0}),
    (
        "on a motorcycle tyre: simulations",
        {"CAMMAX": 0.149, "MC_CONTOUR_A": 0.1},
        {"CAMMAX": 0.151, "MC_CONTOUR_A": 0.1},
    ),
    (
        "on a motorcycle tyre: simulations",
        {"CAMMAX": 0.149, "MC_CONTOUR_A": 0.1},
        {"CAMMAX": 0.149, "MC_CONTOUR_A": 0.0},
    ),
    (
        "INFLPRES 199000 lies outside PRESMIN 200000",
        {"PRESMIN": 2e5, "INFLPRES": 1.99e5},
        {"PRESMIN": 2e5, "INFLPRES": 2e5},
    ),
    ("NOMPRES 301000 lies outside", {"PRESMAX": 3e5, "NOMPRES": 3.01e5}, {"PRESMAX": 3e5, "NOMPRES": 3e5}),
    ("the nominal load 1500 lies outside", {"FZMAX": 0.99 * FNOMIN}, {"FZMAX": FNOMIN}),
    (
        "the nominal load 1500 lies outside",
        {"FZMIN": 1.01 * FNOMIN, "FZMAX": 3 * FNOMIN},
        {"FZMIN": FNOMIN, "FZMAX": 3 * FNOMIN},
    ),
    ("the lower limits of slip and camber must not be positive", {"ALPMIN": 0.001}, {"ALPMIN": 0.0}),
    ("the lower limits of slip and camber must not be positive", {"CAMMIN": 0.001}, {"CAMMIN": 0.0}),
    ("the lower limits of slip and camber must not be positive", {"KPUMIN": 0.001}, {"KPUMIN": 0.0}),
    ("is not below", {"FZMIN": 900.0, "FZMAX": 900.0}, {"FZMIN": 900.0, "FZMAX": 901.0}),
    ("FZMAX, 1.49 times the nominal load", {"FZMAX": 1.49 * FNOMIN}, {"FZMAX": 1.51 * FNOMIN}),
    ("below FZMIN", {"FZMIN": 0.21 * FNOMIN}, {"FZMIN": 0.19 * FNOMIN}),
    (
        "the effective radius is 0.85 of the unloaded one",
        {"Q_RE0": 0.849 - RE_OVER_R0},
        {"Q_RE0": 0.851 - RE_OVER_R0},
    ),
    (
        "the effective radius is 1.05 of the unloaded one",
        {"Q_RE0": 1.051 - RE_OVER_R0},
        {"Q_RE0": 1.049 - RE_OVER_R0},
    ),
    ("eps_gamma comes close to 1", {"PECP1": 0.91, "PECP2": 0.0}, {"PECP1": 0.89, "PECP2": 0.0}),
    ("eps_gamma comes close to 1", {"PECP1": 1.09, "PECP2": 0.0}, {"PECP1": 1.11, "PECP2": 0.0}),
    ("the lateral friction coefficient is 4.1", {**PLAIN, "PDY1": 4.1}, {**PLAIN, "PDY1": 3.9}),
    ("the curvature E_y reaches 1.01 > 1", {**PLAIN, "PEY1": 1.01}, {**PLAIN, "PEY1": 0.99}),
    (
        "QSX4-11 and QSX12-14 are both",
        {"QSX11": 0.1, "QSX14": 0.1},
        {**{f"QSX{i}": 0.0 for i in range(4, 12)}, "QSX14": 0.1},
    ),
    (
        "QSX4-11 and QSX12-14 are both",
        {"QSX11": 0.1, "QSX12": 0.1},
        {"QSX12": 0.0, "QSX13": 0.0, "QSX14": 0.0, "QSX11": 0.1},
    ),
    ("scaling factors differ from 1: LFZO", {"LFZO": 0.999}, {"LFZO": 1.0}),
    (
        "TYRESIDE is symmetric, but the odd terms",
        {"TYRESIDE": "SYMMETRIC", "PHY1": 0.01},
        {"TYRESIDE": "LEFT", "PHY1": 0.01},
    ),
    (
        "is the common default 0.5",
        {**HALF, "MC_CONTOUR_A": 0.1},
        {**HALF, "PECP2": 0.1, "MC_CONTOUR_A": 0.1},
    ),
    (
        "is the common default 0.5",
        {**HALF, "MC_CONTOUR_A": 0.1},
        {**HALF, "MC_CONTOUR_A": 0.0},
    ),
    ("the shape factor must be positive", {"QCZ1": 0.0}, {"QCZ1": 0.01}),
]


def said(change) -> str:
    return "\n".join(p.sentence for p in check(TYRE.replace(**change)))


@pytest.mark.parametrize(("words", "beyond", "within"), LIMITS)
def test_a_problem_is_found_beyond_the_limit_only(words, beyond, within):
    assert words in said(beyond)
    assert words not in said(within)


@pytest.mark.parametrize(("ALPMAX", "percent"), [(3.0, True), (16.0, False)])
def test_a_sideslip_limit_below_the_peak_says_the_share_that_is_reached(ALPMAX, percent):
    alpha = np.radians(np.linspace(0.1, 30.0, 300))
    force = np.abs(TYRE(FNOMIN, alpha).Fy)
    limit = float(np.radians(ALPMAX))
    share = abs(TYRE(FNOMIN, limit).Fy) / force.max()
    words = f"ALPMAX, {ALPMAX:.1f} deg, where the side force at nominal load is {share:.0%} of its peak"
    assert (words in said({"ALPMAX": limit, "ALPMIN": -limit})) == percent


def test_a_sideslip_limit_beyond_the_peak_is_no_problem():
    alpha = np.radians(np.linspace(0.1, 30.0, 300))
    early = {"PCY1": 1.8, "PEY1": -1.0, "PEY2": 0.0, "PKY1": -30.0}
    peak = float(alpha[np.argmax(np.abs(TYRE.replace(**early)(FNOMIN, alpha).Fy))])
    assert 0.02 < peak < 0.2
    for factor, told in ((1.02, False), (0.95, True)):
        assert ("of its peak" in said({**early, "ALPMAX": factor * peak, "ALPMIN": -0.3})) == told


def test_a_file_that_ends_before_a_section_says_which_moment_is_default(tmp_path):
    text = TYRE.text()
    whole, cut = tmp_path / "whole.tir", tmp_path / "cut.tir"
    whole.write_text(text)
    cut.write_text(text[: text.index("[ALIGNING_COEFFICIENTS]")])
    said = "all of Mz is default"
    assert not any(said in problem.sentence for problem in tir.read(whole).problems)
    assert any(said in problem.sentence for problem in tir.read(cut).problems)


def test_a_file_that_is_not_to_be_trusted_says_so_again():
    tyre = TYRE.annotate(provenance={"NOT TO BE TRUSTED": "run 3 contradicts the others"})
    new = {problem.sentence for problem in tir.check(tyre)} - {
        problem.sentence for problem in tir.check(TYRE)
    }
    assert new == {"the file says of itself that it is not to be trusted: run 3 contradicts the others"}
