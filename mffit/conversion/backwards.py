"""``mffit convert --to mf52``: a file of MF 6.2 as one of MF 5.2 or PAC2002, by a fit of the old formula to its forces."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

import tir
from mffit.conversion import mf52, wording
from mffit.conversion.convert import MISFIT, ORIGIN, camber_range
from mffit.conversion.grid import Conditions, Reach, conditions, loads, reach_of
from mffit.conversion.old_files import OF_62, OWN, old_completed, refuse_load_of_zero, refuse_no_numbers
from mffit.conversion.refit import UNBOUNDED, Fit
from mffit.conversion.result import ROUNDING, Conversion, misfits
from tir import Tyre
from tir.document import folded
from tir.outputs import outputs_of
from tir.parameters import BY_NAME
from tir.units import SI
from tir.writing import comment_text, entry, value_text

HEADERS: Mapping[str, Mapping[str, object]] = {
    "mf52": {"PROPERTY_FILE_FORMAT": "MF-TYRE", "TYPE": "CAR", "FITTYP": 6, "USE_MODE": 14},
    "pac2002": {"PROPERTY_FILE_FORMAT": "PAC2002", "USE_MODE": 4, "FE_METHOD": "NO"},
}
"""[MODEL] of the old files by their kind: the version, and combined forces by their coefficients. Relaxation (14) is asked for in
MF 5.2 only: Chrono, which reads PAC2002, computes no horizontal force by other modes than 1 to 4."""
FILE = {"FILE_TYPE": "tir", "FILE_VERSION": 3.0, "FILE_FORMAT": "ASCII"}
KINDS = {"mf52": "MF-Tyre 5.2", "pac2002": "PAC2002"}
KEYS: Mapping[str, str] = {
    "MODEL": "LONGVL VXLOW TYRESIDE",
    "DIMENSION": "UNLOADED_RADIUS WIDTH ASPECT_RATIO RIM_RADIUS RIM_WIDTH",
    "VERTICAL": "VERTICAL_STIFFNESS VERTICAL_DAMPING BREFF DREFF FREFF FNOMIN",
    "LONG_SLIP_RANGE": "KPUMIN KPUMAX",
    "SLIP_ANGLE_RANGE": "ALPMIN ALPMAX",
    "INCLINATION_ANGLE_RANGE": "CAMMIN CAMMAX",
    "VERTICAL_FORCE_RANGE": "FZMIN FZMAX",
    "SCALING_COEFFICIENTS": "LFZO LCX LMUX LEX LKX LHX LVX LGAX LCY LMUY LEY LKY LHY LVY LGAY LTR LRES LGAZ LXAL LYKA LVYKA LS "
    "LSGKP LSGAL LMX LVMX LMY",
    "LONGITUDINAL_COEFFICIENTS": "PCX1 PDX1 PDX2 PDX3 PEX1 PEX2 PEX3 PEX4 PKX1 PKX2 PKX3 PHX1 PHX2 PVX1 PVX2 RBX1 RBX2 RCX1 REX1 "
    "REX2 RHX1 PTX1 PTX2 PTX3",
    "OVERTURNING_COEFFICIENTS": "QSX1 QSX2 QSX3",
    "LATERAL_COEFFICIENTS": "PCY1 PDY1 PDY2 PDY3 PEY1 PEY2 PEY3 PEY4 PKY1 PKY2 PKY3 PHY1 PHY2 PHY3 PVY1 PVY2 PVY3 PVY4 RBY1 RBY2 "
    "RBY3 RCY1 REY1 REY2 RHY1 RHY2 RVY1 RVY2 RVY3 RVY4 RVY5 RVY6 PTY1 PTY2",
    "ROLLING_COEFFICIENTS": "QSY1 QSY2 QSY3 QSY4",
    "ALIGNING_COEFFICIENTS": "QBZ1 QBZ2 QBZ3 QBZ4 QBZ5 QBZ9 QBZ10 QCZ1 QDZ1 QDZ2 QDZ3 QDZ4 QDZ6 QDZ7 QDZ8 QDZ9 QEZ1 QEZ2 QEZ3 "
    "QEZ4 QEZ5 QHZ1 QHZ2 QHZ3 QHZ4 SSZ1 SSZ2 SSZ3 SSZ4",
}
"""Keys of an old file in the order of the MF-Tyre 5.2 manual, by section."""
OF_PAC2002 = {"OVERTURNING_COEFFICIENTS": "QSX4 QSX5 QSX6 QSX7 QSX8 QSX9 QSX10 QSX11"}
"""Keys that PAC2002 has in addition."""
OF_CHANNEL = {
    "Fx": ("LONGITUDINAL_COEFFICIENTS", "PT"),
    "Fy": ("LATERAL_COEFFICIENTS", "PT"),
    "Mz": ("ALIGNING_COEFFICIENTS", "SS"),
    "Mx": ("OVERTURNING_COEFFICIENTS", "-"),
}
"""Section of a channel's coefficients, and prefixes of those that do not affect its pure slip. The
side force comes before the moments, into which it enters."""


def to_old(path: str | Path, kind: str, given: Mapping[str, float] = MappingProxyType({})) -> Conversion:
    """The MF 5.2 or PAC2002 file that comes nearest to the forces of an MF 6.2 file, at its inflation pressure.

    Coefficients that mean the same stay. Those of a channel are fitted to its forces where the old formula gives others: those of
    camber alone if the upright wheel agrees, all otherwise.

    Parameters
    ----------
    path : the file, evaluated as its USE_MODE asks, on a straight path
    kind : ``"mf52"`` or ``"pac2002"``
    given : values [SI] of keys that it lacks

    Raises
    ------
    TirError
        If the file cannot be read, has no cornering stiffness, or gives forces that are not numbers.
    """
    tyre = tir.read(path, **given)
    refuse_load_of_zero(tyre.values, path)
    reach = reach_of(tyre.values, tyre.present)
    at = conditions(reach)
    channels = mf52.OldForces._fields
    read = outputs_of(channels, tyre.p, at._asdict(), turn_slip=tyre.turn_slip)
    goal = {name: np.array(np.broadcast_to(x, at.Fz.shape)) for name, x in zip(channels, read, strict=True)}
    refuse_no_numbers(goal, path)
    keys = _keys(kind)
    values = _start(tyre, keys) | _cornering_stiffness(tyre, reach) | camber_range(tyre, reach)
    values |= _relaxation(tyre, values, reach)
    refuse_no_numbers(_forces(at, values)._asdict(), path)
    fitted: list[str] = []
    for channel in OF_CHANNEL:
        stages = _stages(channel, keys, values, at, goal[channel])
        for fit in stages:
            values |= fit.solved(values, partial(_bounds, values))
        fitted += stages[-1].names if stages else []
    misfit = tuple(misfits(_forces(at, values), at, goal))
    return Conversion(
        path=Path(path),
        problems=tyre.problems,
        old=None,
        tyre=tyre,
        kind=KINDS[kind],
        text=_text(tyre, Path(path).name, kind, values, fitted, wording.worst(misfit)),
        reach=reach,
        misfit=misfit,
        fitted=tuple(fitted),
        held={},
    )


def _keys(kind: str) -> Mapping[str, list[str]]:
    """The keys of an old file by section."""
    more = OF_PAC2002 if kind == "pac2002" else {}
    return {section: f"{keys} {more.get(section, '')}".split() for section, keys in KEYS.items()}


def _forces(at: Conditions, values: Mapping[str, Any]) -> mf52.OldForces:  # plain or traced
    return mf52.forces(mf52.in_terms_of_62(values), *at)


def _start(tyre: Tyre, keys: Mapping[str, Sequence[str]]) -> dict[str, Any]:
    """The old values: those of the same name, at the pressure of the file, where the terms of pressure are 0."""
    known = {name: tyre[name] for names in keys.values() for name in names if name in tyre.values}
    values = old_completed({**known, "NOMPRES": tyre["INFLPRES"], "INFLPRES": tyre["INFLPRES"]})
    at_pressure = (float(tyre["INFLPRES"]) / float(tyre["NOMPRES"])) ** float(tyre["QSY8"])
    return values | {name: float(tyre[name]) * at_pressure for name in keys["ROLLING_COEFFICIENTS"]}


def _cornering_stiffness(tyre: Tyre, reach: Reach) -> dict[str, float]:
    """PKY1 and PKY2 nearest to the stiffness of the upright wheel over load, if PKY4 is not the 2 of the old formula.

    A fit that starts at those of 6.2 ends far off if PKY4 is negative, with which PKY1 has the other sign.
    """
    if tyre["PKY4"] == OF_62["PKY4"]:
        return {}
    Fz, Fz0 = loads(reach), float(tyre["FNOMIN"]) * float(tyre["LFZO"])
    wanted = np.asarray(tyre.state(Fz).K_ya) / (Fz0 * (float(tyre["LKY"]) or 1.0))

    def off(at: Mapping[str, float]) -> np.ndarray:
        return np.asarray(at["PKY1"] * np.sin(2.0 * np.arctan(Fz / (at["PKY2"] * Fz0))) - wanted)

    return _nearest(off, {"PKY1": float(wanted[np.argmax(np.abs(wanted))]), "PKY2": 2.0})


def _relaxation(tyre: Tyre, values: Mapping[str, Any], reach: Reach) -> dict[str, float]:
    """Coefficients of the old relaxation lengths nearest to those of the upright wheel over load."""
    Fz = loads(reach)
    state = tyre.state(Fz)
    wanted = np.concatenate([np.abs(state.sigma_x), np.abs(state.sigma_y)])

    def off(at: Mapping[str, float]) -> np.ndarray:
        p = mf52.in_terms_of_62({**values, **at})
        return np.asarray(np.concatenate(mf52.relaxation_lengths(p, Fz)) - wanted)

    return _nearest(off, {"PTX1": 1.0, "PTX2": 0.0, "PTX3": 0.0, "PTY1": 1.0, "PTY2": 2.0})


def _nearest(
    off: Callable[[Mapping[str, float]], np.ndarray], start: Mapping[str, float]
) -> dict[str, float]:
    """The coefficients with the least sum of squares of ``off``, by name."""
    import lmfit  # loads scipy.stats and matplotlib, so it is imported only on use

    def residual(at: lmfit.Parameters) -> np.ndarray:
        return off(at.valuesdict())

    found = lmfit.minimize(residual, lmfit.create_params(**start), method="least_squares")
    return dict(found.params.valuesdict())


def _stages(
    channel: str,
    keys: Mapping[str, Sequence[str]],
    values: Mapping[str, Any],
    at: Conditions,
    goal: np.ndarray,
) -> list[Fit]:
    """What is fitted after one another: nothing if the old formula gives the same, the coefficients of camber if it does so
    upright; else those of the upright wheel, those of camber, and all together."""
    section, others = OF_CHANNEL[channel]
    names = [name for name in keys[section] if not name.startswith(others)]
    by_camber = [name for name in names if name in mf52.SCALED_BY_CAMBER]
    upright, u = at.gamma == 0.0, at.u(goal)

    def force(at: Conditions, values: Mapping[str, Any]) -> Any:
        return getattr(_forces(at, values), channel)

    def everywhere(names: Sequence[str]) -> Fit:
        return Fit(names, partial(force, at), goal, u)

    off = np.abs(force(at, values) - goal) > ROUNDING * np.max(np.abs(goal))
    if not np.any(off):
        return []
    if by_camber and not np.any(off & upright):
        return [everywhere(by_camber)]
    alone = [name for name in names if name not in by_camber]
    here = Conditions(*(x[upright] for x in at))
    parts = [Fit(alone, partial(force, here), goal[upright], u[upright]), everywhere(by_camber)]
    return [*(parts if by_camber else []), everywhere(names)]


def _bounds(values: Mapping[str, Any], name: str) -> tuple[float, float]:
    """Those of a fit: they keep terms of camber that hardly differ from running away."""
    if name not in BY_NAME:
        return UNBOUNDED
    start, (lower, upper) = float(values[name]), BY_NAME[name].bounds
    return min(lower, start), max(upper, start)


def _text(
    tyre: Tyre, name: str, kind: str, values: Mapping[str, Any], fitted: Sequence[str], worst: str
) -> str:
    """The old file; comments say of every value whether it is that of the 6.2 file."""
    about = {ORIGIN: f"{name}, MF 6.2 at {float(tyre['INFLPRES']) / 1000.0:g} kPa", MISFIT: worst}
    lines = ["[MDI_HEADER]", *_entries(FILE)]
    for key, words in about.items():
        lines += folded(f"! provenance: {key}: {comment_text(words)}")
    lines += ["[UNITS]", *_entries(SI)]
    rows = {**BY_NAME, **OWN}
    for section, keys in _keys(kind).items():
        lines.append(f"[{section}]")
        lines += _entries(HEADERS[kind] if section == "MODEL" else {})
        for key in keys:
            said = "fitted to the forces of the MF 6.2 file" if key in fitted else ""
            lines.append(entry(key, value_text(rows[key], values[key]), said))
    return "\r\n".join(lines) + "\r\n"


def _entries(stated: Mapping[str, object]) -> list[str]:
    return [entry(key, f"'{x}'" if isinstance(x, str) else f"{x}") for key, x in stated.items()]
