"""``mffit predict``, and ``prediction.json``, the file in a build's folder from which it predicts."""

from __future__ import annotations

import base64
import json
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import tir
from mffit.errors import InputError
from mffit.linearised.combined import Combinations, planned
from mffit.linearised.components import Components
from mffit.linearised.inputs import Input
from mffit.linearised.smooth import SmoothFunctions
from mffit.output import folder_of_build
from mffit.points import Points
from mffit.points.levels import SPEED
from mffit.points.points import of_si
from mffit.prediction.conditions import PATH, checked, read_conditions
from mffit.prediction.predictor import MissedChannel, Predictor
from mffit.quantities import CHANNELS, COLUMNS
from mffit.rig_errors import BY_NAME as ERROR_OF
from tir import TirWarning, Tyre
from tir.envelope import RANGES
from tir.errors import counted, listed
from tir.parameters import BY_NAME

FILE = "prediction.json"
ABOUT = "What mffit predict needs; arrays are base64 of little-endian numbers, row after row."


def write(path: Path, found: Predictor, file: str, fitted: str) -> None:
    """Write a predictor; ``file`` names the plain property file in the same folder, ``fitted`` that of the fitted model."""
    content = {
        "about": ABOUT,
        "file": file,
        "fitted": fitted,
        "phi_t_per_m": found.path,
        "coefficients": found.names,
        "zeros": dict(found.zeros),
        "beside": dict(found.beside),
        "setups": dict(found.setups),
        "V_range_mps": found.V_range,
        "T_range_degC": found.T_range,
        "lowest_load_N": found.lowest_load,
        "stated": _text(found.stated),
        "channels": {
            name: {
                "inputs": [asdict(one) for one in own.smooth.inputs],
                "nodes": own.smooth.nodes.tolist(),
                "sign": own.smooth.sign,
                "components": asdict(own.components),
                "missed": own.missed.tolist(),
                "root": _text(own.root),
                "noise": own.noise,
                "size": own.size,
                "growth": own.growth.tolist(),
                "tested": _text(own.combinations.tested),
                "strays": _text(own.combinations.strays),
                "proven": own.is_proven,
            }
            for name, own in found.channels.items()
        },
    }
    path.write_text(json.dumps(content, allow_nan=False) + "\n", encoding="utf-8")


def load(folder: Path) -> tuple[Predictor, Tyre, Tyre]:
    """The predictor, the plain property file and that of the fitted model, from the folder of a build.

    Raises
    ------
    InputError
        The folder has no sound prediction.json of a build.
    TirError
        A property file of the build is missing or damaged.
    """
    folder = folder_of_build(folder)
    path = folder / FILE
    if not path.exists():
        sentence = (
            f"has no {FILE}; name the folder of a build, and build again if it is of an earlier version"
        )
        raise InputError(sentence, file=folder)
    try:
        content = json.loads(path.read_text(encoding="utf-8"), parse_constant=_refuse)
        known, names = _predictor(content), [str(content[key]) for key in ("file", "fitted")]
    except (OSError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError):
        raise InputError("is not as a build writes it; build the tyre again", file=path) from None
    file, fitted = (tir.read(folder / name) for name in names)
    return known, file, fitted


def predict(folder: str | Path, conditions: str | Path | pd.DataFrame) -> pd.DataFrame:
    """Forces at conditions, with standard uncertainties (k = 1).

    Parameters
    ----------
    folder : folder of a build
    conditions : table, or its path, with the columns ``alpha_deg``, ``gamma_deg`` and ``Fz_N``, in ISO-W axes; ``kappa``,
        ``p_kPa``, ``V_mps``, ``T_degC`` and, for a disc, ``phi_t_per_m`` are optional

    Returns
    -------
    DataFrame
        The conditions in the units of their names, and for each fitted channel, here Fy: ``Fy_N``, the force of the plain file;
        ``u_Fy_N``, the standard deviation of a reading of a new run around it; ``Fy_best_N``, the best estimate, with the
        estimated model error; ``u_Fy_best_N``, its standard uncertainty as the tyre's mean force; ``u_Fy_run_N``, the standard
        deviation of a reading of a new run around it; ``u_Fy_setup_N``, the same after the rig was set up anew. Columns with
        these names in the conditions are replaced.

    Raises
    ------
    InputError
        The folder is not that of a build, or the table lacks a column, or has a value that is not a number or is impossible.

    Warns
    -----
    TirWarning
        A condition is outside the ranges of the property file, a speed is outside the tested ones, or conditions were never
        tested together.
    """
    known, tyre, fitted = load(Path(folder))
    table = checked(conditions) if isinstance(conditions, pd.DataFrame) else read_conditions(Path(conditions))
    found = known.predict(tyre, fitted, table)
    for sentence in (
        *_beyond_ranges(known, tyre, table),
        *_never_combined(known, known.points(tyre, table), found),
    ):
        warnings.warn(sentence, TirWarning, stacklevel=2)
    return found


def _never_combined(known: Predictor, points: Points, found: pd.DataFrame) -> Iterator[str]:
    """A sentence if it is the largest part of an uncertainty that conditions were never tested together."""
    apart = known.never_combined(points, found)
    rows = [row for row, names in enumerate(apart) if names]
    if rows:
        (names, _), *_ = Counter(apart[row] for row in rows).most_common(1)
        yield (
            f"{listed([COLUMNS[name] for name in names])} were tested, but never together as in {len(rows)} of "
            f"{counted(len(points), 'condition')}, first in row {rows[0] + 1}: the uncertainty there is that of an untested "
            "combination; run it if it matters"
        )


def _beyond_ranges(known: Predictor, tyre: Tyre, table: pd.DataFrame) -> Iterator[str]:
    """A sentence for each condition that leaves the range of the property file: force and uncertainty are extrapolated there.

    Speed, temperature and path curvature have no range in a file; those of the test count. Temperature is held to its ends; a
    speed that is not stated is that of the test.
    """
    points = known.points(tyre, table)
    ranges = {
        name: tuple(tyre[key] * of_si(name) for key in keys)
        for name, keys in zip(("Fz_N", "gamma_deg", "p_kPa", "alpha_deg", "kappa"), RANGES, strict=True)
    }
    of_file = "the range of the property file", "no reading supports force or uncertainty there"
    nearest, words = "the force is that at the nearest of them", dict.fromkeys(ranges, of_file)
    if "V_mps" in table:
        points = points.replace(V=table["V_mps"].to_numpy(dtype=float))
        ranges["V_mps"], words["V_mps"] = known.V_range, ("the tested speeds", of_file[1])
        if known.follows_speed:
            words["V_mps"] = "the tested speeds", nearest
    if known.T_range is not None:
        ranges["T_degC"] = known.T_range
        words["T_degC"] = "the tested temperatures", nearest
    if known.curved:
        ranges[PATH] = (-known.sharpest, known.sharpest)
        words[PATH] = "the tested path curvature", of_file[1]
    for name, (low, high) in ranges.items():
        values = points.phi_t if name == PATH else points.condition(name)
        slack = SPEED.tolerance * high if name == "V_mps" else 1e-6 * (high - low)
        rows = np.flatnonzero((values < low - slack) | (values > high + slack))
        if len(rows):
            what, so = words[name]
            yield (
                f"{name} is outside {what}, {' to '.join(dict.fromkeys((f'{low:.4g}', f'{high:.4g}')))}, in {len(rows)} of "
                f"{counted(len(points), 'condition')}, first in row {rows[0] + 1}: {so}"
            )


def _predictor(content: dict[str, Any]) -> Predictor:
    names, channels, T_range = tuple(content["coefficients"]), content["channels"], content["T_range_degC"]
    if not (set(names) <= {*BY_NAME, *ERROR_OF} and set(channels) <= set(CHANNELS)):
        raise ValueError("an unknown name")
    return Predictor(
        path=float(content["phi_t_per_m"]),
        names=names,
        channels={name: _channel(own, len(names)) for name, own in channels.items()},
        V_range=(float(content["V_range_mps"][0]), float(content["V_range_mps"][1])),
        T_range=None if T_range is None else (float(T_range[0]), float(T_range[1])),
        lowest_load=float(content["lowest_load_N"]),
        stated=_array(content["stated"], len(names)),
        **{
            key: {ERROR_OF[name].name: float(value) for name, value in content[key].items()}
            for key in ("zeros", "beside", "setups")
        },
    )


def _channel(own: dict[str, Any], coefficients: int) -> MissedChannel:
    inputs = tuple(Input(**{**one, "averaged": tuple(one["averaged"])}) for one in own["inputs"])
    shape = [len(inputs[i].settings()) for i in planned(inputs)]
    tested, strays = (_array(own[key], 1).reshape(shape) for key in ("tested", "strays"))
    components = Components(**{**own["components"], "lengths": tuple(own["components"]["lengths"])})
    missed = np.array(own["missed"], dtype=float)
    nodes = np.array(own["nodes"], dtype=float).reshape(len(missed), len(inputs))
    return MissedChannel(
        smooth=SmoothFunctions(inputs, nodes, np.array(components.lengths), int(own["sign"])),
        components=components,
        missed=missed,
        root=_array(own["root"], len(missed) + coefficients),
        noise=float(own["noise"]),
        size=float(own["size"]),
        growth=np.array(own["growth"], dtype=float).reshape(len(inputs)),
        combinations=Combinations(inputs, tested > 0.0, strays),
        is_proven=bool(own["proven"]),
    )


def _refuse(constant: str) -> float:
    raise ValueError(f"{constant} is no number")


def _text(values: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")


def _array(text: str, rows: int) -> np.ndarray:
    values = np.frombuffer(base64.b64decode(text), dtype="<f4").astype(float)
    if not np.all(np.isfinite(values)):
        raise ValueError("a number is not finite")
    return values.reshape(rows, len(values) // max(rows, 1))
