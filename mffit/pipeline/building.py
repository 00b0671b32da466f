"""``mffit build``: sweeps to property files."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import tomli_w
from threadpoolctl import threadpool_limits

from mffit import config as configuration
from mffit import fit as fitting
from mffit.config import Config
from mffit.fit import FitResult
from mffit.measured import Measured
from mffit.output import output_folder, refuse_early
from mffit.pipeline.inputs import inputs_of, read_base, read_points
from mffit.pipeline.measuring import epsilon_gamma, measure, without_play
from mffit.pipeline.members import write_members
from mffit.pipeline.provenance import Annotate, annotator
from mffit.points import Points
from mffit.points.stretch import StretchNote
from mffit.progress import Progress, silent
from mffit.quantities import CHANNELS
from mffit.recordings.stretch_table import stretch_table
from mffit.results import BuildResult, as_json
from mffit.rig import NO_FAULTS, Simulation
from mffit.suspicion import marks
from tir import Tyre

USES = ("turn-slip", "normal")
"""What a written file may be for, beside the plain name."""
WRITTEN = ("result.json", "information.json", "points.csv", "report.html")
"""What a run is sure to write beside its property files, known before the work begins."""


def build(
    config: Config | Mapping[str, Any] | str | Path,
    out: str | Path | None = None,
    *,
    ensemble: int = 0,
    progress: Progress = silent,
) -> BuildResult:
    """Turn rig sweeps into an MF-6.2 tyre.

    Parameters
    ----------
    config : path of a ``tyre.toml``, its content, or a loaded Config
    out : folder to write to; nothing is written if None
    ensemble : property files to draw from what the fit leaves uncertain, beside the best one
    progress : called with a sentence before each step

    Returns
    -------
    BuildResult
        The tyre, the direct measurements and the fit.

    Raises
    ------
    InputError
        On bad input; nothing is written then.
    """
    began = time.perf_counter()
    config = configuration.load(config)
    progress("reading sweeps")
    reading = read_points(config)
    points, warnings = reading.points, reading.warnings
    base = read_base(config)
    progress("measuring the camber reduction factor")
    parts, measured = measure(config, points, base)
    disc = config.rig.on_disc
    names = fitting.file_names(config.tyre.name, config.spin.exact, disc)
    if out is not None:
        refuse_early(Path(out), (*names.values(), *WRITTEN), inputs_of(config))
    with threadpool_limits(1):  # the matrices are small: threads cost more than they bring
        fitted = fitting.fit(config, points, parts, measured, base, progress)
        sound = without_outliers(config, points, measured, fitted, base)
        if sound is not measured:
            measured = sound
            fitted = fitting.fit(config, points, parts, measured, base, progress)
        bias = finite_spin_bias(config, points, undistorted(config, fitted), base)
        if bias is not None:
            measured = measured.debiased(bias)
        if bias is not None and config.spin.pecp1 == "debiased":
            assert measured.epsilon_gamma_debiased is not None
            measured = replace(measured, pecp1=measured.epsilon_gamma_debiased.value)
            fitted = fitting.fit(config, points, parts, measured, base, progress)
    measured = measured.with_model(
        epsilon_gamma_model=fitted.epsilon_gamma_model,
        pecp1=float(fitted.written["PECP1"]) if measured.epsilon_gamma is not None else None,
    )
    if ensemble:
        progress(f"drawing {ensemble} tyres from what the fit leaves uncertain")
    annotated = annotator(config, measured, fitted)
    with threadpool_limits(1):
        drawn = tuple(_members(fitted, ensemble, annotated, disc)) if ensemble else ()
    assert fitted.files is not None
    made = fitted.files.by_use
    result = BuildResult(
        config=config,
        points=points,
        parts=parts,
        measured=measured,
        fit=fitted,
        files=names,
        tyres={use: annotated(made[use].tyre, use) for use in names},
        members=drawn,
        plain=config.spin.exact if disc else "normal",
        warnings=(*warnings, *measured.warnings, *fitted.warnings),
        seconds=time.perf_counter() - began,
    )
    if out is not None:
        progress("writing the report")
        write_build(result, Path(out), reading.stretches)
    return result


def _members(fitted: FitResult, count: int, annotated: Annotate, disc: bool) -> Iterator[Tyre]:
    """Tyres drawn from what the fit leaves uncertain, each of which says that it is a draw."""
    best = annotated(fitted.tyre, "turn-slip" if disc else "normal")
    assert fitted.search is not None
    for i, values in enumerate(fitting.ensemble(fitted.search, count), 1):
        told = {"ensemble": f"draw {i} of {count} from what the fit leaves uncertain"}
        yield best.replace(**values).annotate(status=dict.fromkeys(values, "drawn"), provenance=told)


def without_outliers(
    config: Config, points: Points, measured: Measured, fitted: FitResult, base: Tyre | None
) -> Measured:
    """The direct method without the readings that the fit gave no weight; the very same where they make no difference."""
    if not fitted.outliers:
        return measured
    rows = np.arange(len(points))
    Fy, Mz = (
        np.where(
            np.isin(rows, [o.row for o in fitted.outliers if o.channel == name]),
            np.nan,
            getattr(points, name),
        )
        for name in CHANNELS
    )
    sound = points.replace(Fy=Fy, Mz=Mz).select(np.isfinite(Fy))
    again = measure(config, sound, base)[1]
    return measured if again == measured else again


def finite_spin_bias(
    config: Config, points: Points, simulation: Simulation | None, base: Tyre | None
) -> float | None:
    """What the direct method adds to eps_gamma because spin on a disc is not small; None where it does not apply.

    The method is run on what a faultless rig would read, without noise, of a model whose eps_gamma is known.
    """
    if simulation is None:
        return None
    Fy, Mz = replace(simulation, faults=NO_FAULTS).readings(points)
    found = epsilon_gamma(without_play(config), points.replace(Fy=Fy, Mz=Mz), base)
    return None if found is None else found.value - float(simulation.values["PECP1"])


def undistorted(config: Config, fitted: FitResult) -> Simulation | None:
    """The model that tells what finite spin does: PECP1 decided by the points; None where there is no turn slip."""
    if not config.rig.on_disc or fitted.epsilon_gamma_model is None:
        return None
    assert fitted.search is not None
    return fitting.with_free_epsilon(fitted.search)


def write_build(result: BuildResult, out: Path, stretches: Sequence[StretchNote] = ()) -> None:
    """Write every output of a build, or nothing; ``stretches`` of recordings go to ``stretches.csv``."""
    from mffit import report

    siblings = [f"{result.config.tyre.name}-{use}.tir" for use in USES]
    with output_folder(out, by="build", protected=inputs_of(result.config), outdated=siblings) as folder:
        for use, name in result.files.items():
            result.tyres[use].write(folder / name)
        as_json.write(folder / "result.json", as_json.build(result))
        as_json.write_information(folder / "information.json", result)
        points_table(result).to_csv(folder / "points.csv", index=False)
        if stretches:
            stretch_table(stretches).to_csv(folder / "stretches.csv", index=False)
        (folder / "resolved.toml").write_bytes(resolved_text(result.config, out))
        write_members(result, folder)
        report.write_build(result, folder)


def resolved_text(config: Config, out: Path) -> bytes:
    """The content of ``resolved.toml`` in a folder ``out``."""
    return tomli_w.dumps(configuration.resolved(config, folder=out)).encode()


def points_table(result: BuildResult) -> pd.DataFrame:
    """The input columns with the odd and even part and the model at every point (contract of points.csv)."""
    table = result.points.table.copy()
    parts, fit = result.parts, result.fit
    signs = configuration.axis_signs(result.config)
    table["Fy_odd_N"], table["Fy_even_N"] = parts.Fy_odd * signs["Fy"], parts.Fy_even * signs["Fy"]
    table["Mz_odd_Nm"], table["Mz_even_Nm"] = parts.Mz_odd * signs["Mz"], parts.Mz_even * signs["Mz"]
    table["Fy_model_N"], table["Mz_model_Nm"] = fit.Fy_model * signs["Fy"], fit.Mz_model * signs["Mz"]
    table["paired"] = parts.paired
    table["outlier"] = marks(fit.outliers, len(table))
    table["doubtful"] = np.isin(np.arange(len(table)), [row for doubt in fit.doubts for row in doubt.index])
    for name, values in origin(result.points).items():
        if name not in table:  # a heading of the user's own stays
            table[name] = values
    return table


def origin(points: Points) -> dict[str, np.ndarray]:
    """Where every point comes from, by the columns of points.csv; a straight path has no radius."""
    curved = np.abs(points.phi_t)
    path = {
        "path_centre": np.where(points.phi_t < 0.0, "left", "right"),
        "path_radius_m": np.divide(1.0, curved, out=np.full(len(points), np.nan), where=curved > 0.0).round(
            6
        ),
    }
    return {
        "file": np.array([Path(name).name for name in points.files], dtype=object)[points.file],
        "line": points.line,
        "sweep": np.array(points.sweep_names, dtype=object)[points.sweep],
        "direction": np.where(points.direction > 0, "forward", "backward"),
        "mount": np.where(points.mount > 0, "normal", "flipped"),
        **(path if np.any(curved) else {}),
    }
