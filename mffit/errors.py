"""What a user has to put right, said in one sentence.

Only :class:`InputError` reaches the user without a traceback: the command line prints ``mffit: <sentence>``
and exits with 2. Everything else is a bug of ours. This module imports nothing of ours, so all may import it.
"""

from __future__ import annotations

from pathlib import Path


class InputError(Exception):
    """Bad input: what is wrong, where it stands and what to do about it.

    Parameters
    ----------
    sentence : what is there, why it is wrong and what to do; without the place
    file : the file at fault; its place opens the text, ``file:line: ...``
    line : line in ``file``, counted from 1
    column : heading of the CSV column at fault
    key : dotted key of ``tyre.toml`` at fault, as ``rig.path_radius``

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
