"""The model compiled by numba: loops over many conditions as vector instructions, or one condition.

The source is generated once and kept in a folder of the user's cache, whose name is a hash of everything that the
machine code follows from; numba keeps the machine code beside it.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from importlib.resources import files as resources
from pathlib import Path
from typing import Any, NamedTuple

from tir.codegen.program import INPUTS, Program, Switches, trace
from tir.codegen.source import COMMON, FUNCTIONS, Dialect, assignments, function, name_of, preparation
from tir.equations.forces import Forces
from tir.errors import TirError

BRANCHLESS = Dialect({**COMMON, "where": "select({}, {}, {})", "both": "({} & {})"}, inline=False)
SOURCES = ("equations", "codegen", "evaluate.py", "derivatives.py", "parameters.csv")
"""What the machine code follows from."""
HEAD = f"""from math import sqrt
from numba import njit
from tir.codegen.intrinsics import OPTIONS, select
from tir.codegen.vector_math import {", ".join(name for name in FUNCTIONS if name != "sqrt")}

"""
SIGNATURES = {
    "batch": "void(float64[::1], float64[:, ::1], int64, float64[:, ::1])",
    "one": f"UniTuple(float64, {len(Forces._fields)})(float64[::1], {', '.join(['float64'] * len(INPUTS))})",
}


class Kernel(NamedTuple):
    """The model for some switches, compiled."""

    prepare: Callable[..., tuple[float, ...]]  #: see :func:`tir.codegen.source.preparation`
    run: Callable[..., Any]
    """``batch(constants, inputs (7, m), n, forces (6, m))`` computes the first n columns; ``one(constants, *inputs)`` returns the
    six forces."""


@cache
def available() -> bool:
    """Whether numba is installed and runs with the numpy that is there; imports it."""
    try:
        import numba  # noqa: F401
    except ImportError:
        return False
    return True


def threads() -> int:
    """How many threads a large call may use: numba's own setting (``numba.set_num_threads``, NUMBA_NUM_THREADS)."""
    import numba

    return int(numba.get_num_threads())


@cache
def load(kind: str, switches: Switches) -> Kernel:
    """The kernel "batch" or "one", from the cache or compiled, which takes some seconds.

    Raises
    ------
    TirError
        If numba is not installed.
    """
    if not available():
        raise TirError(
            "compiled kernels need numba, which is not installed or does not run here: pip install mffit[fast]"
        )
    name = "_".join([kind, *(word for word, on in switches._asdict().items() if on)])
    path = cache_folder() / f"{name}.py"
    if not path.exists():
        _write(path, source(kind, switches))
    spec = importlib.util.spec_from_file_location(f"tir_kernels_{name}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # numba's cache looks it up by name
    spec.loader.exec_module(module)
    return Kernel(module.prepare, getattr(module, kind))


def source(kind: str, switches: Switches) -> str:
    """The Python source that numba compiles."""
    program = trace(switches, Forces._fields)
    free = kind == "batch"  # letting other threads run costs a single call a tenth of its time
    decorator = f'@njit("{SIGNATURES[kind]}", cache=True, nogil={free}, **OPTIONS)\n'
    return HEAD + preparation(program) + "\n\n" + decorator + {"batch": _batch, "one": _one}[kind](program)


def _unpacked(program: Program) -> list[str]:
    return [f"{name_of(node)} = constants[{i}]" for i, node in enumerate(program.constants)]


def _batch(program: Program) -> str:
    lines, results = assignments(program.per_point, program.outputs.values(), BRANCHLESS)
    inputs = [f"{name} = inputs[{i}, i]" for i, name in enumerate(INPUTS)]
    outputs = [f"forces[{i}, i] = {x}" for i, x in enumerate(results)]
    loop = ["for i in range(n):", *(f"    {line}" for line in (*inputs, *lines, *outputs))]
    return function("batch(constants, inputs, n, forces)", [*_unpacked(program), *loop])


def _one(program: Program) -> str:
    lines, results = assignments(program.per_point, program.outputs.values(), BRANCHLESS)
    return function(
        f"one(constants, {', '.join(INPUTS)})",
        [*_unpacked(program), *lines, f"return ({', '.join(results)})"],
    )


@cache
def cache_folder() -> Path:
    """Where the kernels of these very sources are kept; created if need be."""
    folder = _user_cache() / f"kernels-{_fingerprint()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError:
        return Path(tempfile.mkdtemp(prefix="tir-kernels-"))


def _user_cache() -> Path:
    if "NUMBA_CACHE_DIR" in os.environ:
        return Path(os.environ["NUMBA_CACHE_DIR"]) / "tir"
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local")) / "tir"
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "tir"


def _fingerprint() -> str:
    """Numba notices another processor or another numba by itself, but no edit outside the compiled file."""
    found = hashlib.sha256()
    for name in SOURCES:
        place = resources("tir") / name
        parts = sorted(place.iterdir(), key=lambda x: x.name) if place.is_dir() else [place]
        for part in parts:
            if part.name.endswith((".py", ".csv")):
                found.update(part.name.encode() + b"\0" + part.read_bytes() + b"\0")
    return found.hexdigest()[:20]


def _write(path: Path, text: str) -> None:
    """Whole or not at all: several processes may write the same file at the same time."""
    handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".part")
    with os.fdopen(handle, "w", encoding="ascii") as stream:
        stream.write(text)
    os.replace(temporary, path)
