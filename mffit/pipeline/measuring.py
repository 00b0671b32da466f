"""``mffit spin`` and ``mffit align``: measurements that need no tyre model."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import tir
from mffit import as_json
from mffit import config as configuration
from mffit import measured as direct
from mffit import parts as decomposition
from mffit import points as ingestion
from mffit.config import Config
from mffit.errors import InputError
from mffit.made import Made, made
from mffit.measured import Alignment, Measured, radius_readings
from mffit.measured.result import NO_FIT, AfterFit
from mffit.output import output_folder
from mffit.parts import Parts
from mffit.pipeline.inputs import input_hashes, inputs_of, project_of, read_base, read_points
from mffit.points import Points
from mffit.points.loading import Reading
from mffit.suspicion import JudgedMeasurement, Trust, judge
from tir import Tyre


def spin(config: Config | Mapping[str, Any] | str | Path, out: str | Path | None = None) -> Measured:
    """The alignment check and the direct method only, judged by the rules that need no fit.

    Parameters
    ----------
    config : path of a ``tyre.toml``, its content, or a loaded Config
    out : folder for ``spin.json``; nothing is written if None

    Returns
    -------
    Measured
        Stiffnesses, radii, turn-slip force and eps_gamma by load, with their budgets; SI units, ISO signs.

    Raises
    ------
    InputError
        On bad input, or without points from which eps_gamma or a stiffness can be measured.
    """
    config = configuration.load(config)
    measured = spin_of(config, read_points(config), made(input_hashes(config)))
    if out is not None:
        of = project_of(config)
        with output_folder(Path(out), by="spin", of=of, protected=inputs_of(config)) as folder:
            as_json.write(folder / "spin.json", measured)
    return measured


def spin_of(config: Config, reading: Reading, made_of: Made | None = None) -> Measured:
    """:func:`spin` of points that were read."""
    found = measure(config, reading.points, read_base(config))[1]
    trust = judge(
        JudgedMeasurement(
            points=reading.points,
            nominal=found.nominal,
            radius_counts=not follows_path(config),
            sideslip_zeros=found.sideslip_zeros,
            drift=found.drift,
            lag=found.lag,
        )
    )
    warnings = (*said(trust), *reading.warnings, *found.warnings)
    return replace(found, made=made_of, reasons=trust.reasons, warnings=warnings)


def said(trust: Trust) -> tuple[str, ...]:
    """Reasons and doubts as warnings."""
    return (*(f"the result is not to be trusted: {reason}" for reason in trust.reasons), *trust.doubts)


def follows_path(config: Config) -> bool:
    """Whether r_e was measured along the path, so that an error of the path's radius cancels."""
    return any(radius.follows_path for radius in radius_readings(config))


def alignment_of(config: Config, points: Points) -> Alignment | None:
    """:func:`align` of the points of a project; None on a flat track or without zeros both ways."""
    try:
        return _aligned(config, points) if config.rig.on_disc else None
    except InputError:
        return None


def align(
    source: str | Path,
    *,
    axes: str | None = None,
    path_centre: str | None = None,
    resolution_deg: float = 0.0,
) -> Alignment:
    """Next steering correction from forward and backward zeros; see :func:`mffit.measured.align`.

    Parameters
    ----------
    source : path of a ``tyre.toml``, or of a bare table
    axes, path_centre : axes and side of the path centre of a bare table
    resolution_deg : smallest angle by which the axis can be adjusted [deg]

    Returns
    -------
    Alignment
        The correction in degrees of the rig's axis, by load and step. The cornering stiffness is measured if the sweeps of a
        ``tyre.toml`` allow it; for a bare table the usual one is assumed.

    Raises
    ------
    InputError
        The input is wrong, or no load has zeros in both directions.
    """
    source = Path(source)
    if source.suffix == ".toml":
        config = configuration.load(source)
        return _aligned(config, ingestion.read(config).points, resolution_deg)
    points = ingestion.load_table(source, axes=axes, path_centre=path_centre)
    return direct.align(points, axes=axes or "iso", resolution_deg=resolution_deg)


def _aligned(config: Config, points: Points, resolution_deg: float = 0.0) -> Alignment:
    points, stiffness = direct.at_the_axis(config, points, decomposition.split(points))
    return direct.align(points, axes=config.rig.axes, measured=stiffness, resolution_deg=resolution_deg)


def measure(
    config: Config, points: Points, base: Tyre | None, after: AfterFit = NO_FIT
) -> tuple[Parts, Measured]:
    """The odd and even parts of the points, and the direct measurements from those that roll freely, if there are any."""
    rolling = _rolling(points)
    own = points if np.all(rolling) else points.select(rolling)
    parts = decomposition.split(own)
    measured = direct.measure(config, own, parts, base, after)
    parts = replace(parts, alpha_odd=direct.odd_alpha(own, parts, config))
    return (parts if own is points else parts.among(points, rolling)), measured


def epsilon_gamma(config: Config, points: Points, base: Tyre | None) -> tir.Quantity | None:
    """eps_gamma of the points by the direct method; None if the method fails."""
    try:
        own = points.select(_rolling(points))
        return direct.measure(config, own, decomposition.split(own), base).epsilon_gamma
    except InputError:
        return None


def _rolling(points: Points) -> np.ndarray:
    """Mask (n,) of the points that roll freely; of all points if none does."""
    rolling = points.free_rolling
    return rolling if np.any(rolling) else np.ones_like(rolling)


def without_play(config: Config) -> Config:
    """The configuration of the same rig without backlash."""
    return config.model_copy(update={"rig": config.rig.model_copy(update={"backlash_deg": 0.0})})
