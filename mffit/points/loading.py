"""All sweeps of a configuration, or a single table, as points."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from mffit import sweeps as files
from mffit.config import Config, path_curvature
from mffit.errors import InputError
from mffit.points import levels
from mffit.points.plausibility import check_physics as check
from mffit.points.points import Points, concatenate
from mffit.points.reduction import reduce
from mffit.points.requirements import check_disc_programme
from tir.conventions import FLIPPED

SIDES = ("left", "right")
STAND_IN = {"p": 250e3, "V": 1.0}
"""Pressure [Pa] and speed [m/s] of a bare table that holds none; alignment depends on neither."""


def load(
    config: Config, *, check_physics: bool = True, continuous: bool = False
) -> tuple[Points, tuple[str, ...]]:
    """Read the sweeps of a configuration as points in ISO-W.

    Parameters
    ----------
    config : the checked ``tyre.toml``
    check_physics : test the declared axes, frame and path centre, and what a disc needs, against the data
    continuous : keep the samples of sweeps that never rest, marked ``continuous``

    Returns
    -------
    points, warnings

    Raises
    ------
    InputError
        On files that cannot be read, data that contradict the declaration, and without any steady point.
    """
    found = files.load(config)
    phi_t = path_curvature(config.rig)
    reduced = [reduce(sweep, phi_t) for sweep in found.sweeps]
    points = concatenate([part.points for part in reduced if len(part.points)] or [reduced[0].points])
    warnings = [*found.warnings, *(sentence for part in reduced for sentence in part.warnings)]
    steady = points.select(~points.continuous)
    if not len(steady):
        raise InputError(
            "no sweep rests long enough for a steady point; hold every set-point for some seconds, "
            "or leave out "
            "column time_s to take each row for a finished point",
            file=config.path,
        )
    if not continuous:
        warnings += _left_out(points)
    if check_physics:
        warnings += check(steady, config)
        if config.rig.type == "rotating-disk":
            check_disc_programme(steady, config)
    warnings += _thin(steady, config)
    return points if continuous else steady, tuple(warnings)


def load_table(path: str | Path, *, axes: str | None = None, path_centre: str | None = None) -> Points:
    """Points of a bare table, for the alignment of the sideslip axis.

    Parameters
    ----------
    path : file with the contract's headings
    axes : "iso", "sae" or "adapted-sae"
    path_centre : "left" or "right"; the radius is unknown, so that phi_t is -1 or 1 and says only the side

    Raises
    ------
    InputError
        ``axes`` or ``path_centre`` is not said, as a table does not hold it, or the file cannot be read.

    Notes
    -----
    A continuous sweep has no zero points and is left out.
    """
    axes = _said("axes", axes, tuple(FLIPPED), path)
    path_centre = _said("path_centre", path_centre, SIDES, path)
    phi_t = -1.0 if path_centre == "left" else 1.0
    found = files.load_file(path, axes=axes).sweeps
    points = concatenate([reduce(_completed(sweep), phi_t).points for sweep in found])
    return points.select(~points.continuous)


def _said(name: str, value: str | None, choice: tuple[str, ...], path: str | Path) -> str:
    """The value of what a bare table cannot say itself."""
    if value in choice:
        return value
    found = f"does not say the rig's {name}" if value is None else f'{name} = "{value}" is not known'
    written = " or ".join(f'"{one}"' for one in choice)
    raise InputError(f"{found}; give {name} = {written}, or a tyre.toml", file=path)


def _completed(sweep: files.Sweep) -> files.Sweep:
    filled = {
        name: np.where(np.isfinite(getattr(sweep, name)), getattr(sweep, name), value)
        for name, value in STAND_IN.items()
    }
    return replace(sweep, p=filled["p"], V=filled["V"])


def _left_out(points: Points) -> list[str]:
    names = [points.files[index] for index in np.unique(points.file[points.continuous])]
    return [f"{name}: keeps moving and gives no steady point; only mffit diagnose uses it" for name in names]


def _thin(points: Points, config: Config) -> list[str]:
    """What the data lack without being wrong."""
    out = []
    if not np.any(np.isfinite(points.Mz)):
        out.append("Mz_Nm was not measured: only Fy is fitted")
    if config.rig.type == "rotating-disk" and not np.any(points.direction < 0):
        out.append(
            "there are no backward runs: sideslip misalignment cannot be told from turn slip and ply-steer"
        )
    if levels.count(points.Fz, levels.LOAD) == 1:
        out.append(f"there is one load only ({np.mean(points.Fz):.0f} N): terms that vary with load are held")
    return out
