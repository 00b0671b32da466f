"""The files that a build writes."""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from mffit import as_json, prediction
from mffit import config as configuration
from mffit.comparison.characteristics import characteristics
from mffit.config import Config
from mffit.config.toml_file import toml_text
from mffit.csv_tables import write_csv
from mffit.numbers import Numbers, to_json
from mffit.output import BUILT, output_folder
from mffit.pipeline.inputs import inputs_of, project_of
from mffit.points import Points
from mffit.points.stretch import StretchNote, stretch_table
from mffit.prediction import Predictor
from mffit.quantities import COMPARED, column
from mffit.results import BuildResult
from mffit.suspicion import marks
from tir import Quantity, Tyre

REPORT = "report.html"
EXPLAINED = "explained.txt"
"""What ``mffit build --explain`` prints."""
WRITTEN = (BUILT, "information.json", prediction.FILE, "points.csv", EXPLAINED, REPORT)
"""Files that every build writes in addition to its property files."""
FOLDER, INDEX = "ensemble", "index.csv"
NUMBERS = ("epsilon_gamma", *COMPARED)
"""Columns of the table of drawn tyres, after the file."""


def write_build(
    result: BuildResult, out: Path, stretches: Sequence[StretchNote] = (), *, with_report: bool = True
) -> None:
    """Write every output of a build, or nothing.

    ``stretches`` of recordings go to ``stretches.csv``.
    """
    from mffit.report import text

    config = result.config
    with output_folder(out, by="build", of=project_of(config), protected=inputs_of(config)) as folder:
        for use, name in result.files.items():
            result.tyres[use].write(folder / name)
        as_json.write(folder / BUILT, result)
        _write_information(folder / "information.json", result)
        (folder / EXPLAINED).write_text(f"{text.build_explained(result)}\n", encoding="utf-8")
        write_csv(points_table(result), folder / "points.csv")
        known, use = result.predicting
        if known is not None:
            prediction.write(folder / prediction.FILE, known, result.tir_path, result.files[use])
        if result.correction is not None:
            fitted = result.files[result.fitted]
            prediction.write_correction(folder / result.correction_name, result.correction, fitted)
        if stretches:
            write_csv(stretch_table(stretches), folder / "stretches.csv")
        (folder / "resolved.toml").write_bytes(resolved_text(config, out))
        write_members(result, folder)
        if with_report:
            from mffit import report

            report.write_build(result, folder)


def _write_information(path: Path, result: BuildResult) -> None:
    """Write ``information.json``, one line per key, because it is mainly read by programs."""
    assert result.fit.search is not None
    content = as_json.document(to_json(result.fit.posterior))
    lines = ",\n".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in content.items())
    path.write_text("{\n" + lines + "\n}\n", encoding="utf-8")


def resolved_text(config: Config, out: Path) -> bytes:
    """The content of ``resolved.toml`` in a folder ``out``."""
    return toml_text(configuration.resolved(config, folder=out)).encode()


def points_table(result: BuildResult) -> pd.DataFrame:
    """The content of ``points.csv``: the input columns, the odd and even parts and the model at every point."""
    table = result.points.table.copy()
    parts, fit = result.parts, result.fit
    signs = configuration.axis_signs(result.config)
    table["Fy_odd_N"], table["Fy_even_N"] = parts.Fy_odd * signs["Fy"], parts.Fy_even * signs["Fy"]
    table["Mz_odd_Nm"], table["Mz_even_Nm"] = parts.Mz_odd * signs["Mz"], parts.Mz_even * signs["Mz"]
    for channel, model in fit.model.items():
        table[column(channel, "model")] = model * signs.get(channel, 1.0)
    table["paired"] = parts.paired
    table["outlier"] = marks(fit.outliers, len(table))
    table["doubtful"] = np.isin(np.arange(len(table)), [row for doubt in fit.doubts for row in doubt.index])
    for name, values in origin(result.points).items():
        if name not in table:  # a column of the input with this heading takes precedence
            table[name] = values
    table["excluded"] = False
    return table if result.excluded is None else _with_excluded(table, result.points, result.excluded)


def _with_excluded(table: pd.DataFrame, points: Points, excluded: Points) -> pd.DataFrame:
    """The table with the points that were left out by hand at their places in the files; what is computed is blank there."""
    rows = excluded.table.copy()
    for name, values in origin(excluded).items():
        if name not in rows:
            rows[name] = values
    rows = rows.assign(paired="", outlier="", doubtful=False, excluded=True)
    order = list(dict.fromkeys((*points.files, *excluded.files)))
    files = [order.index(own.files[k]) for own in (points, excluded) for k in own.file.tolist()]
    first = np.lexsort((np.r_[points.line, excluded.line], files))
    found = pd.concat([table, rows.astype({"doubtful": bool, "excluded": bool})], ignore_index=True)
    return found.iloc[first]


def origin(points: Points) -> dict[str, np.ndarray]:
    """File, line, sweep and path of every point, by column of ``points.csv``; a straight path has no radius."""
    curvature = np.abs(points.phi_t)
    radius = np.divide(1.0, curvature, out=np.full(len(points), np.nan), where=curvature > 0.0)
    columns = {
        "file": np.array([Path(name).name for name in points.files], dtype=object)[points.file],
        "line": points.line,
        "sweep": np.array(points.sweep_names, dtype=object)[points.sweep],
        "direction": np.where(points.direction > 0, "forward", "backward"),
        "mount": np.where(points.mount > 0, "normal", "flipped"),
    }
    if np.any(curvature):
        columns["path_centre"] = np.where(points.phi_t < 0.0, "left", "right")
        columns["path_radius_m"] = radius.round(6)
    if len(points.used_setups) > 1:
        columns["setup"] = np.array(points.setups, dtype=object)[points.setup]
    return columns


def write_members(result: BuildResult, out: Path) -> None:
    """Write ``ensemble/<name>-001.tir`` and so on, and ``ensemble/index.csv``; nothing without members.

    Every member is a model for turn slip on (off on a flat track) within the physical limits of the fit.
    """
    members = result.members
    if not members:
        return
    folder = out / FOLDER
    folder.mkdir()
    rows = []
    for i, member in enumerate(members, 1):
        name = f"{result.config.tyre.name}-{i:0{len(str(len(members)))}d}.tir"
        member.write(folder / name)
        found = numbers(member, turn_slip=result.on_disc)
        rows.append({"file": name, **{key: number.value for key, number in found.items()}})
    write_csv(pd.DataFrame(rows), folder / INDEX)


def numbers(
    tyre: Tyre, *, turn_slip: bool, known: Numbers | None = None, predictor: Predictor | None = None
) -> dict[str, Quantity]:
    """The main characteristics at nominal load and pressure on a straight path; SI units, ISO signs."""
    load = float(tyre["FNOMIN"])
    found = characteristics(tyre, load, turn_slip=turn_slip, known=known, predictor=predictor)
    return {key: found[key] for key in NUMBERS if key in found}
