"""`mffit build`: property files of one tyre or of many; `mffit fleet`: comparison of built tyres."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mffit.cli.console import Voice, voiced
from mffit.cli.options import PATH, out_option, strict
from mffit.errors import InputError
from tir.errors import counted

if TYPE_CHECKING:
    from mffit.results import BuildOutcome, BuildResult

FEWEST_TYRES_TO_COMPARE = 2


@click.command()
@click.argument("tyre_tomls", nargs=-1, required=True, type=PATH, metavar="TYRE_TOML...")
@out_option(
    "Folder to write to [default: out/ beside each TYRE_TOML]. With several tyres, each gets a folder of its name, and a page "
    "compares them."
)
@click.option(
    "--ensemble",
    type=click.IntRange(0),
    default=0,
    help="Number of files to draw from the posterior of the fit.",
)
@click.option(
    "--set",
    "coefficients",
    multiple=True,
    metavar="NAME=VALUE",
    help="Set a coefficient as [coefficients] does, instead of the entry there: PCY1=1.3 holds it, RBX1=base too; "
    "'PEY1={min=-3, max=0.5}' bounds it. May be repeated.",
)
@click.option(
    "--no-report",
    "with_report",
    is_flag=True,
    callback=lambda context, option, left_out: not left_out,
    help="Write neither report.html nor plots, for quick tries.",
)
@click.option(
    "--explain",
    is_flag=True,
    help="Print everything that is said about the result; what is built already is read from the folder.",
)
@strict
@click.option("--jobs", type=click.IntRange(1), default=1, help="Number of tyres to build at the same time.")
@click.option("--dask", metavar="ADDRESS", help="Build on the workers of this Dask scheduler.")
@voiced
def build(tyre_tomls: tuple[Path, ...], jobs: int, dask: str | None, **asked: Any) -> None:
    """Make the property file from the sweeps.

    Runs the whole pipeline and writes .tir, result.json, report.html, points.csv and plots.
    """
    if (len(tyre_tomls) > 1 or dask) and asked["explain"]:
        raise click.UsageError(
            "--explain is for one TYRE_TOML; a folder that is built keeps it as explained.txt"
        )
    if len(tyre_tomls) > 1 or dask:
        _build_many(tyre_tomls, jobs=dask or jobs, **asked)
    else:
        _build(tyre_tomls[0], **asked)


def _build(
    tyre_toml: Path,
    out: Path | None,
    voice: Voice,
    *,
    coefficients: tuple[str, ...],
    explain: bool,
    strict: bool,
    **asked: Any,
) -> None:
    """Build one tyre; further options in ``asked`` go to :func:`mffit.pipeline.build`."""
    from mffit import config, pipeline
    from mffit.report import text

    where = out or tyre_toml.parent / "out"
    settings = config.load(tyre_toml, coefficients=coefficients)
    if not (explain and pipeline.is_current(settings, where, **asked)):
        with voice.progress() as show:
            result = pipeline.build(settings, where, progress=show, **asked)
        if not explain:
            voice.warn(result.warnings if voice.quiet or voice.json else text.warnings_beside(result))
            voice.answer(result, _summary(result, tyre_toml, out, coefficients))
            return _judge(voice, result.tir_path, result.reasons, result.trust.doubts, strict=strict)
    said, kept = pipeline.explained(where)
    voice.warn(kept["warnings"])
    voice.answer(kept, said)
    _judge(voice, kept["tir"], kept["reasons"], kept["in_doubt"], strict=strict)


def _summary(result: BuildResult, tyre_toml: Path, out: Path | None, coefficients: tuple[str, ...]) -> str:
    """One screen about a build, which ends with commands that go on from it."""
    from mffit.report import text

    where = out or tyre_toml.parent / "out"
    has_report = (where / "report.html").exists()
    tables = "report.html, result.json, points.csv, plots" if has_report else "result.json, points.csv"
    drawn = f", ensemble ({counted(len(result.members), 'file')})" if result.members else ""
    again = ["mffit", "build", str(tyre_toml), *([] if out is None else ["--out", str(out)])]
    again += [] if has_report else ["--no-report"]
    again += [word for one in coefficients for word in ("--set", one)]
    model = [] if out is None else ["--model", str(out / result.tir_path)]
    following = [(shlex.join([*again, "--explain"]), "all that is said about the result")]
    if result.reasons or result.trust.doubts:
        why = shlex.join(["mffit", "diagnose", str(tyre_toml), *model]), "names what the model misses"
        following.insert(0, why)
    return text.build_summary(result, f"{where}: {tables}{drawn}", following)


def _judge(voice: Voice, file: str, reasons: Sequence[str], doubts: Sequence[str], *, strict: bool) -> None:
    """Exit with the code of a result that is not to be trusted, or with ``strict`` one in doubt."""
    if reasons:
        voice.distrust(f"{file} is not to be trusted: see above")
    if strict and doubts:
        voice.distrust(f"{file} is in doubt, and --strict asks for more: {doubts[0]}")


def _build_many(
    tyre_tomls: tuple[Path, ...],
    out: Path | None,
    voice: Voice,
    *,
    coefficients: tuple[str, ...],
    explain: bool,
    strict: bool,
    **asked: Any,
) -> None:
    """Build several tyres; further options in ``asked`` go to :func:`mffit.pipeline.build_many`."""
    from mffit import pipeline
    from mffit.report import text

    if coefficients:
        raise click.UsageError(
            "--set is a try with one TYRE_TOML: build the tyres one by one, or write [coefficients]"
        )
    finished: list[BuildOutcome] = []
    interrupted = False
    with voice.progress() as show:

        def done(outcome: BuildOutcome) -> None:
            finished.append(outcome)
            voice.tell(text.many_line(outcome, len(finished), len(tyre_tomls)))
            show(f"{len(finished)} of {len(tyre_tomls)} finished")

        show(f"building {len(tyre_tomls)} tyres")
        try:
            finished = list(pipeline.build_many(tyre_tomls, out, done=done, **asked))
        except KeyboardInterrupt:
            interrupted = True
    if finished:
        voice.say(text.many_summary(finished))
    if out is not None and not interrupted:
        _compare_built(finished, out, voice)
    voice.give(finished)
    _end(finished, interrupted, strict, voice)


def _compare_built(finished: list[BuildOutcome], out: Path, voice: Voice) -> None:
    """Compare the tyres that were built completely."""
    from mffit import pipeline

    whole = [outcome.out for outcome in finished if outcome.out is not None and outcome.whole]
    if len(whole) < FEWEST_TYRES_TO_COMPARE:
        return
    try:
        pipeline.fleet(whole, out)
        voice.say(f"\nwritten to {out}: fleet.html, fleet.json, fleet.csv")
    except InputError as error:
        voice.warn([f"the tyres are not compared: {error}"])


def _end(finished: list[BuildOutcome], interrupted: bool, strict: bool, voice: Voice) -> None:
    """Name the tyres that were not built, and exit with the code of the worst."""
    from mffit.report import text

    if voice.json or voice.quiet:
        for outcome in finished:
            if not outcome.whole:
                click.echo(f"mffit: {text.lacking(outcome)}", err=True)
    if interrupted:
        click.echo(
            "mffit: interrupted; the finished tyres are complete, and the same command continues with the others",
            err=True,
        )
        raise SystemExit(130)
    states = {outcome.state for outcome in finished}
    if "refused" in states:
        raise SystemExit(2)
    if "failed" in states:
        raise SystemExit(1)
    doubtful = [outcome.name for outcome in finished if not outcome.trusted]
    if doubtful:
        voice.distrust(f"not to be trusted: {', '.join(doubtful)}")
    if strict and (in_doubt := [outcome for outcome in finished if outcome.in_doubt]):
        names = ", ".join(outcome.name for outcome in in_doubt)
        voice.distrust(f"in doubt, and --strict asks for more: {names}: {in_doubt[0].in_doubt[0]}")


@click.command()
@click.argument("folders", nargs=-1, required=True, type=PATH, metavar="DIR...")
@out_option("Folder for fleet.html, fleet.json, fleet.csv and priors.json [default: only printed].")
@voiced
def fleet(folders: tuple[Path, ...], out: Path | None, voice: Voice) -> None:
    """Compare built tyres.

    DIR is a folder that `mffit build` wrote. Tyres that were measured on one rig are estimated together.
    """
    from mffit import pipeline
    from mffit.report import text

    with voice.progress() as show:
        found = pipeline.fleet(folders, out, progress=show)
    voice.answer(found, text.fleet_summary(found), out, "fleet.html", "fleet.json", "fleet.csv")
