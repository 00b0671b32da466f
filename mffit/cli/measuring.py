"""`mffit spin` and `mffit align`: direct measurements, without a fit."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import Voice, voiced
from mffit.cli.options import PATH, out_option, path_centre, tyre_toml


@click.command()
@tyre_toml
@out_option("Folder to write to [default: out/ beside TYRE_TOML].")
@voiced
def spin(tyre_toml: Path, out: Path | None, voice: Voice) -> None:
    """Measure eps_gamma directly.

    Checks the alignment and applies the direct method, without a fit; prints eps_gamma with its uncertainty budget. Exit code 3
    if the result is not to be trusted.
    """
    from mffit import pipeline
    from mffit.report import text
    from mffit.results import as_json

    out = out or tyre_toml.parent / "out"
    with voice.progress() as show:
        show("measuring")
        measured = pipeline.spin(tyre_toml, out)
    voice.say(text.spin_summary(measured))
    voice.warn(measured.warnings)
    voice.written(out, "spin.json")
    voice.give(lambda: as_json.spin(measured))
    if not measured.trusted:
        voice.distrust("the measurement is not to be trusted: see above")


@click.command()
@click.argument("source", type=PATH, metavar="TYRE_TOML|FILE.csv")
@click.option(
    "--axes", type=click.Choice(["iso", "sae", "adapted-sae"]), help="Axes of a CSV file without a tyre.toml."
)
@path_centre
@click.option("--resolution", type=float, metavar="DEG", help="Smallest step of the steering axis.")
@voiced
def align(
    source: Path, axes: str | None, path_centre: str | None, resolution: float | None, voice: Voice
) -> None:
    """Compute the next steering correction.

    Uses forward and backward points at zero angles; the correction is in degrees of the rig's axis.
    """
    from mffit import pipeline
    from mffit.errors import InputError
    from mffit.report import text
    from mffit.results import as_json

    if source.suffix != ".toml" and (axes is None or path_centre is None):
        raise InputError("a CSV file does not state axes and path centre; give --axes and --path-centre")
    finest = {} if resolution is None else {"resolution_deg": resolution}
    alignment = pipeline.align(source, axes=axes, path_centre=path_centre, **finest)
    voice.say(text.alignment_table(alignment))
    voice.warn(alignment.warnings)
    voice.give(lambda: as_json.alignment(alignment))
