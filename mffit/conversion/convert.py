"""``mffit convert``: a file of MF 5.2 or PAC2002 as one of MF 6.2."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType, SimpleNamespace
from typing import Any

import numpy as np

from mffit.conversion import constants, mf52, wording
from mffit.conversion.grid import Conditions, Reach, conditions, reach_of
from mffit.conversion.old_files import OldFile, read_old, refuse_no_numbers
from mffit.conversion.refit import held, refit
from mffit.conversion.result import Conversion, OldConversion, RegionMisfit
from mffit.errors import InputError
from mffit.fit.same_curve import in_one_form
from tir import Tyre
from tir.equations import lateral, normalise, stiffness
from tir.outputs import outputs_of
from tir.parameters import BY_NAME
from tir.writing import replace_file

CHANNELS_COMPARED = ("Fx", "Fy", "Mx", "Mz")
ORIGIN = "converted from"
MISFIT = "misfit of the conversion"
"""Keys of the provenance of a converted file."""
MARK = f"! provenance: {ORIGIN}:".encode()
"""A line of every converted file."""
STRUCTURE = ("LONGITUDINAL_STIFFNESS", "LATERAL_STIFFNESS", "PCFX1", "PCFX2", "PCFY1", "PCFY2")


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
        ``.tyre.write("new.tir")`` writes the file; ``.misfit`` says how near it comes, by channel and region.

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
    start = {name: getattr(p, name) for name in BY_NAME} | _camber_stiffness(p, reach) | _carcass(p, reach)
    start |= {"FITTYP": 62.0, "USE_MODE": 124.0}
    start |= in_one_form(start)
    found = refit(start, at, goal, reach)
    values = {**start, **found, **camber_range(old, reach)}
    tyre = Tyre.from_values(values)
    new = dict(zip(CHANNELS_COMPARED, outputs_of(CHANNELS_COMPARED, tyre.p, at._asdict()), strict=True))
    misfit = tuple(misfits(new, at, goal))
    how = f"by a fit of the terms of {wording.refitted(found)}; see the table of mffit convert"
    provenance = {ORIGIN: f"{old.path.name}, {old.kind}, {how}", MISFIT: wording.worst(misfit)}
    tyre = tyre.annotate(status=_status(old, values, found), provenance=provenance)
    return Conversion(
        tyre=tyre, old=old, reach=reach, misfit=misfit, fitted=tuple(found), held=held(p, reach)
    )


def _camber_stiffness(p: SimpleNamespace, reach: Reach) -> dict[str, float]:
    """PKY6 and PKY7 nearest to the old camber stiffness of the upright wheel over load."""
    Fz = np.linspace(*reach.Fz, int(constants.LOADS_OF_THE_GRID))
    q = normalise.inputs(p, normalise.OperatingCondition(Fz))
    force = p.PHY3 * stiffness.cornering_stiffness(p, q, 0.0)
    force = force + lateral.camber_force(p, q, 1.0)
    scale = p.LKYC or 1.0
    terms = np.column_stack([Fz, Fz * q.dfz]) * scale
    PKY6, PKY7 = np.linalg.lstsq(terms, force, rcond=None)[0]
    return {"PKY6": float(PKY6), "PKY7": float(PKY7)}


def _carcass(p: SimpleNamespace, reach: Reach) -> dict[str, float]:
    """Carcass stiffnesses over load that give the old relaxation lengths; the table's defaults where the file has none."""
    Fz = np.linspace(*reach.Fz, int(constants.LOADS_OF_THE_GRID))
    q = normalise.inputs(p, normalise.OperatingCondition(Fz))
    slip = stiffness.longitudinal_slip_stiffness(p, q), stiffness.cornering_stiffness(p, q, 0.0)
    out: dict[str, float] = {}
    sides = (("LONGITUDINAL_STIFFNESS", "PCFX"), ("LATERAL_STIFFNESS", "PCFY"))
    for K, sigma, (key, term) in zip(slip, mf52.relaxation_lengths(p, Fz), sides, strict=True):
        if np.all(sigma > 0.0):
            terms = np.column_stack([np.ones_like(Fz), q.dfz, q.dfz**2])
            at_nominal, linear, quadratic = np.linalg.lstsq(terms, np.abs(K) / sigma, rcond=None)[0]
            if at_nominal > 0.0:
                out |= {
                    key: float(at_nominal),
                    f"{term}1": float(linear / at_nominal),
                    f"{term}2": float(quadratic / at_nominal),
                }
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
        elif BY_NAME[name].section.endswith("_COEFFICIENTS"):
            out[name] = f"converted: {old.kind} has no such term"
    return out


def misfits(new: Mapping[str, Any], at: Conditions, goal: Mapping[str, np.ndarray]) -> list[RegionMisfit]:
    """The misfit of every channel within the small camber and beyond, with and without longitudinal slip."""
    slipping = at.kappa != 0.0
    out = []
    for channel in CHANNELS_COMPARED:
        most = at.largest_alike(goal[channel])
        off = np.abs(np.broadcast_to(new[channel], at.Fz.shape) - goal[channel])
        for region in ((True, False), (True, True), (False, False), (False, True)):
            chosen = (at.small_camber == region[0]) & (slipping == region[1]) & (most > 0.0)
            if np.any(chosen):
                here, alike = off[chosen], most[chosen]
                worst = int(np.argmax(here / alike))
                out.append(
                    RegionMisfit(
                        channel, *region,
                        rms=float(np.sqrt(np.mean(here**2))),
                        rms_share=float(np.sqrt(np.mean((here / alike) ** 2))),
                        load=float(at.Fz[chosen][worst]),
                        largest=float(here[worst]),
                        greatest_force=float(alike[worst]),
                        within=float(np.mean(here <= float(constants.GOOD_SHARE) * alike)),
                    )
                )  # fmt: skip
    return out


def write(found: Conversion | OldConversion, out: str | Path) -> None:
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
