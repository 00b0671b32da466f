"""`mffit spin` and `mffit align`: what is measured without a fit."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import warn


@click.command()
@click.argument("tyre_toml", type=click.Path(path_type=Path))
@click.option(
    "--out", type=click.Path(path_type=Path), help="Folder to write to [default: out/ beside TYRE_TOML]."
)
def spin(tyre_toml: Path, out: Path | None) -> None:
    """Alignment check and direct method only: eps_gamma with its uncertainty budget."""
    from mffit import pipeline
    from mffit.report import text

    out = out or tyre_toml.parent / "out"
    measured = pipeline.spin(tyre_toml, out)
    click.echo(text.spin_summary(measured))
    warn(measured.warnings)
    click.echo(f"written to {out}: spin.json")


@click.command()
@click.argument("source", type=click.Path(path_type=Path), metavar="TYRE_TOML|FILE.csv")
@click.option("--axes", type=click.Choice(["iso", "sae", "adapted-sae"]), help="Axes of a bare CSV file.")
@click.option(
    "--path-centre", type=click.Choice(["left", "right"]), help="Side of the disc centre, for a CSV file."
)
def align(source: Path, axes: str | None, path_centre: str | None) -> None:
    """Next steering correction from forward and backward zeros, in degrees of the rig's axis."""
    from mffit import pipeline
    from mffit.errors import InputError
    from mffit.report import text

    if source.suffix != ".toml" and (axes is None or path_centre is None):
        raise InputError("a CSV file needs --axes and --path-centre, as it does not say them itself")
    alignment = pipeline.align(source, axes=axes, path_centre=path_centre)
    click.echo(text.alignment_table(alignment))
    warn(alignment.warnings)
