"""The workflows: one screen each, one call per step."""

from __future__ import annotations

import json
import math
import re
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import tomli_w
from threadpoolctl import threadpool_limits

import mffit
import tir
from mffit import config as configuration
from mffit import fit as fitting
from mffit import measured as direct
from mffit import parts as decomposition
from mffit import points as ingestion
from mffit.config import Config
from mffit.diagnosis import Diagnosis, corrected_points
from mffit.diagnosis import diagnose as find_effects
from mffit.effects import CATALOG, Effect
from mffit.errors import InputError
from mffit.fit import FitResult
from mffit.measured import Alignment, Measured
from mffit.output import digest, output_folder, refuse_early
from mffit.parts import Parts
from mffit.points import Points
from mffit.rig import FAULT_NAMES, UNITS, RigFaults
from tir import Tyre

Progress = Callable[[str], None]
"""Called with a short sentence whenever a step begins."""


BUILD_FILES = ("result.json", "points.csv", "report.html")
DIAGNOSIS_FILES = ("diagnosis.json", "diagnosis.html")
"""What a run is sure to write beside a property file, known before the work begins."""


PLAIN = " /\\!#$&'()+,;=@[]{}~"
"""What may stand in a file's name, beside letters and digits, without being written as %XX in a property file."""


def silent(sentence: str) -> None:
    """Progress that is not shown."""


@dataclass(frozen=True, slots=True)
class Result:
    """Everything a build produces."""

    config: Config
    points: Points
    parts: Parts
    measured: Measured
    fit: FitResult
    tyre: Tyre  #: what the .tir holds
    warnings: tuple[str, ...]
    seconds: float
    tir_path: str  #: name of the .tir in the output folder
    files: Mapping[str, str] = field(
        default_factory=dict
    )  #: name of each file by use, "turn-slip" or "normal"
    tyres: Mapping[str, Tyre] = field(default_factory=dict)  #: what each of them holds

    def to_json(self) -> dict[str, Any]:
        """The content of result.json."""
        return {
            "tyre": self.config.tyre.model_dump(exclude_none=True),
            "spin": self.measured.to_json(),
            "fit": self.fit.to_json(),
            "tir": self.tir_path,
            "files": dict(self.files),
            "warnings": list(self.warnings),
        }


def build(
    config: Config | Mapping[str, Any] | str | Path,
    out: str | Path | None = None,
    *,
    progress: Progress = silent,
) -> Result:
    """Turn rig sweeps into an MF-6.2 tyre.

    Parameters
    ----------
    config : path of a ``tyre.toml``, its content, or a loaded Config
    out : folder to write to; nothing is written if None
    progress : called with a sentence before each step

    Returns
    -------
    Result
        The tyre, the direct measurements and the fit.

    Raises
    ------
    InputError
        On bad input; nothing is written then.
    """
    began = time.perf_counter()
    config = configuration.load(config)
    progress("reading sweeps")
    points, warnings = ingestion.load(config)
    base = read_base(config)
    progress("measuring the camber reduction factor")
    parts, measured = measure(config, points, base)
    refuse_early(_folder(out), (f"{config.tyre.name}.tir", *BUILD_FILES), inputs_of(config))
    with threadpool_limits(1):  # the matrices are small: threads cost more than they bring
        fitted = fitting.fit(config, points, parts, measured, base, progress)
        bias = finite_spin_bias(config, points, fitted, base)
        if bias is not None:
            measured = measured.debiased(bias)
        if bias is not None and config.spin.pecp1 == "debiased":
            assert measured.epsilon_gamma_debiased is not None
            measured = replace(measured, pecp1=measured.epsilon_gamma_debiased.value)
            fitted = fitting.fit(config, points, parts, measured, base, progress)
    measured = measured.with_model(
        epsilon_gamma_model=fitted.epsilon_gamma_model, pecp1=_number(fitted.written, "PECP1", measured)
    )
    disc = config.rig.type == "rotating-disk"
    names = fitting.file_names(config.tyre.name, config.spin.exact, disc)
    assert fitted.files is not None
    tyres = {use: annotated(fitted.files.by_use[use].tyre, config, measured, fitted, use) for use in names}
    plain = config.spin.exact if disc else "normal"
    result = Result(
        config=config,
        points=points,
        parts=parts,
        measured=measured,
        fit=fitted,
        tyre=tyres[plain],
        warnings=(*warnings, *measured.warnings, *fitted.warnings),
        seconds=time.perf_counter() - began,
        tir_path=names[plain],
        files=names,
        tyres=tyres,
    )
    if out is not None:
        progress("writing the report")
        write_build(result, Path(out))
    return result


def spin(config: Config | Mapping[str, Any] | str | Path, out: str | Path | None = None) -> Measured:
    """Alignment check and direct method only; writes ``spin.json`` if ``out`` is given."""
    config = configuration.load(config)
    points, warnings = ingestion.load(config)
    _, measured = measure(config, points, read_base(config))
    measured = replace(measured, warnings=(*warnings, *measured.warnings))
    if out is not None:
        with output_folder(Path(out), by="spin", protected=inputs_of(config)) as folder:
            _write_json(folder / "spin.json", measured.to_json())
    return measured


def diagnose(
    config: Config | Mapping[str, Any] | str | Path,
    model: Tyre | str | Path | None = None,
    *,
    out: str | Path | None = None,
    effects: Sequence[Effect] = CATALOG,
    progress: Progress = silent,
) -> Diagnosis:
    """Find where a simulation's model and the measurement disagree, and what explains it.

    Parameters
    ----------
    config : path of a ``tyre.toml``, its content, or a loaded Config
    model : the model that the simulation uses; default the last build's file, else one fitted now
    out : folder to write to; nothing is written if None
    effects : the library of effects, to which records of your own may be added
    progress : called with a sentence before each step

    Returns
    -------
    Diagnosis
        With the direct method redone where a rig effect was found.
    """
    config = configuration.load(config)
    progress("reading sweeps")
    points, _ = ingestion.load(config, continuous=True)
    base = read_base(config)
    inputs = [*inputs_of(config), last_build(config)]
    if isinstance(model, str | Path):
        inputs.append(Path(model))
    refuse_early(_folder(out), (f"{config.tyre.name}.tir", *DIAGNOSIS_FILES), inputs)
    tyre, choice = _model(config, model, progress)
    with threadpool_limits(1):
        rig = rig_of_build(tyre, config)
        diagnosis = find_effects(points, tyre, config, rig=rig, effects=effects, progress=progress)
    diagnosis = replace(diagnosis, notes=(*choice, *diagnosis.notes))
    disc = config.rig.type == "rotating-disk"
    if disc and any(found.effect.kind == "rig" for found in diagnosis.effects):
        diagnosis = replace(diagnosis, notes=(*diagnosis.notes, _redone(config, points, diagnosis, base)))
    if out is not None:
        write_diagnosis(diagnosis, Path(out), protected=inputs)
    return diagnosis


def _model(
    config: Config, model: Tyre | str | Path | None, progress: Progress
) -> tuple[Tyre, tuple[str, ...]]:
    """The simulation's model, as given, else the last build's, else fitted now; and what to say of the choice."""
    if isinstance(model, Tyre):
        return model, ()
    if model is not None:
        return tir.read(model), ()
    wanted = "turn-slip" if config.model.turn_slip and config.rig.type == "rotating-disk" else "normal"
    for name in (f"{config.tyre.name}.tir", f"{config.tyre.name}-{wanted}.tir"):
        last = config.folder / "out" / name
        if last.is_file() and use_of(tyre := tir.read(last)) in (wanted, None):
            return tyre, () if name == f"{config.tyre.name}.tir" else (
                f"The model is {name} of the last build.",
            )
    note = (
        "The model was fitted to these points first, as there was no earlier build for simulations with turn slip "
        f"{'on' if wanted == 'turn-slip' else 'off'}."
    )
    return build(config, progress=progress).tyres[wanted], (note,)


def use_of(tyre: Tyre) -> str | None:
    """Which use a built file is for, "turn-slip" or "normal", as its provenance says; None for files from elsewhere."""
    said = tyre.provenance.get("use") or tyre.provenance.get("configuration", "")
    found = re.match(r"(?:spin\.exact )?(turn-slip|normal)\b", said)
    return found[1] if found else None


def _redone(config: Config, points: Points, diagnosis: Diagnosis, base: Tyre | None) -> str:
    """The direct method with the rig's faults taken off, in one sentence."""
    names = " and ".join(f.effect.name for f in diagnosis.effects if f.effect.kind == "rig")
    mended = without_play(config)
    without = corrected_points(points, diagnosis.state)
    before, after = (
        _epsilon(settings, chosen, base) for settings, chosen in ((config, points), (mended, without))
    )
    if before is None or after is None:
        return f"eps_gamma cannot be measured {'with' if after else 'even without'} {names}."
    if abs(after.value - before.value) < 0.5 * after.u:
        return (
            f"eps_gamma stays {after.value:.2f} +- {after.u:.2f} (k = 1) with {names} corrected: the direct method allows "
            "for it."
        )
    return (
        f"eps_gamma was {before.value:.2f} +- {before.u:.2f} with {names}; corrected it is {after.value:.2f} +- "
        f"{after.u:.2f} (k = 1)."
    )


def _epsilon(config: Config, points: Points, base: Tyre | None) -> tir.Quantity | None:
    """eps_gamma of the points, None where the direct method fails on them."""
    try:
        return direct.measure(config, points, decomposition.split(points), base).epsilon_gamma
    except InputError:
        return None


def write_diagnosis(diagnosis: Diagnosis, out: Path, protected: Iterable[Path] = ()) -> None:
    """Write every output of a diagnosis, or nothing; the ``protected`` files were read and are not replaced."""
    from mffit import report

    with output_folder(out, by="diagnose", protected=protected) as folder:
        diagnosis.tyre.write(folder / diagnosis.model_after)
        _write_json(folder / "diagnosis.json", diagnosis.to_json())
        report.write_diagnosis(diagnosis, folder)


def measure(config: Config, points: Points, base: Tyre | None) -> tuple[Parts, Measured]:
    """Split the points and measure directly."""
    parts = decomposition.split(points)
    measured = direct.measure(config, points, parts, base)
    return replace(parts, alpha_odd=direct.odd_alpha(points, parts, config)), measured


def finite_spin_bias(config: Config, points: Points, fitted: FitResult, base: Tyre | None) -> float | None:
    """What the direct method adds to eps_gamma because spin on a disc is not small; None where it does not apply.

    The method is run on what a faultless rig would read, without noise, of the fitted model, whose eps_gamma is known.
    """
    if config.rig.type != "rotating-disk" or fitted.epsilon_gamma_model is None:
        return None
    faultless = replace(fitted.simulation, faults=RigFaults())
    Fy, Mz = faultless.readings(points)
    found = _epsilon(without_play(config), points.replace(Fy=Fy, Mz=Mz), base)
    return None if found is None else found.value - float(fitted.simulation.values["PECP1"])


def without_play(config: Config) -> Config:
    """The configuration of the same rig with a steering axis that has no play."""
    return config.model_copy(update={"rig": config.rig.model_copy(update={"backlash_deg": 0.0})})


def read_base(config: Config) -> Tyre | None:
    """The base file of the configuration, if it names one."""
    if config.tyre.base is None:
        return None
    path = config.folder / config.tyre.base
    if not path.is_file():
        raise InputError(
            f"the base file {path} does not exist: correct [tyre] base or remove it",
            file=config.path,
            key="tyre.base",
        )
    return tir.read(path)


def annotated(tyre: Tyre, config: Config, measured: Measured, fitted: FitResult, use: str) -> Tyre:
    """The tyre with its measured quantities, its use and provenance as structured comments."""
    provenance = {
        "program": f"mffit {mffit.__version__}",
        "use": f"{use}, for simulations with turn slip {'on' if use == 'turn-slip' else 'off'}",
        "configuration": _settings(config),
        **inputs_said(config),
    }
    rig = {RIG + name: tir.Quantity(value, u, UNITS[name]) for name, (value, u) in fitted.rig.items()}
    return tyre.annotate(measured={**measured.quantities(), **rig}, provenance=provenance)


def rig_of_build(tyre: Tyre, config: Config) -> RigFaults | None:
    """The rig errors that the build found, if the file was fitted to these very sweeps; None otherwise."""
    of_file = {name: digest for name, digest in tyre.provenance.items() if name.startswith("input ")}
    if not of_file or of_file != inputs_said(config):
        return None
    found = {name: tyre.measured[RIG + name].value for name in FAULT_NAMES if RIG + name in tyre.measured}
    return RigFaults(**{"backlash_deg": config.rig.backlash_deg, **found}) if found else None


def inputs_said(config: Config) -> dict[str, str]:
    """The hashes of the inputs as a property file's provenance: ASCII, and no colon in a name."""
    return {f"input {quote(name, safe=PLAIN)}": known for name, known in input_hashes(config).items()}


RIG = "rig."
"""What opens the name of a rig error among a file's measured quantities."""


def input_hashes(config: Config) -> dict[str, str]:
    """First 16 hex digits of the SHA-256 of every input file, by its name as the configuration gives it."""
    return {name: digest(config.folder / name)[:16] for name in _input_names(config)}


def inputs_of(config: Config) -> list[Path]:
    """Every file that a run of this configuration reads."""
    files = [config.folder / name for name in _input_names(config)]
    return files if config.path is None else [config.path, *files]


def last_build(config: Config) -> Path:
    """Where a build writes its property file by default."""
    return config.folder / "out" / f"{config.tyre.name}.tir"


def _input_names(config: Config) -> list[str]:
    names = [sweep.file for sweep in config.sweep] + ([config.tyre.base] if config.tyre.base else [])
    return list(dict.fromkeys(names))


def _folder(out: str | Path | None) -> Path | None:
    return None if out is None else Path(out)


def write_build(result: Result, out: Path) -> None:
    """Write every output of a build, or nothing."""
    from mffit import report

    siblings = [f"{result.config.tyre.name}-{use}.tir" for use in ("turn-slip", "normal")]
    with output_folder(out, by="build", protected=inputs_of(result.config), outdated=siblings) as folder:
        for use, name in (result.files or {"": result.tir_path}).items():
            result.tyres.get(use, result.tyre).write(folder / name)
        _write_json(folder / "result.json", result.to_json())
        points_table(result).to_csv(folder / "points.csv", index=False)
        resolved = configuration.resolved(result.config, folder=out)
        (folder / "resolved.toml").write_bytes(tomli_w.dumps(resolved).encode())
        report.write_build(result, folder)


def points_table(result: Result):
    """The input columns with the odd and even part and the model at every point (contract of points.csv)."""
    table = result.points.table.copy()
    parts, fit = result.parts, result.fit
    signs = configuration.axis_signs(result.config)
    table["Fy_odd_N"], table["Fy_even_N"] = parts.Fy_odd * signs["Fy"], parts.Fy_even * signs["Fy"]
    table["Mz_odd_Nm"], table["Mz_even_Nm"] = parts.Mz_odd * signs["Mz"], parts.Mz_even * signs["Mz"]
    table["Fy_model_N"], table["Mz_model_Nm"] = fit.Fy_model * signs["Fy"], fit.Mz_model * signs["Mz"]
    table["paired"] = parts.paired
    return table


def _write_json(path: Path, content: Mapping[str, Any]) -> None:
    path.write_text(
        json.dumps(_plain(content), indent=2, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8"
    )


def _plain(value: Any) -> Any:
    """JSON has no NaN and no numpy types."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _number(tyre: Tyre, name: str, measured: Measured) -> float | None:
    return float(tyre[name]) if measured.epsilon_gamma is not None else None


def _settings(config: Config) -> str:
    return f"spin.exact {config.spin.exact}, spin.pecp1 {config.spin.pecp1}, camber stiffness by {config.camber_stiffness.method}"


def align(source: str | Path, *, axes: str | None = None, path_centre: str | None = None) -> Alignment:
    """Next steering correction from forward and backward zeros; see :func:`mffit.measured.align`.

    Parameters
    ----------
    source : path of a ``tyre.toml``, or of a bare table
    axes, path_centre : what a bare table does not say itself
    """
    source = Path(source)
    if source.suffix == ".toml":
        config = configuration.load(source)
        points, _ = ingestion.load(config, check_physics=False)
        return direct.align(points, axes=config.rig.axes)
    points = ingestion.load_table(source, axes=axes, path_centre=path_centre)
    return direct.align(points, axes=axes or "iso")
