"""What every command says in the same way: warnings, progress, and silence to a reader who left."""

from __future__ import annotations

import os
from typing import Any

import click


def warn(warnings) -> None:
    """Warnings go to stderr, one line each."""
    for sentence in warnings:
        click.echo(f"warning: {sentence}", err=True)


def progress():
    """A spinner with the running step on a terminal; silence elsewhere."""
    from contextlib import contextmanager

    @contextmanager
    def shown():
        from rich.console import Console

        console = Console(stderr=True)
        if not console.is_terminal:
            yield lambda sentence: None
            return
        with console.status("starting") as status:
            yield lambda sentence: status.update(sentence)

    return shown()


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
