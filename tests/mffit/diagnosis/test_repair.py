"""Only likely effects are repaired, and no property file is replaced by one that is worse alone."""

from __future__ import annotations

import json
from contextlib import suppress
from types import SimpleNamespace

import numpy as np
import pytest
from blind_set import draw_case, write_case
from small_programme import LOADS, SLIP, TYRE, U_FY, U_MZ

from mffit import pipeline
from mffit.cli import main
from mffit.config import RigTable
from mffit.diagnosis import diagnose
from mffit.effects import CATALOG, Effect, Free
from mffit.points import make_points
from mffit.report import text
from mffit.rig import Simulation

CONFIG = SimpleNamespace(
    tyre=SimpleNamespace(name="warm"),
    model=SimpleNamespace(turn_slip=True, star=False, u_coefficients=0.0),
    rig=RigTable(type="flat-track"),
)
GRIP = Effect("grip", "friction", "tyre", "Another friction.", (Free("LMUY", 0.1, (0.0,), 0.3, 2.0),))
TEMPERATURE = next(effect for effect in CATALOG if effect.id == "temperature")
PER_KELVIN = -0.01


@pytest.fixture(scope="module")
def tied(tmp_path_factory):
    """A campaign of a tyre with ply-steer, which a misaligned axis explains as well."""
    folder = tmp_path_factory.mktemp("tied")
    write_case(draw_case("tied", ("ply-steer",), "moderate", 23), folder / "rig", folder / "truth.json")
    return folder


def test_a_suspicion_is_listed_and_not_repaired(tied):
    found = pipeline.diagnose(tied / "rig" / "tyre.toml", tied / "rig" / "given.tir", out=tied / "out")
    (effect,) = found.effects
    assert effect.tied
    assert effect.confidence < 0.5
    assert not effect.repaired
    assert found.gap_after == found.gap_before
    assert found.effects[0].gap_after.Fy_rmse_N < 0.9 * found.gap_before.Fy_rmse_N
    assert (tied / "out" / "tied.tir").read_text() == (tied / "rig" / "given.tir").read_text()
    assert json.loads((tied / "out" / "diagnosis.json").read_text())["effects"][0]["repaired"] is False
    assert "not repaired" in found.headline
    assert "suspected and not repaired" in text.diagnosis_summary(found)
    assert "suspected, not repaired" in (tied / "out" / "diagnosis.html").read_text()


def test_repair_all_repairs_a_suspicion(tied, capsys):
    toml, model = str(tied / "rig" / "tyre.toml"), str(tied / "rig" / "given.tir")
    arguments = ["diagnose", toml, "--model", model, "--repair-all", "--json", "--out", str(tied / "all")]
    with suppress(SystemExit):
        main(arguments)
    content = json.loads(capsys.readouterr().out)
    assert content["effects"][0]["repaired"] is True
    assert content["gap_after"]["Fy_rmse_N"] < 0.9 * content["gap_before"]["Fy_rmse_N"]


def test_a_file_that_is_worse_alone_does_not_replace_the_given_one():
    """The tyre warms up along each sweep; the given model took up the mean loss of friction, which a term should hold."""
    rows = np.array([(a, load, k) for k, load in enumerate((*LOADS, 1400.0)) for a in (*SLIP, *SLIP[::-1])])
    n = len(rows)
    rng = np.random.default_rng(3)
    points = make_points(
        np.radians(rows[:, 0]), 0.0, rows[:, 1], p=250e3, V=10.0, phi_t=0.0, u_Fy=U_FY, u_Mz=U_MZ,
        sweep=rows[:, 2].astype(int), sweep_names=("a", "b", "c"),
        T=30.0 + 4.0 * np.abs(rows[:, 0]) + rng.normal(0.0, 1.0, n),
    )  # fmt: skip
    warmth = 1.0 + PER_KELVIN * (points.T - points.T.min())
    Fy, Mz = Simulation.of(TYRE).readings(points)
    points = points.replace(
        Fy=warmth * Fy + U_FY * rng.standard_normal(n), Mz=warmth * Mz + U_MZ * rng.standard_normal(n)
    )
    given = TYRE.replace(LMUY=0.75)
    found = diagnose(points, given, CONFIG, effects=(GRIP, TEMPERATURE), repair_all=True)
    assert {one.effect.id for one in found.effects} == {"grip", "temperature"}
    check = found.validation
    assert check.gap_after.Fy_rmse_N < 0.3 * check.gap_before.Fy_rmse_N
    assert check.gap_file.Fy_rmse_N > 1.1 * check.gap_before.Fy_rmse_N
    assert found.tyre.values == given.values
    assert found.with_terms is not None
    assert found.with_terms["LMUY"] == pytest.approx(found.state.values["LMUY"])
    assert "The property file is the given one" in text.diagnosis_summary(found).replace("\n  ", " ")
