"""A base for other nominal conditions: what is not fitted keeps the base's forces."""

from __future__ import annotations

import itertools
import shutil
import tomllib
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
import tomli_w

import mffit
import tir
from mffit.comparison import wording
from mffit.errors import InputError
from mffit.fit.at_nominal import CONDITIONS, Nominal, at_nominal, tyre_at_nominal
from tir.equations import vertical
from tir.mode import BLOCK
from tir.parameters import TABLE

SAMPLES = Path(__file__).parents[3] / "samples"
VECTORS = Path(__file__).parents[2] / "tir" / "vectors"
ALL_TERMS = {
    "PFZ1": 0.6, "Q_FZ2": 4.0, "Q_V1": 3e-4, "QSY2": 0.01, "QSY3": 4e-4, "QSY4": 3e-5, "QSY5": 0.2, "QSY6": -0.1, "QSY7": 0.85,
    "QSY8": -0.4, "QSX4": 0.3, "QSX5": 0.8, "QSX6": 1.2, "QSX7": 0.4, "QSX8": -0.6, "QSX9": 0.7, "PPMX1": 0.2, "PDXP2": 0.1,
    "PDYP2": -0.2, "PECP2": 0.3, "PHYP3": 0.05, "PCFX1": 0.2, "PCFX2": -0.03, "PCFX3": 0.3, "PCFY1": 0.1, "PCFY2": -0.02,
    "PCFY3": 0.4, "PEX3": -0.2, "PKX3": 0.3, "QBZ3": 0.4, "QEZ3": -0.3,
}  # fmt: skip
"""Terms that the reference tyre lacks, so that every one of the equations counts."""


@pytest.fixture(scope="module")
def base() -> tir.Tyre:
    return tir.read(VECTORS / "moto_front.tir").replace(**ALL_TERMS)


def at(tyre: tir.Tyre, wanted: Nominal) -> tir.Tyre:
    return replace(tyre, values=MappingProxyType(at_nominal(tyre.values, wanted)))


def drawn_nominal(tyre: tir.Tyre, rng: np.random.Generator, *, vary: tuple[bool, ...]) -> Nominal:
    return Nominal(
        *(
            x * np.exp(on * rng.uniform(-0.5, 0.5))
            for x, on in zip(Nominal.of(tyre.values), vary, strict=True)
        )
    )


def drawn_conditions(rng: np.random.Generator) -> dict[str, np.ndarray]:
    ends = {
        "Fz": (300.0, 3000.0), "alpha": (-0.3, 0.3), "gamma": (-0.8, 0.8), "kappa": (-0.3, 0.3), "phi_t": (-0.4, 0.4),
        "Vx": (3.0, 40.0), "p": (150e3, 350e3),
    }  # fmt: skip
    return {name: rng.uniform(*end, 300) for name, end in ends.items()}


def assert_same(found: np.ndarray, expected: np.ndarray) -> None:
    """Equal to rounding, relative to the largest of each row."""
    size = np.max(np.abs(expected), axis=-1, keepdims=True)
    np.testing.assert_allclose(found / size, expected / size, atol=1e-10)


def test_every_force_stays_without_turn_slip(base):
    """Load, pressure, speed and radius at once, evaluated by the equations themselves."""
    rng = np.random.default_rng(1)
    for _ in range(20):
        other = at(base, drawn_nominal(base, rng, vary=(True, True, True, True)))
        where = drawn_conditions(rng)
        assert_same(np.array(other(**where, turn_slip=False)), np.array(base(**where, turn_slip=False)))


def test_every_force_stays_with_turn_slip(base):
    """Where the file is one for turn slip, pressure included: it has no pressure term in the stiffness of its moment."""
    rng = np.random.default_rng(2)
    base = base.replace(USE_MODE=125)
    for _ in range(20):
        other = at(base, drawn_nominal(base, rng, vary=(True, True, True, False)))
        where = drawn_conditions(rng)
        assert_same(np.array(other(**where, turn_slip=True)), np.array(base(**where, turn_slip=True)))


def test_path_curvature_pushes_as_before_if_the_radius_is_another(base):
    """Upright, all spin is that of the path, which the equations multiply by the free radius."""
    wanted = Nominal.of(base.values)._replace(radius=1.07 * base["UNLOADED_RADIUS"])
    where = drawn_conditions(np.random.default_rng(3)) | {"gamma": 0.0}
    found, expected = (np.array(t(**where, turn_slip=True)) for t in (at(base, wanted), base))
    assert_same(found, expected)


def test_radii_and_relaxation_lengths_stay(base):
    rng = np.random.default_rng(4)
    for _ in range(20):
        other = at(base, drawn_nominal(base, rng, vary=(True, True, True, False)))
        where = drawn_conditions(rng)
        found, expected = (t.state(**where, turn_slip=False) for t in (other, base))
        for name in ("Re", "sigma_x", "sigma_y", "K_xk", "K_ya", "mu_x", "mu_y"):
            np.testing.assert_allclose(
                getattr(found, name), getattr(expected, name), rtol=1e-10, err_msg=name
            )
        deflections = [
            vertical.deflection(t.p, where["Fz"], where["p"] / t["NOMPRES"] - 1.0) for t in (other, base)
        ]
        np.testing.assert_allclose(*deflections, rtol=1e-10)


def test_another_free_radius_moves_the_rolling_radius_and_keeps_the_deflection(base):
    still = base.replace(Q_V1=0.0)
    longer = at(still, Nominal.of(base.values)._replace(radius=base["UNLOADED_RADIUS"] + 0.02))
    load = np.linspace(300.0, 3000.0, 9)
    change = longer.state(load).Re - still.state(load).Re
    np.testing.assert_allclose(change, 0.02 * base["Q_RE0"], rtol=1e-9)
    deflections = [vertical.deflection(t.p, load, 0.0) for t in (longer, still)]
    np.testing.assert_allclose(*deflections, rtol=1e-10)


def test_what_other_programs_evaluate_stays_too(base):
    """The products in the published formulae of load over deflection (paper, 4), contact patch and yaw stiffness."""
    base = base.replace(Q_V2=0.05, Q_FCX=0.2, Q_FCY=0.3, PCMZ1=0.4)
    other = at(base, Nominal(1.4 * base["FNOMIN"], 190e3, 25.0, 0.95 * base["UNLOADED_RADIUS"]))
    load, p = np.array([600.0, 1500.0]), 220e3

    def numbers(t: tir.Tyre) -> np.ndarray:
        dpi, R0, F0 = p / t["NOMPRES"] - 1.0, t["UNLOADED_RADIUS"], t["FNOMIN"]
        relative = load / (t["VERTICAL_STIFFNESS"] * (1.0 + t["PFZ1"] * dpi) * R0)
        return np.array(
            [
                R0 * (t["Q_RA1"] * np.sqrt(relative) + t["Q_RA2"] * relative),
                t["Q_RB1"] * np.cbrt(relative) + t["Q_RB2"] * relative,
                t["Q_V2"] * R0 / t["LONGVL"] * np.ones(2),
                t["Q_FCX"] / F0 * np.ones(2),
                t["Q_FCY"] / F0 * np.ones(2),
                t["YAW_STIFFNESS"] * (1.0 + t["PCMZ1"] * dpi) * np.ones(2),
            ]
        )

    np.testing.assert_allclose(numbers(other), numbers(base), rtol=1e-12)


def test_guessed_turn_slip_stays_a_guess(base):
    guess = base.replace(**{row.name: row.default for row in BLOCK})
    other = at(guess, Nominal(2.0 * base["FNOMIN"], base["NOMPRES"], 10.0, base["UNLOADED_RADIUS"]))
    assert {row.name: other[row.name] for row in BLOCK} == {row.name: row.default for row in BLOCK}


def test_the_same_conditions_change_nothing(base):
    same = tyre_at_nominal(base, Nominal.of(base.values))
    assert same == base
    assert CONDITIONS not in same.provenance


def test_what_cannot_be_the_same_is_said_with_its_size(base):
    """PPZ2 acts on the camber moment without turn slip and not on that with it: only one of the two can stay."""
    wanted = Nominal.of(base.values)._replace(pressure=200e3)
    said = tyre_at_nominal(base, wanted).provenance[CONDITIONS]
    assert said.startswith(
        "its coefficients hold for 250 kPa and are converted to 200 kPa, but Mz with turn slip"
    )
    assert (
        tyre_at_nominal(base.replace(PPZ2=0.0), wanted)
        .provenance[CONDITIONS]
        .endswith("with the same forces")
    )


def project(folder: Path, base: tir.Tyre, **tyre: float) -> Path:
    """Sideslip sweeps of the flat track only, so that the longitudinal force is that of the base."""
    sample = SAMPLES / "flat-track-combined"
    content = tomllib.loads((sample / "tyre.toml").read_text())
    content["tyre"] |= {"name": "front", "base": "base.tir", **tyre}
    content["sweep"] = [{"file": f"sideslip_{load}N.csv"} for load in (2000, 4200, 6500)]
    for row in content["sweep"]:
        shutil.copy(sample / row["file"], folder)
    base.write(folder / "base.tir")
    (folder / "tyre.toml").write_text(tomli_w.dumps(content))
    return folder / "tyre.toml"


def test_a_build_keeps_the_forces_that_it_does_not_fit(tmp_path):
    base = tir.read(SAMPLES / "flat-track-combined" / "true.tir")
    changed = {"nominal_load": 6300.0, "nominal_pressure": 190.0, "nominal_speed": 25.0}
    changed["unloaded_radius"] = round(1.02 * base["UNLOADED_RADIUS"], 4)
    result = mffit.build(project(tmp_path, base, **changed), with_report=False)
    kappa = np.linspace(-0.2, 0.2, 21)
    for load, alpha in itertools.product((2000.0, 4200.0, 6500.0), (0.0, -0.06, 0.1)):
        found, expected = (
            t(load, alpha=alpha, kappa=kappa, p=230e3, Vx=20.0, turn_slip=False) for t in (result.tyre, base)
        )
        np.testing.assert_allclose(found.Fx, expected.Fx, rtol=1e-9)
    lent = [row.name for row in TABLE if row.stage in ("Fx", "Fx-camber", "Fx-pressure", "combined-Fx")]
    assert {result.fit.coefficients[name].status for name in lent} <= {"base", "converted"}
    assert result.tyre.status["PKX1"] == "from base, converted"
    before, after = "4200 N, 240 kPa, 16.7 m/s, 0.3185 m radius", "6300 N, 190 kPa, 25 m/s, 0.3249 m radius"
    conditions = f"hold for {before} and are converted to {after}"
    assert any(conditions in text for text in result.fit.explanations)
    base.write(tmp_path / "one.tir")
    result.tyre.write(tmp_path / "other.tir")
    said = wording.headline(mffit.compare(tmp_path / "one.tir", tmp_path / "other.tir"))
    assert said.startswith(f"Nominal conditions differ, one.tir {before}, other.tir {after}")


def test_a_factor_that_vanishes_is_refused(tmp_path):
    base = tir.read(SAMPLES / "flat-track-combined" / "true.tir").replace(PPX1=4.0, PPX2=0.0)
    toml = project(tmp_path, base, nominal_pressure=0.75 * base["NOMPRES"] / 1e3)
    with pytest.raises(
        InputError, match=r"tyre\.toml:\d+: tyre\.base: .*base\.tir cannot be converted .*PPX1"
    ):
        mffit.build(toml)


def test_signs_of_the_same_curve_are_those_that_the_fit_allows(tmp_path):
    """MFeval's tyre has PKY1 > 0 with PKY4 < 0, which is the curve of the opposite signs."""
    base = tir.read(VECTORS / "MagicFormula62.tir")
    assert base["PKY1"] > 0.0 > base["PKY4"]
    own = {"nominal_load": base["FNOMIN"], "nominal_pressure": base["NOMPRES"] / 1e3}
    toml = project(
        tmp_path, base, **own, unloaded_radius=base["UNLOADED_RADIUS"], nominal_speed=base["LONGVL"]
    )
    found = mffit.pipeline.inputs.read_base(mffit.config.load(toml))
    assert (found["PKY1"], found["PKY4"]) == (-base["PKY1"], -base["PKY4"])
    outside = [
        row.name for row in TABLE if row.stage and not row.bounds[0] <= found[row.name] <= row.bounds[1]
    ]
    assert not outside
    where = drawn_conditions(np.random.default_rng(5))
    assert_same(np.array(found(**where, turn_slip=False)), np.array(base(**where, turn_slip=False)))
