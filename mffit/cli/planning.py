"""`mffit plan`: the most informative further runs."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import Voice, voiced
from mffit.cli.options import out_option, tyre_toml


@click.command()
@tyre_toml
@click.option(
    "--goal",
    help="What to make more certain: eps_gamma, eps_gamma:joint, bands, bands:Mz, or tie:EFFECT "
    "[default: the source of PECP1].",
)
@click.option("--coefficient", metavar="NAME", help="Make this coefficient more certain instead.")
@click.option(
    "--runs", type=click.IntRange(1, 10), default=3, show_default=True, help="Largest number of runs."
)
@click.option(
    "--without", multiple=True, metavar="KIND", help="Kind of run that the rig cannot make; may be repeated."
)
@out_option("Folder to write to [default: out/plan/ beside TYRE_TOML].")
@voiced
def plan(
    tyre_toml: Path,
    goal: str | None,
    coefficient: str | None,
    runs: int,
    without: tuple[str, ...],
    out: Path | None,
    voice: Voice,
) -> None:
    """Plan the most informative further runs.

    Shows what the present sweeps identify, and the shortest list of runs that would add most.
    """
    from mffit import pipeline
    from mffit.errors import InputError
    from mffit.report import text
    from mffit.results import as_json

    if goal and coefficient:
        raise InputError("--goal and --coefficient exclude each other; give only one")
    out = out or tyre_toml.parent / "out" / "plan"
    with voice.progress() as show:
        found = pipeline.plan(
            tyre_toml, coefficient or goal, runs=runs, without=without, out=out, progress=show
        )
    voice.say(text.plan_summary(found))
    inside = "sheets to fill in" if found.points else "what changes in tyre.toml"
    voice.written(out, "plan.html", "plan.json", *([f"runs ({inside})"] if found.steps else []))
    voice.give(lambda: as_json.plan(found))
