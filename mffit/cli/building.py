"""`mffit build`: sweeps to property file, of one tyre or of many; `mffit fleet`: many built tyres together."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import Voice, voiced

MANY_BUILT = 2
"""Tyres from which on they are compared."""


@click.command()
@click.argument(
    "tyre_tomls", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="TYRE_TOML..."
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder to write to; of several tyres each in a folder of its name, with a page that compares them "
    "[default: out/ beside each TYRE_TOML].",
)
@click.option(
    "--ensemble", type=click.IntRange(0), default=0, help="Files to draw from what the fit leaves uncertain."
)
@click.option("--jobs", type=click.IntRange(1), default=1, help="Of several tyres, how many at a time.")
@click.option("--dask", metavar="ADDRESS", help="Build on the workers of this Dask scheduler.")
@voiced
def build(
    tyre_tomls: tuple[Path, ...], out: Path | None, ensemble: int, jobs: int, dask: str | None, voice: Voice
) -> None:
    """Run the whole pipeline: sweeps to .tir, result.json, report.html."""
    if len(tyre_tomls) > 1 or dask:
        _build_many(tyre_tomls, out, ensemble, jobs, dask, voice)
    else:
        _build(tyre_tomls[0], out, ensemble, voice)


def _build(tyre_toml: Path, out: Path | None, ensemble: int, voice: Voice) -> None:
    from mffit import pipeline
    from mffit.report import text
    from mffit.results import as_json

    out = out or tyre_toml.parent / "out"
    with voice.progress() as show:
        result = pipeline.build(tyre_toml, out, ensemble=ensemble, progress=show)
    voice.warn(result.warnings)
    voice.say(text.build_summary(result))
    files = dict.fromkeys((result.tir_path, *result.files.values()))
    drawn = f", ensemble ({len(result.members)} files)" if result.members else ""
    voice.say(f"written to {out}: {', '.join(files)}, report.html, result.json, points.csv, plots{drawn}")
    voice.give(lambda: as_json.build(result))
    if result.fit.distrusted:
        click.echo(f"{result.tir_path} is not to be trusted: see above", err=True)


def _build_many(
    tyre_tomls: tuple[Path, ...],
    out: Path | None,
    ensemble: int,
    jobs: int,
    dask: str | None,
    voice: Voice,
) -> None:
    from mffit import pipeline
    from mffit.errors import InputError
    from mffit.report import text
    from mffit.results import Outcome, as_json

    finished: list[Outcome] = []
    state = None

    def done(outcome: Outcome) -> None:
        finished.append(outcome)
        voice.tell(text.many_line(outcome, len(finished), len(tyre_tomls)))
        if state is not None:
            state(f"{len(finished)} of {len(tyre_tomls)} finished")

    interrupted = False
    with voice.progress() as show:
        state = show
        show(f"building {len(tyre_tomls)} tyres")
        try:
            finished = [
                *pipeline.build_many(tyre_tomls, out, jobs=jobs, dask=dask, ensemble=ensemble, done=done)
            ]
        except KeyboardInterrupt:
            interrupted = True
    if finished:
        voice.say(text.many_summary(finished))
    whole = [outcome.out for outcome in finished if outcome.out is not None and outcome.whole]
    if out is not None and len(whole) >= MANY_BUILT and not interrupted:
        try:
            pipeline.fleet(whole, out)
            voice.say(f"\nwritten to {out}: fleet.html, fleet.json, fleet.csv")
        except InputError as error:
            voice.warn([f"the tyres are not compared: {error}"])
    voice.give(lambda: [as_json.outcome(outcome) for outcome in finished])
    if voice.json or voice.quiet:
        for outcome in finished:
            if not outcome.whole:
                click.echo(f"mffit: {text.lacking(outcome)}", err=True)
    if interrupted:
        click.echo(
            "mffit: interrupted; finished tyres are whole, the same command goes on with the others", err=True
        )
        raise SystemExit(130)
    if any(outcome.state == "refused" for outcome in finished):
        raise SystemExit(2)
    if any(outcome.state == "failed" for outcome in finished):
        raise SystemExit(1)


@click.command()
@click.argument("folders", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="DIR...")
@click.option(
    "--out", type=click.Path(path_type=Path), help="Folder for fleet.html, .json, .csv, priors.json."
)
@voiced
def fleet(folders: tuple[Path, ...], out: Path | None, voice: Voice) -> None:
    """Compare built tyres (the folders that `build` wrote); those of one rig are estimated together."""
    from mffit import pipeline
    from mffit.report import text
    from mffit.results import as_json

    with voice.progress() as show:
        found = pipeline.fleet(folders, out, progress=show)
    voice.say(text.fleet_summary(found))
    if out is not None:
        voice.say(f"written to {out}: fleet.html, fleet.json, fleet.csv")
    voice.give(lambda: as_json.fleet(found))
