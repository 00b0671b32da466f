"""Arguments and options that several commands share, each in one place."""

from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any, TypeVar

import click

Command = TypeVar("Command", bound=Callable[..., Any])
PATH = click.Path(path_type=Path)


def _as_given(context: click.Context, option: click.Parameter, value: float | None) -> dict[str, float]:
    return {} if value is None else {"UNLOADED_RADIUS": value}


def _unloaded_radius(*names: str, **settings: Any) -> Callable[[Command], Command]:
    wanted = "Of the tyre, in metres, if the files lack it."
    return click.option("--unloaded-radius", *names, type=float, metavar="M", help=wanted, **settings)


tyre_toml = click.argument("tyre_toml", type=PATH)
tir_file = click.argument("file", type=PATH, metavar="FILE.tir")
path_centre = click.option(
    "--path-centre",
    type=click.Choice(["left", "right"]),
    help="Side of the disc's centre, rolling forwards, where no tyre.toml states it.",
)


unloaded_radius = _unloaded_radius()
given = _unloaded_radius("given", callback=_as_given)
"""The same option, as values of keys by which :func:`tir.read` completes a property file."""


def _headings(context: click.Context, option: click.Parameter, given: tuple[str, ...]) -> dict[str, str]:
    from mffit.errors import InputError

    parts = [one.partition("=") for one in given]
    if wrong := [one for one, (name, _, heading) in zip(given, parts, strict=True) if not (name and heading)]:
        raise InputError(f'"{wrong[0]}" is not a channel with its heading; write p_kPa=Druck', key="--column")
    return {name.strip(): heading.strip() for name, _, heading in parts}


column = click.option(
    "--column",
    "headings",
    multiple=True,
    metavar="CHANNEL=HEADING",
    callback=_headings,
    help="Heading of a channel, if it is not recognised, such as p_kPa=Druck; may be repeated.",
)
strict = click.option(
    "--strict", is_flag=True, help="Exit code 3 also if the result is only in doubt, for automatic runs."
)
transient = click.option(
    "--transient",
    is_flag=True,
    help="With the lag of the contact, from slip speeds; an FMU then co-simulates only.",
)
turn_slip_option = click.option(
    "--turn-slip/--no-turn-slip",
    default=None,
    help="Turn slip on or off [default: as the file's USE_MODE says].",
)


def out_option(
    help_text: str,
    *,
    beside: str = "",
    is_file: bool = False,
    of_files: Collection[str] = (),
    **settings: Any,
) -> Callable[[Command], Command]:
    """The option ``--out`` with the path of a folder, or of a file; one that cannot be written is refused before any work.

    ``beside`` is the default, relative to the folder of TYRE_TOML; names that end as those ``of_files`` are refused, because
    they would become folders.
    """

    def usable(context: click.Context, option: click.Parameter, out: Path | None) -> Path | None:
        from mffit.errors import InputError
        from mffit.output import refuse_unusable

        if context.resilient_parsing:
            return out
        if out is not None and out.suffix.lower() in of_files:
            name = f" --name {out.stem}" * any(one.name == "name" for one in context.command.params)
            raise InputError(
                f"is the name of a file, but --out names the folder: write --out {out.parent}{name}",
                key=f"--out {out}",
            )
        if out is not None:
            refuse_unusable(out, is_file=is_file)
        elif beside:
            return Path(context.params["tyre_toml"].parent, beside)
        return out

    if beside:
        help_text += f" [default: {beside}/ beside TYRE_TOML]."
    return click.option("--out", type=PATH, help=help_text, callback=usable, **settings)


EXPORTED = (".c", ".h", ".fmu", ".m", ".tir", ".csv", ".mat")
export_folder = out_option("Folder to write to.", of_files=EXPORTED, default="export", show_default=True)


def code_options(command: Command) -> Command:
    """The arguments and options of all exports to code, by the names that the functions of :mod:`mffit.export` have for them."""
    name = click.option("--name", help="Name in the code [default: made from the file's name].")
    limits = click.option("--limits", is_flag=True, help="Limit the inputs to the ranges of the file.")
    for option in (limits, turn_slip_option, name, export_folder, tir_file):
        command = option(command)
    return command


def names_of_programs(help_text: str, **settings: Any) -> Callable[[Command], Command]:
    """The option ``--for``: names of programs with commas between them."""

    def listed(context: click.Context, option: click.Parameter, text: str) -> list[str]:
        return list(dict.fromkeys(name.strip() for name in text.split(",") if name.strip()))

    return click.option("--for", "targets", metavar="NAMES", help=help_text, callback=listed, **settings)
