"""The model as machine code, compiled with LLVM once per machine and cached in a folder of the user.

The name of the folder is a hash of everything that the machine code depends on.
"""

import ctypes
import importlib.util
import os
import sys
import tempfile
from array import array
from collections.abc import Callable, Mapping
from functools import cache
from importlib.resources import files as resources
from pathlib import Path
from typing import Any, NamedTuple

from tir.codegen.constants import VECTOR_LANES
from tir.codegen.cpython import SCALARS
from tir.codegen.program import Switches, trace
from tir.codegen.single import compiled_for, constants
from tir.equations.forces import Forces
from tir.errors import TirError

SOURCES = (
    "equations",
    "codegen",
    "codegen/cpython",
    "constants.py",
    "evaluate.py",
    "derivatives.py",
    "parameters.csv",
)
"""Files that the machine code depends on."""
LANES = int(VECTOR_LANES)
"""Smallest number of conditions in a call of the kernel for arrays."""
KINDS = ("batch", "one")
FASTCALL = 0x80
"""CPython's METH_FASTCALL."""


class Kernel(NamedTuple):
    """The model as machine code, for one combination of switches."""

    definition: Any  #: CPython's record of the built-in function
    keep: Any  #: owner of the memory of the machine code
    prepare: Callable[..., tuple[float, ...]]  #: see :func:`tir.codegen.source.preparation`

    def run_of(self, values: Mapping[str, float]) -> Callable[..., Any]:
        """The function of :func:`tir.codegen.cpython.entry.module`, bound to the values of a tyre."""
        bind = ctypes.pythonapi.PyCFunction_NewEx
        bind.argtypes, bind.restype = (ctypes.c_void_p, ctypes.py_object, ctypes.py_object), ctypes.py_object
        numbers = array("d", constants(self.prepare, values)).tobytes()
        numbers += array("Q", sorted(map(id, SCALARS))).tobytes()
        keeps_alive = self
        bound: Callable[..., Any] = bind(ctypes.addressof(self.definition), numbers, keeps_alive)
        return bound


class _Definition(ctypes.Structure):
    """CPython's ``PyMethodDef``."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("address", ctypes.c_void_p),
        ("flags", ctypes.c_int),
        ("doc", ctypes.c_char_p),
    )


@cache
def obstacle() -> str | None:
    """Why no machine code can be compiled and called here, with what to do; None if it can.

    Not tested without CPython's global lock.
    """
    from sysconfig import get_config_var  # imported late, so that import tir is quick

    if sys.implementation.name != "cpython" or sys.maxsize <= 2**32:
        return "compiled kernels need CPython of 64 bits; calls go through numpy here"
    if get_config_var("Py_GIL_DISABLED"):
        return (
            "compiled kernels are not used on a free-threaded build of CPython; calls go through numpy here"
        )
    if importlib.util.find_spec("llvmlite") is None:
        return "compiled kernels need llvmlite, which is not installed: pip install llvmlite"
    return None


@cache
def load(kind: str, switches: Switches) -> Kernel:
    """The kernel "batch" or "one", from the cache, or else compiled within a second or two.

    Raises
    ------
    TirError
        If it cannot be compiled here, see :func:`obstacle`.
    """
    reason = obstacle()
    if reason is not None:
        raise TirError(reason)
    from llvmlite import binding

    machine = _machine()
    name = "_".join([kind, *(word for word, on in switches._asdict().items() if on)])
    path = cache_folder() / f"{name}.o"
    code = _read(path)
    if code is None:
        from tir.codegen.cpython import entry

        code = _compiled(entry.module(kind, trace(switches, Forces._fields), _lanes()), machine)
        _write(path, code)
    engine = binding.create_mcjit_compiler(binding.parse_assembly(""), machine)
    engine.add_object_file(binding.ObjectFileRef.from_data(code))
    engine.finalize_object()
    definition = _Definition(kind.encode(), engine.get_function_address(kind), FASTCALL, None)
    return Kernel(definition, engine, compiled_for(switches, Forces._fields)[0])


def _machine() -> Any:
    """LLVM's description of this processor; also makes the functions of Python known that the machine code calls."""
    from llvmlite import binding

    from tir.codegen.cpython.entry import API

    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    for name in API:
        binding.add_symbol(name, ctypes.cast(getattr(ctypes.pythonapi, name), ctypes.c_void_p).value)
    return binding.Target.from_default_triple().create_target_machine(
        cpu=binding.get_host_cpu_name(), features=binding.get_host_cpu_features().flatten(), opt=3,
        codemodel="jitdefault", jit=True,
    )  # fmt: skip


def _lanes() -> int:
    from llvmlite import binding

    return LANES if binding.get_host_cpu_features().get("avx512f") else LANES // 2


def _compiled(text: str, machine: Any) -> bytes:
    from llvmlite import binding

    module = binding.parse_assembly(text)
    module.triple, module.data_layout = machine.triple, str(machine.target_data)
    passes = binding.create_pass_builder(machine, binding.create_pipeline_tuning_options(speed_level=3))
    passes.getModulePassManager().run(module, passes)
    code: bytes = machine.emit_object(module)
    return code


@cache
def cache_folder() -> Path:
    """Folder of the kernels for exactly these sources and this processor; created if need be."""
    folder = _user_cache() / f"kernels-{_fingerprint()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError:
        return Path(tempfile.mkdtemp(prefix="tir-kernels-"))


def _user_cache() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local") / "tir"
    given = Path(os.environ.get("XDG_CACHE_HOME", ""))  # valid only if absolute, by its specification
    return (given if given.is_absolute() else Path.home() / ".cache") / "tir"


def _fingerprint() -> str:
    """Hash of the sources, of LLVM and of the processor."""
    import hashlib  # imported late, so that import tir is quick

    from llvmlite import __version__, binding

    processor = (binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten())
    here = (__version__, sys.version, binding.get_process_triple(), *processor)
    found = hashlib.sha256("\0".join(here).encode())
    for name in SOURCES:
        place = resources("tir") / name
        parts = sorted(place.iterdir(), key=lambda x: x.name) if place.is_dir() else [place]
        for part in parts:
            if part.name.endswith((".py", ".csv")):
                found.update(part.name.encode() + b"\0" + part.read_bytes() + b"\0")
    return found.hexdigest()[:20]


def _read(path: Path) -> bytes | None:
    """The cached machine code; None if there is none or it is damaged."""
    try:
        seal, code = path.read_bytes().split(b"\n", 1)
    except (OSError, ValueError):
        return None
    return code if seal == _seal(code) else None


def _write(path: Path, code: bytes) -> None:
    """Write the file in one step, because several processes may write it at the same time; a failure is ignored."""
    temporary = ""
    try:
        handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".part")
        with os.fdopen(handle, "wb") as stream:
            stream.write(_seal(code) + b"\n" + code)
        os.replace(temporary, path)
    except OSError:  # the disk is full, or, on Windows, another process reads the file
        if temporary:
            Path(temporary).unlink(missing_ok=True)


def _seal(code: bytes) -> bytes:
    import hashlib

    return hashlib.sha256(code).hexdigest().encode()
