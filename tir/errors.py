"""What can be wrong with a property file: one exception class, one record, and the words for lists of names."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tir.constants import NAMES_IN_A_SENTENCE

LEVELS = ("error", "warning", "note")
"""Levels of a problem, the gravest first."""


class TirError(Exception):
    """A property file that cannot be used.

    Parameters
    ----------
    sentence : what is there, why it is wrong and what to do; without the place
    path, line : where; they open the text as ``path:line: ...``
    name : the key at fault
    """

    def __init__(
        self,
        sentence: str,
        *,
        path: str | Path | None = None,
        line: int | None = None,
        name: str | None = None,
    ) -> None:
        self.sentence, self.path, self.line, self.name = sentence, path, line, name
        place = "" if path is None else f"{path}:{line}: " if line is not None else f"{path}: "
        super().__init__(place + sentence)


class TirWarning(UserWarning):
    """A tyre gives forces, but probably not those that were meant."""


@dataclass(frozen=True, slots=True)
class Problem:
    """Something to look at in a file that can still be read."""

    level: str  #: "error" (cannot be simulated sensibly), "warning" or "note" (nothing to mend)
    sentence: str  #: what, where and what to do
    name: str = ""  #: the key concerned
    line: int | None = None


def counted(number: int, what: str) -> str:
    """A number and a noun, with the plural on the first word: "1 key of MF 6.2", "2 keys of MF 6.2"."""
    head, *rest = what.split(" ", 1)
    plural = "es" if head.endswith("ch") else "s"
    return " ".join([str(number), head + plural * (number != 1), *rest])


def listed(words: Sequence[str]) -> str:
    """Words of a sentence: "a", "a and b", "a, b and c"; empty for none."""
    *first, last = words or ("",)
    return f"{', '.join(first)} and {last}" if first else last


def begun(text: str) -> str:
    """A text with a capital at its beginning, as a sentence begins."""
    return f"{text[:1].upper()}{text[1:]}"


def some(names: Sequence[str]) -> str:
    """The first of many names, and the number of the others."""
    shown = NAMES_IN_A_SENTENCE
    return ", ".join(names[:shown]) + (f" and {len(names) - shown} more" if len(names) > shown else "")
