"""`mffit simulate`: sweeps of a virtual rig."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import Voice, voiced
from mffit.cli.options import PATH, out_option


@click.command()
@click.argument("rig_toml", type=PATH)
@out_option("Folder to write to.", required=True)
@click.option(
    "--seed", type=int, default=None, help="Seed of noise and drawn rig errors [default: that of the file]."
)
@voiced
def simulate(rig_toml: Path, out: Path, seed: int | None, voice: Voice) -> None:
    """Simulate the sweeps of a virtual rig.

    Writes sweeps and a tyre.toml that `mffit build` reads, and the true values in truth.json.
    """
    from mffit import virtual_rig

    with voice.progress() as show:
        show("simulating")
        truth = virtual_rig.simulate(rig_toml, out, seed=seed)
    voice.written(out, "sweeps", "tyre.toml", "truth.json")
    voice.give(truth.to_json)
