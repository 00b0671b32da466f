"""``mffit convert``: a file of MF 5.2 or PAC2002 as one of MF 6.2."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType, SimpleNamespace
from typing import Any

import numpy as np

from mffit.conversion import mf52, wording
from mffit.conversion.grid import Reach, conditions, loads, reach_of
from mffit.conversion.old_files import OldFile, read_old, refuse_no_numbers
from mffit.conversion.refit import held, refit
from mffit.conversion.result import Conversion, misfits
from mffit.errors import InputError
from mffit.fit.same_curve import in_one_form
from tir import Problem, Tyre
from tir.consumers import rule_problems
from tir.document import number_of, read_document, unquoted
from tir.equations import lateral, normalise, stiffness
from tir.outputs import outputs_of
from tir.parameters import BY_NAME, TURN_SLIP
from tir.targets import TARGETS
from tir.writing import replace_file

ORIGIN = "converted from"
MISFIT = "misfit of the conversion"
"""Keys of the provenance of a converted file."""
MARK = f"! provenance: {ORIGIN}:".encode()
"""A line of every converted file."""
STRUCTURE = ("LONGITUDINAL_STIFFNESS", "LATERAL_STIFFNESS", "PCFX1", "PCFX2", "PCFY1", "PCFY2")
READERS = ("chrono", "pac2002")
"""Programs of :data:`tir.targets.TARGETS` that read old files and no others."""
STATED = ("PROPERTY_FILE_FORMAT", "USE_MODE")
"""Keys of [MODEL] that such a program evaluates, and that a conversion replaces."""


def convert(
    path: str | Path, given: Mapping[str, float] = MappingProxyType({}), *, fittyp: int | None = None
) -> Conversion:
    """The MF 6.2 file that has the forces of an MF 5.2 or PAC2002 file.

    Most coefficients mean the same. Those of camber are fitted to the old side force and aligning moment over the ranges of the
    file, because MF 6.2 has another camber force, and leaves camber out of the force that acts on the trail; the upright wheel
    keeps its forces exactly. Curvature factors of the upright wheel that exceed 1, where the old formula holds them, are fitted
    to the old forces within that limit.

    Parameters
    ----------
    path : the old file
    given : values [SI] of keys that it lacks
    fittyp : 5, 6 or 21: the version of the file, if its own FITTYP is wrong or missing

    Returns
    -------
    Conversion
        ``.tyre.write("new.tir")`` writes the file; ``.misfit`` states the difference of the forces, by channel and region.

    Raises
    ------
    TirError
        If the file is of another version, or cannot be read.
    """
    old = read_old(path, given, fittyp)
    p = mf52.in_terms_of_62(old.values)
    reach = reach_of(old.values, old.present)
    at = conditions(reach)
    goal = mf52.forces(p, *at)._asdict()
    refuse_no_numbers(goal, path)
    start = {name: getattr(p, name) for name in BY_NAME} | _upright(p, reach)
    start |= {"FITTYP": 62.0, "USE_MODE": 124.0}
    start |= in_one_form(start)
    found = refit(start, at, goal, reach)
    values = start | found | camber_range(old, reach)
    tyre = Tyre.from_values(values)
    misfit = tuple(misfits(outputs_of((*goal,), tyre.p, at._asdict()), at, goal))
    how = f"by a fit of the terms of {wording.refitted(found)}; see the table of mffit convert"
    provenance = {ORIGIN: f"{old.path.name}, {old.kind}, {how}", MISFIT: wording.worst(misfit)}
    tyre = tyre.annotate(status=_status(old, values, found), provenance=provenance)
    return Conversion(
        path=old.path, problems=(*old.problems, *tyre.problems), old=old, tyre=tyre, kind=old.kind, text=tyre.text(),
        reach=reach, misfit=misfit, fitted=tuple(found), held=held(p, reach),
    )  # fmt: skip


def _upright(p: SimpleNamespace, reach: Reach) -> dict[str, float]:
    """What gives the old camber stiffness and relaxation lengths of the upright wheel over load: PKY6 and PKY7, and carcass
    stiffnesses; the table's defaults of these where the file has no relaxation lengths."""
    Fz = loads(reach)
    q = normalise.inputs(p, normalise.OperatingCondition(Fz))
    K_ya = stiffness.cornering_stiffness(p, q, 0.0)
    terms = np.column_stack([Fz, Fz * q.dfz]) * (p.LKYC or 1.0)
    by_camber = np.linalg.lstsq(terms, p.PHY3 * K_ya + lateral.camber_force(p, q, 1.0), rcond=None)[0]
    out = dict(zip(("PKY6", "PKY7"), by_camber.tolist(), strict=True))
    sides = (("LONGITUDINAL_STIFFNESS", "PCFX1", "PCFX2"), ("LATERAL_STIFFNESS", "PCFY1", "PCFY2"))
    slip = stiffness.longitudinal_slip_stiffness(p, q), K_ya
    for K, sigma, names in zip(slip, mf52.relaxation_lengths(p, Fz), sides, strict=True):
        if np.all(sigma > 0.0):
            terms = np.column_stack([np.ones_like(Fz), q.dfz, q.dfz**2])
            at_nominal, *by_load = np.linalg.lstsq(terms, np.abs(K) / sigma, rcond=None)[0].tolist()
            if at_nominal > 0.0:
                out |= dict(zip(names, (at_nominal, *(x / at_nominal for x in by_load)), strict=True))
    return out


def camber_range(old: OldFile | Tyre, reach: Reach) -> dict[str, float]:
    """The range of camber of the converted file where it is narrower than that of the other one: as far as it was fitted."""
    wide = abs(float(old.values["CAMMAX"])) > reach.gamma or "CAMMAX" not in old.present
    return {"CAMMIN": -reach.gamma, "CAMMAX": reach.gamma} if wide else {}


def _status(old: OldFile, values: Mapping[str, Any], found: Mapping[str, float]) -> dict[str, str]:
    """The origin of every value as a comment of the file."""
    out = {}
    for name in values:
        if name in found:
            out[name] = f"converted from {old.kind}: fitted to the old forces"
        elif name in STRUCTURE and values[name] != old.values[name]:
            out[name] = f"converted from {old.kind}: by its relaxation lengths"
        elif name in old.present and values[name] == old.values[name]:
            out[name] = f"converted from {old.kind}: unchanged"
        elif name in old.present:
            out[name] = f"converted from {old.kind}: was {old.values[name]:.6g}"
        elif BY_NAME[name].section == TURN_SLIP:
            out[name] = f"default: {old.kind} has no turn slip"
        elif BY_NAME[name].section.endswith("_COEFFICIENTS"):
            out[name] = f"converted: {old.kind} has no such term"
    return out


def write(found: Conversion, out: str | Path) -> None:
    """Write the converted file; a file that is not a converted one is left alone.

    Raises InputError if the path is the old file, another file or a folder, or if it cannot be written.
    """
    out = Path(out)
    if out.is_dir():
        raise InputError("is a folder; name the file to write", file=out)
    try:
        if out.exists() and MARK not in out.read_bytes():
            raise InputError("exists already and was not made by mffit convert; give another name", file=out)
        out.parent.mkdir(parents=True, exist_ok=True)
        replace_file(out, found.text.encode("ascii"))
    except OSError as error:
        raise InputError(f"cannot be written ({error.strerror}); give another name", file=out) from None


def check_old(
    path: str | Path, targets: Sequence[str], given: Mapping[str, float] = MappingProxyType({})
) -> list[Problem]:
    """Problems of an MF 5.2 or PAC2002 file in programs that read it; forces are those of the upright wheel, which stay.

    Parameters
    ----------
    path : the old file
    targets : names of :data:`READERS`
    given : values [SI] of keys that it lacks

    Raises
    ------
    TirError
        If the file is of another formula, or cannot be read.
    """
    found = convert(path, given)
    lines = {line.key: unquoted(line.value) for line in reversed(read_document(path).entries)}
    form, mode = (lines.get(key) for key in STATED)
    stated: dict[str, float | str] = {} if form is None else {"PROPERTY_FILE_FORMAT": form}
    if (number := number_of(mode or "")) is not None:
        stated["USE_MODE"] = number
    tyre = found.tyre.replace(**stated)
    tyre = replace(tyre, present=tyre.present.difference(STATED) | stated.keys())
    return [*found.problems, *(p for name in targets for p in rule_problems(tyre, TARGETS[name]))]
