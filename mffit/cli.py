"""The command line: a thin shell over the Python API."""

from __future__ import annotations

import os
import sys
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import click

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}


@click.group(context_settings=CONTEXT)
@click.version_option(package_name="mffit", prog_name="mffit")
def commands() -> None:
    """From tyre-rig sweeps to an MF-6.2 property file with a measured camber reduction factor."""


@commands.command()
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


@commands.command()
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


@commands.command()
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


@commands.command()
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
    click.echo(f"written to {out}: diagnosis.html, diagnosis.json, {diagnosis.model_after}")


@commands.command()
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.tir")
@click.option(
    "--for", "targets", default="", metavar="NAMES", help="Programs that are to read it: mftyre,simscape,..."
)
def check(file: Path, targets: str) -> None:
    """Check a .tir: units, missing and unknown keys, physics over the file's own ranges."""
    import tir
    from tir.check import check as problems_of

    tyre = tir.read(file)
    problems = [*tyre.problems, *problems_of(tyre, targets.split(",") if targets else ())]
    for problem in problems:
        click.echo(f"{problem.level}: {problem.sentence}")
    errors = sum(problem.level == "error" for problem in problems)
    click.echo(f"{file}: {errors} errors, {len(problems) - errors} warnings")
    if errors:
        raise SystemExit(2)


@commands.command()
@click.argument("rig_toml", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder to write to.")
@click.option("--seed", type=int, default=None, help="Seed of noise and drawn faults [default: the file's].")
def simulate(rig_toml: Path, out: Path, seed: int | None) -> None:
    """Virtual rig: write sweeps that `build` reads, and truth.json."""
    from mffit import virtual_rig

    virtual_rig.simulate(rig_toml, out, seed=seed)
    click.echo(f"written to {out}: sweeps, tyre.toml, truth.json")


@commands.command()
@click.argument("files", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FILE...")
@click.option(
    "--out", type=click.Path(path_type=Path), help="Folder for tyre.toml, stretches.csv and pictures."
)
def sniff(files: tuple[Path, ...], out: Path | None) -> None:
    """What recordings hold: channels, units, axes, conditions, stretches, and the tyre.toml for them."""
    from mffit import pipeline, recordings
    from mffit.report import text

    found = recordings.sniff(files)
    click.echo(text.sniff_summary(found))
    if out is None:
        folder = Path()
        click.echo(
            "\n" + recordings.project_text(found, folder, unloaded_radius=None, nominal_load=None), nl=False
        )
        return
    for path in pipeline.write_sniffed(found, out):
        click.echo(f"written {path}")


@commands.command()
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="[FILE...] DIR")
@click.option("--from", "recorded", is_flag=True, help="From the recordings FILE... before DIR.")
@click.option("--unloaded-radius", type=float, metavar="M", help="With --from: of the tyre, in metres.")
@click.option("--nominal-load", type=float, metavar="N", help="With --from: FNOMIN, in newtons.")
@click.option("--nominal-pressure", type=float, metavar="KPA", help="With --from [default: as most was run].")
@click.option("--name", help="With --from: of the output files [default: the first recording's].")
def init(paths: tuple[Path, ...], recorded: bool, name: str | None, **tyre: float | None) -> None:
    """Write a commented tyre.toml and empty CSV templates, or with --from a project for recordings."""
    from mffit.errors import InputError
    from mffit.init_project import init_project

    *files, folder = paths
    if recorded:
        from mffit import pipeline
        from mffit.report import text

        if not files:
            raise InputError("--from needs recordings before the folder: mffit init --from FILE... DIR")
        found, written = pipeline.init_from(files, folder, name=name, **tyre)
        click.echo(text.sniff_summary(found))
    elif files:
        raise InputError(
            f"one folder only; recordings go behind --from: mffit init --from {files[0]} {folder}"
        )
    else:
        written = init_project(folder)
    for path in written:
        click.echo(f"written {path}")


def warn(warnings) -> None:
    """Warnings go to stderr, one line each."""
    for sentence in warnings:
        click.echo(f"warning: {sentence}", err=True)


def progress():
    """A spinner with the running step on a terminal; silence elsewhere."""
    from contextlib import contextmanager

    @contextmanager
    def shown():
        from rich.console import Console

        console = Console(stderr=True)
        if not console.is_terminal:
            yield lambda sentence: None
            return
        with console.status("starting") as status:
            yield lambda sentence: status.update(sentence)

    return shown()


class Unheard:
    """A stream that goes on in silence when its reader leaves (``mffit ... | head -1``): no failure of the command."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        try:
            return self._stream.write(text)
        except BrokenPipeError:
            self._give_up()
            return len(text)

    def flush(self) -> None:
        try:
            self._stream.flush()
        except BrokenPipeError:
            self._give_up()

    def _give_up(self) -> None:
        """Send the rest, also what Python flushes at its end, nowhere."""
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self._stream.fileno())
        os.close(nowhere)


def main(arguments: list[str] | None = None) -> None:
    """Entry point: exit 0 done, 2 bad input or usage with one sentence, 1 a bug."""
    with redirect_stdout(Unheard(sys.stdout)), redirect_stderr(Unheard(sys.stderr)):
        _run(arguments)


def _run(arguments: list[str] | None) -> None:
    from mffit.errors import InputError
    from tir.errors import TirError

    try:
        commands.main(arguments, standalone_mode=False)
    except (InputError, TirError) as error:
        click.echo(f"mffit: {error}", err=True)
        sys.exit(2)
    except click.ClickException as error:
        error.show()
        sys.exit(2)
    except (click.Abort, KeyboardInterrupt):
        click.echo("mffit: interrupted; nothing was written", err=True)
        sys.exit(130)


if __name__ == "__main__":
    main()
