"""Reading property files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from tir.document import Document, read_document
from tir.properties import described
from tir.tyre import Tyre


def read(path: str | Path, **lacking: float | str) -> Tyre:
    """The tyre of a ``.tir`` file of MF 6.1 or 6.2.

    Units other than SI are converted, and missing keys take the defaults of the table. ``Tyre.problems`` lists everything
    unusual with its line.

    Parameters
    ----------
    path : the file
    lacking : values [SI] of keys that the file lacks, such as ``UNLOADED_RADIUS=0.3``; a key of the file keeps its value

    Raises
    ------
    TirError
        If the file is not a property file, is truncated, contains an unreadable number, or has another MF version.
    """
    return interpret(read_document(path), lacking)


def interpret(document: Document, lacking: Mapping[str, float | str] = MappingProxyType({})) -> Tyre:
    """The tyre that a document describes, with values of keys that it lacks; raises as :func:`read`."""
    return described(Tyre, document, lacking)
