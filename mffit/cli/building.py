"""`mffit build`: sweeps to property file."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import progress, warn


@click.command()
@click.argument("tyre_toml", type=click.Path(path_type=Path))
@click.option(
    "--out", type=click.Path(path_type=Path), help="Folder to write to [default: out/ beside TYRE_TOML]."
)
@click.option(
    "--ensemble", type=click.IntRange(0), default=0, help="Files to draw from what the fit leaves uncertain."
)
def build(tyre_toml: Path, out: Path | None, ensemble: int) -> None:
    """Run the whole pipeline: sweeps to .tir, result.json, report.html."""
    from mffit import pipeline
    from mffit.report import text

    out = out or tyre_toml.parent / "out"
    with progress() as show:
        result = pipeline.build(tyre_toml, out, ensemble=ensemble, progress=show)
    warn(result.warnings)
    click.echo(text.build_summary(result))
    files = dict.fromkeys((result.tir_path, *result.files.values()))
    drawn = f", ensemble ({len(result.members)} files)" if result.members else ""
    click.echo(f"written to {out}: {', '.join(files)}, report.html, result.json, points.csv, plots{drawn}")
    if result.fit.distrusted:
        click.echo(f"{result.tir_path} is not to be trusted: see above", err=True)
