"""`mffit diagnose`: effects that a simulation lacks."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import Voice, voiced
from mffit.cli.options import PATH, out_option, tyre_toml


@click.command()
@tyre_toml
@click.option(
    "--model",
    type=PATH,
    help="The simulation's .tir [default: that of the last build].",
)
@out_option("Folder to write to [default: out/diagnosis/ beside TYRE_TOML].")
@click.option(
    "--repair-all", is_flag=True, help="Correct the model for uncertain effects too (confidence below 50 %)."
)
@voiced
def diagnose(tyre_toml: Path, model: Path | None, out: Path | None, repair_all: bool, voice: Voice) -> None:
    """Find effects that a simulation lacks.

    Shows where simulation and measurement disagree, names the effects that explain it, and corrects the model.
    """
    from mffit import pipeline
    from mffit.report import text
    from mffit.results import as_json

    out = out or tyre_toml.parent / "out" / "diagnosis"
    with voice.progress() as show:
        diagnosis = pipeline.diagnose(tyre_toml, model, out=out, repair_all=repair_all, progress=show)
    voice.say(text.diagnosis_summary(diagnosis))
    voice.written(out, "diagnosis.html", "diagnosis.json", text.models_written(diagnosis), "corrected.toml")
    voice.give(lambda: as_json.diagnosis(diagnosis))
    if not diagnosis.trusted:
        voice.distrust(f"{diagnosis.model_after} is not to be trusted: see above")
