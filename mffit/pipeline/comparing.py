"""``mffit compare``: two files, a file and data, or two builds."""

from __future__ import annotations

import json
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import tir
from mffit import config as configuration
from mffit.comparison import Comparison, Subject, against_points, between
from mffit.config import Config
from mffit.diagnosis.inexact import Inexactness
from mffit.errors import InputError
from mffit.fleet.specimen import RESOLVED
from mffit.measured import LoadResult
from mffit.output import output_folder
from mffit.pipeline.inputs import inputs_of, read_base, read_points
from mffit.pipeline.measuring import measure, without_play
from mffit.pipeline.provenance import posterior_of, use_of
from mffit.points import Points
from mffit.progress import Progress, silent
from mffit.results import as_json
from mffit.rig import NO_FAULTS, RigFaults, Simulation
from tir import Tyre

RESULT = "result.json"


def compare(
    first: str | Path,
    second: str | Path,
    *,
    turn_slip: bool | None = None,
    out: str | Path | None = None,
    progress: Progress = silent,
) -> Comparison:
    """Put two property files, a file and measured points, or two builds side by side.

    Parameters
    ----------
    first, second : property file, folder of a build, or (one of the two) a ``tyre.toml`` with its sweeps
    turn_slip : evaluate both files with turn slip on, or off; default each as it is meant
    out : folder to write to; nothing is written if None
    progress : called with a sentence before each step

    Returns
    -------
    Comparison
        Numbers, curves and coefficients, the differences ranked; with uncertainties where a build's ``result.json`` is beside
        the file.

    Raises
    ------
    InputError, tir.errors.TirError
        A file cannot be read, or both sides are data.
    """
    paths = [Path(first), Path(second)]
    data = [path.suffix.lower() == ".toml" for path in paths]
    if all(data):
        raise InputError(
            f"{paths[0]} and {paths[1]} are both measured data; build each, then compare the two folders"
        )
    read = [path for path, is_data in zip(paths, data, strict=True) if not is_data]
    if any(data):
        config = configuration.load(paths[data.index(True)])
        read += inputs_of(config)
        progress("reading sweeps")
        found = _with_data(_subject(read[0]), config)
    else:
        sides = [_subject(path) for path in paths]
        if sides[0].name == sides[1].name:
            files = [
                path / side.name if path.is_dir() else path for path, side in zip(paths, sides, strict=True)
            ]
            sides = [replace(side, name=name) for side, name in zip(sides, _apart(*files), strict=True)]
        if turn_slip is not None:
            sides = [replace(side, turn_slip=turn_slip) for side in sides]
        progress("comparing")
        found = between(*sides)
    if out is not None:
        from mffit import report

        progress("writing the page")
        protected = [path for path in read if path.is_file()]
        with output_folder(Path(out), by="compare", protected=protected) as folder:
            as_json.write(folder / "compare.json", as_json.comparison(found))
            report.write_comparison(found, folder)
    return found


def _subject(path: Path) -> Subject:
    """A property file, or that of a build's folder, with what its build knows of its uncertainty."""
    if path.is_dir():
        path = path / _file_of_build(path)
    tyre = tir.read(path)
    posterior = posterior_of(tyre, path)
    written = _beside(path)
    rig = written.get("rig")
    if posterior is None:
        main = str(written.get("tir", ""))
        return Subject(path.name, tyre, _turn_slip(tyre), told_of="" if main == path.name else main, rig=rig)
    return Subject(path.name, tyre, _turn_slip(tyre), *_known(posterior), rig=rig)


def _beside(path: Path) -> dict[str, Any]:
    """What a build beside the file says of the file that its covariance is of, ``tir``, and of its ``rig``."""
    try:
        result = json.loads((path.parent / RESULT).read_text(encoding="utf-8"))
        resolved = tomllib.loads((path.parent / RESOLVED).read_text(encoding="utf-8"))
        return {"tir": result["tir"], "rig": resolved["rig"]}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def _apart(first: Path, second: Path) -> tuple[str, str]:
    """The shortest ends of two paths that differ; both whole if they are one."""
    parts = [path.resolve().parts for path in (first, second)]
    for k in range(2, max(map(len, parts)) + 1):
        a, b = ("/".join(p[-k:]) for p in parts)
        if a != b:
            return a, b
    return str(first), str(second)


def _known(posterior: Inexactness) -> tuple[tuple[str, ...], np.ndarray]:
    return posterior.names, posterior.root @ posterior.root.T


def _file_of_build(folder: Path) -> str:
    try:
        return str(json.loads((folder / RESULT).read_text(encoding="utf-8"))["tir"])
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(
            f"{folder} is no folder of a build: it has no {RESULT} that names a property file; give the .tir itself"
        ) from None


def _turn_slip(tyre: Tyre) -> bool:
    """Whether the file is meant for simulations that compute turn slip: as its build says, else as USE_MODE does."""
    use = use_of(tyre)
    return use == "turn-slip" if use is not None else int(tyre["USE_MODE"]) % 10 == 5


def _with_data(subject: Subject, config: Config) -> Comparison:
    """The file against the sweeps, simulated as the rig is declared and as [model] says."""
    points = read_points(config).points
    base = read_base(config)
    turn_slip = config.model.turn_slip and config.rig.on_disc
    faults = RigFaults(backlash_deg=config.rig.backlash_deg)
    simulation = Simulation.of(subject.tyre, faults, turn_slip=turn_slip, star=config.model.star)
    if config.rig.radius is not None:
        simulation = replace(simulation, radius_m=config.rig.radius)
    faultless = replace(simulation, faults=NO_FAULTS).readings(points)
    of_file = points.replace(Fy=faultless.Fy, Mz=faultless.Mz)

    def direct(declared: Config, rows: Points) -> tuple[LoadResult, ...]:
        try:
            return measure(declared, rows, base)[1].per_load
        except InputError:  # without turn slip in the simulation the force has no direction
            return ()

    name = config.path.name if config.path is not None else config.tyre.name
    return against_points(
        subject, simulation, points, direct(config, points), direct(without_play(config), of_file), name
    )
