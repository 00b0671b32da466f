"""Errors that the user can correct, each one sentence.

Only :class:`InputError` reaches the user without a traceback: the command line prints ``mffit: <sentence>``
and exits with 2. Any other exception is a bug in mffit. Every module may import this one.
"""

import difflib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from mffit import constants


class InputError(Exception):
    """Bad input: what is wrong, where, and how to correct it.

    Parameters
    ----------
    sentence : what was found, why it is wrong and what to do; without the place
    file : the file at fault; the text begins with it, ``file:line: ...``
    line : line in ``file``, counted from 1
    column : heading of the CSV column at fault
    key : dotted key of ``tyre.toml`` at fault, for example ``rig.path_radius``

    Notes
    -----
    ``str(error)`` is the whole text with the place in front.
    """

    def __init__(
        self,
        sentence: str,
        *,
        file: str | Path | None = None,
        line: int | None = None,
        column: str | None = None,
        key: str | None = None,
    ) -> None:
        self.sentence = " ".join(sentence.split())
        self.file = None if file is None else Path(file)
        self.line = line
        self.column = column
        self.key = key
        super().__init__(self._text())

    def _text(self) -> str:
        place = ""
        if self.file is not None:
            place = f"{self.file}:{self.line}: " if self.line is not None else f"{self.file}: "
        if self.key is not None:
            place += f"{self.key}: "
        elif self.column is not None:
            place += f"column {self.column}: "
        return place + self.sentence


@contextmanager
def readable(
    path: Path,
    *,
    missing: str = "there is no such file; correct its name",
    folder: str = "is a folder; name the files in it",
) -> Iterator[None]:
    """Within this block, an operating system error while reading ``path`` becomes an :class:`InputError`.

    ``missing`` and ``folder`` are its sentences for a file that does not exist, and for a folder of this name.
    """
    try:
        yield
    except FileNotFoundError:
        raise InputError(missing, file=path) from None
    except IsADirectoryError:
        raise InputError(folder, file=path) from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror}); check its permissions", file=path) from None


def check_readable(path: Path) -> None:
    """Raise :class:`InputError` if the file cannot be opened."""
    with readable(path):
        path.open("rb").close()


def meant(word: str, known: Iterable[str], *, likeness: float = constants.LIKENESS_OF_MISSPELT) -> str:
    """The known word that a misspelt one probably is; empty if none is like it."""
    return next(iter(difflib.get_close_matches(word, list(known), n=1, cutoff=likeness)), "")


def shortened(text: object) -> str:
    """The text on one line, short enough to be quoted in a message."""
    line = " ".join(str(text).split())
    return line if len(line) <= constants.LONGEST_QUOTE else f"{line[: constants.LONGEST_QUOTE]}..."
