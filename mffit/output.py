"""A folder that is written whole or not at all."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mffit.errors import InputError


@contextmanager
def output_folder(out: Path) -> Iterator[Path]:
    """A temporary folder beside ``out`` whose files replace those of ``out`` only if the block succeeds.

    Files of ``out`` that this run does not write stay. An interrupted or failing run leaves ``out`` as it
    was.
    """
    if out.exists() and not out.is_dir():
        raise InputError(f"{out} is a file, and the output needs a folder: name another with --out")
    parent = out.absolute().parent
    try:
        parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(prefix=f".{out.name}-", dir=parent))
    except OSError as error:
        raise InputError(
            f"cannot write to {parent} ({error.strerror}): name another folder with --out"
        ) from error
    try:
        yield temporary
        out.mkdir(exist_ok=True)
        for path in sorted(temporary.iterdir()):
            target = out / path.name
            if target.is_dir() and path.is_dir():
                shutil.rmtree(target)
            os.replace(path, target)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
