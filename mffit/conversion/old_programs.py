"""What programs that compute PAC2002 do with an old file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from mffit.conversion.convert import convert
from tir import Problem
from tir.consumers import rule_problems
from tir.document import number_of, unquoted
from tir.targets import TARGETS

READERS = ("chrono", "pac2002")
"""Programs of :data:`tir.targets.TARGETS` that read old files and no others."""
STATED = ("PROPERTY_FILE_FORMAT", "USE_MODE")
"""Keys of [MODEL] that such a program goes by, and that a conversion replaces."""


def check_old(
    path: str | Path, targets: Sequence[str], given: Mapping[str, float] = MappingProxyType({})
) -> list[Problem]:
    """Problems of an MF 5.2 or PAC2002 file in programs that read it; forces are those of the upright wheel, which stay.

    Parameters
    ----------
    path : the old file
    targets : names of :data:`READERS`
    given : values [SI] of keys that it lacks

    Raises
    ------
    TirError
        If the file is of another formula, or cannot be read.
    """
    found = convert(path, given)
    lines = {line.key: unquoted(line.value) for line in reversed(found.old.document.entries)}
    form, mode = (lines.get(key) for key in STATED)
    stated: dict[str, float | str] = {} if form is None else {"PROPERTY_FILE_FORMAT": form}
    if (number := number_of(mode or "")) is not None:
        stated["USE_MODE"] = number
    tyre = found.tyre.replace(**stated)
    tyre = replace(tyre, present=tyre.present.difference(STATED) | stated.keys())
    return [*found.old.problems, *(p for name in targets for p in rule_problems(tyre, TARGETS[name]))]
