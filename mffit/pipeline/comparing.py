"""``mffit compare``: two files, a file and data, or two builds."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import tir
from mffit import as_json, fleet, prediction
from mffit import config as configuration
from mffit.comparison import ComparedSubject, Comparison, against_points, between, wording
from mffit.comparison.of_rig import declared_errors, explained_by_rig
from mffit.config import Config, declared_faults
from mffit.errors import InputError
from mffit.fit.plan import channels_of
from mffit.fleet import Specimen
from mffit.measured import LoadResult
from mffit.output import output_folder
from mffit.pipeline.inputs import inputs_of, read_base, read_points
from mffit.pipeline.measuring import measure, without_play
from mffit.pipeline.provenance import (
    fitted_to,
    missed_by_file,
    posterior_of,
    terms_beside,
    use_of,
)
from mffit.points import Points
from mffit.progress import READING, Progress, silent
from mffit.rig import Simulation
from mffit.rig_errors import NO_FAULTS
from mffit.viewer.named import tell_apart


def compare(
    first: str | Path,
    second: str | Path,
    *,
    turn_slip: bool | None = None,
    given: Mapping[str, float] = MappingProxyType({}),
    out: str | Path | None = None,
    progress: Progress = silent,
) -> Comparison:
    """Compare two property files, a file and measured points, or two builds.

    Parameters
    ----------
    first, second : property file, folder of a build, or (one of the two) a ``tyre.toml`` with its sweeps
    turn_slip : evaluate both files with turn slip on, or off; default as each file is intended
    given : values [SI] of keys that a file lacks, such as UNLOADED_RADIUS
    out : folder to write to; nothing is written if None
    progress : called with a sentence before each step

    Returns
    -------
    Comparison
        Numbers, curves and coefficients, with the differences ranked; with uncertainties if a build's ``information.json`` is
        next to the file.

    Raises
    ------
    InputError, tir.errors.TirError
        A file cannot be read, or both sides are data.
    """
    paths = [Path(first), Path(second)]
    data = [path for path in paths if path.suffix.lower() == ".toml"]
    files = [path for path in paths if path not in data]
    if not files:
        raise InputError(
            f"{paths[0]} and {paths[1]} are both measured data; build each, then compare the two folders"
        )
    if data:
        config = configuration.load(data[0])
        progress(READING)
        found = _with_data(_subject(files[0], given), config)
        files += inputs_of(config)
    else:
        progress("comparing")
        found = between(*_sides(paths, given, turn_slip))
    if out is not None:
        progress("writing the page")
        write_comparison(found, Path(out), read=files)
    return found


def write_comparison(found: Comparison, out: Path, read: Sequence[Path]) -> None:
    """Write every output of a comparison, or nothing; the files that were ``read`` are not replaced."""
    from mffit import report

    with output_folder(out, by="compare", protected=[path for path in read if path.is_file()]) as folder:
        as_json.write(folder / "compare.json", found)
        report.write_comparison(found, folder)


def _subject(path: Path, given: Mapping[str, float]) -> ComparedSubject:
    """A property file, or that of a build's folder, with its covariance if its build is next to it."""
    build = None
    if path.is_dir():
        build = _build_in(path)
        path = build.folder / build.file
    else:
        with suppress(InputError):
            build = fleet.read(path.parent)
    tyre = tir.read(path, **given)
    use = use_of(tyre)
    subject = ComparedSubject(path.name, tyre, tyre.turn_slip if use is None else use == "turn-slip")
    posterior = posterior_of(tyre, path)
    if posterior is None:
        return subject
    known = None if build is None else build.numbers
    subject = replace(subject, known=known, build=build, missed=missed_by_file(tyre, path))
    try:
        foretold, _, fitted = prediction.load(path.parent)
    except InputError:  # of an earlier version
        return subject
    return replace(subject, foretold=(foretold, fitted))


def _build_in(folder: Path) -> Specimen:
    """The build of a folder."""
    try:
        return fleet.read(folder)
    except InputError:
        raise InputError(
            f"{folder} is not the folder of a build: it has no result.json that names a property file; give the .tir itself"
        ) from None


def _sides(
    paths: Sequence[Path], given: Mapping[str, float], turn_slip: bool | None
) -> list[ComparedSubject]:
    """Both subjects; equal names get as much of their paths as makes them differ."""
    sides = [_subject(path, given) for path in paths]
    files = [path / side.name if path.is_dir() else path for path, side in zip(paths, sides, strict=True)]
    return [
        replace(
            side,
            name=f"{name}{file.suffix}",
            turn_slip=side.turn_slip if turn_slip is None else turn_slip,
        )
        for side, name, file in zip(sides, tell_apart(files), files, strict=True)
    ]


def _with_data(subject: ComparedSubject, config: Config) -> Comparison:
    """The file against the sweeps, simulated with the declared rig and the settings of [model]."""
    points = read_points(config).points
    base = read_base(config)
    turn_slip = config.model.turn_slip and config.rig.on_disc
    beside = terms_beside(subject.tyre)
    faults = declared_faults(config.rig).replace(**beside)
    simulation = Simulation.of(subject.tyre, faults, turn_slip=turn_slip, star=config.model.star)
    if config.rig.radius is not None:
        simulation = replace(simulation, radius_m=config.rig.radius)
    perfect = NO_FAULTS.replace(**beside)
    faultless = replace(simulation, faults=perfect).readings(points)

    def direct(declared: Config, rows: Points) -> tuple[LoadResult, ...]:
        try:
            return measure(declared, rows, base)[1].per_load
        except InputError:  # a simulation without turn slip has no turn-slip force to measure
            return ()

    measured = direct(config, points)
    of_file = direct(without_play(config), points.replace(Fy=faultless.Fy, Mz=faultless.Mz))
    name = config.path.name if config.path is not None else config.tyre.name
    declared = declared_errors(config, points.used_setups, channels_of(points))
    found = against_points(subject, simulation, points, measured, of_file, name)
    own = subject.known is not None and fitted_to(subject.tyre, config)
    by_rig = explained_by_rig(points, simulation, declared, subject.missed)
    notes = (*found.notes, *wording.notes_on_rig(by_rig))
    if beside:
        notes += (wording.note_on_conditions(subject.name, beside),)
    return replace(found, by_rig=by_rig, fitted=own, notes=notes)
