"""`mffit compare`: two property files, a file and data, or two builds."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import Voice, voiced
from mffit.cli.options import PATH, out_option


@click.command()
@click.argument("first", type=PATH, metavar="A.tir|FOLDER")
@click.argument("second", type=PATH, metavar="B.tir|FOLDER|TYRE_TOML")
@out_option("Folder for compare.html and compare.json [default: nothing is written].")
@click.option(
    "--turn-slip",
    type=click.Choice(["on", "off"]),
    help="Evaluate both files with turn slip on or off [default: each as intended].",
)
@voiced
def compare(first: Path, second: Path, out: Path | None, turn_slip: str | None, voice: Voice) -> None:
    """Compare two property files, a file and data, or two builds.

    Ranks the differences of curves, stiffnesses, peaks, trail and eps_gamma.
    """
    from mffit import pipeline
    from mffit.report import text
    from mffit.results import as_json

    both = None if turn_slip is None else turn_slip == "on"
    with voice.progress() as show:
        found = pipeline.compare(first, second, turn_slip=both, out=out, progress=show)
    voice.say(text.comparison_table(found))
    voice.written(out, "compare.html", "compare.json")
    voice.give(lambda: as_json.comparison(found))
