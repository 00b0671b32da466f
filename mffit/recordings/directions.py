"""The direction of rolling that the name of a recording states."""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path

from mffit.sweeps import formats

LETTER = "[^\\W\\d_]"
BACKWARD = re.compile(
    rf"backward|reverse|(?<!{LETTER})(?:(?:zu)?r(?:ü|ue|u)ck(?:w(?:ä|ae|a)rts|lauf|fahrt|rollen|rollend)?|bwd|rev)(?!{LETTER})",
    re.IGNORECASE,
)
"""Words in the name of a file that was recorded rolling backwards; no others that begin like them, such as Rückstellmoment."""


def rolls_backward(path: Path) -> bool:
    """Whether the name of a recording says that the wheel rolled backwards."""
    return BACKWARD.search(unicodedata.normalize("NFC", formats.stem(path.name))) is not None
