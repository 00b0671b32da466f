"""What all commands share: results as text or JSON, warnings, progress, and closed pipes."""

from __future__ import annotations

import functools
import json
import os
import re
import sys
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from mffit.progress import Progress, ShownStep, silent

if TYPE_CHECKING:
    from tir import Tyre

NOT_ASCII = re.compile(r"[^\x00-\x7f]")
NOT_TRUSTED = 3
"""Exit code of a command that is done, but whose result says that it is not to be trusted."""


@contextmanager
def progress() -> Iterator[Progress]:
    """A spinner with the current step on a terminal; nothing elsewhere."""
    console = None
    if sys.stderr.isatty() or "FORCE_COLOR" in os.environ:  # elsewhere rich is not even loaded
        from rich.console import Console

        console = Console(stderr=True)
    if console is None or not console.is_terminal:
        yield silent
        return
    begun = time.monotonic()
    with console.status("starting") as status:
        yield lambda sentence: status.update(ShownStep(sentence, begun))  # which a terminal shows anew


class Voice:
    """Output of a command: text for people, one JSON document for programs, or neither.

    Warnings and errors go to stderr in any case.
    """

    def __init__(self, *, json: bool, quiet: bool) -> None:
        self.json, self.quiet = json, quiet

    def say(self, text: str, *, end: str = "\n") -> None:
        """Print a result for people to stdout."""
        if not (self.json or self.quiet):
            click.echo(text + end, nl=False)

    def written(self, out: Path | None, *files: str) -> None:
        """Name the files that were written to a folder, if any."""
        if out is not None:
            self.say(f"written to {out}: {', '.join(files)}")

    def give(self, content: object) -> None:
        """Print a record, or JSON made from records, if ``--json`` asks for it."""
        if self.json:
            from mffit import as_json

            click.echo(as_json.text(content), nl=False)

    def answer(self, found: object, text: str, out: Path | None = None, *files: str) -> None:
        """Print a result as text with the files that were written, or as JSON."""
        self.say(text)
        self.written(out, *files)
        self.give(found)

    def tell(self, sentence: str) -> None:
        """Print a line about the progress to stderr."""
        if not self.quiet:
            click.echo(sentence, err=True)

    def warn(self, warnings: Iterable[str]) -> None:
        """Print warnings to stderr, one line each, even with ``--quiet``."""
        for sentence in warnings:
            click.echo(f"warning: {sentence}", err=True)

    def warn_of(self, file: Path, tyre: Tyre) -> None:
        """Warn of what ``mffit check`` calls an error in a file that is in use: its forces are not those that were meant."""
        self.warn(f"{file}: {one.sentence}" for one in tyre.problems if one.level == "error")

    def distrust(self, what: str) -> NoReturn:
        """End with the exit code of a result that is not to be trusted."""
        click.echo(what, err=True)
        raise SystemExit(NOT_TRUSTED)

    def progress(self) -> AbstractContextManager[Progress]:
        """As :func:`progress`; nothing with ``--quiet``."""
        return nullcontext(silent) if self.quiet else progress()


@contextmanager
def told(voice: Voice) -> Iterator[None]:
    """Warnings about the tyre, said as those of every command."""
    from tir import TirWarning

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", TirWarning)
        yield
    voice.warn(str(one.message) for one in caught)


def voiced(command: Callable[..., Any]) -> Callable[..., Any]:
    """The command with the options ``--json`` and ``--quiet``, called with a :class:`Voice` as ``voice``."""

    @click.option("--json", "json", is_flag=True, help="Print the result as JSON instead of text.")
    @click.option("--quiet", "-q", is_flag=True, help="Print warnings and errors only.")
    @functools.wraps(command)
    def with_voice(*args: Any, json: bool, quiet: bool, **keys: Any) -> Any:
        return command(*args, voice=Voice(json=json, quiet=quiet), **keys)

    return with_voice


class PipeTolerant:
    """Output stream that ignores a closed pipe (``mffit ... | head -1``), and takes every character.

    A file or a pipe on Windows has an encoding of a few hundred characters; others are escaped there as in JSON.
    """

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        try:
            try:
                return int(self._stream.write(text))
            except UnicodeEncodeError:
                return int(self._stream.write(NOT_ASCII.sub(lambda found: json.dumps(found[0])[1:-1], text)))
        except BrokenPipeError:
            self._discard_the_rest()
            return len(text)

    def flush(self) -> None:
        try:
            self._stream.flush()
        except BrokenPipeError:
            self._discard_the_rest()

    def _discard_the_rest(self) -> None:
        """Redirect to the null device, so that Python's own flush at exit does not fail either."""
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self._stream.fileno())
        os.close(nowhere)
