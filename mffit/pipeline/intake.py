"""From recordings to a project: ``mffit sniff`` and ``mffit init --from``."""

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from mffit import config as configuration
from mffit.config import Config, SweepTable
from mffit.config.loading import STAND_IN, checked
from mffit.config.toml_file import toml_text
from mffit.csv_tables import csv_text
from mffit.errors import InputError
from mffit.output import must_be_new, new_files
from mffit.pipeline.inputs import input_names
from mffit.points.loading import read
from mffit.points.stretch import stretch_table
from mffit.recordings import Sniffed, Stated, disc_signs, project_text, sniff
from mffit.recordings.disc import files_of_folder
from mffit.recordings.guess import NOTHING_NAMED
from mffit.recordings.project_file import how_to_agree, load_beyond, relative, slug, sweeps_text, tyre_found
from mffit.recordings.recording import rolls_backward
from mffit.recordings.sniffed import configuration_of, holding, stated_of_tyre
from mffit.suspicion import before_the_fit, under_axes
from mffit.sweeps import formats

STRETCHES = "stretches.csv"


@formats.reading_once()
def init_from(
    files: Sequence[str | Path],
    folder: str | Path,
    *,
    headings: Mapping[str, str] = NOTHING_NAMED,
    **known: Any,
) -> tuple[Sniffed, list[Path]]:
    """Write a project from recordings: ``tyre.toml``, ``stretches.csv`` and a picture of each recording.

    Parameters
    ----------
    files : recordings as the rig wrote them, or patterns; they are not moved
    folder : created if necessary; existing files are never replaced
    headings : headings that are not recognised, by channel, such as ``{"p_kPa": "Druck"}``
    known : fields of :class:`mffit.recordings.Stated`, such as ``nominal_load``; the recordings state the others

    Returns
    -------
    sniffed, list of Path
        What the recordings hold, and the files written, ``tyre.toml`` first.

    Raises
    ------
    InputError
        A recording cannot be read, radius, load or pressure is missing, the configuration refuses a value, a file exists
        already, no axes fit, or the recordings look like those of a disc and neither ``disc`` nor ``belt`` is given, or they
        contradict the stated disc.
    """
    folder, stated = Path(folder), Stated(**known)
    with _as_options():
        _check_keys(stated)
        sniffed = sniff(files, unloaded_radius=stated.unloaded_radius, headings=headings)
        stated = _with_those_of_files(stated, sniffed, folder)
        sniffed, text = _as_a_build_reads(_checked(sniffed, stated), folder, stated)
    return sniffed, written_project(folder, sniffed, text)


def project_of(sniffed: Sniffed, folder: Path, stated: Stated) -> tuple[Sniffed, str]:
    """The text of the ``tyre.toml`` for recordings, and what they hold with the doubts that the statements raise.

    Raises InputError if the pressure is unknown, no axes fit, or the recordings look like those of a disc and nothing is stated
    about the path.
    """
    sniffed = _checked(sniffed, stated)
    return sniffed, project_text(sniffed, folder, stated)


def unlisted(config: Config) -> Iterator[Path]:
    """Recordings that ``tyre.toml`` does not name, in its folder and in those within it that hold sweeps."""
    folder = config.folder
    named = {(folder / name).resolve() for name in input_names(config)}
    of_sweeps = ((folder / sweep.file).parent for sweep in config.sweep)
    within = (path for path in of_sweeps if path.resolve().is_relative_to(folder.resolve()))
    for place in dict.fromkeys([folder, *within]):
        for path in files_of_folder(place) if place.is_dir() else ():
            if path.resolve() not in named and path.name != STRETCHES:
                yield path


def entry_of(path: Path, config: Config) -> SweepTable:
    """The [[sweep]] of a recording that ``tyre.toml`` does not list: as a listed one with these headings, else as recognised.

    Raises InputError if it cannot be read or is not recognised.
    """
    raw = formats.read(path)
    for known in (one for one in config.sweep if one.columns):
        with suppress(InputError):  # it is missing yet, or still being written
            other = formats.read(config.folder / known.file)
            if (raw.headings, raw.units) == (other.headings, other.units):
                entry = SweepTable(file=relative(path, config.folder), columns=known.columns)
                return entry.model_copy(update={"direction": "backward"}) if rolls_backward(path) else entry
    found = sniff([path], unloaded_radius=config.tyre.unloaded_radius, columns=config.columns)
    text = sweeps_text(found, config.folder, config.columns)
    return SweepTable.model_validate(tomllib.loads(text)["sweep"][0])


def sweep_text(entry: SweepTable) -> str:
    """The [[sweep]] as ``tyre.toml`` writes it."""
    return toml_text({"sweep": [entry.model_dump(mode="json", exclude_defaults=True)]}).strip()


def _as_a_build_reads(sniffed: Sniffed, folder: Path, stated: Stated) -> tuple[Sniffed, str]:
    """The recordings and the text of the ``tyre.toml``, under the first axes that fit and that a build does not refuse.

    Raises InputError if the recordings contradict the stated disc; another reason for which a build refuses them is a warning.
    """
    refusals = []
    for axes in sniffed.axes if stated.axes is None else (stated.axes,):
        ordered = tuple(sorted(sniffed.axes, key=lambda one: one != axes))
        found = replace(sniffed, axes=ordered)
        belt = stated.disc is None and not disc_signs(sniffed)
        refusal = _refusal_of_a_build(found, stated, sniffed.axes[0] if belt and sniffed.axes else "")
        if refusal is None:
            return found, project_text(found, folder, stated)
        refusals.append(refusal)
    first = refusals[0]
    if stated.disc is not None and first.key in ("rig.axes", "rig.path_centre", "rig.force_frame"):
        raise InputError(first.sentence, key="rig.path_centre")
    found = _with_warning(sniffed, f"mffit build refuses these recordings: {first}")
    return found, project_text(sniffed, folder, stated)


def _refusal_of_a_build(sniffed: Sniffed, stated: Stated, read_under: str) -> InputError | None:
    """Why a build refuses the points of the ``tyre.toml``; None if it takes them.

    ``read_under`` are the axes of the points; "" if a build reads others, as it does on a disc.
    """
    here = Path()  # the project's folder may not exist yet
    try:
        config = checked(tomllib.loads(project_text(sniffed, here, stated)), path=None, folder=here, lines={})
        points = sniffed.points
        if read_under and len(points):
            points = under_axes(points, read_under, config.rig.axes)
            pressed = [file in holding(sniffed.recordings, "p_kPa") for file in points.files]
            nominal = 1e3 * config.tyre.nominal_pressure  # of the files that do not state theirs
            points = points.replace(p=np.where(np.array(pressed)[points.file], points.p, nominal))
        else:
            points = read(config).points
        before_the_fit(points, config)
    except InputError as error:
        return error
    return None


def _with_those_of_files(stated: Stated, sniffed: Sniffed, folder: Path) -> Stated:
    """What is stated, with radius and load of the tyre from the recordings where they are not.

    Raises InputError if neither states them.
    """
    found = tyre_found(sniffed, folder)
    options = {
        "unloaded_radius": ("the free radius", "--unloaded-radius M"),
        "nominal_load": ("the nominal load", "--nominal-load N"),
    }
    stated = stated._replace(**{k: getattr(found, k) for k in options if getattr(stated, k) is None})
    lacking = [asked for key, asked in options.items() if getattr(stated, key) is None]
    if lacking:
        words, given = (" and ".join(column) for column in zip(*lacking, strict=True))
        raise InputError(f"the recordings do not state {words} of the tyre: give {given}")
    return stated


def _check_keys(stated: Stated) -> None:
    """Refuse values that the configuration refuses."""
    given = {"name": "tyre", **STAND_IN}
    for key in ("name", "unloaded_radius", "nominal_load", "nominal_pressure"):
        if (value := getattr(stated, key)) is not None:
            given[key] = value
    rig: dict[str, object] = {"type": "flat-track"}
    if stated.disc is not None:
        rig = {"type": "rotating-disk", "path_radius": stated.disc.radius, "path_centre": stated.disc.centre}
    configuration.load({"tyre": given, "rig": rig, "sweep": [{"file": "any.csv"}]})


@contextmanager
def _as_options() -> Iterator[None]:
    """Within this block, errors about keys of [tyre] and [rig] name the options that state them."""
    try:
        yield
    except InputError as error:
        table, _, key = (error.key or "").partition(".")
        if table not in ("tyre", "rig"):
            raise
        raise InputError(error.sentence, file=error.file, key=f"--{key.replace('_', '-')}") from None


def _checked(sniffed: Sniffed, stated: Stated) -> Sniffed:
    """The recordings with the doubts that the statements raise, refused if no project can be made from them."""
    first = sniffed.recordings[0].path
    known = "nominal_pressure" in stated_of_tyre(sniffed) or any(
        "p_kPa" in r.guesses for r in sniffed.recordings
    )
    if stated.nominal_pressure is None and not known:
        asked = [(r.path, said) for r in sniffed.recordings for said in r.remarks if "p_kPa" in said]
        nothing = "no pressure is measured, so the nominal pressure is unknown: give"
        path, why = asked[0] if asked else (first, nothing)
        raise InputError(f"{why}{'; or give' * bool(asked)} --nominal-pressure KPA", file=path)
    if not len(sniffed.points):
        of_force = [said for r in sniffed.recordings for said in r.remarks if "known to be Fx_N" in said]
        raise InputError("; ".join([sniffed.reading.warnings[-1], *of_force[:1]]), file=first)
    if sniffed.of_two_tyres:
        raise InputError(sniffed.reading.warnings[-1])
    if not sniffed.axes and stated.axes is None:
        raise InputError(
            f"no known axes fit: in ISO signs {' and '.join(sniffed.wrong)}, which no tyre does; {how_to_agree(sniffed)}: write "
            "that into the tyre.toml of `mffit init DIR`",
            file=first,
        )
    if stated.disc is None and not stated.belt and (signs := disc_signs(sniffed)):
        raise InputError(
            f"the recordings look like those of a disc ({'; '.join(signs)}): give --disc --path-radius M --path-centre "
            "left|right, or --belt if the path was straight",
            file=first,
        )
    doubt = load_beyond(sniffed, stated.nominal_load)
    return _with_warning(sniffed, doubt) if doubt else sniffed


def _with_warning(sniffed: Sniffed, said: str) -> Sniffed:
    reading = sniffed.reading
    return replace(sniffed, reading=reading._replace(warnings=(*reading.warnings, said)))


def written_project(folder: Path, sniffed: Sniffed, text: str) -> list[Path]:
    """Write the text of :func:`project_of` and its other files; returns the paths, ``tyre.toml`` first.

    Raises InputError if one of the files is there already, or the folder cannot be written to.
    """
    names = [slug(r.path) for r in sniffed.recordings]
    # run_+4 and run_-4 have one name
    apart = [name if names.count(name) == 1 else f"{name}-{k}" for k, name in enumerate(names, 1)]
    pictures = {f"{apart[k]}.png": k for k, r in enumerate(sniffed.recordings) if r.rate > 0.0}
    contents = {"tyre.toml": text}
    if sniffed.reading.stretches:
        contents[STRETCHES] = csv_text(stretch_table(sniffed.reading.stretches))
    must_be_new(folder, pictures)
    written = new_files(folder, contents)
    for name, k in pictures.items():
        _picture(sniffed, k, folder / name)
    return [*written, *(folder / name for name in pictures)]


def _picture(sniffed: Sniffed, k: int, path: Path) -> None:
    """Write the picture of recording number ``k``."""
    from mffit import sweeps
    from mffit.report.drawing import pictures
    from mffit.report.figures.recording import recording

    axes = sniffed.axes[0] if sniffed.axes else "iso"
    runs = sweeps.load(configuration_of(sniffed.recordings[k : k + 1], axes)).sweeps
    notes = [n for n in sniffed.reading.stretches if n.file == runs[0].file]
    pictures.save(recording(runs, notes), path)
