"""The exported C, compiled, against the equations."""

from __future__ import annotations

import ctypes
import inspect
import platform
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import tir
from tir.codegen import c99
from tir.codegen.javascript import javascript
from tir.codegen.lag import LAG_INPUTS
from tir.codegen.program import INPUTS, Switches
from tir.equations.forces import Forces
from tir.evaluate import evaluate
from tir.exporting import STATES
from tir.parameters import TABLE
from tir.transient import Contact, step

VECTORS = Path(__file__).parent / "vectors"
COMPILER = next((name for name in ("cc", "gcc", "clang") if shutil.which(name)), None)
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
pytestmark = pytest.mark.filterwarnings("ignore:turn slip is on")
"""The public files have the common defaults of turn slip."""
STRICT = [
    "-std=c99",
    "-pedantic",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-Wdouble-promotion",
    "-ffp-contract=off",
    "-O2",
]


def record(names) -> type[ctypes.Structure]:
    return type("Record", (ctypes.Structure,), {"_fields_": [(name, ctypes.c_double) for name in names]})


def compiled(code, name: str, folder: Path, *flags: str) -> ctypes.CDLL:
    (folder / f"{name}.h").write_text(code.header, encoding="ascii")
    (folder / f"{name}.c").write_text(code.source, encoding="ascii")
    library = folder / f"{name}.so"
    command = [str(COMPILER), *STRICT, *flags, "-shared", "-fPIC", f"{name}.c", "-o", str(library), "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return ctypes.CDLL(str(library))


@pytest.fixture
def conditions(request) -> list[list[float]]:
    rng = np.random.default_rng(11)
    n = 300
    rows = np.array(
        [
            rng.uniform(-100.0, 6000.0, n), rng.uniform(-0.4, 0.4, n), rng.uniform(-0.9, 0.9, n), rng.uniform(-0.5, 0.5, n),
            rng.uniform(-0.8, 0.8, n), rng.uniform(-30.0, 30.0, n), rng.uniform(1e5, 4e5, n),
        ]
    ).T.tolist()  # fmt: skip
    rows.append([2000.0, 0.03, 0.0, 0.01, 0.0, 10.0, 2.2e5])  # no spin at all
    usual = [2000.0, 0.03, 0.1, 0.01, -0.2, 10.0, 2.2e5]
    for i in range(len(INPUTS)):
        rows += [[*usual[:i], value, *usual[i + 1 :]] for value in (0.0, float("nan"))]
    return rows


@needs_compiler
@pytest.mark.parametrize("file", ["MagicFormula62", "moto_front"])
@pytest.mark.parametrize("switches", [Switches(), Switches(True), Switches(True, True, True)], ids=str)
def test_the_compiled_code_equals_the_equations(tmp_path, conditions, file, switches):
    tyre = tir.read(VECTORS / f"{file}.tir")
    library = compiled(tir.export_c(tyre, name="front_1", **switches._asdict()), "front_1", tmp_path)
    with np.errstate(all="ignore"):
        wanted = evaluate(
            tyre.p, **dict(zip(INPUTS, np.array(conditions).T, strict=True)), **switches._asdict()
        )
    for function, names, values in (
        (library.front_1_evaluate, Forces._fields, wanted[0]),
        (library.front_1_evaluate_state, STATES, wanted[1]),
    ):
        function.argtypes, function.restype = [ctypes.c_double] * len(INPUTS), record(names)
        found = [function(*row) for row in conditions]
        for name in names:
            assert_near(np.array([getattr(one, name) for one in found]), getattr(values, name))


def assert_near(a: np.ndarray, wanted) -> None:
    b = np.broadcast_to(wanted, a.shape)
    sound = np.isfinite(b)
    assert np.array_equal(a[~sound], b[~sound], equal_nan=True)
    scale = np.maximum(np.abs(b[sound]), 1e-3 * np.max(np.abs(b[sound])))
    assert np.max(np.abs(a[sound] - b[sound]) / scale) < 1e-12


GLIBC = platform.libc_ver()
IN_VECTORS = (
    shutil.which("gcc")
    and platform.machine() == "x86_64"
    and GLIBC[0] == "glibc"
    and tuple(map(int, GLIBC[1].split("."))) >= (2, 35)
)


@needs_compiler
@pytest.mark.parametrize("flags", [(), ("-O3", "-march=native")], ids=["as it is", "in vectors"])
@pytest.mark.parametrize("switches", [Switches(), Switches(True, True, True)], ids=str)
def test_many_conditions_equal_the_equations(tmp_path, conditions, switches, flags):
    tyre = tir.read(VECTORS / "moto_front.tir")
    library = compiled(tir.export_c(tyre, name="m", **switches._asdict()), "m", tmp_path, *flags)
    inputs = np.array(conditions).T.copy()
    found = np.full((len(Forces._fields), inputs.shape[1]), -1.0)
    pointers = [x.ctypes.data_as(ctypes.c_void_p) for x in (*inputs, *found)]
    library.m_evaluate_many(ctypes.c_size_t(inputs.shape[1]), *pointers)
    with np.errstate(all="ignore"):
        wanted = evaluate(tyre.p, **dict(zip(INPUTS, inputs, strict=True)), **switches._asdict())[0]
    for a, b in zip(found, wanted, strict=True):
        assert_near(a, b)


@pytest.mark.skipif(not IN_VECTORS, reason="gcc on x86-64 with glibc 2.35 computes in vectors")
def test_gcc_computes_many_conditions_in_vectors(tmp_path):
    compiled(tir.export_c(tir.read(VECTORS / "moto_front.tir"), name="m", turn_slip=True), "m", tmp_path)
    # vectors of eight; for shorter ones the gain is too small for some versions
    command = ["gcc", "-O3", "-march=skylake-avx512", "-fopt-info-loop-optimized", "-c", "m.c"]
    said = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stderr
    assert "loop vectorized" in said


def test_the_code_allocates_nothing_and_keeps_nothing():
    code = tir.export_c(tir.read(VECTORS / "moto_front.tir"))
    assert not re.search(r"malloc|static|float\b|while|goto", code.source)
    assert len(re.findall(r"for\s*\(", code.source)) == 1, "that of many conditions"
    assert re.findall(r"#include\s+(\S+)", code.source) == ['"tyre.h"', "<math.h>"]
    assert (code.header + code.source).isascii()
    assert set(re.findall(r"^\w.*\(", code.source.replace(c99.IN_VECTORS, ""), re.MULTILINE)) == {
        "void tyre_evaluate_many(",
        "tyre_forces tyre_evaluate(",
        "tyre_state tyre_evaluate_state(",
    }


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("2front", "not a valid name in C"),
        ("a b", "not a valid name in C"),
        ("", "not a valid name in C"),
        ("double", "tyre_double"),
        ("Math", "tyre_Math"),
    ],
)
def test_a_name_that_is_invalid_in_c_is_refused(name, words):
    with pytest.raises(tir.TirError, match=words):
        tir.export_c(tir.Tyre.from_values({}), name=name)


def test_inputs_have_one_name_in_every_language():
    """That of a call of the tyre; CasADi and the FMU have tests of their own."""
    inputs = {"Fz", "alpha", "gamma", "kappa", "phi_t", "Vx", "p"}
    tyre = tir.read(VECTORS / "moto_front.tir")
    called = {*inspect.signature(tir.Tyre.__call__).parameters} - {"self", "turn_slip", "star", "limits"}
    code = tir.export_c(tyre, name="t", tunable=True, lag=True)
    heads = {
        function: set(re.findall(r"double (\w+)", arguments))
        for function, arguments in re.findall(
            r"^t_\w+ (t_\w+)\((.*)\)", code.header + code.source, re.MULTILINE
        )
    }
    for end in ("evaluate", "evaluate_state", "evaluate_tuned", "evaluate_state_tuned"):
        assert heads[f"t_{end}"] == inputs
    contact = {*tir.transient.ContactInputs._fields}
    assert heads["t_contact"] == heads["t_step"] - {"dt"} == contact | {"u", "v"}
    (arguments,) = re.findall(r"return \((.*)\) => {", javascript())
    assert called == set(arguments.split(", ")) == inputs
    assert "   p        inflation pressure [Pa]" in code.header


@needs_compiler
def test_numbers_beyond_all_bounds_are_written_as_c_has_them(tmp_path):
    """A stiffness of 0 divides: the relaxation length is infinite, in C too."""
    tyre = tir.read(VECTORS / "moto_front.tir").replace(LATERAL_STIFFNESS=0.0)
    library = compiled(tir.export_c(tyre), "tyre", tmp_path)
    function = library.tyre_evaluate_state
    function.argtypes, function.restype = [ctypes.c_double] * len(INPUTS), record(STATES)
    assert function(2000.0, 0.03, 0.1, 0.01, -0.2, 10.0, 2.2e5).sigma_y == float("inf")


def test_values_that_code_cannot_hold_are_named():
    with pytest.raises(tir.TirError, match="LMUY is 0"):
        tir.export_c(tir.Tyre.from_values({"LMUY": 0.0}))
    with pytest.raises(tir.TirError, match="PKY1 is nan"):
        tir.export_c(tir.Tyre.from_values({"PKY1": float("nan")}))


@needs_compiler
def test_scaling_factors_are_arguments_of_the_tuned_functions(tmp_path):
    tyre = tir.read(VECTORS / "moto_front.tir").replace(LKYC=0.9)
    library = compiled(tir.export_c(tyre, name="t", turn_slip=True, tunable=True), "t", tmp_path)
    factors = [row.name for row in TABLE if row.scaling]
    tuning = record(factors)
    library.t_as_in_file.restype = tuning
    at = [1400.0, 0.06, 0.3, 0.02, -0.1, 10.0, 2.2e5]
    library.t_evaluate_tuned.argtypes = [ctypes.POINTER(tuning), *[ctypes.c_double] * len(INPUTS)]
    library.t_evaluate_tuned.restype = record(Forces._fields)
    for changes in ({}, {"LMUY": 0.7, "LTR": 1.1, "LFZO": 1.2, "LMP": 0.5}):
        turned = library.t_as_in_file()
        for name, value in changes.items():
            setattr(turned, name, value)
        found = library.t_evaluate_tuned(ctypes.byref(turned), *at)
        wanted = evaluate(tyre.replace(**changes).p, *at, turn_slip=True)[0]
        for name in Forces._fields:
            assert getattr(found, name) == pytest.approx(float(getattr(wanted, name)), rel=1e-12)


@needs_compiler
@pytest.mark.parametrize("turn_slip", [False, True])
def test_the_lag_in_c_is_that_of_the_transient_contact(tmp_path, turn_slip):
    """Rolling, standing, backwards and lifted, in steps of any length."""
    tyre = tir.read(VECTORS / "moto_front.tir")
    library = compiled(tir.export_c(tyre, name="t", turn_slip=turn_slip, lag=True), "t", tmp_path)
    factors = [row.name for row in TABLE if row.scaling]
    tuning = record(factors)
    library.t_as_in_file.restype = tuning
    turned = library.t_as_in_file()
    n = 2 + len(LAG_INPUTS)
    library.t_step.argtypes = [ctypes.POINTER(tuning), *[ctypes.c_double] * (n + 1)]
    library.t_step.restype = record(("u", "v"))
    library.t_contact.argtypes = [ctypes.POINTER(tuning), *[ctypes.c_double] * n]
    library.t_contact.restype = record((*Forces._fields, *STATES, "kappa", "alpha"))
    rng = np.random.default_rng(6)
    contact = Contact()
    for i in range(60):
        Vx = float(rng.choice([0.0, 0.3, 15.0, -8.0]))
        Fz, dt = (
            float(rng.choice([1400.0, 900.0, 0.0], p=[0.6, 0.3, 0.1])),
            float(rng.choice([1e-4, 0.01, 1.0])),
        )
        Vsx, Vsy, gamma, phi_t = (
            rng.uniform(-0.5, 0.5),
            rng.uniform(-0.8, 0.8),
            rng.uniform(-0.4, 0.4),
            rng.uniform(-0.1, 0.1),
        )
        damping = float(i % 2) * 400.0
        given = (Fz, Vx, Vsx, Vsy, gamma, phi_t, 2.4e5, damping)
        moved = library.t_step(ctypes.byref(turned), dt, *contact, *given)
        contact, forces = step(
            tyre, contact, dt, Fz, Vx, Vsx, Vsy, gamma, phi_t, 2.4e5, damping=damping, turn_slip=turn_slip
        )
        assert (moved.u, moved.v) == pytest.approx(contact, rel=1e-9, abs=1e-15)
        found = library.t_contact(ctypes.byref(turned), *contact, *given)
        assert [getattr(found, name) for name in Forces._fields] == pytest.approx(
            list(forces), rel=1e-9, abs=1e-9
        )
