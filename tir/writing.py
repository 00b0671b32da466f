"""Writing property files: the file's own text with its changes, or a new file for a program."""

from __future__ import annotations

import os
import tempfile
from dataclasses import replace
from pathlib import Path

from tir.merging import merged
from tir.parameters import TABLE
from tir.record import TyreRecord
from tir.rendering import render
from tir.targets import DEFAULT, target_of


def content(tyre: TyreRecord, target: str | None = None) -> tuple[str, str]:
    """Text and encoding of the tyre's file; see :meth:`tir.Tyre.text`."""
    if target is None and tyre.document is not None:
        document = merged(tyre, tyre.document)
        return document.text, document.encoding
    chosen = target_of(target or DEFAULT)
    if target is None:  # without a named program, keys of other programs that were given are kept
        own = {row.name for row in TABLE if tyre[row.name] != row.default}
        chosen = replace(chosen, without=tuple(name for name in chosen.without if name not in own))
    return render(tyre, chosen), "ascii"


def write(tyre: TyreRecord, path: str | Path, target: str | None = None) -> None:
    """Write :func:`content`; the file at ``path`` is replaced only once the new one is complete."""
    text, encoding = content(tyre, target)
    replace_file(Path(path), text.encode(encoding))


def replace_file(path: Path, content: bytes, mode: int = 0o644) -> None:
    """Write a file in one step: the one at ``path`` is replaced only once the new one is complete."""
    handle, temporary = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
        os.chmod(temporary, mode)
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
