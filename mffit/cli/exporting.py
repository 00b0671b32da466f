"""`mffit export`: a property file as code, FMU or the file of another program, or a project's points as TYDEX."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from mffit.cli.console import Voice, told, voiced
from mffit.cli.options import (
    code_options,
    export_folder,
    names_of_programs,
    out_option,
    tir_file,
    transient,
    turn_slip_option,
    tyre_toml,
)
from mffit.errors import InputError


def _report(voice: Voice, written: list[Path], file: Path, turn_slip: bool | None, **more: object) -> None:
    import tir
    from tir.mode import words

    names = [str(path) for path in written]
    tyre = tir.read(file)
    voice.warn_of(file, tyre)
    switches = tyre.switches(turn_slip=turn_slip)
    why = f"the file's USE_MODE is {tyre['USE_MODE']:g}" if turn_slip is None else "as asked for"
    voice.say(f"written with {words(switches)} ({why}): {', '.join(names)}")
    voice.give({"written": names, "turn_slip": switches.turn_slip, **more})


def _code(write: Callable[..., Any], file: Path, out: Path, voice: Voice, **asked: Any) -> None:
    """Write code by a function of :mod:`mffit.export`, with the options that were ``asked`` for, and say so."""
    with told(voice):
        written = write(file, out, **asked)
    _report(voice, written if isinstance(written, list) else [written], file, asked["turn_slip"])


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
def c(**asked: Any) -> None:
    """Export a property file as C99 code.

    Writes one header and one source in double precision, without memory allocation or state.
    """
    from mffit.export import write_c

    _code(write_c, **asked)


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
def fmu(fmi: str, **asked: Any) -> None:
    """Export a property file as an FMU (functional mock-up unit).

    For model exchange and co-simulation, with C sources and a binary for this machine.
    """
    from mffit.export import write_fmu

    _code(write_fmu, fmi=int(fmi), **asked)


@export.command()
@code_options
@voiced
def matlab(**asked: Any) -> None:
    """Export a property file as MATLAB functions of arrays.

    Writes NAME.m, and NAME_mfeval.m with the columns of MFeval. Scaling factors are arguments. Octave runs them too.
    """
    from mffit.export import write_matlab

    _code(write_matlab, **asked)


@export.command("tir")
@tir_file
@names_of_programs("Programs to write it for: mfeval,simscape,...", required=True)
@export_folder
@voiced
def property_file(file: Path, targets: list[str], out: Path, voice: Voice) -> None:
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

    if not targets:
        raise InputError("names no program: write, for example, --for mfeval,simscape", key="--for")
    tyre = tir.read(file)
    voice.warn_of(file, tyre)
    texts = {f"{file.stem}-{name}.tir": tyre.text(name) for name in targets}
    made = [interpret(parse_document(text)) for text in texts.values()]
    lacking = {key for other in made for key in other.present} - tyre.present
    shown = [row.name for row in TABLE if row.name in lacking]
    with output_folder(out, by="export", protected=[file]) as folder:
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="ascii", newline="")
    written = [str(out / name) for name in texts]
    for other, name in zip(made, targets, strict=True):
        voice.warn(problem.sentence for problem in target_problems(other, TARGETS[name]))
    voice.say(f"written: {', '.join(written)}")
    if shown:
        voice.say(
            f"{counted(len(shown), 'key')} that {file} lacks got the default, marked as not measured: {some(shown)}"
        )
    voice.give({"written": written, "defaults": shown})


def _ranges(
    context: click.Context, option: click.Parameter, given: tuple[str, ...]
) -> dict[str, tuple[float, float]]:
    found = {}
    for text in given:
        name, _, ends = text.partition("=")
        try:
            low, high = map(float, ends.split(":"))
        except ValueError:
            raise InputError(
                "is not NAME=LOW:HIGH; write, for example, --range alpha_deg=-12:12", key=f"--range {text}"
            ) from None
        found[name] = low, high
    return found


@export.command()
@tir_file
@click.option(
    "--for",
    "form",
    required=True,
    type=click.Choice(["csv", "mat"]),
    help="Form: CSV or MATLAB.",
)
@export_folder
@turn_slip_option
@click.option(
    "--range",
    "ranges",
    multiple=True,
    metavar="NAME=LOW:HIGH",
    callback=_ranges,
    help="Narrower range of Fz_N, alpha_deg, gamma_deg or kappa; may be repeated.",
)
@click.option("--error", type=float, default=0.5, show_default=True, metavar="PERCENT", help="Largest error.")
@voiced
def table(file: Path, out: Path, error: float, voice: Voice, **asked: Any) -> None:
    """Export a property file as lookup tables.

    Linear interpolation between their nodes misses the tyre by less than 0.5 % of the largest force.
    """
    from mffit.export import write_table

    with told(voice), voice.progress() as progress:
        made = write_table(file, out, error=error / 100.0, progress=progress, **asked)
    voice.warn(made.warnings)
    for one in made.tables:
        voice.say(one.sentence)
    _report(voice, made.written, file, asked["turn_slip"], tables=[one.keys() for one in made.tables])


@export.command()
@tyre_toml
@out_option("Folder to write to", beside="out/tydex")
@voiced
def tydex(tyre_toml: Path, out: Path, voice: Voice) -> None:
    """Export the points of a project as TYDEX 1.3, one file per sweep."""
    from mffit import pipeline

    names = [str(path) for path in pipeline.write_tydex(tyre_toml, out)]
    voice.answer({"written": names}, f"written: {', '.join(names)}")
