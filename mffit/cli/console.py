"""What every command says in the same way: results as text or JSON, warnings, progress, and silence to a reader who left."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Any

import click

from mffit.progress import Progress, silent


def warn(warnings: Iterable[str]) -> None:
    """Warnings go to stderr, one line each."""
    for sentence in warnings:
        click.echo(f"warning: {sentence}", err=True)


@contextmanager
def progress() -> Iterator[Progress]:
    """A spinner with the running step on a terminal; silence elsewhere."""
    from rich.console import Console

    console = Console(stderr=True)
    if not console.is_terminal:
        yield silent
        return
    with console.status("starting") as status:
        yield lambda sentence: status.update(sentence)


class Voice:
    """How a command speaks: text for people, one JSON document for programs, or neither.

    Warnings and errors go to stderr in any case.
    """

    def __init__(self, *, json: bool, quiet: bool) -> None:
        self.json, self.quiet = json, quiet

    def say(self, text: str, *, end: str = "\n") -> None:
        """A result for people, on stdout."""
        if not (self.json or self.quiet):
            click.echo(text + end, nl=False)

    def give(self, content: Callable[[], Any]) -> None:
        """The same result for programs; worked out only where it is asked for."""
        if self.json:
            from mffit.results import as_json

            click.echo(as_json.text(content()), nl=False)

    def tell(self, sentence: str) -> None:
        """What goes on, line by line, on stderr."""
        if not self.quiet:
            click.echo(sentence, err=True)

    def warn(self, warnings: Iterable[str]) -> None:
        """As :func:`warn`, in any case."""
        warn(warnings)

    def progress(self) -> AbstractContextManager[Progress]:
        """As :func:`progress`, unless nothing is to be said."""
        return nullcontext(silent) if self.quiet else progress()


def voiced(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command ``--json`` and ``--quiet``, and hand it a :class:`Voice` as ``voice``."""

    @click.option("--json", "json", is_flag=True, help="Print the result as JSON instead of text.")
    @click.option("--quiet", "-q", is_flag=True, help="Print warnings and errors only.")
    @functools.wraps(command)
    def heard(*args: Any, json: bool, quiet: bool, **keys: Any) -> Any:
        return command(*args, voice=Voice(json=json, quiet=quiet), **keys)

    return heard


class Unheard:
    """A stream that goes on in silence when its reader leaves (``mffit ... | head -1``): no failure of the command."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        try:
            return self._stream.write(text)
        except BrokenPipeError:
            self._give_up()
            return len(text)

    def flush(self) -> None:
        try:
            self._stream.flush()
        except BrokenPipeError:
            self._give_up()

    def _give_up(self) -> None:
        """Send the rest, also what Python flushes at its end, nowhere."""
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self._stream.fileno())
        os.close(nowhere)
