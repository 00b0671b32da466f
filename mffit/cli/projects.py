"""`mffit sniff`, `init` and `simulate`: content of recordings, a project to start from, and sweeps of a virtual rig."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mffit.cli.console import Voice, voiced
from mffit.cli.options import PATH, column, out_option, path_centre, unloaded_radius
from mffit.errors import InputError

if TYPE_CHECKING:
    from mffit.recordings import DiscPath


@click.command()
@click.argument("files", nargs=-1, required=True, type=PATH, metavar="FILE...")
@column
@voiced
def sniff(files: tuple[Path, ...], headings: dict[str, str], voice: Voice) -> None:
    """Show the content of recordings.

    Prints channels, units, axes, conditions and stretches, and a tyre.toml for the recordings.
    """
    from mffit import recordings
    from mffit.report import text

    with voice.progress() as show:
        show("reading recordings")
        found = recordings.sniff(files, headings=headings)
    voice.answer(found, text.sniff_summary(found))
    voice.say("\n" + recordings.project_text(found, Path()), end="")


@click.command()
@click.argument("paths", nargs=-1, required=True, type=PATH, metavar="[FILE...] DIR")
@click.option("--from", "recorded", is_flag=True, help="From the recordings FILE... before DIR.")
@click.option(
    "--sample",
    metavar="S",
    help="A copy of a sample: flat-track, flat-track-combined, front-120-70 or rear-190-55.",
)
@unloaded_radius
@click.option(
    "--nominal-load", type=float, metavar="N", help="With --from: FNOMIN, in newtons, if the files lack it."
)
@click.option(
    "--nominal-pressure",
    type=float,
    metavar="KPA",
    help="With --from [default: NOMPRES of the files, else as most was run].",
)
@click.option("--disc", is_flag=True, help="With --from: the path was that of a disc.")
@click.option("--path-radius", type=float, metavar="M", help="With --disc: radius of the path, in metres.")
@path_centre
@click.option(
    "--belt", is_flag=True, help="With --from: the path was straight, whatever the recordings look like."
)
@click.option(
    "--name",
    help="With --from: of the output files [default: the folder's, or the recording's if it lies there].",
)
@column
@voiced
def init(paths: tuple[Path, ...], recorded: bool, sample: str | None, voice: Voice, **asked: Any) -> None:
    """Write a commented tyre.toml and empty CSV templates, with --from a project for recordings, or a sample."""
    from mffit.init_project import copy_sample, init_project, to_fill_in
    from mffit.report import text

    *files, folder = paths
    if recorded and sample is not None:
        raise InputError("--from and --sample exclude each other; give one of them")
    if recorded:
        written = _init_from(files, folder, voice, **asked)
    elif files:
        raise InputError(
            f"one folder only; recordings go behind --from: mffit init --from {files[0]} {folder}"
        )
    else:
        written = init_project(folder) if sample is None else copy_sample(sample, folder)
    lines = [f"written {path}" for path in written]
    build = shlex.join(["mffit", "build", str(written[0])])
    if recorded or sample is not None:
        lines += ["", text.steps([(build, "fits the property file")])]
    else:
        keys = ", ".join(to_fill_in())
        lines += ["", f"Fill in {keys} in {written[0]} and the empty tables; then run {build}"]
    voice.answer({"written": [str(path) for path in written]}, "\n".join(lines))


def _init_from(
    files: list[Path], folder: Path, voice: Voice, *, disc: bool, path_radius: float | None, **asked: Any
) -> list[Path]:
    """Write a project for recordings with what was ``asked`` for; returns the files."""
    from mffit import pipeline
    from mffit.report import text

    if not files:
        raise InputError("--from needs recordings before the folder: mffit init --from FILE... DIR")
    if folder.is_file():
        rest = " ".join(map(str, (folder, *files[1:], files[0])))
        raise InputError(f"the folder comes last, behind the recordings: mffit init --from {rest}")
    with voice.progress() as show:
        show("reading recordings")
        path = _disc(disc, path_radius, asked.pop("path_centre"), asked["belt"])
        found, written = pipeline.init_from(files, folder, disc=path, **asked)
    voice.say(text.sniff_summary(found))
    return written


def _disc(disc: bool, radius: float | None, centre: str | None, belt: bool) -> DiscPath | None:
    """The path of a disc from the options; None without one."""
    from mffit.recordings import DiscPath

    if not disc and radius is None and centre is None:
        return None
    if belt:
        raise InputError("--disc and --belt exclude each other; give one of them")
    if radius is None or centre is None:
        raise InputError("a disc needs --path-radius M and --path-centre left|right")
    return DiscPath(radius, centre)


@click.command()
@click.argument("rig_toml", type=PATH)
@out_option("Folder to write to.", required=True)
@click.option(
    "--seed", type=int, default=None, help="Seed of noise and drawn rig errors [default: that of the file]."
)
@voiced
def simulate(rig_toml: Path, out: Path, seed: int | None, voice: Voice) -> None:
    """Simulate the sweeps of a virtual rig.

    Writes sweeps and a tyre.toml that `mffit build` reads, and the true values in truth.json.
    """
    from mffit import virtual_rig

    with voice.progress() as show:
        show("simulating")
        truth = virtual_rig.simulate(rig_toml, out, seed=seed)
    voice.answer(truth.to_json(), f"written to {out}: sweeps, tyre.toml, truth.json")
