"""`mffit open`: a project in a local window."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import Voice, voiced
from mffit.cli.options import PATH


@click.command("open")
@click.argument(
    "paths",
    type=PATH,
    nargs=-1,
    required=True,
    metavar="tyre.toml|FOLDER|FILE.tir...",
)
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, help="Port on this machine [default: a free one]."
)
@click.option("--no-browser", is_flag=True, help="Only print the address.")
@voiced
def open_window(paths: tuple[Path, ...], port: int, no_browser: bool, voice: Voice) -> None:
    """Open a project in a local window in the browser.

    Shows measured points and curves, adjusts coefficients, leaves points out, and refits; every click is saved in tyre.toml.
    A folder of recordings is shown as a table to correct, then becomes a project. Ctrl-C ends it; other machines cannot reach
    it.
    """
    from mffit import window

    def opened(address: str) -> None:
        voice.say(f"{paths[0]}: open at {address}\nCtrl-C ends it")
        voice.give(lambda: {"address": address})
        if not no_browser:
            click.launch(address)

    window.open_path(paths, port=port, opened=opened)
