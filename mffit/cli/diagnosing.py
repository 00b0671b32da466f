"""`mffit diagnose`: what a simulation is missing."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import progress


@click.command()
@click.argument("tyre_toml", type=click.Path(path_type=Path))
@click.option(
    "--model", type=click.Path(path_type=Path), help="The simulation's .tir [default: the last build's]."
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder to write to [default: out/diagnosis/ beside TYRE_TOML].",
)
def diagnose(tyre_toml: Path, model: Path | None, out: Path | None) -> None:
    """Find where simulation and measurement disagree, name the missing effect, show the gap shrink."""
    from mffit import pipeline
    from mffit.report import text

    out = out or tyre_toml.parent / "out" / "diagnosis"
    with progress() as show:
        diagnosis = pipeline.diagnose(tyre_toml, model, out=out, progress=show)
    click.echo(text.diagnosis_summary(diagnosis))
    click.echo(f"written to {out}: diagnosis.html, diagnosis.json, {diagnosis.model_after}, corrected.toml")
