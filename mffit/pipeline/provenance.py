"""What a property file says of its making, written and read back."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from urllib.parse import quote

import numpy as np

import mffit
import tir
from mffit.config import Config, declared_faults
from mffit.diagnosis.inexact import Inexactness, correlated, refitted
from mffit.fit import FitResult
from mffit.measured import Measured
from mffit.pipeline.inputs import input_hashes
from mffit.rig_errors import BY_NAME as RIG_ERRORS
from mffit.rig_errors import Faults
from tir import Tyre

PROGRAM = "program"
"""Which version wrote a file, among its provenance."""
RIG = "rig."
"""What opens the name of a rig error among a file's measured quantities."""
TURN_SLIP = {"turn-slip": "on", "normal": "off", "both": "on or off"}
"""What each use of a file means for the simulation's turn slip."""
PLAIN = " /\\!#$&'()+,;=@[]{}~"
"""What may stand in a file's name, beside letters and digits, without being written as %XX in a property file."""


Annotate = Callable[[Tyre, str], Tyre]
"""The tyre, of a use, with its measured quantities and provenance as structured comments."""


def annotator(config: Config, measured: Measured, fitted: FitResult) -> Annotate:
    """What a build says in each of its files; the inputs are hashed once for all of them."""
    inputs = _inputs(config)
    rig = {
        RIG + name: tir.Quantity(value, u, RIG_ERRORS[name].unit) for name, (value, u) in fitted.rig.items()
    }

    def annotated(tyre: Tyre, use: str) -> Tyre:
        provenance = {
            PROGRAM: f"mffit {mffit.__version__}",
            "use": f"{use}, for simulations with turn slip {TURN_SLIP[use]}",
            "configuration": _settings(config),
            **inputs,
        }
        return tyre.annotate(measured={**measured.quantities(), **rig}, provenance=provenance)

    return annotated


def use_of(tyre: Tyre) -> str | None:
    """Which use a built file is for, "turn-slip", "normal" or "both", as its provenance says; None for files from elsewhere."""
    said = tyre.provenance.get("use") or tyre.provenance.get("configuration", "")
    found = re.match(r"(?:spin\.exact )?(turn-slip|normal|both)\b", said)
    return found[1] if found else None


def rig_of_build(tyre: Tyre, config: Config) -> Faults | None:
    """The rig errors that a build on these very sweeps found; None if its file does not say."""
    found = {name: tyre.measured[RIG + name].value for name in RIG_ERRORS if RIG + name in tyre.measured}
    return declared_faults(config.rig).replace(**found) if found else None


def fitted_to(tyre: Tyre, config: Config) -> bool:
    """Whether a build fitted the file to these very sweeps."""
    of_file = {name: digest for name, digest in tyre.provenance.items() if name.startswith("input ")}
    return bool(of_file) and of_file == _inputs(config)


def known_of_model(
    tyre: Tyre, config: Config, path: Path | None, *, same: bool, fresh: bool
) -> tuple[Inexactness | None, bool]:
    """What is known of a model's coefficients beside ``model.u_coefficients``, None if nothing is; and whether it was fitted
    to these very sweeps.

    Fitted to these sweeps they may move again; of a build on other sweeps its posterior says how far. A file counts as a
    build's only if result.json beside it has the same values: it may have been edited since.

    Parameters
    ----------
    tyre, config : the model and what it is compared with
    path : where the model was read; None if it was not
    same : whether a build fitted it to these very sweeps, see :func:`fitted_to`
    fresh : whether it was fitted just now
    """
    posterior = None if path is None else posterior_of(tyre, path)
    if same and (fresh or posterior is not None):
        return refitted(tyre, curved=config.rig.on_disc), True
    return (None if config.model.u_coefficients else posterior), False


def posterior_of(tyre: Tyre, path: Path) -> Inexactness | None:
    """The posterior of the build that wrote a file; None if the file is none of a build or has other values."""
    try:
        result = json.loads((path.parent / "result.json").read_text(encoding="utf-8"))
        posterior, values = result["fit"]["posterior"], result["fit"]["coefficients"]
        rows = [k for k, name in enumerate(posterior["names"]) if name in values]
        names = [posterior["names"][k] for k in rows]
        covariance = np.array(posterior["covariance"], dtype=float)[np.ix_(rows, rows)]
        expected = {name: float(row["value"]) for name, row in values.items()}
    except (OSError, ValueError, KeyError, TypeError, IndexError):
        return None
    same = all(np.isclose(float(tyre[n]), v, rtol=1e-6, atol=1e-12) for n, v in expected.items())
    return correlated(names, np.array([expected[n] for n in names]), covariance) if names and same else None


def _inputs(config: Config) -> dict[str, str]:
    """The hashes of the inputs as a property file's provenance: ASCII, and no colon in a name."""
    return {f"input {quote(name, safe=PLAIN)}": known for name, known in input_hashes(config).items()}


def _settings(config: Config) -> str:
    spin = config.spin
    return f"spin.exact {spin.exact}, spin.pecp1 {spin.pecp1}, camber stiffness by {config.camber_stiffness.method}"
