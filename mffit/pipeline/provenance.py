"""The origin of a property file: what its comments state, written and read."""

import json
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

import numpy as np

import tir
from mffit.config import Config
from mffit.diagnosis.inexact import refitted
from mffit.diagnosis.search import Asked
from mffit.fit import FitResult, plain_use
from mffit.fit.influences.nuisances import of_run
from mffit.made import Made
from mffit.measured import Measured
from mffit.numbers import Numbers
from mffit.output import BUILT
from mffit.pipeline.inputs import input_hashes
from mffit.quantities import DIRECT, KEYS
from mffit.results import TEMPERATURE
from mffit.rig_errors import error_of, unit_of
from mffit.suspicion import Trust
from tir import Tyre
from tir.errors import listed
from tir.record import DISTRUSTED
from tir.temperature import CURVED_BY, HIGHEST, LOWEST, RIG

PROGRAM = "program"
"""Key of the version that wrote a file."""
BY_HAND = "set by hand"
"""Key of what the engineer set in [coefficients]."""
METHOD = "method"
"""Key of the number of the method."""
SOURCE = "source"
"""Key of the digest of the program's own files."""
PATHS = "path curvature"
"""Key of the path curvatures that were run, for which a property file has no range."""
DIGITS = 16
"""Digits of a hash in a property file, whose lines are to be short; result.json has all 64."""
TURN_SLIP = {"turn-slip": "on", "normal": "off", "both": "on or off"}
"""Setting of the simulation's turn slip for each use of a file."""
PLAIN = " /\\!#$&'()+,;=@[]{}~"
"""Characters of file names that comments contain without %XX, in addition to letters and digits."""

Annotate = Callable[[Tyre, str], Tyre]
"""Adds measured quantities and provenance as structured comments to the tyre for a use."""


def annotator(config: Config, made: Made, measured: Measured, fitted: FitResult, trust: Trust) -> Annotate:
    """The annotation of all files of a build."""
    inputs = _of_inputs(made.inputs)
    plain = plain_use(config)

    def annotated(tyre: Tyre, use: str) -> Tyre:
        special = fitted.temperature if use == TEMPERATURE else None
        use = plain if special else use
        provenance = {
            PROGRAM: f"{made.program} {made.version}",
            METHOD: str(made.method),
            SOURCE: made.source[:DIGITS],
            "use": f"{use}, for simulations with turn slip {TURN_SLIP[use]}",
            "quantities": _quantities(measured),
            PATHS: _paths(fitted),
            "configuration": _settings(config),
            **_by_hand(fitted),
            **inputs,
        }
        quantities = {**measured.quantities(), **_of_rig(fitted.rig if special is None else special.rig)}
        if (speed := fitted.speed) is not None:
            low, high = speed.V_range
            scaled = listed([error.acts_on[0] for name in speed.terms if (error := error_of(name))])
            provenance["speed"] = (
                f"holds at {speed.V_ref:g} m/s, elsewhere {scaled} times 1 + k (V - {speed.V_ref:g}), with "
                f"{', '.join(RIG + name for name in speed.terms)}, tested from {low:.3g} to {high:.3g} m/s"
            )
        if special is not None:
            low, high = special.T_range
            quantities |= {LOWEST: tir.Quantity(low, 0.0, "degC"), HIGHEST: tir.Quantity(high, 0.0, "degC")}
            provenance["temperature"] = (
                f"holds at {special.T_ref:g} degC; elsewhere LMUY, LKY, LKYC times 1 + k (T - {special.T_ref:g}) with "
                "rig.k_T_grip_per_K, _stiffness_, _camber_"
                + (
                    "; LMUY also + rig.k_T_grip_per_K2 times the square"
                    if set(CURVED_BY.values()) & special.terms.keys()
                    else ""
                )
            )
        measured_as = fitted.coefficients["PECP1"].origin
        status = {"PECP1": measured_as} if "+-" in tyre.status.get("PECP1", "") else {}
        return marked(tyre.annotate(status=status, measured=quantities, provenance=provenance), trust.reasons)

    return annotated


def marked(tyre: Tyre, against: Sequence[str]) -> Tyre:
    """The tyre with the reasons against trusting it in its comments, and without those of an earlier judgement."""
    kept = {key: text for key, text in tyre.provenance.items() if key != DISTRUSTED}
    reasons = {DISTRUSTED: "; ".join(against)} if against else {}
    return replace(tyre, provenance={**reasons, **kept})


def _of_rig(rig: Mapping[str, tuple[float, float]]) -> dict[str, tir.Quantity]:
    """Rig numbers as quantities of a file, by the name that they have there."""
    return {
        RIG + quote(name, safe=PLAIN): tir.Quantity(value, u, unit_of(name))
        for name, (value, u) in rig.items()
        if not of_run(name)
    }


def use_of(tyre: Tyre) -> str | None:
    """The use of a built file, "turn-slip", "normal" or "both", from its provenance; None for other files."""
    stated = tyre.provenance.get("use") or tyre.provenance.get("configuration", "")
    found = re.match(r"(?:spin\.exact )?(turn-slip|normal|both)\b", stated)
    return found[1] if found else None


def rig_of_build(tyre: Tyre) -> dict[str, float] | None:
    """The rig errors that the build found, of the rig or of a set-up, from the comments of its file; None without them."""
    found = {unquote(n.removeprefix(RIG)): q.value for n, q in tyre.measured.items() if n.startswith(RIG)}
    return {name: value for name, value in found.items() if error_of(name)} or None


def terms_beside(tyre: Tyre) -> dict[str, float]:
    """A file's terms over temperature, pressure and speed, and the conditions at which it holds, by rig number."""
    rig = rig_of_build(tyre) or {}
    counted = {
        name: error.counts_from for name in rig if (error := error_of(name)) and error.counts_from in rig
    }
    return {name: rig[name] for name in {*counted, *counted.values()}}


def fitted_to(tyre: Tyre, config: Config) -> bool:
    """Whether a build fitted the file to the present sweeps."""
    of_file = _inputs_stated(tyre)
    return bool(of_file) and of_file == _of_inputs(input_hashes(config))


def known_of_model(tyre: Tyre, config: Config, path: Path | None, *, same: bool, fresh: bool) -> Asked:
    """The question of a diagnosis with what is known of a model from its build.

    Coefficients fitted to the present sweeps (``same``, see :func:`fitted_to`, or ``fresh``: just now) are fitted again; those
    of a build on other sweeps have that build's posterior. ``model.u_coefficients`` takes precedence over a posterior. A file
    that was edited since, so that the result.json next to it has other values, has no posterior; the tyre misses the formula of
    its build all the same.
    """
    result = {} if path is None else _result_beside(path)
    built = _has_values(tyre, result)
    posterior = _posterior(result) if built else None
    if same and (fresh or posterior is not None):
        known = {name: entry.u for name, entry in config.coefficients.items() if entry.u is not None}
        return Asked(coefficients=refitted(tyre, curved=config.rig.on_disc, stated=known), seen=True)
    left = _left(result) if built or _has_inputs(tyre, result) else {}
    return Asked(coefficients=None if config.model.u_coefficients else posterior, left=left)


def posterior_of(tyre: Tyre, path: Path) -> Numbers | None:
    """The posterior of the build that wrote a file; None if no build did or the file was edited."""
    return _posterior(_result_of(tyre, path))


def missed_by_file(tyre: Tyre, path: Path) -> dict[str, float]:
    """By channel, what the build that wrote a file states that it misses; empty if no build did or the file was edited."""
    return _left(_result_of(tyre, path))


def was_edited(tyre: Tyre, path: Path) -> bool:
    """Whether a file of the build whose result.json is next to it has other values."""
    result = _result_beside(path)
    return _has_inputs(tyre, result) and not _has_values(tyre, result)


def _result_of(tyre: Tyre, path: Path) -> dict[str, Any]:
    """The result of the build that wrote a file; empty if no build did or the file was edited."""
    result = _result_beside(path)
    return result if _has_values(tyre, result) else {}


def _result_beside(path: Path) -> dict[str, Any]:
    """The result.json next to a file; empty if it cannot be read."""
    try:
        return dict(json.loads((path.parent / BUILT).read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        return {}


def _has_values(tyre: Tyre, result: Mapping[str, Any]) -> bool:
    """Whether a file has the coefficients of a result."""
    try:
        values = {name: float(row["value"]) for name, row in result["fit"]["coefficients"].items()}
    except (ValueError, KeyError, TypeError, AttributeError):
        return False
    return all(np.isclose(float(tyre[n]), v, rtol=1e-6, atol=1e-12) for n, v in values.items())


def _has_inputs(tyre: Tyre, result: Mapping[str, Any]) -> bool:
    """Whether the comments of a file name the inputs of a result, as they do however the file was edited."""
    try:
        return _of_inputs(result["made"]["inputs"]) == _inputs_stated(tyre)
    except (KeyError, TypeError, AttributeError):
        return False


def _inputs_stated(tyre: Tyre) -> dict[str, str]:
    """Digests of the inputs in the comments of a file."""
    return {name: digest for name, digest in tyre.provenance.items() if name.startswith("input ")}


def _posterior(result: Mapping[str, Any]) -> Numbers | None:
    """The posterior of the coefficients that a result states; None without one."""
    try:
        posterior, values = result["fit"]["posterior"], result["fit"]["coefficients"]
        rows = [k for k, name in enumerate(posterior["names"]) if name in values]
        names = [posterior["names"][k] for k in rows]
        covariance = np.array(posterior["covariance"], dtype=float)[np.ix_(rows, rows)]
    except (ValueError, KeyError, TypeError, IndexError):
        return None
    return Numbers.of(names, np.array([values[n]["value"] for n in names]), covariance) if names else None


def _left(result: Mapping[str, Any]) -> dict[str, float]:
    """By channel, the rms [N], [Nm] by which a built file misses the readings of its build beyond their stated noise.

    Readings of other runs contain it as well: the file holds for the mean of the runs.
    """
    try:
        found = result["fit"]["channels"]
        of_file = found | (result["fit"].get("runs") or {}).get("channels_without", {})
        noise = {name: row["rmse"] / row["over_noise"] for name, row in found.items() if row["over_noise"]}
        left = {name: row["rmse"] ** 2 - noise.get(name, 0.0) ** 2 for name, row in of_file.items()}
    except (KeyError, TypeError, AttributeError):
        return {}
    return {name: math.sqrt(square) for name, square in left.items() if square > 0.0}


def _quantities(measured: Measured) -> str:
    """How each stated quantity is obtained, and how it enters the file."""
    known = {
        KEYS[name]: DIRECT[name] for name in KEYS if measured.nominal and getattr(measured.nominal, name)
    }
    return "; ".join(f"{key}: {q.how}{f', as {q.enters}' if q.enters else ''}" for key, q in known.items())


def _paths(fitted: FitResult) -> str:
    """The path curvatures of the points."""
    assert fitted.full is not None
    run = np.unique(fitted.full.problem.points.phi_t) + 0.0
    return f"tested at {listed([f'{phi_t:.6g}' for phi_t in run])} 1/m"


def _of_inputs(hashes: Mapping[str, str]) -> dict[str, str]:
    """Hashes of the inputs as entries of the provenance, whose names are ASCII without colons."""
    return {f"input {quote(name, safe=PLAIN)}": known[:DIGITS] for name, known in hashes.items()}


def _by_hand(fitted: FitResult) -> dict[str, str]:
    """What [coefficients] sets, as an entry of the provenance; empty if it sets nothing."""
    assert fitted.search is not None
    hand = fitted.search.hand
    return {BY_HAND: ", ".join(hand.said(name) for name in hand.names)} if hand.names else {}


def _settings(config: Config) -> str:
    spin = config.spin
    return f"spin.exact {spin.exact}, spin.pecp1 {spin.pecp1}, camber stiffness by {config.camber_stiffness.method}"
