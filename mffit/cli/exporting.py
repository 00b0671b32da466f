"""`mffit export`: a property file as code, FMU or the file of another program, or a project's points as TYDEX."""

from __future__ import annotations

from pathlib import Path

import click

from mffit.cli.console import Voice, told, voiced
from mffit.cli.options import code_options, out_option, tir_file, transient, turn_slip_option, tyre_toml
from mffit.errors import InputError


def _folder(out: Path, ending: str, *, named: bool = True) -> Path:
    """The folder to write to; refuses the name of a file, which would become a folder of that name.

    ``named``: whether the command has ``--name``.
    """
    if out.suffix.lower() == ending:
        name = f" --name {out.stem}" if named else ""
        raise InputError(
            f"is the name of a file, but --out names the folder: write --out {out.parent}{name}",
            key=f"--out {out}",
        )
    return out


def _report(voice: Voice, written: list[Path], file: Path, turn_slip: bool | None, **more: object) -> None:
    import tir
    from tir.mode import words

    names = [str(path) for path in written]
    tyre = tir.read(file)
    on = tyre.turn_slip if turn_slip is None else turn_slip
    why = f"the file's USE_MODE is {tyre['USE_MODE']:g}" if turn_slip is None else "as asked for"
    voice.say(f"written with {words(on)} ({why}): {', '.join(names)}")
    voice.give({"written": names, "turn_slip": on, **more})


@click.group()
def export() -> None:
    """Export a property file as C code, FMU, MATLAB functions or for another program, or points as TYDEX."""


@export.command()
@code_options
@transient
@click.option(
    "--tunable", is_flag=True, help="Also functions with scaling factors and temperature as arguments."
)
@voiced
def c(
    file: Path,
    out: Path,
    name: str | None,
    turn_slip: bool | None,
    limits: bool,
    transient: bool,
    tunable: bool,
    voice: Voice,
) -> None:
    """Export a property file as C99 code.

    Writes one header and one source in double precision, without memory allocation or state.
    """
    from mffit.export import write_c

    with told(voice):
        written = write_c(
            file,
            _folder(out, ".c"),
            name=name,
            turn_slip=turn_slip,
            limits=limits,
            tunable=tunable,
            transient=transient,
        )
    _report(voice, written, file, turn_slip)


@export.command()
@code_options
@transient
@click.option(
    "--fmi",
    type=click.Choice(["2", "3"]),
    default="2",
    show_default=True,
    help="Version of the standard: FMI 2.0 or 3.0.",
)
@click.option(
    "--sources-only",
    is_flag=True,
    help="Without a binary: the importing program compiles the sources (Simulink: fmudialog.compileFMUSources).",
)
@voiced
def fmu(
    file: Path,
    out: Path,
    name: str | None,
    turn_slip: bool | None,
    limits: bool,
    fmi: str,
    transient: bool,
    sources_only: bool,
    voice: Voice,
) -> None:
    """Export a property file as an FMU (functional mock-up unit).

    For model exchange and co-simulation, with C sources and a binary for this machine.
    """
    from mffit.export import write_fmu

    with told(voice):
        written = write_fmu(
            file,
            _folder(out, ".fmu"),
            fmi=int(fmi),
            name=name,
            turn_slip=turn_slip,
            limits=limits,
            transient=transient,
            sources_only=sources_only,
        )
    _report(voice, [written], file, turn_slip)


@export.command()
@code_options
@voiced
def matlab(
    file: Path, out: Path, name: str | None, turn_slip: bool | None, limits: bool, voice: Voice
) -> None:
    """Export a property file as MATLAB functions of arrays.

    Writes NAME.m, and NAME_mfeval.m with the columns of MFeval. Scaling factors are arguments. Octave runs them too.
    """
    from mffit.export import write_matlab

    with told(voice):
        written = write_matlab(file, _folder(out, ".m"), name=name, turn_slip=turn_slip, limits=limits)
    _report(voice, written, file, turn_slip)


@export.command("tir")
@tir_file
@click.option(
    "--for", "targets", required=True, metavar="NAMES", help="Programs to write it for: mfeval,simscape,..."
)
@out_option("Folder to write to.", default="export", show_default=True)
@voiced
def property_file(file: Path, targets: str, out: Path, voice: Voice) -> None:
    """Export a property file for other programs.

    Writes one complete file for each, FILE-NAME.tir, with the keys, order and line ends that the program needs. Numbers stay.
    """
    import tir
    from mffit.output import output_folder
    from tir.consumers import target_problems
    from tir.document import parse_document
    from tir.errors import counted, some
    from tir.parameters import TABLE
    from tir.targets import TARGETS
    from tir.tyre import interpret

    names = list(filter(None, (name.strip() for name in targets.split(","))))
    if not names:
        raise InputError("names no program: write, for example, --for mfeval,simscape", key="--for")
    tyre = tir.read(file)
    made = {name: interpret(parse_document(tyre.text(name))) for name in names}
    found = [problem.sentence for name in made for problem in target_problems(made[name], TARGETS[name])]
    lacking = {key for other in made.values() for key in other.present} - tyre.present
    shown = [row.name for row in TABLE if row.name in lacking]
    with output_folder(_folder(out, ".tir", named=False), by="export", protected=[file]) as folder:
        for name in names:
            tyre.write(folder / f"{file.stem}-{name}.tir", target=name)
    written = [str(out / f"{file.stem}-{name}.tir") for name in names]
    voice.warn(found)
    voice.say(f"written: {', '.join(written)}")
    if shown:
        voice.say(
            f"{counted(len(shown), 'key')} that {file} lacks got the default, marked as not measured: {some(shown)}"
        )
    voice.give({"written": written, "defaults": shown})


@export.command()
@tir_file
@click.option(
    "--for",
    "form",
    required=True,
    type=click.Choice(["csv", "mat"]),
    help="Form: CSV or MATLAB.",
)
@out_option("Folder to write to.", default="export", show_default=True)
@turn_slip_option
@click.option(
    "--range",
    "ranges",
    multiple=True,
    metavar="NAME=LOW:HIGH",
    help="Narrower range of Fz_N, alpha_deg, gamma_deg or kappa; may be repeated.",
)
@click.option("--error", type=float, default=0.5, show_default=True, metavar="PERCENT", help="Largest error.")
@voiced
def table(
    file: Path,
    form: str,
    out: Path,
    turn_slip: bool | None,
    ranges: tuple[str, ...],
    error: float,
    voice: Voice,
) -> None:
    """Export a property file as lookup tables.

    Linear interpolation between their nodes misses the tyre by less than 0.5 % of the largest force.
    """
    from mffit.export import write_table

    with told(voice), voice.progress() as progress:
        made = write_table(
            file,
            _folder(out, f".{form}", named=False),
            form=form,
            turn_slip=turn_slip,
            error=error / 100.0,
            ranges=dict(map(_range, ranges)),
            progress=progress,
        )
    voice.warn(made.warnings)
    for one in made.tables:
        voice.say(one.sentence)
    _report(voice, made.written, file, turn_slip, tables=[one.keys() for one in made.tables])


def _range(text: str) -> tuple[str, tuple[float, float]]:
    name, _, ends = text.partition("=")
    try:
        low, high = map(float, ends.split(":"))
    except ValueError:
        raise InputError(
            "is not NAME=LOW:HIGH; write, for example, --range alpha_deg=-12:12", key=f"--range {text}"
        ) from None
    return name, (low, high)


@export.command()
@tyre_toml
@out_option("Folder to write to [default: out/tydex/ beside TYRE_TOML].")
@voiced
def tydex(tyre_toml: Path, out: Path | None, voice: Voice) -> None:
    """Export the points of a project as TYDEX 1.3, one file per sweep."""
    from mffit import pipeline

    written = pipeline.write_tydex(tyre_toml, out or tyre_toml.parent / "out" / "tydex")
    names = [str(path) for path in written]
    voice.say(f"written: {', '.join(names)}")
    voice.give({"written": names})
