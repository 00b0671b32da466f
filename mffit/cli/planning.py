"""`mffit plan`: which further runs would tell most."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import Voice, voiced


@click.command()
@click.argument("tyre_toml", type=click.Path(path_type=Path))
@click.option(
    "--goal",
    help="eps_gamma, eps_gamma:joint, bands, bands:Mz, or tie:EFFECT [default: what PECP1 comes from].",
)
@click.option("--coefficient", metavar="NAME", help="Aim at the standard error of a coefficient instead.")
@click.option(
    "--runs", type=click.IntRange(1, 10), default=3, show_default=True, help="Length of the list at most."
)
@click.option(
    "--without", multiple=True, metavar="KIND", help="Kind of run that this rig cannot make; may be repeated."
)
@click.option(
    "--out", type=click.Path(path_type=Path), help="Folder to write to [default: out/plan/ beside TYRE_TOML]."
)
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
    """What the sweeps identify, and the shortest list of further runs that would tell most."""
    from mffit import pipeline
    from mffit.errors import InputError
    from mffit.report import text
    from mffit.results import as_json

    if goal and coefficient:
        raise InputError("--goal and --coefficient exclude each other; give one")
    out = out or tyre_toml.parent / "out" / "plan"
    with voice.progress() as show:
        found = pipeline.plan(
            tyre_toml, coefficient or goal, runs=runs, without=without, out=out, progress=show
        )
    voice.say(text.plan_summary(found))
    inside = "sheets to fill in" if found.points else "what changes in tyre.toml"
    sheets = f", runs ({inside})" if found.steps else ""
    voice.say(f"written to {out}: plan.html, plan.json{sheets}")
    voice.give(lambda: as_json.plan(found))
