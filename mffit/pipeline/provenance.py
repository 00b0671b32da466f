"""What a property file says of its making, written and read back."""

from __future__ import annotations

import re
from urllib.parse import quote

import mffit
import tir
from mffit.config import Config
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
    of_file = {name: digest for name, digest in tyre.provenance.items() if name.startswith("input ")}
    if not of_file or of_file != _inputs(config):
        return None
    found = {name: tyre.measured[RIG + name].value for name in FAULT_NAMES if RIG + name in tyre.measured}
    return RigFaults(**{"backlash_deg": config.rig.backlash_deg, **found}) if found else None


def _inputs(config: Config) -> dict[str, str]:
    """The hashes of the inputs as a property file's provenance: ASCII, and no colon in a name."""
    return {f"input {quote(name, safe=PLAIN)}": known for name, known in input_hashes(config).items()}


def _settings(config: Config) -> str:
    spin = config.spin
    return f"spin.exact {spin.exact}, spin.pecp1 {spin.pecp1}, camber stiffness by {config.camber_stiffness.method}"
