"""``mffit spin`` and ``mffit align``: measurements that need no tyre model, and what a fit says of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import tir
from mffit import config as configuration
from mffit import fit as fitting
from mffit import measured as direct
from mffit import parts as decomposition
from mffit import points as ingestion
from mffit.config import Config
from mffit.errors import InputError
from mffit.fit import FitResult
from mffit.made import made
from mffit.measured import Alignment, Measured
from mffit.output import output_folder
from mffit.parts import Parts
from mffit.pipeline.inputs import input_hashes, inputs_of, read_base, read_points
from mffit.pipeline.judging import judged_measurement, said
from mffit.points import Points
from mffit.points.loading import Reading
from mffit.quantities import SIDEWAYS
from mffit.results import as_json
from mffit.rig import Simulation
from mffit.rig_errors import NO_FAULTS
from tir import Tyre


def spin(config: Config | Mapping[str, Any] | str | Path, out: str | Path | None = None) -> Measured:
    """The alignment check and the direct method only, judged by the rules that need no fit.

    Writes ``spin.json`` if ``out`` is given.
    """
    config = configuration.load(config)
    measured = replace(spin_of(config, read_points(config)), made=made(input_hashes(config)))
    if out is not None:
        with output_folder(Path(out), by="spin", protected=inputs_of(config)) as folder:
            as_json.write(folder / "spin.json", measured)
    return measured


def spin_of(config: Config, reading: Reading) -> Measured:
    """:func:`spin` of points that were read."""
    _, measured = measure(config, reading.points, read_base(config))
    trust = judged_measurement(config, reading.points, measured)
    warnings = (*said(trust), *reading.warnings, *measured.warnings)
    return replace(measured, warnings=warnings, reasons=trust.reasons)


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
    resolution_deg: float = direct.constants.AXIS_RESOLUTION,
) -> Alignment:
    """Next steering correction from forward and backward zeros; see :func:`mffit.measured.align`.

    Parameters
    ----------
    source : path of a ``tyre.toml``, or of a bare table
    axes, path_centre : axes and side of the path centre of a bare table
    resolution_deg : smallest angle by which the axis can be adjusted [deg]

    Notes
    -----
    The cornering stiffness is measured if the sweeps of a ``tyre.toml`` allow it; a bare table needs the usual one.
    """
    source = Path(source)
    if source.suffix == ".toml":
        config = configuration.load(source)
        return _aligned(config, ingestion.load(config)[0], resolution_deg)
    points = ingestion.load_table(source, axes=axes, path_centre=path_centre)
    return direct.align(points, axes=axes or "iso", resolution_deg=resolution_deg)


def _aligned(
    config: Config, points: Points, resolution_deg: float = direct.constants.AXIS_RESOLUTION
) -> Alignment:
    points, stiffness = direct.at_the_axis(config, points, decomposition.split(points))
    return direct.align(points, axes=config.rig.axes, measured=stiffness, resolution_deg=resolution_deg)


def measure(config: Config, points: Points, base: Tyre | None) -> tuple[Parts, Measured]:
    """The odd and even parts of the points, and the direct measurements from those that roll freely, if there are any."""
    rolling = _rolling(points)
    own = points if np.all(rolling) else points.select(rolling)
    parts = decomposition.split(own)
    measured = direct.measure(config, own, parts, base)
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


def without_outliers(
    config: Config, points: Points, measured: Measured, fitted: FitResult, base: Tyre | None
) -> Measured | None:
    """The direct method without the readings that the fit rejected; None if they make no difference."""
    if not fitted.outliers:
        return None
    readings = {}
    for channel in SIDEWAYS:
        rejected = [outlier.row for outlier in fitted.outliers if outlier.channel == channel]
        readings[channel] = np.where(
            np.isin(np.arange(len(points)), rejected), np.nan, getattr(points, channel)
        )
    sound = points.replace(**readings).select(np.isfinite(readings["Fy"]))
    again = measure(config, sound, base)[1]
    return None if again == measured else again


def finite_spin_bias(
    config: Config, points: Points, simulation: Simulation | None, base: Tyre | None
) -> float | None:
    """Bias of eps_gamma of the direct method due to finite spin on a disc; None without a disc.

    The method is applied to noise-free readings of a rig without errors, of a model whose eps_gamma is known.
    """
    if simulation is None:
        return None
    readings = replace(simulation, faults=NO_FAULTS, of_parts={}).readings(points)
    found = epsilon_gamma(without_play(config), points.replace(**readings), base)
    return None if found is None else found.value - float(simulation.values["PECP1"])


def undistorted(config: Config, fitted: FitResult) -> Simulation | None:
    """The fitted model with a PECP1 that the points determine, as the bias needs it; None without turn slip."""
    if not config.rig.on_disc or fitted.epsilon_gamma_model is None:
        return None
    assert fitted.search is not None
    return fitting.with_free_epsilon(fitted.search)
