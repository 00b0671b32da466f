"""Code made from the equations gives the numbers of the equations themselves, on every path and at every edge."""

from __future__ import annotations

import itertools
import math
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import tir
from tir import calls, kernels
from tir.codegen import single
from tir.codegen.cpython import kernel
from tir.codegen.graph import INPUT, PARAMETER, Graph
from tir.codegen.program import INPUTS, Switches, trace
from tir.codegen.replay import replay
from tir.equations.forces import Forces, State
from tir.evaluate import evaluate
from tir.parameters import TABLE

VECTORS = Path(__file__).parent / "vectors"
ALL_SWITCHES = [Switches(*on) for on in itertools.product((False, True), repeat=3)]
TOLERANCE = 1e-12 if np.lib.NumpyVersion(np.__version__) >= "2.0.0" else 3e-12
"""numpy 1 computes tan and arctan three units in the last place off, numpy 2 one; the edges magnify that."""
"""Of the value, or of 1e-3 of the channel's largest: hundreds of roundings in another order."""
needs_llvm = pytest.mark.skipif(kernel.obstacle() is not None, reason="llvmlite is not installed")


@pytest.fixture(scope="module", params=["MagicFormula62", "moto_front"])
def tyre(request) -> tir.Tyre:
    """Every coefficient at work, QDRP2 and the odd ones too."""
    found = tir.read(VECTORS / f"{request.param}.tir")
    rng = np.random.default_rng(7)
    idle = [row.name for row in TABLE if row.section.endswith("COEFFICIENTS") and not found[row.name]]
    return found.replace(**{name: float(rng.uniform(0.01, 0.05)) for name in idle})


@pytest.fixture(scope="module")
def conditions(tyre) -> dict[str, np.ndarray]:
    """Inside and outside the ranges of a file, rolling backwards, and every edge in every input."""
    rng = np.random.default_rng(5)
    n = 500
    ordinary = {
        "Fz": tyre["FNOMIN"] * rng.uniform(-0.1, 2.5, n),
        "alpha": rng.uniform(-1.5, 1.5, n) ** 3,
        "gamma": rng.uniform(-1.0, 1.0, n),
        "kappa": rng.uniform(-1.0, 1.0, n) ** 3,
        "phi_t": rng.uniform(-1.0, 1.0, n),
        "Vx": rng.uniform(-30.0, 40.0, n),
        "pressure": rng.uniform(5e4, 6e5, n),
    }
    usual = {
        "Fz": 2e3,
        "alpha": 0.03,
        "gamma": 0.1,
        "kappa": 0.01,
        "phi_t": -0.2,
        "Vx": 10.0,
        "pressure": 2.2e5,
    }
    edges = [
        {**usual, name: value}
        for name in INPUTS
        for value in (0.0, -0.0, 1e-9, -1e-9, 1.0, -1.0, 50.0, math.nan)
    ]
    edges.append({**usual, "gamma": 0.0, "phi_t": 0.0})  # no spin at all
    return {name: np.append(ordinary[name], [edge[name] for edge in edges]) for name in INPUTS}


def assert_equal(found, wanted, names) -> None:
    for name, a, b in zip(names, found, wanted, strict=True):
        a, b = np.asarray(a, float), np.broadcast_to(np.asarray(b, float), np.shape(a))
        assert np.array_equal(np.isnan(a), np.isnan(b)), f"{name}: NaN in other places"
        assert np.array_equal(np.isinf(a), np.isinf(b)), f"{name}: infinite in other places"
        sound = np.isfinite(b)
        scale = np.maximum(np.abs(b[sound]), 1e-3 * np.max(np.abs(b[sound]), initial=0.0))
        error = np.abs(a[sound] - b[sound])
        assert np.all(error <= TOLERANCE * scale), f"{name}: {np.max(error / scale):.2g}"


@pytest.mark.parametrize("switches", ALL_SWITCHES, ids=str)
def test_floats_equal_the_equations(tyre, conditions, switches):
    with np.errstate(all="ignore"):
        wanted = evaluate(tyre.p, **conditions, **switches._asdict())
        rows = [[float(x) for x in row] for row in zip(*conditions.values(), strict=True)]
        forces = [calls.forces(tyre, row, switches) for row in rows]
        state = [calls.state(tyre, row, switches) for row in rows]
    assert_equal(zip(*forces, strict=True), wanted[0], Forces._fields)
    assert_equal(zip(*state, strict=True), wanted[1], State._fields)
    assert {type(x) for found in (*forces, *state) for x in found} == {float}


@needs_llvm
@pytest.mark.parametrize("switches", [Switches(), Switches(True), Switches(True, True, True)], ids=str)
def test_the_compiled_loop_equals_the_equations(tyre, conditions, switches, compiled):
    compiled(switches, "batch")
    with np.errstate(all="ignore"):
        wanted = evaluate(tyre.p, **conditions, **switches._asdict())[0]
        for times in (1, 2):
            many = [np.tile(x, times) for x in conditions.values()]
            found = calls.forces(tyre, many, switches)
            assert_equal(found, [np.tile(x, times) for x in wanted], Forces._fields)


@needs_llvm
def test_the_compiled_single_call_equals_the_equations(tyre, conditions, compiled):
    switches = Switches(True, False, True)
    compiled(switches, "one")
    fresh = tyre.replace()
    with np.errstate(all="ignore"):
        wanted = evaluate(tyre.p, **conditions, **switches._asdict())[0]
    rows = zip(*conditions.values(), strict=True)
    found = [calls.forces(fresh, [float(x) for x in row], switches) for row in rows]
    assert_equal(zip(*found, strict=True), wanted, Forces._fields)


def as_at_start(monkeypatch) -> None:
    """No kernel is loaded, and nothing is counted yet."""
    monkeypatch.setattr(kernels, "meter", cache(kernels.Meter))


def assert_none_is_loaded() -> None:
    kinds = [kernels.meter(kind, Switches(on)) for kind in kernel.KINDS for on in (False, True)]
    assert [one.loaded for one in kinds] == [None] * 4


@pytest.fixture
def compiled(monkeypatch):
    """Compiles for this test only."""
    as_at_start(monkeypatch)

    def load(switches: Switches, kind: str) -> None:
        kernels.meter(kind, switches).load()
        assert kernels.meter(kind, switches).loaded is not None

    return load


@pytest.fixture(scope="module")
def in_lanes():
    """Functions of :mod:`tir.codegen.vector_math` as functions of arrays (n,) with n a multiple of the lanes."""
    ir = pytest.importorskip("llvmlite.ir")
    import ctypes

    from llvmlite import binding

    from tir.codegen import vector_math
    from tir.codegen.instructions import DOUBLE, VectorValue, repeated

    vector = ir.VectorType(DOUBLE, kernel.LANES)

    def compiled(name: str, *more: float):
        text = ir.Module()
        pointer = vector.as_pointer()
        function = ir.Function(text, ir.FunctionType(ir.VoidType(), [pointer, pointer]), "f")
        builder = ir.IRBuilder(function.append_basic_block())
        x = VectorValue(builder, builder.load(function.args[0], align=8))
        others = (VectorValue(builder, repeated(vector, y)) for y in more)
        found = getattr(vector_math, name)(x, *others)
        builder.store(found.value, function.args[1], align=8)
        builder.ret_void()
        machine = kernel._machine()
        engine = binding.create_mcjit_compiler(binding.parse_assembly(""), machine)
        engine.add_object_file(binding.ObjectFileRef.from_data(kernel._compiled(str(text), machine)))
        engine.finalize_object()
        run = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)(engine.get_function_address("f"))

        def of(x) -> np.ndarray:
            n = np.size(x)
            padded = np.append(x, np.ones(-n % kernel.LANES))
            out = np.empty_like(padded)
            for at in range(0, padded.size, kernel.LANES):
                run(padded[at:].ctypes.data, out[at:].ctypes.data)
            return out[:n]

        of.engine = engine
        return of

    return compiled


def test_elementary_functions_are_those_of_the_libm(in_lanes):
    angles = np.concatenate([np.linspace(-9.0, 9.0, 4001), np.geomspace(1e-300, 1e6, 500), [0.0]])
    for name, x in (
        ("sin", angles),
        ("cos", angles),
        ("tan", angles),
        ("arctan", np.append(angles, [np.inf, -np.inf, 0.2679491924311227, 3.732050807568877])),
        ("arccos", np.linspace(-0.999, 1.0, 1001)),
        ("exp", np.linspace(-700.0, 700.0, 2001)),
    ):
        function = in_lanes(name)
        found, wanted = function(x), getattr(np, name)(x)
        assert np.max(np.abs(found / np.where(wanted == 0.0, 1.0, wanted) - (wanted != 0.0))) < 3e-15, name
        assert np.all(np.isnan(function(np.full(8, np.nan)))), name


@pytest.mark.parametrize("y", [0.85, -0.4, 2.0, -3.0, 0.0])
def test_powers_are_those_of_the_libm(in_lanes, y):
    power, positive = in_lanes("power", y), np.geomspace(1e-6, 1e3, 1001)
    assert power(positive) == pytest.approx(positive**y, rel=1e-14)
    edges = np.array([0.0, -2.0, math.inf, math.nan])
    with np.errstate(all="ignore"):
        assert power(edges) == pytest.approx(np.power(edges, y), nan_ok=True)


def test_shapes_broadcast_and_scalars_stay_floats(tyre):
    Fz, alpha = np.array([[1000.0], [2000.0]]), np.array([0.01, 0.02, 0.03])
    forces = tyre(Fz, alpha, phi_t=-0.1)
    for force in forces:
        assert force.shape == (2, 3)
    assert tyre(2000.0, 0.02, phi_t=-0.1) == pytest.approx([force[1, 1] for force in forces], rel=1e-12)
    for kind in (int, np.float64, np.array):
        assert type(tyre(kind(2000), 0.02).Fy) is float
    assert tyre(np.array([]), 0.02).Fy.shape == (0,)
    assert tyre([2000.0, 3000.0], 0.02).Fy.shape == (2,)


def test_blocks_are_put_together_in_order(tyre, monkeypatch):
    alpha = np.linspace(-0.2, 0.2, 23)
    whole = tyre(2000.0, alpha)
    monkeypatch.setattr(calls, "BLOCK", 5)
    assert np.array_equal(np.array(tyre(2000.0, alpha)), np.array(whole))


@needs_llvm
def test_the_compiled_loop_takes_few_conditions_other_strides_and_other_kinds(tyre, compiled):
    compiled(Switches(), "batch")
    alpha = np.linspace(-0.2, 0.2, 51)
    whole = np.array(evaluate(tyre.p, np.full(51, 2000.0), alpha)[0])
    for part in (
        slice(0, 1),
        slice(0, 7),
        slice(0, 8),
        slice(0, 9),
        slice(None, None, 3),
        slice(None, None, -1),
    ):
        assert_equal(tyre(2000.0, alpha[part]), whole[:, part], Forces._fields)
    assert_equal(
        tyre(np.array([2000, 3000]), 0.1), evaluate(tyre.p, np.array([2e3, 3e3]), 0.1)[0], Forces._fields
    )
    column = tyre(2000.0, alpha.reshape(17, 3).T)
    assert_equal(column, np.array([row.reshape(17, 3).T for row in whole]), Forces._fields)


@needs_llvm
@pytest.mark.parametrize(
    ("kind", "arguments"),
    [
        ("one", ()),
        ("one", (1.0,) * 6 + ("no number",)),
        ("batch", (np.ones(8),) * 7),
        ("batch", (np.ones(8),) * 7 + (b"not to be written", 0, 8)),
        ("batch", (np.ones(16)[::2],) * 7 + (np.ones((6, 8)), 0, 8)),
    ],
)
def test_machine_code_refuses_wrong_arguments(tyre, kind, arguments):
    run = kernel.load(kind, Switches()).run_of(calls._values(tyre, Switches(), calls.FORCES))
    with pytest.raises((TypeError, ValueError, BufferError)):
        run(*arguments)


@needs_llvm
def test_machine_code_lets_go_of_its_arrays_also_after_an_error(tyre):
    run = kernel.load("batch", Switches()).run_of(calls._values(tyre, Switches(), calls.FORCES))
    given, out = np.ones(8), np.ones((6, 8))
    before = sys.getrefcount(given), sys.getrefcount(out)
    run(*(given,) * 7, out, 0, 8)
    with pytest.raises((TypeError, ValueError, BufferError)):
        run(*(given,) * 7, b"not to be written", 0, 8)
    assert (sys.getrefcount(given), sys.getrefcount(out)) == before


@needs_llvm
def test_a_part_shorter_than_a_vector_stays_within_its_arrays(tyre):
    run = kernel.load("batch", Switches()).run_of(calls._values(tyre, Switches(), calls.FORCES))
    alpha, out = np.linspace(-0.2, 0.2, 32), np.zeros((6, 32))
    given = (np.array(2e3), alpha, *(np.array(x) for x in (0.0, 0.0, 0.0, 16.0, 2e5)))
    for first, last in ((0, 3), (3, 7), (7, 8), (30, 32), (8, 31)):
        run(*given, out, first, last)
    assert_equal(out, tyre(2e3, alpha, p=2e5, Vx=16.0), Forces._fields)


@needs_llvm
def test_narrower_vectors_give_the_same(tmp_path, monkeypatch):
    """Processors without AVX-512 compute fewer conditions together."""
    monkeypatch.setattr(kernel, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(kernel, "_lanes", lambda: 4)
    tyre = tir.read(VECTORS / "moto_front.tir")
    run = kernel.load.__wrapped__("batch", Switches()).run_of(calls._values(tyre, Switches(), calls.FORCES))
    alpha, out = np.linspace(-0.2, 0.2, 23), np.zeros((6, 23))
    run(np.array(2e3), alpha, *(np.array(x) for x in (0.0, 0.0, 0.0, 16.0, 2e5)), out, 0, 23)
    assert_equal(out, evaluate(tyre.p, 2e3, alpha, pressure=2e5, Vx=16.0)[0], Forces._fields)


@pytest.mark.parametrize("given", ["", "relative/cache"])
def test_an_unusable_cache_variable_gives_the_usual_folder(monkeypatch, given):
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", given)
    assert kernel._user_cache() == Path.home() / ".cache" / "tir"


def test_parameters_that_are_complex_or_arrays_go_through_with_arrays_of_inputs(tyre):
    """A complex step of a parameter is its derivative; a parameter may differ from condition to condition."""
    step, alpha = 1e-20, np.linspace(-0.1, 0.1, 5)
    moved = tyre.replace(PKY2=tyre["PKY2"] + 1j * step)
    ones = [moved(2000.0, float(a)).Fy.imag / step for a in alpha]
    assert moved(2000.0, alpha).Fy.imag / step == pytest.approx(ones)
    n = calls.BLOCK + 3
    many = tyre.replace(PKY2=np.linspace(1.0, 2.0, n))(2000.0, np.full(n, 0.05)).Fy
    for k in (0, n - 1):
        assert many[k] == pytest.approx(tyre.replace(PKY2=1.0 + k / (n - 1))(2000.0, 0.05).Fy)


def test_lists_are_arrays_for_states_too(tyre):
    assert tyre.state([2e3, 3e3], [0.01, 0.02]).K_ya == pytest.approx(
        [tyre.state(2e3, 0.01).K_ya, tyre.state(3e3, 0.02).K_ya]
    )


@needs_llvm
def test_damaged_machine_code_in_the_cache_is_made_again(tmp_path, monkeypatch):
    monkeypatch.setattr(kernel, "cache_folder", lambda: tmp_path)
    tyre = tir.read(VECTORS / "moto_front.tir")
    load = kernel.load.__wrapped__
    load("one", Switches())
    (kept,) = tmp_path.iterdir()
    whole = kept.read_bytes()
    for damaged in (whole[:-100], whole[:3000] + b"\0" * 40 + whole[3040:], b"", b"no seal"):
        kept.write_bytes(damaged)
        run = load("one", Switches()).run_of(calls._values(tyre, Switches(), calls.FORCES))
        assert run(2e3, 0.05, 0.0, 0.0, 0.0, 16.0, 2e5) == pytest.approx(tyre(2e3, 0.05, p=2e5, Vx=16.0))
        assert kept.read_bytes() == whole


@needs_llvm
@pytest.mark.parametrize("cached", [True, False])
@pytest.mark.parametrize("kind", ["one", "batch"])
def test_machine_code_is_found_without_being_asked_for(monkeypatch, tmp_path, kind, cached):
    """From the cache, else compiled; a tyre that was called before changes over."""
    as_at_start(monkeypatch)
    monkeypatch.setattr(kernels, "WORTH_LOADING", {"one": 5, "batch": 5 * calls.PER_CALL})
    monkeypatch.setattr(kernel, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(kernel, "load", kernel.load.__wrapped__)
    if cached:
        kernel.load(kind, Switches())
    called = tir.read(VECTORS / "moto_front.tir")
    alpha = 0.05 if kind == "one" else np.full(calls.FEW, 0.05)
    before = called(2e3, alpha, turn_slip=False)
    assert kernels.meter(kind, Switches()).loaded is None
    for _ in range(5):
        called(2e3, alpha, turn_slip=False)
    assert kernels.meter(kind, Switches()).loaded is not None
    after = called(2e3, alpha, turn_slip=False)
    fast = called.prepared[False, False, False] if kind == "one" else called.prepared["batch", Switches()]
    assert type(fast) is type(len), "a built-in function"
    np.testing.assert_allclose(after, before, rtol=1e-12)


def test_where_nothing_can_be_compiled_the_calls_go_on(tyre, monkeypatch):
    as_at_start(monkeypatch)
    monkeypatch.setattr(kernels, "WORTH_LOADING", {"one": 2, "batch": 2})
    monkeypatch.setattr(kernel, "obstacle", lambda: "none here")
    found = [tyre.replace()(2e3, a).Fy for a in (0.05, np.array([0.05])) for _ in range(4)]
    assert found == pytest.approx([found[0]] * 8)
    assert_none_is_loaded()


@pytest.mark.parametrize("broken", [ImportError("llvmlite"), OSError("no room"), RuntimeError("LLVM")])
def test_a_broken_llvmlite_stops_no_call(tyre, monkeypatch, broken):
    def fail(*given):
        raise broken

    as_at_start(monkeypatch)
    monkeypatch.setattr(kernels, "WORTH_LOADING", {"one": 2, "batch": 2})
    monkeypatch.setattr(kernel, "obstacle", lambda: None)
    monkeypatch.setattr(kernel, "load", fail)
    found = [tyre.replace()(2e3, a).Fy for a in (0.05, np.array([0.05])) for _ in range(4)]
    assert found == pytest.approx([found[0]] * 8)
    assert_none_is_loaded()


def test_without_a_global_lock_machine_code_is_refused_and_calls_go_on(tyre, monkeypatch):
    import sysconfig

    as_at_start(monkeypatch)
    monkeypatch.setattr(kernels, "WORTH_LOADING", {"one": 2, "batch": 2})
    monkeypatch.setattr(sysconfig, "get_config_var", lambda name: int(name == "Py_GIL_DISABLED"))
    monkeypatch.setattr(kernel, "obstacle", kernel.obstacle.__wrapped__)
    kernel.load.cache_clear()
    with pytest.raises(tir.TirError, match="free-threaded"):
        tir.compile_kernels()
    found = [tyre.replace()(2e3, a).Fy for a in (0.05, np.array([0.05])) for _ in range(4)]
    assert found == pytest.approx([found[0]] * 8)
    assert_none_is_loaded()


NUMBERS = [
    1800.0,
    1800,
    True,
    np.float64(1800.0),
    np.float32(1800.0),
    np.int64(1800),
    np.int32(1800),
    np.array(1800.0),
]


@pytest.mark.parametrize("machine", [False, pytest.param(True, marks=needs_llvm)])
def test_numbers_of_every_type_are_the_same_number(tyre, compiled, monkeypatch, machine):
    if machine:
        compiled(Switches(), "one")
    fresh = tyre.replace()
    for x in NUMBERS:
        for _ in range(2):
            found = fresh(x, 0.05, x / 36000.0, p=250000, turn_slip=False)
            assert all(type(f) is float for f in found)
            wanted = evaluate(tyre.p, float(x), 0.05, float(x / 36000.0), pressure=2.5e5)[0]
            assert found == pytest.approx([float(f) for f in wanted], rel=1e-12)
    assert fresh(1800.0, np.array([0.05])).Fy.shape == (1,), "an array of one is an array"
    assert np.iscomplexobj(fresh(1800.0, 0.05 + 1e-20j).Fy)
    with pytest.raises(tir.TirError, match="number"):
        fresh("1800", 0.05)


def test_without_llvm_the_message_names_the_package(monkeypatch):
    monkeypatch.setattr(kernel.importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(kernel, "obstacle", kernel.obstacle.__wrapped__)
    kernel.load.cache_clear()
    with pytest.raises(tir.TirError, match="pip install llvmlite"):
        tir.compile_kernels()


@pytest.mark.parametrize("turn_slip", [False, True])
def test_few_conditions_without_llvm_are_computed_one_by_one(monkeypatch, tyre, conditions, turn_slip):
    """The equations in numpy take as long for three conditions as for sixty; where Python's numbers raise, numpy is used."""
    monkeypatch.setattr(kernel, "obstacle", lambda: "none here")
    monkeypatch.setattr(kernels.meter("batch", Switches(turn_slip)), "loaded", None)
    few = [np.reshape(x[:6], (2, 3)) if np.ndim(x) else x for x in conditions.values()]
    given = dict(zip(conditions, few, strict=True))
    wanted = evaluate(tyre.p, **given, turn_slip=turn_slip)[0]
    named = {"p" if name == "pressure" else name: x for name, x in given.items()}
    in_numpy = calls._in_numpy
    monkeypatch.setattr(calls, "_in_numpy", None)
    for found, force in zip(tyre.replace()(**named, turn_slip=turn_slip), wanted, strict=True):
        np.testing.assert_allclose(found, force, rtol=1e-11, atol=1e-11 * np.max(np.abs(force)))
    monkeypatch.setattr(calls, "_in_numpy", in_numpy)
    named["p"] = np.zeros(3)
    assert all(x.shape == (2, 3) for x in tyre.replace()(**named, turn_slip=turn_slip))


def test_large_calls_without_llvm_go_through_numpy(monkeypatch, tyre):
    monkeypatch.setattr(kernel, "obstacle", lambda: "none here")
    as_at_start(monkeypatch)
    monkeypatch.setattr(kernels, "WORTH_LOADING", {"one": 1, "batch": 1})
    alpha = np.linspace(-0.1, 0.1, 7)
    assert tyre.replace()(2000.0, alpha).Fy == pytest.approx(evaluate(tyre.p, 2000.0, alpha)[0].Fy, rel=1e-12)


@pytest.mark.parametrize("switches", ALL_SWITCHES, ids=str)
def test_arrays_without_llvm_equal_the_equations(tyre, conditions, switches, monkeypatch):
    """Each input as an array, and as a single number beside arrays."""
    as_at_start(monkeypatch)
    tyre = tyre.replace()  # not bound to machine code
    with np.errstate(all="ignore"):
        wanted = evaluate(tyre.p, **conditions, **switches._asdict())[0]
        assert_equal(calls.forces(tyre, list(conditions.values()), switches), wanted, Forces._fields)
        for name in INPUTS:
            for value in (conditions[name][0], conditions[name][-1]):
                given = {**conditions, name: np.array(value)}
                wanted = evaluate(tyre.p, **given, **switches._asdict())[0]
                assert_equal(calls.forces(tyre, list(given.values()), switches), wanted, Forces._fields)


def test_whole_numbers_and_short_floats_are_computed_as_doubles(tyre):
    rows = np.array([[2000, 220000], [3000, 240000]])
    found = tyre(rows[:, 0].astype("i4"), 0.0625, p=rows[:, 1].astype("f4"))
    assert found.Fy == pytest.approx([tyre(float(Fz), 0.0625, p=float(p)).Fy for Fz, p in rows], rel=1e-12)


def test_a_replay_takes_its_places_again(tyre):
    """So that what is between inputs and forces stays in the processor's cache."""
    program = replay(Switches(True), Forces._fields)
    assert program.room < 0.6 * (len(program.operations) + len(program.symbols))


def test_a_called_tyre_can_be_pickled(tyre):
    import pickle

    noted = tyre.annotate(measured={"C": tir.Quantity(1.0, 0.1, "N")})
    before = noted(2000.0, 0.02)
    again = pickle.loads(pickle.dumps(noted))
    assert again == noted
    assert again.measured == noted.measured
    assert again.text() == noted.text()
    assert again(2000.0, 0.02) == before


def test_the_name_of_a_tyre_fits_a_screen(tyre):
    noted = tyre.annotate(status=dict.fromkeys(tyre.values, "fitted +- 1"))
    many = {f"m{i}": tir.Quantity(float(i), 0.1, "N") for i in range(9)}
    assert re.findall(r"m\d(?= = )", repr(noted.annotate(measured=many))) == [
        "m0",
        "m1",
        "m2",
        "m3",
        "m4",
        "m5",
    ]
    assert len(repr(noted)) < 400
    assert "FNOMIN" in repr(noted)
    assert f"{len(tyre.values)} fitted" in repr(noted)


def test_importing_tir_imports_no_compiler():
    code = "import sys, tir; print([m for m in ('llvmlite', 'scipy', 'pandas') if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


@needs_llvm
def test_the_cache_notices_every_edit(tmp_path, monkeypatch):
    import shutil

    package = Path(kernel.__file__).parents[2]
    for name in kernel.SOURCES:
        copy = shutil.copytree if (package / name).is_dir() else shutil.copy
        if not (tmp_path / name).exists():
            copy(package / name, tmp_path / name)
    monkeypatch.setattr(kernel, "resources", lambda package: tmp_path)
    before = kernel._fingerprint()
    assert kernel._fingerprint() == before
    edited = tmp_path / "equations" / "lateral.py"
    edited.write_text(edited.read_text() + "\n")
    assert kernel._fingerprint() != before


def test_every_module_that_computes_is_in_the_key_of_the_cache():
    """What the equations, the evaluation and the generators import of tir, they import from what the key covers."""
    import ast

    package = Path(kernel.__file__).parents[2]
    covered = [
        f
        for name in kernel.SOURCES
        for f in ([package / name] if "." in name else (package / name).glob("*.py"))
    ]
    # words, refusals, the table that is covered, types
    harmless = {
        "tir.errors",
        "tir.inputs",
        "tir.parameters",
        "tir.record",
        "tir.constant",
        "tir.mode",
        "tir.exporting",
    }
    for path in covered:
        if path.suffix != ".py":
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and str(node.module).startswith("tir"):
                for module in (
                    {str(node.module)} - {"tir.equations", "tir.codegen", "tir.codegen.cpython"} - harmless
                ):
                    assert any(
                        f.with_suffix("") == package.parent / module.replace(".", "/") for f in covered
                    ), module


class TestGraph:
    """What is simplified away must be the same for every number, NaN and infinity included."""

    @pytest.fixture
    def graph(self):
        return Graph()

    def test_equal_operations_are_one(self, graph):
        x = graph.symbol("x", INPUT)
        assert (x + 1.0) * 2.0 is (1.0 * (x + 1.0)) * 2.0
        assert len(graph.nodes) == 3

    def test_nothing_times_a_number_is_kept_for_nan(self, graph):
        x = graph.symbol("x", INPUT)
        assert (0.0 * x).operation == "multiply"

    def test_factors_of_the_tyre_meet_first(self, graph):
        x, y = graph.symbol("x", INPUT), graph.symbol("y", INPUT)
        a, b, c = (graph.symbol(name, PARAMETER) for name in "abc")
        product = (a * x) * b * y / c
        constant, rest = product.arguments
        assert constant.level == PARAMETER
        assert rest is x * y

    def test_a_number_times_its_sign_alone_is_an_absolute_value(self, graph):
        x, y = graph.symbol("x", INPUT), graph.symbol("y", INPUT)
        assert (x * np.where(x < 0.0, -1.0, 1.0)).operation == "absolute"
        for other in (
            x * np.where(x < 0.0, -1.0, 0.0),
            x * np.where(x < 0.0, 1.0, -1.0),
            x * np.where(x < 1.0, -1.0, 1.0),
            y * np.where(x < 0.0, -1.0, 1.0),
        ):
            assert other.operation == "multiply"

    def test_an_unsupported_operation_is_refused(self, graph):
        with pytest.raises(TypeError):
            np.sinh(graph.symbol("x", INPUT))

    def test_the_program_asks_only_for_what_it_needs(self):
        program = trace(Switches(), ("K_ya",))
        assert "PKY1" in program.parameters
        assert not {"PCX1", "QSY1", "PKYP1"} & set(program.parameters)

    def test_constants_of_a_tyre_with_infinite_values_are_numpys(self, tyre):
        """Where Python's sine raises."""
        values = {**calls._values(tyre, Switches(), calls.FORCES), "QDRP1": math.inf}
        prepare, _ = single.compiled_for(Switches(True), Forces._fields)
        with pytest.raises(ValueError, match="domain"):
            prepare(values, **single.MATH)
        assert any(math.isnan(x) for x in single.constants(prepare, values))
