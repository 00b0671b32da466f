"""The C compiler of the machine."""

import os
import platform
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from mffit.errors import InputError

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-shared", "-fvisibility=hidden")
SUFFIX = {"win32": ".dll", "darwin": ".dylib"}
MACHINES = {"amd64": "x86_64", "x86_64": "x86_64", "arm64": "aarch64", "aarch64": "aarch64"}
SYSTEMS = {"linux": "linux", "darwin": "darwin", "win32": "windows"}
OLD_NAMES = {
    "x86_64-linux": "linux64",
    "x86_64-windows": "win64",
    **dict.fromkeys(("x86_64-darwin", "aarch64-darwin"), "darwin64"),
}
"""Names of folders in FMI 2.0; for other machines the name of FMI 3.0 is usual."""
REMEDY = "name another one in CC, or use --sources-only"


def suffix() -> str:
    """The suffix of a shared library on this machine."""
    return SUFFIX.get(sys.platform, ".so")


def host_folder(fmi: int) -> str:
    """The folder of ``binaries`` for this machine. Raises InputError if FMI has no name for this machine."""
    machine, system = MACHINES.get(platform.machine().lower()), SYSTEMS.get(sys.platform)
    if machine is None or system is None:
        raise InputError(
            f"FMI defines no folder for binaries of this machine ({platform.machine()}, {sys.platform}): use --sources-only"
        )
    name = f"{machine}-{system}"
    return OLD_NAMES.get(name, name) if fmi == 2 else name


def compile_shared(sources: Sequence[Path], library: Path, definitions: Sequence[str]) -> None:
    """Compile C files to a shared library. Raises InputError if there is no compiler, or it failed."""
    command = [
        *_compiler(),
        *FLAGS,
        *([] if sys.platform == "win32" else ["-fPIC"]),
        *(f"-D{name}" for name in definitions),
        *map(str, sources),
        "-o",
        str(library),
        "-lm",
    ]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, errors="replace", check=False, timeout=300.0
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        why = getattr(error, "strerror", None) or error
        raise InputError(f"the C compiler {command[0]} did not run ({why}); {REMEDY}") from error
    if done.returncode:
        line = next((line for line in done.stderr.splitlines() if "error" in line), done.stderr.strip())
        raise InputError(f"the C compiler {command[0]} failed ({line}); {REMEDY}")


def _compiler() -> list[str]:
    named = shlex.split(os.environ.get("CC", ""))
    if named:
        return named
    found = [name for name in ("cc", "gcc", "clang") if shutil.which(name)]
    if found:
        return found[:1]
    raise InputError(
        "no C compiler (cc, gcc, clang) was found for the binary of this machine: install one, name it in CC, or use "
        "--sources-only, so that the program that imports the FMU compiles it"
    )
