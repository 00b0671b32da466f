"""`mffit simulate`: a virtual rig."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import Voice, voiced


@click.command()
@click.argument("rig_toml", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder to write to.")
@click.option("--seed", type=int, default=None, help="Seed of noise and drawn faults [default: the file's].")
@voiced
def simulate(rig_toml: Path, out: Path, seed: int | None, voice: Voice) -> None:
    """Virtual rig: write sweeps that `build` reads, and truth.json."""
    from mffit import virtual_rig

    with voice.progress() as show:
        show("simulating")
        truth = virtual_rig.simulate(rig_toml, out, seed=seed)
    voice.say(f"written to {out}: sweeps, tyre.toml, truth.json")
    voice.give(truth.to_json)
