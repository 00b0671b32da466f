"""What a property file says of its making, written and read back."""

from __future__ import annotations

import json
import re
from pathlib import Path
from urllib.parse import quote

import numpy as np

import mffit
import tir
from mffit.config import Config
from mffit.diagnosis.inexact import Inexactness, correlated, refitted
from mffit.fit import FitResult
from mffit.measured import Measured
from mffit.pipeline.inputs import input_hashes
from mffit.rig import FAULT_NAMES, UNITS, RigFaults
from tir import Tyre

RIG = "rig."
"""What opens the name of a rig error among a file's measured quantities."""
TURN_SLIP = {"turn-slip": "on", "normal": "off", "both": "on or off"}
"""What each use of a file means for the simulation's turn slip."""
PLAIN = " /\\!#$&'()+,;=@[]{}~"
"""What may stand in a file's name, beside letters and digits, without being written as %XX in a property file."""


def annotated(tyre: Tyre, config: Config, measured: Measured, fitted: FitResult, use: str) -> Tyre:
    """The tyre with its measured quantities, its use and provenance as structured comments."""
    provenance = {
        "program": f"mffit {mffit.__version__}",
        "use": f"{use}, for simulations with turn slip {TURN_SLIP[use]}",
        "configuration": _settings(config),
        **_inputs(config),
    }
    rig = {RIG + name: tir.Quantity(value, u, UNITS[name]) for name, (value, u) in fitted.rig.items()}
    return tyre.annotate(measured={**measured.quantities(), **rig}, provenance=provenance)


def use_of(tyre: Tyre) -> str | None:
    """Which use a built file is for, "turn-slip", "normal" or "both", as its provenance says; None for files from elsewhere."""
    said = tyre.provenance.get("use") or tyre.provenance.get("configuration", "")
    found = re.match(r"(?:spin\.exact )?(turn-slip|normal|both)\b", said)
    return found[1] if found else None


def rig_of_build(tyre: Tyre, config: Config) -> RigFaults | None:
    """The rig errors that the build found, if the file was fitted to these very sweeps; None otherwise."""
    if not fitted_to(tyre, config):
        return None
    found = {name: tyre.measured[RIG + name].value for name in FAULT_NAMES if RIG + name in tyre.measured}
    return RigFaults(**{"backlash_deg": config.rig.backlash_deg, **found}) if found else None


def fitted_to(tyre: Tyre, config: Config) -> bool:
    """Whether a build fitted the file to these very sweeps."""
    of_file = {name: digest for name, digest in tyre.provenance.items() if name.startswith("input ")}
    return bool(of_file) and of_file == _inputs(config)


def known_of_model(tyre: Tyre, config: Config, path: str | Path) -> Inexactness | None:
    """What is known of a model's coefficients beside ``model.u_coefficients``; None if nothing is.

    Fitted to these very sweeps they may move again; of a build on other sweeps its posterior, kept in result.json beside
    the file, says how far.
    """
    if fitted_to(tyre, config):
        return refitted(tyre, curved=config.rig.type == "rotating-disk")
    if config.model.u_coefficients:
        return None
    try:
        result = json.loads((Path(path).parent / "result.json").read_text(encoding="utf-8"))
        posterior, values = result["fit"]["posterior"], result["fit"]["coefficients"]
        rows = [k for k, name in enumerate(posterior["names"]) if name in values]
        names = [posterior["names"][k] for k in rows]
        covariance = np.array(posterior["covariance"], dtype=float)[np.ix_(rows, rows)]
        expected = np.array([float(values[name]["value"]) for name in names])
    except (OSError, ValueError, KeyError, TypeError, IndexError):
        return None
    of_file = np.array([float(tyre[name]) for name in names])
    if not names or not np.allclose(of_file, expected, rtol=1e-4, atol=1e-9):
        return None
    return correlated(names, of_file, covariance)


def _inputs(config: Config) -> dict[str, str]:
    """The hashes of the inputs as a property file's provenance: ASCII, and no colon in a name."""
    return {f"input {quote(name, safe=PLAIN)}": known for name, known in input_hashes(config).items()}


def _settings(config: Config) -> str:
    spin = config.spin
    return f"spin.exact {spin.exact}, spin.pecp1 {spin.pecp1}, camber stiffness by {config.camber_stiffness.method}"
