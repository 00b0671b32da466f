"""The exported MATLAB functions in Octave, against the equations and MFeval's own numbers."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import tir
from tir.codegen import matlab
from tir.codegen.matlab import STATE_TEXTS, MatlabCode, export_matlab
from tir.codegen.program import INPUTS, ORDER, Switches
from tir.equations.forces import Forces
from tir.evaluate import evaluate

pytest.importorskip("scipy")  # exchanges arrays with Octave
from tests.octave import needs_octave, run

ROOT = Path(__file__).parents[2]
VECTORS = ROOT / "tests" / "tir" / "vectors"
SAMPLES = ROOT / "samples"
DISC, CAR = SAMPLES / "front-120-70" / "true.tir", SAMPLES / "flat-track-combined" / "true.tir"
CALL = "Fz, kappa, alpha, gamma, phi_t, Vx, pressure"
pytestmark = pytest.mark.filterwarnings("ignore:turn slip is on")
"""The public files have the common defaults of turn slip."""


def put(code: MatlabCode, folder: Path, name: str) -> None:
    (folder / f"{name}.m").write_text(code.function, encoding="ascii")
    (folder / f"{name}_mfeval.m").write_text(code.mfeval, encoding="ascii")


def conditions(tyre: tir.Tyre, n: int) -> dict[str, np.ndarray]:
    """Random ones far beyond the ranges, and each input once 0, infinite and NaN; columns by name."""
    rng, load = np.random.default_rng(7), tyre["FNOMIN"]
    usual = {
        "Fz": load, "alpha": 0.03, "gamma": 0.1, "kappa": 0.01, "phi_t": -0.2, "Vx": 10.0, "pressure": tyre["INFLPRES"],
    }  # fmt: skip
    ends = {
        "Fz": (-0.05 * load, 3.0 * load), "alpha": (-0.6, 0.6), "gamma": (-0.9, 0.9), "kappa": (-1.0, 1.0), "phi_t": (-0.8, 0.8),
        "Vx": (-30.0, 30.0), "pressure": (0.4 * usual["pressure"], 1.6 * usual["pressure"]),
    }  # fmt: skip
    odd = [usual | {key: value} for key in INPUTS for value in (0.0, 1e6, -1e6, np.inf, -np.inf, np.nan)]
    return {
        key: np.concatenate([rng.uniform(*ends[key], n), [row[key] for row in odd]])[:, None]
        for key in INPUTS
    }


def assert_equal(found: np.ndarray, right: np.ndarray, name: str) -> None:
    """To 1e-12 of the largest value of ordinary conditions; infinite and NaN where the equations are."""
    assert not np.iscomplexobj(found), name
    right = np.broadcast_to(right, found.shape)
    sound = np.isfinite(right)
    assert np.array_equal(found[~sound], right[~sound], equal_nan=True), name
    largest = np.quantile(np.abs(right[sound]), 0.999)
    scale = np.maximum(np.abs(right[sound]), largest)
    assert np.max(np.abs(found[sound] - right[sound]) / scale) < 1e-12, name


@needs_octave
@pytest.mark.parametrize(
    ("file", "switches", "count"),
    [
        (DISC, Switches(turn_slip=True), 100_000),
        (DISC, Switches(turn_slip=False), 10_000),
        (CAR, Switches(turn_slip=False), 100_000),
        (VECTORS / "moto_front.tir", Switches(True, True, True), 10_000),
        (VECTORS / "MagicFormula62.tir", Switches(True, False, True), 10_000),
    ],
    ids=["disc-turn-slip", "disc-normal", "car", "motorcycle-star-limits", "car-turn-slip-limits"],
)
def test_the_function_equals_the_equations(tmp_path, file, switches, count):
    tyre = tir.read(file)
    put(export_matlab(tyre, name="front", **switches._asdict()), tmp_path, "front")
    given = conditions(tyre, count)
    found = run(tmp_path, f"[r, s] = front({CALL});", **given)
    with np.errstate(all="ignore"):
        forces, state = evaluate(tyre.p, **given, **switches._asdict())
    for name in Forces._fields:
        assert_equal(found["r"][name], getattr(forces, name), name)
    for name in STATE_TEXTS:
        assert_equal(found["s"][name], getattr(state, name), name)


@needs_octave
def test_any_sizes_that_fit_expand_and_the_last_inputs_may_be_left_out(tmp_path):
    tyre = tir.read(CAR)
    put(export_matlab(tyre, name="front"), tmp_path, "front")
    script = """
    column = [1000; 3000; 5000]; row = [-0.1 0 0.1 0.2];
    scalar = front(4000); matrix = front(column, 0.02, row); down = front(column, 0.02, 0.1);
    across = front(4000, 0, row, 0.01, 0, 20, 2e5); cube = front(column, 0, row, ones(1, 1, 2) * 0.02);
    single_load = front(single(4000), 0, 0.1); whole_load = front(int32(4000), 0, 0.1); nothing = front(zeros(0, 1));
    """
    found = run(tmp_path, script)
    column, row = np.array([[1000.0], [3000.0], [5000.0]]), np.array([[-0.1, 0.0, 0.1, 0.2]])
    for name, right in {
        "scalar": tyre(np.array([[4000.0]])),
        "matrix": tyre(column, kappa=0.02, alpha=row),
        "down": tyre(column, kappa=0.02, alpha=0.1),
        "across": tyre(4000.0, alpha=row, gamma=0.01, Vx=20.0, p=2e5),
        "cube": tyre(column[:, :, None], alpha=row[:, :, None], gamma=np.full((1, 1, 2), 0.02)),
        "single_load": tyre(np.array([[4000.0]]), alpha=0.1),
        "whole_load": tyre(np.array([[4000.0]]), alpha=0.1),
        "nothing": tyre(np.zeros((0, 1))),
    }.items():
        for force in Forces._fields:
            wanted = getattr(right, force)
            assert found[name][force].shape == wanted.shape, name
            assert found[name][force] == pytest.approx(wanted, rel=1e-12, abs=1e-9), name


@needs_octave
def test_scaling_factors_are_the_last_argument(tmp_path):
    tyre = tir.read(VECTORS / "moto_front.tir").replace(LKYC=0.9)
    put(export_matlab(tyre, name="front", turn_slip=True), tmp_path, "front")
    call = "front(1400, 0.02, 0.06, 0.3, -0.1, 10, 2.2e5"
    script = f"""
    [as_in_file, ~, t] = {call});
    t.LMUY = 0.7; t.LTR = 1.1; t.LFZO = 1.2; t.LMP = 0.5; turned = {call}, t);
    wrong = t; wrong.LMUy = 1; refused = 0;
    try, {call}, wrong); catch, refused = refused + 1; end
    try, {call}, struct('LMUY', 0.8)); catch, refused = refused + 1; end
    t.LMUY = [0.7 0.8];
    try, {call}, t); catch e, said = e.message; end
    """
    found = run(tmp_path, script)
    at = {"kappa": 0.02, "alpha": 0.06, "gamma": 0.3, "phi_t": -0.1, "Vx": 10.0, "pressure": 2.2e5}
    changed = tyre.replace(LMUY=0.7, LTR=1.1, LFZO=1.2, LMP=0.5)
    for name, one in (("as_in_file", tyre), ("turned", changed)):
        right = evaluate(one.p, 1400.0, **at, turn_slip=True)[0]
        for force in Forces._fields:
            assert found[name][force].item() == pytest.approx(float(getattr(right, force)), rel=1e-12), name
    assert found["t"]["LKYC"].item() == 0.9
    assert found["refused"] == 2, "a field that does not exist, or one that is missing, was accepted"
    assert found["said"][0] == "a factor in tuning is not a scalar"


MFEVAL = {
    "Fx": 1, "Fy": 2, "Mx": 4, "My": 5, "Mz": 6, "Re": 13, "Kya": 26, "sigma_x": 27, "sigma_y": 28, "Kxk": 30,
}  # fmt: skip
"""Columns of MFeval 4 by its documentation, counted from 1."""


@needs_octave
def test_the_columns_are_those_of_mfeval(tmp_path):
    """Against numbers of MFeval itself; it adds 1e-6 to divisors of Mz, see the vectors' page."""
    tyre = tir.read(VECTORS / "moto_front.tir")
    rows = np.genfromtxt(VECTORS / "mfeval_moto_front.csv", delimiter=",", names=True)
    rows = rows[rows["mode"] == 211]
    put(export_matlab(tyre, name="front", turn_slip=False), tmp_path, "front")
    given = np.array([rows[key] for key in ("Fz", "kappa", "alpha", "gamma", "gamma", "Vx", "p")]).T
    given[:, 4] = 0.0  # phit
    script = """
    out = front_mfeval(given, 211); usual = front_mfeval(given(1, 1:6));
    try, front_mfeval(given, 112), catch e, said = e.message; end
    """
    found = run(tmp_path, script, given=given)
    out = found["out"]
    assert out.shape == (len(rows), 30)
    for name, column in MFEVAL.items():
        right, limit = rows[name], 5e-5 if name == "Mz" else 1e-7
        scale = np.maximum(np.abs(right), 1e-3 * np.max(np.abs(right)))
        assert np.max(np.abs(out[:, column - 1] - right) / scale) < limit, name
    assert np.array_equal(out[:, [2, *range(6, 12)]], given)
    assert out[:, 22] == pytest.approx(np.abs(out[:, 29]) / out[:, 26])
    assert list(np.flatnonzero(np.isnan(out).all(axis=0)) + 1) == [14, 15, 20, 21, 25, 29]
    assert found["usual"][0, 11] == tyre["INFLPRES"]
    assert found["said"][0].startswith(
        "this tyre was exported for useMode 211. For another one, mffit export"
    )
    for option in ("--limits", "--turn-slip", "--no-turn-slip", "star=True"):
        assert option in found["said"][0]


@pytest.mark.parametrize("turn_slip", [False, True])
def test_the_text_has_only_what_code_generation_allows(turn_slip):
    """No cells, handles, loops, growing arrays or functions beyond a short list; a variable is set before it is read."""
    code = export_matlab(tir.read(VECTORS / "moto_front.tir"), name="front", turn_slip=turn_slip, limits=True)
    for text in code:
        assert text.isascii()
        assert re.match(r"function [^\r\n]*\n(%.*\n)+\n%#codegen\n", text)
        assert max(map(len, text.splitlines())) <= 130
        bare = re.sub(r"'[^']*'|%.*", "", text)
        assert not re.search(
            r"[{}@!\"]|\beval\b|\bfeval|\bend *\+|\bclear\b|\bglobal\b|\bwhile\b|\bfor\b", bare
        )
        called = {word.lower() for word in re.findall(r"(?<![.\w])([A-Za-z]\w*)\(", bare)}
        own = {"front", "front_mfeval", "evaluate", "choose", "r", "a", "in"}
        assert called <= matlab.CALLED | own | {"if"}, called
        assert bare.count("(") == bare.count(")")
    body = code.function.split("function [r, s] = evaluate(")[1].replace("...\n", "")
    known = set(body.split(")", 1)[0].split(", ")) | matlab.CALLED | {"choose", "Inf", "NaN"}
    for line in re.findall(r"^(\w+) = (.*);$", body.split("end\n")[0], re.MULTILINE):
        words = {*re.findall(r"(?<![.\w'])[A-Za-z]\w*", line[1])}
        assert words <= known, f"{line[0]} reads {words - known} before it is set"
        known.add(line[0])
    assert len({word for word in known if re.fullmatch(r"x\d+", word)}) < 70, "a variable is not used again"


def test_the_help_text_names_inputs_outputs_and_where_the_tyre_is_from():
    tyre = tir.read(VECTORS / "moto_front.tir")
    origin = "From a\nsystem('x').tir"
    function, mfeval = export_matlab(tyre, name="front", turn_slip=True, limits=True, origin=origin)
    first = function.split("\n\n%#codegen")[0]
    assert all(line[0] == "%" for line in first.splitlines()[1:])
    for word in (
        "turn slip on",
        "inputs held to",
        "From a system('x').tir",
        "sideslip angle",
        "tuning.LMUY",
        "[N/rad]",
    ):
        assert word in first
    assert function.split("(")[1].startswith(", ".join(ORDER[:-1]))
    assert "only 112 is accepted" in mfeval
    assert "From a system" in mfeval


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("2front", "not a valid name in MATLAB"),
        ("End", "tyre_End"),
        ("sqrt", "tyre_sqrt"),
        ("t" * 57, "longer than the 56"),
    ],
)
def test_a_name_that_matlab_cannot_have_is_refused(name, words):
    with pytest.raises(tir.TirError, match=words):
        export_matlab(tir.Tyre.from_values({}), name=name)


def test_a_value_that_is_not_finite_is_named():
    with pytest.raises(tir.TirError, match="PKY1 is nan, which exported code cannot hold"):
        export_matlab(tir.Tyre.from_values({"PKY1": float("nan")}))


def test_a_divisor_that_is_zero_is_named():
    with pytest.raises(tir.TirError, match="LMUY is 0"):
        export_matlab(tir.Tyre.from_values({"LMUY": 0.0}))
