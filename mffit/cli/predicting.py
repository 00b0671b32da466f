"""`mffit predict`: forces at conditions, with uncertainty."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import Voice, voiced
from mffit.cli.options import PATH, out_option


@click.command()
@click.argument("folder", type=PATH, metavar="DIR")
@click.argument("conditions", type=PATH, metavar="CONDITIONS.csv")
@out_option("File to write.", is_file=True, required=True)
@voiced
def predict(folder: Path, conditions: Path, out: Path, voice: Voice) -> None:
    """Predict forces at conditions, from the folder of a build.

    Writes the force of the property file and the best estimate, with what the formula misses added; both with how far a new
    run may lie from them (k = 1). Conditions and forces are in ISO-W.
    """
    from mffit import pipeline
    from mffit.prediction import write_table
    from mffit.report import text

    found = pipeline.predict(folder, conditions)
    write_table(found, out, conditions)
    voice.say(text.prediction_summary(found, out))
    voice.give(lambda: {"written": [str(out)], "conditions": len(found)})
