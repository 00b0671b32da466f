"""`mffit watch`: what the files of a campaign say while it runs."""

import json
import time
from pathlib import Path

import click

from mffit.cli.console import Voice, voiced
from mffit.cli.options import tyre_toml


@click.command()
@tyre_toml
@click.option("--once", is_flag=True, help="End when no file is being written any more.")
@voiced
def watch(tyre_toml: Path, once: bool, voice: Voice) -> None:
    """Follow a campaign while it runs.

    Prints points, eps_gamma, alignment and the most informative next run whenever a file of the project is new, changed or gone.
    Sweeps that TYRE_TOML lists may still be missing; recordings next to it that it does not list are used, and nothing is
    written. With --json, one line of JSON for each change. Ctrl-C ends it.
    """
    from mffit import as_json, pipeline
    from mffit.report import text

    last = None
    try:
        for last in pipeline.watch(tyre_toml, once=once):
            voice.say(f"{time.strftime('%H:%M:%S')} {text.campaign_text(last)}")
            if voice.json:
                click.echo(json.dumps(as_json.document(last)))
    except KeyboardInterrupt:
        if last is not None:
            voice.say("\n".join(["", *text.campaign_lines(last)]))
