"""The measured points of a project as columns for a page."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95
from mffit.fit import FitResult
from mffit.points import Points, concatenate, levels
from mffit.points.noise import stating
from mffit.quantities import CHANNELS, COLUMNS, CONDITIONS, MODEL, QuantityName
from mffit.rig import Simulation
from mffit.viewer import constants
from mffit.viewer.controls import in_si
from mffit.viewer.packing import packed, rounded
from tir.codegen.program import INPUTS, LOADED

MEASURED_ONLY = {"T": CONDITIONS["T_degC"], "t": CONDITIONS["t_s"]}
"""Conditions of points that are not inputs of the model."""
FACETS = {
    name: field for name in INPUTS for field in levels.KINDS if MODEL[name] is CONDITIONS[COLUMNS[field]]
}
"""Field of the points by input of the model, where set-points have levels."""
BITS_OF_BANDS = 12
"""Bits of their numbers: finer than a pixel."""


def axis_quantities() -> dict[str, QuantityName]:
    """Everything that an axis of the page can show, except residuals."""
    radius = {LOADED: CHANNELS[LOADED]._replace(unit="mm")}
    return {name: MODEL[name] for name in INPUTS} | MEASURED_ONLY | CHANNELS | radius


def delivered(fitted: FitResult) -> Simulation:
    """The tyre of the file on the rig as fitted: radii and rolling resistance are fitted after the search."""
    return replace(fitted.simulation, values=dict(fitted.tyre.values))


def columns(points: Points, excluded: Points | None, fitted: FitResult | None) -> dict[str, object]:
    """The points as the tyre felt them, by column, with what the rig read; then those that are left out by hand.

    Conditions and readings are in SI; missing readings are NaN, and channels without a reading are left out. ``shift`` is what
    the rig read beyond what the tyre felt, of the columns that differ; ``more`` the lines of a point after its first.
    ``fitted`` is the number of points that the fit has. Before the fit, None, the readings are shown as they are.
    """
    read, at_tyre = _read_and_felt(points, excluded, fitted)
    groups, levels_of = facets(read)
    outliers = () if fitted is None else fitted.outliers
    named = {
        "u": {
            name: np.where(stating(points.u(name)), points.u(name), np.nan)
            for name in read.measured
            if stating(points.u(name)).any()
        },
        "unused": {
            name: np.array(sorted(o.row for o in outliers if o.channel == name), dtype=int)
            for name in read.measured
        },
        "of": levels_of,
        **_bands(at_tyre, len(points), fitted),
    }
    found = _felt(read, at_tyre) | {
        "mount": read.mount,
        "file": read.file,
        "line": read.line,
        "more": read.last_line - read.line,
    }
    found |= {f"{kind}.{name}": column for kind, part in named.items() for name, column in part.items()}
    return {
        **packed(found),
        "count": len(read),
        "fitted": len(points),
        "measured": read.measured,
        "files": list(read.files),
        "facets": groups,
    }


def differing(
    points: Points, excluded: Points | None, fitted: FitResult, other: FitResult
) -> dict[str, object]:
    """Those of the :func:`columns` that differ between another fit and ``fitted``, packed."""
    known, found = (_felt(*_read_and_felt(points, excluded, one)) for one in (fitted, other))
    found |= {name: np.zeros_like(column) for name, column in known.items() if name not in found}
    return dict(
        packed({name: x for name, x in found.items() if name not in known or _differ(x, known[name])})
    )


def _read_and_felt(
    points: Points, excluded: Points | None, fitted: FitResult | None
) -> tuple[Points, Points]:
    parts = [points] if excluded is None else [points, excluded]
    read = concatenate(parts)
    if fitted is None:
        return read, read
    simulation = delivered(fitted)
    return read, concatenate([simulation.felt(part) for part in parts])


def _felt(read: Points, at_tyre: Points) -> dict[str, np.ndarray]:
    """Conditions and channels as the tyre felt them, and what the rig read beyond that."""
    own, rig = _shown(at_tyre), _shown(read)
    shift = {name: column - own[name] for name, column in rig.items() if _differ(column, own[name])}
    return own | {f"shift.{name}": column for name, column in shift.items()}


def _bands(felt: Points, n: int, fitted: FitResult | None) -> dict[str, dict[str, np.ndarray]]:
    """At some of the first n points, by channel: the model error, and the half width of the 95 % band around both.

    They change smoothly, so that :data:`~mffit.viewer.constants.POINTS_OF_BANDS` points spread over all are enough.
    """
    if fitted is None or fitted.prediction is None:
        return {}
    rows = np.unique(np.linspace(0, n - 1, min(n, constants.POINTS_OF_BANDS)).astype(int))
    tyre = Simulation.of(fitted.tyre, turn_slip=fitted.simulation.turn_slip)
    at = felt.select(rows, with_table=False)
    if fitted.speed is not None:  # the readings are shown as at the speed of the file
        at = at.replace(V=np.full(len(rows), fitted.speed.V_ref))
    found = fitted.prediction.forces(tyre, tyre, at)
    return {
        "band": {"rows": rows},
        "missed": {name: rounded(one.best - one.file, BITS_OF_BANDS) for name, one in found.items()},
        "half": {
            name: rounded(COVERAGE_FACTOR_95 * np.sqrt(one.of_run), BITS_OF_BANDS)
            for name, one in found.items()
        },
    }


def facets(points: Points) -> tuple[list[dict[str, Any]], dict[str, np.ndarray]]:
    """Groups of points by their set-points: name and words of the groups; and by name the group (n,) of each point, -1 for none.

    ``inputs`` are those of the model that the groups share; points of a curve over another input are in the same groups.
    ``is_run`` marks the groups that do not separate curves.
    """
    inputs = _arrays(points)
    found, groups = [], {}
    for name, field in FACETS.items():
        meant = levels.labels_of_setting(points, field)
        of = _ranks(meant) - int(np.any(meant == levels.NO_LEVEL))
        medians = [float(np.median(inputs[name][of == k])) for k in range(of.max(initial=-1) + 1)]
        found.append(_facet(name, MODEL[name].word, [_said(MODEL[name], x) for x in medians], [name]))
        groups[name] = of
    for name, word, of, words, shared in (
        ("path", "path", _ranks(points.phi_t), [_path(x) for x in np.unique(points.phi_t)], ["phi_t"]),
        ("direction", "rolling", (points.direction > 0).astype(int), ["backward", "forward"], ["Vx"]),
        ("mount", "mount", (points.mount > 0).astype(int), ["flipped", "normal"], []),
        ("sweep", "run", points.sweep, points.sweep_names, []),
    ):
        found.append(_facet(name, word, words, shared))
        groups[name] = of
    return found, groups


def _shown(points: Points) -> dict[str, np.ndarray]:
    """Conditions and measured channels by name."""
    return _arrays(points) | {name: points.channel(name) for name in points.measured}


def _differ(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two columns differ in a page, which has single floats."""
    return not np.array_equal(one.astype(np.float32), other.astype(np.float32), equal_nan=True)


def _arrays(points: Points) -> dict[str, np.ndarray]:
    """The inputs of the model and the other conditions of points (n,), SI."""
    known = {"pressure": points.p, "Vx": points.Vx}
    inputs = {name: known[name] if name in known else getattr(points, name) for name in INPUTS}
    return inputs | {name: getattr(points, name) for name in MEASURED_ONLY}


def _facet(name: str, word: str, words: Sequence[str], inputs: Sequence[str]) -> dict[str, Any]:
    return {
        "name": name,
        "word": word,
        "labels": list(words),
        "inputs": list(inputs),
        "is_run": name == "sweep",
        "as_range": name in FACETS and len(words) > constants.MOST_CHIPS,
    }


def _ranks(values: np.ndarray) -> np.ndarray:
    return np.unique(values, return_inverse=True)[1]


def _said(quantity: QuantityName, x: float) -> str:
    shown = round(x / in_si(quantity.unit), 2)
    digits = 3 if abs(shown) < 1000 else 4
    return f"{float(f'{shown:.{digits}g}') + 0.0:g} {quantity.unit_behind}".strip()


def _path(phi_t: float) -> str:
    if not phi_t:
        return "straight"
    return f"R {abs(1.0 / phi_t):.3g} m {'left' if phi_t < 0.0 else 'right'}"
