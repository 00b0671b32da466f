"""The C compiler of this machine."""

from __future__ import annotations

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
    "x86_64-darwin": "darwin64",
    "aarch64-darwin": "darwin64",
}
"""The folders of FMI 2.0; where it has none, that of 3.0 is usual."""
SLOWEST = 300
"""Seconds after which a compiler is given up."""


def suffix() -> str:
    """How a shared library's name ends here."""
    return SUFFIX.get(sys.platform, ".so")


def host_folder(fmi: int) -> str:
    """The folder of ``binaries`` for this machine.

    Raises
    ------
    InputError
        FMI has no name for this machine.
    """
    machine, system = MACHINES.get(platform.machine().lower()), SYSTEMS.get(sys.platform)
    if machine is None or system is None:
        raise InputError(
            f"FMI has no name for binaries of this machine ({platform.machine()}, {sys.platform}): take --sources-only"
        )
    name = f"{machine}-{system}"
    return OLD_NAMES.get(name, name) if fmi == 2 else name


def compile_shared(sources: Sequence[Path], library: Path, definitions: Sequence[str]) -> None:
    """Compile C files to a shared library.

    Raises
    ------
    InputError
        There is no compiler, or it failed.
    """
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
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=SLOWEST)
    except (OSError, subprocess.TimeoutExpired) as error:
        why = getattr(error, "strerror", None) or error
        raise InputError(
            f"the C compiler {command[0]} did not run ({why}); name another in CC, or take --sources-only"
        ) from error
    if done.returncode:
        said = next((line for line in done.stderr.splitlines() if "error" in line), done.stderr.strip())
        raise InputError(
            f"the C compiler {command[0]} failed ({said}); name another in CC, or take --sources-only"
        )


def _compiler() -> list[str]:
    named = shlex.split(os.environ.get("CC", ""))
    if named:
        return named
    for name in ("cc", "gcc", "clang"):
        if shutil.which(name):
            return [name]
    raise InputError(
        "there is no C compiler (cc, gcc, clang) to make the binary of this machine with: install one, name it in CC, or take "
        "--sources-only, which leaves compiling to the program that imports the FMU"
    )
