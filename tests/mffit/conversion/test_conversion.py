"""Old files: their forces against public programs, what the new file reproduces, and what is refused."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

import tir
from mffit import config as configuration
from mffit.cli import main
from mffit.conversion import check_old, convert, is_old, mf52, read_old, refit, to_old, wording
from mffit.conversion.grid import conditions, reach_of
from mffit.errors import InputError
from mffit.fit.known import known_before_fit
from mffit.pipeline.inputs import base_warnings, read_base
from mffit.pipeline.measuring import measure
from mffit.points import make_points
from tir import targets

ROOT = Path(__file__).parents[3]
OLD = Path(__file__).parent / "old_52.tir"
TEXT = OLD.read_text(encoding="ascii")
PUBLISHED = {
    (4000.0, 0.0, 0.0, 0.0): (75.147949, -75.748573, -4.87957),
    (4000.0, 0.05, 0.0, 0.0): (58.711836, -3009.648739, 57.444211),
    (2500.0, -0.08, 0.06, 0.0): (16.775558, 2412.840947, -32.953909),
    (6500.0, 0.12, -0.15, 0.0): (85.474036, -4828.253985, 85.755655),
    (4000.0, 0.03, 0.08, 0.06): (3574.582955, -2344.553633, 86.133659),
    (5500.0, -0.1, -0.05, -0.12): (-4717.77445, 4194.091227, -18.164331),
    (3000.0, 0.02, 0.1, -0.04): (-2071.329384, -1209.079806, -49.207914),
}
"""Fx, Fy, Mz of OLD at Fz, alpha, gamma, kappa by three public programs together: the MATLAB functions of MF 5.2 of a lap
simulation (combined Fx and Fy) and of a course on vehicle dynamics (pure Mz), and the combined Mz of a PAC2002 reader in C++,
with the sign of the sideslip where that has the sign of the longitudinal slip."""


@pytest.fixture(scope="module")
def converted():
    return convert(OLD)


def test_the_old_forces_are_those_of_public_programs():
    p = mf52.in_terms_of_62(read_old(OLD).values)
    found = mf52.forces(p, *np.array([*PUBLISHED]).T)
    wanted = np.array([*PUBLISHED.values()]).T
    for name, column in zip(("Fx", "Fy", "Mz"), wanted, strict=True):
        np.testing.assert_allclose(getattr(found, name), column, rtol=1e-8, atol=2e-6, err_msg=name)
    assert mf52.forces(p, 4000.0).Fy == pytest.approx(PUBLISHED[4000.0, 0.0, 0.0, 0.0][1])


def test_the_new_file_has_the_old_forces(converted, tmp_path):
    """Between the points of the grid too, by the tyre as it is read back: upright exactly, at 5 deg of camber to 2 %."""
    converted.tyre.write(tmp_path / "new.tir")
    tyre = tir.read(tmp_path / "new.tir")
    p = mf52.in_terms_of_62(read_old(OLD).values)
    rng = np.random.default_rng(4)
    n = 2000
    Fz, alpha, kappa = rng.uniform(500, 7900, n), rng.uniform(-0.3, 0.3, n), rng.uniform(-0.25, 0.25, n)
    for gamma, bound in ((np.zeros(n), 1e-9), (np.radians(rng.uniform(-5.0, 5.0, n)), 0.02)):
        old, new = mf52.forces(p, Fz, alpha, gamma, kappa), tyre(Fz, alpha, gamma, kappa)
        for name in ("Fx", "Fy"):
            most = np.max(np.abs(getattr(old, name)))
            assert np.max(np.abs(getattr(new, name) - getattr(old, name))) < bound * most, name
        off = np.abs(new.Mz - old.Mz) / np.max(np.abs(old.Mz))
        assert np.mean(off < 0.02) > 0.95
    assert not converted.poor


def test_the_misfit_is_stated_by_region(converted):
    """The region without slip and within 5 deg of camber, load by load, from forces of both formulae at its conditions."""
    at = conditions(converted.reach)
    here = (np.abs(at.gamma) <= np.radians(5.0) + 1e-9) & (at.kappa == 0.0)
    Fz, alpha, gamma, _ = (x[here] for x in at)
    old = mf52.forces(mf52.in_terms_of_62(read_old(OLD).values), Fz, alpha, gamma).Mz
    off = converted.tyre(Fz, alpha, gamma).Mz - old
    (row,) = (r for r in converted.misfit if (r.channel, r.small_camber, r.slipping) == ("Mz", True, False))
    loads = np.unique(Fz)
    most = np.array([np.max(np.abs(old[Fz == load])) for load in loads])
    shares = np.array([np.max(np.abs(off[Fz == load])) for load in loads]) / most
    worst = int(np.argmax(shares))
    assert np.max(np.abs(gamma)) == pytest.approx(np.radians(5.0))  # the end of the region is in it
    assert row.load == pytest.approx(loads[worst])
    assert row.largest == pytest.approx(shares[worst] * most[worst], rel=1e-6)
    assert row.share == pytest.approx(shares[worst], rel=1e-6)
    assert row.rms == pytest.approx(np.sqrt(np.mean(off**2)), rel=1e-6)
    relative = off / most[np.searchsorted(loads, Fz)]
    assert row.rms_share == pytest.approx(np.sqrt(np.mean(relative**2)), rel=1e-6)


def test_the_upright_wheel_keeps_its_moment(converted):
    """Mz of three public programs at zero camber, and everywhere else that of the old formula, at each load by itself."""
    for (Fz, alpha, gamma, kappa), (_, _, Mz) in PUBLISHED.items():
        if gamma == 0.0:
            assert converted.tyre(Fz, alpha, 0.0, kappa).Mz == pytest.approx(Mz, rel=1e-6)
    p = mf52.in_terms_of_62(read_old(OLD).values)
    alpha, kappa = (x.ravel() for x in np.meshgrid(np.linspace(-0.3, 0.3, 61), [-0.2, 0.0, 0.05]))
    for Fz in (500.0, 2000.0, 6000.0, 7900.0):
        old = mf52.forces(p, Fz, alpha, 0.0, kappa).Mz
        np.testing.assert_allclose(
            converted.tyre(Fz, alpha, 0.0, kappa).Mz, old, atol=0.005 * np.abs(old).max()
        )


def test_the_grid_reaches_the_ends_on_both_sides_and_weights_small_camber_most(converted):
    reach, at = converted.reach, conditions(converted.reach)
    for name in ("alpha", "gamma", "kappa"):
        values = np.unique(getattr(at, name))
        np.testing.assert_allclose(values, -values[::-1], atol=1e-12)
        assert values[-1] == pytest.approx(getattr(reach, name))
    small = np.abs(at.gamma) < np.radians(5.0)
    assert np.all(at.weight[small] == 1.0)
    assert np.all(at.weight[np.abs(at.gamma) > np.radians(5.1)] < 1.0)


def test_ranges_that_the_old_file_states_bound_those_of_the_conversion():
    old = read_old(OLD)
    stated = {"FZMIN": 1500.0, "FZMAX": 5000.0, "ALPMAX": 0.1, "KPUMAX": 0.05, "CAMMAX": 0.02}
    assert reach_of({**old.values, **stated}, old.present | stated.keys()) == (
        (1500.0, 5000.0),
        0.1,
        0.02,
        0.05,
    )
    wide = reach_of({**old.values, **stated}, old.present - stated.keys())
    assert wide.Fz[0] < 1500.0
    assert wide.Fz[1] > 5000.0
    assert min(wide.alpha / 0.1, wide.gamma / 0.02, wide.kappa / 0.05) > 1.0


def test_rolling_resistance_does_not_depend_on_pressure_as_in_the_old_formula(converted):
    My = [converted.tyre(4000.0, p=p).My for p in (1.0e5, 2.0e5)]
    assert My[0] == pytest.approx(My[1], rel=1e-12)


@pytest.mark.parametrize("load", [2000.0, 6000.0])
def test_rolling_resistance_is_that_of_the_old_formula(converted, load):
    """By hand: My = -Fz R0 (QSY1 + QSY3 V/V0 + QSY4 (V/V0)^4) of a freely rolling wheel; QSY2 is 0 in the file."""
    for share in (1.0, 1.5):
        resistance = 0.01 + 0.0004 * share + 0.00004 * share**4
        found = converted.tyre(load, Vx=share * 16.7).My
        assert found == pytest.approx(-load * 0.31 * resistance, rel=1e-9)


def test_relaxation_lengths_and_radius_are_kept(converted):
    """By hand at nominal load: sigma_kappa = R0 PTX1, sigma_alpha = R0 PTY1 sin(2 atan(1/PTY2))."""
    state = converted.tyre.state(4000.0, kappa=0.0)
    assert state.sigma_x == pytest.approx(0.31 * 2.38, rel=0.02)
    assert state.sigma_y == pytest.approx(0.31 * 2.1 * math.sin(2.0 * math.atan(0.5)), rel=0.02)
    deflection = 4000.0 / 2.1e5 * (0.27 * math.atan(8.4) + 0.07)
    assert state.Re == pytest.approx(0.31 - deflection, rel=1e-9)


def test_relaxation_lengths_have_the_scaling_factors_of_the_old_formula():
    """The manual of MF 5.2: R0 LFZO LSGAL with Fz over LFZO FNOMIN, and R0 LSGKP Fz / (LFZO FNOMIN), by hand at nominal load."""
    factors = {"LFZO": 1.2, "LSGAL": 0.9, "LSGKP": 0.8}
    p = mf52.in_terms_of_62({**read_old(OLD).values, **factors, "PTX2": 0.0, "PTX3": 0.0})
    sigma_x, sigma_y = mf52.relaxation_lengths(p, np.array([4000.0]))
    assert sigma_x[0] == pytest.approx(2.38 / 1.2 * 0.31 * 0.8)
    assert sigma_y[0] == pytest.approx(2.1 * math.sin(2.0 * math.atan(0.5 / 1.2)) * 0.31 * 1.2 * 0.9)


def test_every_coefficient_says_that_it_was_converted(converted, tmp_path):
    converted.tyre.write(tmp_path / "new.tir")
    tyre = tir.read(tmp_path / "new.tir")
    for row in tir.parameters.TABLE:
        if row.section.endswith("_COEFFICIENTS") and row.name in tyre.present:
            origin = "default" if row.section == tir.parameters.TURN_SLIP else "converted"
            assert tyre.status[row.name].startswith(origin)
    assert tyre.status["PKY6"].endswith("fitted to the old forces")
    assert tyre.status["PCY1"].endswith("unchanged")
    assert "old_52.tir" in tyre.provenance["converted from"]
    assert (tyre["CAMMAX"], tyre["FITTYP"], tyre["USE_MODE"]) == (0.18, 62, 124)


def test_units_are_those_of_the_file(tmp_path):
    text = TEXT.replace("'meter'", "'mm'").replace("= 0.31\n", "= 310\n").replace("2.1e+005", "2.1D+002")
    text = (
        text.replace("0.205", "205")
        .replace("0.2032", "203.2")
        .replace("0.165", "165")
        .replace("= 16.7\n", "= 16700\n")
    )
    text = text.replace("VXLOW                    = 1\n", "VXLOW                    = 1000\n")
    text = text.replace("VERTICAL_DAMPING         = 50", "VERTICAL_DAMPING = 0.05")
    (tmp_path / "mm.tir").write_text(text)
    old, mm = read_old(OLD).values, read_old(tmp_path / "mm.tir").values
    assert {name: mm[name] for name in mm if mm[name] == mm[name]} == pytest.approx(
        {name: old[name] for name in old if old[name] == old[name]}
    )


UNTOLD = re.sub(
    r"(?m)^(FITTYP|PROPERTY_FILE_FORMAT|PHY3|PT[XY]\d|QTZ1|MBELT|LGA[XYZ]|LSGKP|LSGAL|LGYR|LKYG) .*\n",
    "",
    TEXT,
)
"""Nothing but coefficients that both generations have."""


@pytest.mark.parametrize(
    ("mangled", "said"),
    [
        (TEXT.replace("= 6  ", "= 52 "), "old formula for motorcycles"),
        (TEXT.replace("= 6  ", "= 51 "), "old formula for motorcycles"),
        (TEXT.replace("= 6  ", "= 61 "), "needs no conversion"),
        (UNTOLD, "does not say which version .* if it is of MF 5.2, use --fittyp 6"),
        (re.sub(r"FNOMIN.*\n", "", TEXT), "lacks FNOMIN"),
        (re.sub(r"PKY[12].*\n", "", TEXT), "lacks PKY1 and PKY2, without which its side force"),
        (re.sub(r"P[CDK][XY]\d.*\n", "", TEXT), "has no force"),
        (re.sub(r"(?m)^PKY2 .*$", "PKY2 = 0", TEXT), "PKY2 is 0"),
        (TEXT.replace("-0.8\n", "-0,8\n"), 'PEY1 is "-0,8"'),
    ],
)
def test_what_cannot_be_converted_is_refused(tmp_path, mangled, said):
    (tmp_path / "other.tir").write_text(mangled)
    with pytest.raises(tir.TirError, match=said):
        convert(tmp_path / "other.tir")


@pytest.mark.parametrize(
    "stated",
    [
        "FITTYP = 52",
        "FITTYP = 51\nPROPERTY_FILE_FORMAT = 'MF_05'",
        "FITTYP = 62",
        "PROPERTY_FILE_FORMAT = 'MF-MCTYRE'",
        "PROPERTY_FILE_FORMAT = 'PAC_TIME'",
    ],
)
def test_a_car_tyre_with_a_wrong_version_is_converted_when_told_so(tmp_path, capsys, converted, stated):
    """The messages of reading and converting name the option, and with it the file is that of the right FITTYP."""
    plain = re.sub(r"(FITTYP|PROPERTY_FILE_FORMAT).*\n", "", TEXT)
    (tmp_path / "wrong.tir").write_text(plain.replace("[MODEL]\n", f"[MODEL]\n{stated}\n"))
    if "MC" in stated or "5" in stated:
        with pytest.raises(
            tir.TirError, match=r"MF-MCTyre, the old formula for motorcycles.*write FITTYP 6 or.*--fittyp 6"
        ):
            tir.read(tmp_path / "wrong.tir")
    with pytest.raises(tir.TirError, match="--fittyp 6"):
        convert(tmp_path / "wrong.tir")
    with pytest.raises(tir.TirError, match="FITTYP 52 cannot be converted: give 5, 6, 21"):
        convert(tmp_path / "wrong.tir", fittyp=52)
    main(["convert", str(tmp_path / "wrong.tir"), "--fittyp", "6", "--out", str(tmp_path / "new.tir")])
    capsys.readouterr()
    assert tir.read(tmp_path / "new.tir") == converted.tyre


@pytest.mark.parametrize(
    "stated", ["$ nothing", *(f"PROPERTY_FILE_FORMAT = '{x}'" for x in ("MF52", "MF_52", "SWIFT", "DELFT"))]
)
def test_the_keys_of_an_old_file_are_enough(tmp_path, converted, stated):
    """Whatever program's name it has: read as MF 6.2, its moment under camber would be another."""
    plain = re.sub(r"(FITTYP|PROPERTY_FILE_FORMAT).*\n", "", TEXT)
    (tmp_path / "old.tir").write_text(plain.replace("[MODEL]\n", f"[MODEL]\n{stated}\n"))
    with pytest.raises(tir.TirError, match=r"MF 5.2 generation.*mffit convert"):
        tir.read(tmp_path / "old.tir")
    assert is_old(tmp_path / "old.tir")
    assert convert(tmp_path / "old.tir").tyre == converted.tyre


def test_a_file_of_the_side_force_alone_is_converted(tmp_path):
    """No longitudinal force and no moment: nothing is divided by them, and the side force is the old one."""
    lateral = "[DIMENSION]\nUNLOADED_RADIUS = 0.2\n[VERTICAL]\nFNOMIN = 700\n[LATERAL_COEFFICIENTS]\n"
    text = f"{lateral}PCY1 = 1.5\nPDY1 = -2.4\nPKY1 = -45\nPKY2 = 2\nPHY3 = 0.04\n"
    (tmp_path / "lateral.tir").write_text(text)
    found = convert(tmp_path / "lateral.tir")
    D, K = 2.4 * 600.0, 45.0 * 700.0 * math.sin(2.0 * math.atan(600.0 / (2.0 * 700.0)))
    force = -D * math.sin(1.5 * math.atan(K / (1.5 * D) * 0.05))
    assert found.tyre(600.0, 0.05).Fy == pytest.approx(force, rel=1e-6)
    assert found.tyre(600.0, 0.05).Mz == found.tyre(600.0, 0.0, 0.0, 0.1).Fx == 0.0
    assert found.tyre["PDY1"] > 0.0  # a negative peak is the same curve; one sign is written
    assert not [p.sentence for p in tir.check(found.tyre) if p.level == "error"]


def test_a_file_of_the_longitudinal_force_alone_is_converted(tmp_path):
    """No side force: nothing is divided by its coefficients, and the longitudinal force is the old one."""
    head = "[MODEL]\nFITTYP = 6\n[DIMENSION]\nUNLOADED_RADIUS = 0.3\n[VERTICAL]\nFNOMIN = 4000\n"
    (tmp_path / "along.tir").write_text(
        f"{head}[LONGITUDINAL_COEFFICIENTS]\nPCX1 = 1.6\nPDX1 = 1.1\nPKX1 = 22\n"
    )
    found = convert(tmp_path / "along.tir")
    D, K = 1.1 * 3000.0, 22.0 * 3000.0
    assert found.tyre(3000.0, 0.0, 0.0, 0.04).Fx == pytest.approx(
        D * math.sin(1.6 * math.atan(K / (1.6 * D) * 0.04))
    )
    assert found.tyre(3000.0, 0.1).Fy == found.tyre(3000.0, 0.1).Mz == 0.0
    assert not [p.sentence for p in tir.check(found.tyre) if p.level == "error"]


def test_a_side_force_that_grows_with_sideslip_is_in_other_axes(tmp_path, capsys):
    lateral = "[DIMENSION]\nUNLOADED_RADIUS = 0.2\n[VERTICAL]\nFNOMIN = 700\n[LATERAL_COEFFICIENTS]\n"
    (tmp_path / "other.tir").write_text(
        f"{lateral}PCY1 = 1.5\nPDY1 = 2.4\nPKY1 = -45\nPKY2 = -2\nPHY3 = 0.04\n"
    )
    with pytest.raises(SystemExit) as ended:
        main(["convert", str(tmp_path / "other.tir"), "--out", str(tmp_path / "new.tir")])
    assert ended.value.code == 3
    said = " ".join(capsys.readouterr().out.split())
    assert "the file is in other axes" in said
    assert f"reverse the signs of {', '.join(wording.REVERSED[:-1])} and {wording.REVERSED[-1]} in it" in said


def test_an_old_file_is_checked_for_the_programs_that_read_it(tmp_path, capsys):
    """The file that is made for Chrono has no error there, and its clamp is said; another format stops it."""
    source = Path(__file__).parents[2] / "tir" / "vectors" / "MagicFormula62.tir"
    text = to_old(source, "pac2002").text
    (tmp_path / "pac.tir").write_text(text)
    main(["check", str(tmp_path / "pac.tir"), "--for", "chrono"])
    said = capsys.readouterr().out
    assert "0 errors" in said
    of_source, of_file = (
        targets.beyond_the_peak_in_chrono(tir.read(source)),
        re.findall(r"by \+(\d+) %", said),
    )
    for percent, channel in zip(of_file, ("Fx", "Fy"), strict=True):
        assert float(percent) == pytest.approx(100.0 * of_source[channel], abs=2.0)
    text = re.sub(r"(?m)^USE_MODE .*$", "USE_MODE = 14", text.replace("'PAC2002'", "'DELFT'"))
    (tmp_path / "other.tir").write_text(text)
    names = [p.name for p in check_old(tmp_path / "other.tir", ["chrono"])]
    assert {"PROPERTY_FILE_FORMAT", "USE_MODE"} <= {*names}
    with pytest.raises(SystemExit):  # MF 6 is needed elsewhere
        main(["check", str(tmp_path / "pac.tir"), "--for", "chrono,mfeval"])


def test_the_signs_to_reverse_turn_a_file_from_adapted_sae_to_iso(tmp_path):
    """In adapted SAE the side force and the aligning moment are reversed at the same angles, the others are not."""
    text = TEXT
    for name in wording.REVERSED:
        text = re.sub(rf"(?m)^({name} +=) *(\S+)", lambda m: f"{m.group(1)} {-float(m.group(2))!r}", text)
    (tmp_path / "adapted.tir").write_text(text)
    n, rng = 500, np.random.default_rng(3)
    Fz, alpha, gamma = rng.uniform(1e3, 7e3, n), rng.uniform(-0.3, 0.3, n), rng.uniform(-0.2, 0.2, n)
    at = (Fz, alpha, gamma, rng.uniform(-0.2, 0.2, n))
    iso, adapted = (
        mf52.forces(mf52.in_terms_of_62(read_old(path).values), *at)
        for path in (OLD, tmp_path / "adapted.tir")
    )
    for name, sign in (("Fx", 1.0), ("Fy", -1.0), ("Mx", 1.0), ("Mz", -1.0)):
        most = np.max(np.abs(getattr(iso, name)))
        np.testing.assert_allclose(getattr(adapted, name), sign * getattr(iso, name), atol=1e-6 * most)


def test_the_command_writes_states_and_overwrites_only_its_own(tmp_path, capsys):
    lacking = tmp_path / "old.tir"
    lacking.write_text(re.sub(r"UNLOADED_RADIUS.*\n", "", TEXT))
    out = tmp_path / "new.tir"
    main(["convert", str(lacking), "--out", str(out), "--unloaded-radius", "0.31", "--json"])
    found = json.loads(capsys.readouterr().out)
    assert (found["kind"], found["trusted"], found["reasons"]) == ("MF-Tyre 5.2", True, [])
    assert {row["channel"] for row in found["misfit"]} == {"Fx", "Fy", "Mx", "Mz"}
    assert tir.read(out)["UNLOADED_RADIUS"] == 0.31
    main(["convert", str(OLD), "--out", str(out)])
    assert "Mz       camber to 5 deg" in capsys.readouterr().out
    before = lacking.read_bytes()
    with pytest.raises(SystemExit):
        main(["convert", str(OLD), "--out", str(lacking)])
    assert lacking.read_bytes() == before
    assert "not made by mffit convert" in capsys.readouterr().err


def with_values(**values: float) -> str:
    """The old file with other values."""
    text = TEXT
    for name, value in values.items():
        text, n = re.subn(rf"^({name}\s*=).*", rf"\g<1> {value}", text, flags=re.MULTILINE)
        assert n == 1, name
    return text


def test_curvature_that_mf52_holds_to_one_is_converted(tmp_path):
    """Above 1 at every load, the curvature of Fx acts as 1: the new file has the Fx of an old file that says so."""
    (tmp_path / "held.tir").write_text(with_values(PEX1=1.6, REX1=1.8))
    (tmp_path / "one.tir").write_text(with_values(PEX1=1.0, PEX2=0.0, PEX3=0.0, PEX4=0.0, REX1=1.0, REX2=0.0))
    held, one = convert(tmp_path / "held.tir"), convert(tmp_path / "one.tir")
    assert not held.poor
    assert {"PEX1", "REX1"} <= set(held.fitted)
    assert not {"PEX1", "REX1"} & set(one.fitted)
    rng = np.random.default_rng(6)
    at = (rng.uniform(500.0, 8000.0, 200), *(rng.uniform(-end, end, 200) for end in (0.2, 0.05, 0.3)))
    wanted = one.tyre(*at).Fx
    np.testing.assert_allclose(held.tyre(*at).Fx, wanted, atol=2e-3 * np.max(np.abs(wanted)))


def test_curvature_that_exceeds_one_on_one_side_only_is_approached(tmp_path):
    """Braked, PEX4 raises the curvature above 1 at some loads; without the fit Fx would be off by twice its largest value."""
    (tmp_path / "odd.tir").write_text(with_values(PEX1=0.9, PEX2=0.5, PEX4=-0.4))
    rows = [row for row in convert(tmp_path / "odd.tir").misfit if row.channel == "Fx"]
    assert max(row.share for row in rows) < 0.06


def test_curvature_that_exceeds_one_under_camber_only_is_said_and_costs_little(tmp_path):
    """PEY of a public car tyre, tiny and bent by camber to almost 2, held to 1. At each load, over 5 deg of camber."""
    path = tmp_path / "bent.tir"
    path.write_text(with_values(PEY1=-0.0074722, PEY2=-0.0063208, PEY3=-9.9935, PEY4=-760.14))
    found = convert(path)
    p = mf52.in_terms_of_62(read_old(path).values)
    dfz, gamma = found.reach.Fz[1] / 4000.0 - 1.0, found.reach.gamma
    by_hand = (0.0074722 + 0.0063208 * dfz) * (0.95 * 760.14 * gamma + 9.9935 - 1.0)  # LGAY = 0.95
    assert found.held["PEY"] == pytest.approx(by_hand, rel=0.01)
    assert not {"PEY1", "PEY2", "PEY3"} & set(found.fitted)
    alpha = np.linspace(-0.3, 0.3, 61)
    for Fz in (1000.0, 4000.0, 6000.0, 7900.0):
        for side in (-1.0, 1.0):
            old = mf52.forces(p, Fz, alpha, side * math.radians(5.0), 0.0).Fy
            new = found.tyre(Fz, alpha, side * math.radians(5.0)).Fy
            assert np.max(np.abs(new - old)) < 0.035 * np.max(np.abs(old)), (Fz, side)


def test_the_loads_of_the_conversion_follow_the_scaled_nominal_load():
    old = read_old(OLD)
    free = old.present - {"FZMIN", "FZMAX"}
    whole, half = (reach_of({**old.values, "LFZO": share}, free).Fz for share in (1.0, 0.5))
    assert half == pytest.approx([load / 2.0 for load in whole])


ODD = TEXT.replace("PEX1                     = 0.34", "PEX1                     = 1.6")


def test_curvature_above_one_is_fitted_within_the_limit_that_the_old_formula_keeps(tmp_path, capsys):
    """MF 5.2 holds its curvature factors to 1; MF 6.2 without limits does not, and a wheel that slips would push backwards."""
    (tmp_path / "odd.tir").write_text(ODD)
    main(["convert", str(tmp_path / "odd.tir"), "--out", str(tmp_path / "new.tir")])
    said = " ".join(capsys.readouterr().out.split())
    assert "curvature above 1 (PEX)" in said
    assert re.search(r"hold curvature factors to 1, .* would reach 1\.\d+ \(PEX\) in these ranges", said)
    new, p = tir.read(tmp_path / "new.tir"), mf52.in_terms_of_62(read_old(tmp_path / "odd.tir").values)
    Fz, kappa = np.meshgrid([1000.0, 4000.0, 7900.0], [-1.0, -0.3, -0.1, 0.05, 0.2, 1.0])
    old = mf52.forces(p, Fz.ravel(), kappa=kappa.ravel()).Fx
    assert np.max(np.abs(new(Fz.ravel(), kappa=kappa.ravel()).Fx - old)) < 0.02 * np.max(np.abs(old))
    assert new.status["PEX1"].endswith("fitted to the old forces")
    assert new.status["RBX1"].endswith("unchanged")


def test_a_conversion_that_is_off_says_so(tmp_path, capsys):
    """A strong camber term in the trail's force, which MF 6.2 leaves out."""
    (tmp_path / "odd.tir").write_text(re.sub(r"PHY3 .*\n", "PHY3 = 0.4\n", TEXT))
    with pytest.raises(SystemExit) as end:
        main(["convert", str(tmp_path / "odd.tir"), "--out", str(tmp_path / "new.tir")])
    assert end.value.code == 3
    assert re.search(r"- M_z at camber to 5 deg.* is off by up to", capsys.readouterr().out)
    assert (tmp_path / "new.tir").is_file()


def test_text_for_a_number_that_no_force_needs_is_listed(tmp_path):
    """As in files of MF 6.2: some programs write the unit in place of an unknown mass."""
    (tmp_path / "old.tir").write_text(TEXT + "\n[INERTIA]\nMASS = kg\n")
    said = [problem.sentence for problem in read_old(tmp_path / "old.tir").problems]
    assert any('MASS is "kg"' in one for one in said)


def test_an_old_file_can_be_the_base_of_a_build(tmp_path):
    (tmp_path / "base.tir").write_text(TEXT)
    assert is_old(tmp_path / "base.tir")
    new = tir.Tyre.from_values({})
    new.write(tmp_path / "new.tir")
    assert not is_old(tmp_path / "new.tir")

    found = convert(OLD)

    class Config:
        folder, path = tmp_path, None
        tyre = configuration.models.TyreTable.model_construct(
            base="base.tir",
            nominal_load=found.tyre["FNOMIN"],
            nominal_pressure=found.tyre["NOMPRES"] / 1e3,
            nominal_speed=found.tyre["LONGVL"],
            unloaded_radius=found.tyre["UNLOADED_RADIUS"],
        )

    base = read_base(Config)
    assert base == found.tyre
    (said,) = base_warnings(Config, base)
    most = max(found.misfit, key=lambda row: row.share)
    assert f"({most.share:.1%}) at {most.load:.0f} N" in said
    assert most.channel[0] in said
    assert "base.tir" in said
    written = found.tyre.replace(QSX1=0.0)
    written.write(tmp_path / "again.tir")  # a file converted before says the same
    assert (
        base_warnings(Config, tir.read(tmp_path / "again.tir"))[0].partition(": ")[2]
        == said.partition(": ")[2]
    )
    assert base_warnings(Config, new) == ()


def test_what_a_converted_base_gives_is_marked_as_converted(converted, tmp_path):
    tyre = converted.tyre
    points = make_points(np.radians([-2.0, 2.0]), 0.0, 3000.0, p=200e3, V=10.0, phi_t=0.0, Fy=[900.0, -900.0])
    config = configuration.load(
        {
            "tyre": {
                "name": "t", "unloaded_radius": 0.3, "nominal_load": 4000, "nominal_pressure": 200, "nominal_speed": 16,
            },
            "rig": {"type": "flat-track"},
            "sweep": [{"file": "any.csv"}],
        }
    )  # fmt: skip
    _, measured = measure(config, points, tyre)
    known = known_before_fit(config, points, measured, tyre, {})
    assert known.origin["PCX1"] == known.origin["PKY6"] == "converted"
    tyre.write(tmp_path / "converted.tir")
    known = known_before_fit(config, points, measured, tir.read(tmp_path / "converted.tir"), {})
    assert known.origin["PCX1"] == "converted"
    plain = tir.read(ROOT / "samples" / "front-120-70" / "base.tir")
    assert known_before_fit(config, points, measured, plain, {}).origin["PCX1"] == "base"


def test_writing_over_another_file_is_refused(converted, tmp_path):
    from mffit.conversion import write

    other = tmp_path / "other.tir"
    other.write_text("mine")
    with pytest.raises(InputError, match="give another name"):
        write(converted, other)
    assert other.read_text() == "mine"
    for place, said in ((tmp_path, "is a folder"), (other / "new.tir", "cannot be written")):
        with pytest.raises(InputError, match=said):
            write(converted, place)
    found = read_old(OLD, {"UNLOADED_RADIUS": 0.4}).problems
    assert any("the given 0.4 is not used" in problem.sentence for problem in found)


SAMPLE = ROOT / "samples" / "front-120-70" / "true.tir"


def forces_of(old, *where):
    return mf52.forces(mf52.in_terms_of_62(read_old(old).values), *where)


@pytest.mark.parametrize("kind", ["mf52", "pac2002"])
def test_a_file_goes_there_and_back(converted, tmp_path, kind):
    """The old file's forces, at conditions between those of the fit, from a file that never saw it."""
    converted.tyre.write(tmp_path / "new.tir")
    main(["convert", f"{tmp_path}/new.tir", "--to", kind, "--out", f"{tmp_path}/old.tir", "--quiet"])
    rng = np.random.default_rng(5)
    where = (
        rng.uniform(500, 7900, 2000),
        rng.uniform(-0.3, 0.3, 2000),
        np.radians(rng.uniform(-5.0, 5.0, 2000)),
    )
    first, again = forces_of(OLD, *where), forces_of(tmp_path / "old.tir", *where)
    for name in ("Fx", "Fy", "Mx"):
        off = np.abs(getattr(again, name) - getattr(first, name)) / np.max(np.abs(getattr(first, name)))
        assert np.max(off) < 0.02, name
    assert is_old(tmp_path / "old.tir")


def test_a_motorcycle_tyre_in_the_older_formula(tmp_path):
    """Upright to 1 % of the largest side force of each load, to 5 deg of camber to 2 % in rms; relaxation lengths to 6 %."""
    found = to_old(SAMPLE, "mf52")
    (tmp_path / "old.tir").write_text(found.text, encoding="ascii")
    tyre = tir.read(SAMPLE)
    alpha = np.linspace(-0.24, 0.24, 41)
    for load in (700.0, 1400.0, 2800.0):
        most = np.max(np.abs(tyre(load, alpha).Fy))
        for camber, limit in ((0.0, 0.01), (math.radians(4.0), 0.02), (math.radians(-4.0), 0.02)):
            off = forces_of(tmp_path / "old.tir", load, alpha, camber).Fy - tyre(load, alpha, camber).Fy
            assert np.sqrt(np.mean(off**2)) < limit * most, (load, camber)
    values = read_old(tmp_path / "old.tir").values
    Fz = np.array([700.0, 1400.0, 2800.0])
    sigma = mf52.relaxation_lengths(mf52.in_terms_of_62(values), Fz)
    np.testing.assert_allclose(sigma[0], tyre.state(Fz).sigma_x, rtol=0.06)
    np.testing.assert_allclose(sigma[1], tyre.state(Fz).sigma_y, rtol=0.06)
    assert not {"Fx", "Fy"} & {row.channel for row in found.poor if row.rms_share > 0.02}


@pytest.fixture(scope="module")
def soft_and_odd(tmp_path_factory):
    """A tyre below its nominal pressure, with PKY1 and PKY4 of the other sign, which is the same tyre; its file of PAC2002."""
    tyre = tir.read(SAMPLE)
    tyre = tyre.replace(
        INFLPRES=200e3, PPY1=0.5, PPY2=0.9, PPX1=-0.4, QSY8=0.7, PKY1=-tyre["PKY1"], PKY4=-tyre["PKY4"]
    )
    path = tmp_path_factory.mktemp("odd") / "odd.tir"
    tyre.write(path)
    return tyre, to_old(path, "pac2002")


def test_the_search_ends_where_further_steps_hardly_change_the_side_force(monkeypatch):
    found = to_old(SAMPLE, "mf52").misfit
    monkeypatch.setattr(refit, "STAGE_TOLERANCE", 1e-9)
    for row, best in zip(found, to_old(SAMPLE, "mf52").misfit, strict=True):
        assert row.channel != "Fy" or row.rms == pytest.approx(best.rms, rel=0.02)


def test_the_older_file_holds_at_the_pressure_of_the_newer(soft_and_odd, tmp_path):
    tyre, found = soft_and_odd
    (tmp_path / "old.tir").write_text(found.text, encoding="ascii")
    old = forces_of(tmp_path / "old.tir", 1400.0, 0.05, 0.0, 0.02)
    soft, nominal = tyre(1400.0, 0.05, kappa=0.02), tyre(1400.0, 0.05, kappa=0.02, p=tyre["NOMPRES"])
    assert abs(nominal.Fy / soft.Fy - 1.0) > 0.02
    for name in ("Fx", "Fy"):
        assert getattr(old, name) == pytest.approx(getattr(soft, name), abs=0.02 * 1400.0)
    assert read_old(tmp_path / "old.tir").values["QSY1"] == pytest.approx(
        tyre["QSY1"] * (200e3 / tyre["NOMPRES"]) ** 0.7
    )


def test_a_file_of_pac2002_is_as_chrono_reads_it_and_keeps_the_overturning_moment(soft_and_odd):
    """Chrono reads lines of 200 characters by blanks and quotes. Terms that hardly differ (QSX4, QSX8) do not run away."""
    tyre, found = soft_and_odd
    worst = {row.channel: row.rms_share for row in found.misfit if row.small_camber and not row.slipping}
    assert worst["Fy"] < 0.01
    assert worst["Mx"] < 0.01
    lines = found.text.split("\r\n")
    assert max(map(len, lines)) < 120
    keys = {words[0]: words[2] for words in map(str.split, lines) if len(words) > 2 and words[1] == "="}
    assert keys["PROPERTY_FILE_FORMAT"] == "'PAC2002'"
    assert keys["USE_MODE"] in ("1", "2", "3", "4")
    assert keys["FE_METHOD"] == "'NO'"  # otherwise its coefficients of combined slip are passed over
    assert keys["LENGTH"] == "'meter'"
    assert all(line.find("$") == -1 or line[line.find("$") - 1] == " " for line in lines)
    assert float(keys["CAMMAX"]) == pytest.approx(math.radians(15.0))
    assert abs(float(keys["QSX4"])) < 5.0 * abs(tyre["QSX4"])


def test_the_shift_by_camber_is_that_of_the_camber_stiffness_factor():
    """(55): without vertical shifts the side force vanishes at a sideslip of -(PHY1 + PHY2 dfz + PHY3 gamma LGAY LKYG)."""
    none = dict.fromkeys(("PVY1", "PVY2", "PVY3", "PVY4", "PHY2"), 0.0)
    given = {**read_old(OLD).values, **none, "PHY1": 0.002, "PHY3": 0.03, "LGAY": 1.5, "LKYG": 0.4}
    p, gamma = mf52.in_terms_of_62(given), 0.1
    alpha = np.linspace(-0.02, 0.02, 4001)
    Fy = mf52.forces(p, np.full(4001, 4000.0), alpha, np.full(4001, gamma)).Fy
    assert alpha[np.argmin(np.abs(Fy))] == pytest.approx(-(0.002 + 0.03 * gamma * 1.5 * 0.4), abs=1e-5)


@pytest.mark.parametrize("kind", ["mf52", "pac2002"])
def test_a_file_of_ours_reads_back_without_a_warning(tmp_path, kind):
    """Neither its keys nor the turn slip that its formula lacks are a problem of the tyre."""
    source = Path(__file__).parents[2] / "tir" / "vectors" / "moto_front.tir"
    found = to_old(source, kind)
    path = tmp_path / "own.tir"
    path.write_text(found.text)
    assert not read_old(path).problems
    assert {p.name for p in convert(path).problems} <= {p.name for p in found.problems}
