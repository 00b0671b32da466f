"""A property file or a project's points for other programs: `mffit export c`, `fmu`, `tydex`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from mffit.cli.console import Voice, voiced


def _shared(command: Any) -> Any:
    """What both commands ask for."""
    for decorator in reversed(
        (
            click.argument("file", type=click.Path(path_type=Path), metavar="FILE.tir"),
            click.option(
                "--out",
                type=click.Path(path_type=Path),
                default="export",
                show_default=True,
                help="Folder to write to.",
            ),
            click.option("--name", default=None, help="Name in the code [default: made of the file's]."),
            click.option(
                "--turn-slip/--no-turn-slip", default=True, show_default=True, help="Whether spin acts."
            ),
            click.option("--limits", is_flag=True, help="Hold the inputs to the file's ranges."),
        )
    ):
        command = decorator(command)
    return command


def _report(voice: Voice, written: list[Path]) -> None:
    names = [str(path) for path in written]
    voice.say(f"written: {', '.join(names)}")
    voice.give(lambda: {"written": names})


@click.group()
def export() -> None:
    """A .tir as C99 sources or as an FMU (functional mock-up unit); a project's points as TYDEX."""


@export.command()
@_shared
@voiced
def c(file: Path, out: Path, name: str | None, turn_slip: bool, limits: bool, voice: Voice) -> None:
    """One header and one source of C99: no allocation, no state, doubles."""
    from mffit.export import write_c

    written = write_c(file, out, name=name, turn_slip=turn_slip, limits=limits)
    _report(voice, written)


@export.command()
@_shared
@click.option(
    "--fmi", type=click.Choice(["2", "3"]), default="2", show_default=True, help="Version: FMI 2.0 or 3.0."
)
@click.option("--sources-only", is_flag=True, help="No binary: the importing program compiles the sources.")
@voiced
def fmu(
    file: Path,
    out: Path,
    name: str | None,
    turn_slip: bool,
    limits: bool,
    fmi: str,
    sources_only: bool,
    voice: Voice,
) -> None:
    """An FMU for model exchange and co-simulation, with C sources and a binary for this machine."""
    from mffit.export import write_fmu

    written = write_fmu(
        file, out, fmi=int(fmi), name=name, turn_slip=turn_slip, limits=limits, sources_only=sources_only
    )
    _report(voice, [written])


@export.command()
@click.argument("tyre_toml", type=click.Path(path_type=Path))
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder to write to [default: out/tydex/ beside TYRE_TOML].",
)
@voiced
def tydex(tyre_toml: Path, out: Path | None, voice: Voice) -> None:
    """The points of a project as TYDEX 1.3, a file for each sweep."""
    from mffit import pipeline

    written = pipeline.write_tydex(tyre_toml, out or tyre_toml.parent / "out" / "tydex")
    _report(voice, written)
