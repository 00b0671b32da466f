"""``mffit fleet``: many builds of one rig, compared and combined."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from mffit import fleet as combining
from mffit.comparison import with_u
from mffit.effects import FAULT_WORDS
from mffit.errors import InputError
from mffit.fit import priors
from mffit.fleet import Fleet, Hierarchy, Row, Specimen, TyreEstimate, constants
from mffit.output import output_folder, refuse_early
from mffit.pipeline.members import numbers
from mffit.progress import Progress, silent
from mffit.quantities import COMPARED
from mffit.results import as_json
from tir import Quantity, Tyre

WRITTEN = ("fleet.html", "fleet.json", "fleet.csv", "priors.json")


def fleet(
    folders: Sequence[str | Path], out: str | Path | None = None, *, progress: Progress = silent
) -> Fleet:
    """Compare built tyres, and estimate those of one rig together, its errors common to all.

    Parameters
    ----------
    folders : what ``mffit build`` wrote, two or more
    out : folder for ``fleet.html``, ``fleet.json``, ``fleet.csv`` and ``priors.json``; nothing is written if None
    progress : called with a sentence before each step

    Raises
    ------
    InputError
        A folder is not a whole one of a build, or one is given twice, or fewer than two are.
    """
    places = [Path(folder) for folder in folders]
    if len({place.resolve() for place in places}) < max(len(places), 2):
        raise InputError("a fleet needs two built tyres or more, each once: mffit fleet DIR DIR...")
    if out is not None:
        refuse_early(Path(out), WRITTEN)
    progress("reading the builds")
    specimens = [combining.read(place) for place in places]
    kinds = _kinds(specimens)
    with threadpool_limits(1):
        progress(f"estimating {len(specimens)} tyres together")
        rigs = tuple(
            _together([s for s, kind in zip(specimens, kinds, strict=True) if kind == k])
            for k in range(max(kinds) + 1)
        )
        rows = []
        for specimen, kind in zip(specimens, kinds, strict=True):
            progress(f"comparing {specimen.name}")
            rows.append(_row(specimen, kind))
    shown = _with_estimates(rows, rigs)
    found = Fleet(shown, rigs, tuple(_notes(shown, rigs)))
    if out is not None:
        progress("writing the page")
        write_fleet(found, Path(out))
    return found


def _kinds(specimens: Sequence[Specimen]) -> list[int]:
    """Which rig each was on: builds that were told the very same of their rig."""
    seen: list[Mapping] = []
    out = []
    for specimen in specimens:
        if specimen.rig not in seen:
            seen.append(specimen.rig)
        out.append(seen.index(specimen.rig))
    return out


def _together(specimens: Sequence[Specimen]) -> Hierarchy | None:
    known = [s.information for s in specimens if s.information is not None]
    return combining.estimate(known) if known else None


def _row(specimen: Specimen, rig: int) -> Row:
    alone = None
    if specimen.information is not None:
        alone = combining.estimate([specimen.information]).tyres[0]
    compared = _compared(specimen.tyre, alone, turn_slip=specimen.on_disc)
    return Row(specimen, rig, compared, _epsilon(alone))


def _compared(tyre: Tyre, known: TyreEstimate | None, *, turn_slip: bool) -> dict[str, Quantity]:
    """Stiffnesses and peaks with the uncertainty that the coefficients give them, to first order."""
    names, covariance = (known.names, known.covariance) if known else ((), np.zeros((0, 0)))
    here, u = with_u(tyre, names, covariance, partial(numbers, turn_slip=turn_slip))
    return {key: Quantity(here[key], u.get(key, 0.0), unit.unit) for key, unit in COMPARED.items()}


def _epsilon(found: TyreEstimate | None) -> Quantity | None:
    number = found.number("PECP1") if found is not None else None
    return None if number is None else Quantity(*number, "-")


def _with_estimates(rows: Sequence[Row], rigs: Sequence[Hierarchy | None]) -> tuple[Row, ...]:
    """The rows with what the tyres of each rig say of them together, where there are two or more."""
    left = [list(rig.tyres) if rig is not None else [] for rig in rigs]
    out = []
    for row in rows:
        if row.specimen.information is None:
            out.append(row)
            continue
        tyre = left[row.rig].pop(0)
        out.append(combining.with_estimate(row, _epsilon(tyre), tyre.strain))
    return tuple(out)


def _notes(rows: Sequence[Row], rigs: Sequence[Hierarchy | None]) -> list[str]:
    out = []
    far = {
        name: abs(value - rig.declared[name][0]) / rig.declared[name][1]
        for rig in rigs
        if rig is not None
        for name, (value, _) in rig.rig.items()
        if abs(value - rig.declared[name][0]) > constants.RIG_FAR_FROM_DECLARED * rig.declared[name][1]
    }
    if len(rigs) > 1:
        out.append(
            f"The builds were told of {len(rigs)} different rigs (the table [rig] of each): the tyres of each are estimated "
            "together. priors.json is not written, as it is for one rig."
        )
    for row in rows:
        # Where all tyres leave the declaration, each that leans on it alone seems to differ from the others.
        worst = max(row.strain.keys() - far, key=lambda name: abs(row.strain[name]), default="")
        if worst and abs(row.strain[worst]) > constants.STRAINED_RIG:
            out.append(
                f"{row.specimen.name}: its own error of the rig, {FAULT_WORDS[worst]}, lies {abs(row.strain[worst]):.0f} "
                "standard deviations from that of the other tyres; if the rig was adjusted in between, it is another rig: "
                "leave this tyre out."
            )
    for name, times in far.items():
        out.append(
            f"All tyres together put an error of the rig, {FAULT_WORDS[name]}, {times:.0f} standard deviations from what [rig] "
            "declares: the declaration is too tight, or the tyres share something that the model lacks; then believe the "
            "direct method."
        )
    if len({_nominal(row.specimen.tyre) for row in rows}) > 1:
        out.append(
            "The tyres have different nominal loads or pressures, from which coefficients count: the population mixes them"
            + (", and priors.json is not written." if len(rigs) == 1 else ".")
        )
    return out


def _nominal(tyre: Tyre) -> tuple[float, float]:
    return float(tyre["FNOMIN"]), float(tyre["NOMPRES"])


def later(found: Fleet) -> dict | None:
    """The content of ``priors.json``; None where there are too few tyres, several rigs or several kinds."""
    if len(found.rigs) > 1 or len({_nominal(row.specimen.tyre) for row in found.rows}) > 1:
        return None
    rig = found.rigs[0]
    return None if rig is None else content_of(rig, found.rows[0].specimen.tyre, len(found.rows))


def content_of(rig: Hierarchy, tyre: Tyre, tyres: int) -> dict | None:
    """What a number of tyres, of which one is given, tell later builds; None where they are too few."""
    known = {
        name: priors.Prior(p.mean, math.hypot(p.u_mean, p.scatter))
        for name, p in rig.population.items()
        if p.tyres >= constants.FEWEST_TYRES_FOR_SCATTER
    }
    load, pressure = _nominal(tyre)
    return priors.fleet_content({"FNOMIN": load, "NOMPRES": pressure}, tyres, known) if known else None


def table(found: Fleet) -> pd.DataFrame:
    """The content of ``fleet.csv``: a row per specimen."""
    rows = []
    for row in found.rows:
        numbers = {f"epsilon_gamma_{key}": getattr(row, key) for key in combining.EPSILON} | dict(row.numbers)
        out = {"name": row.specimen.name, "folder": str(row.specimen.folder), "rig": row.rig + 1}
        for key, q in numbers.items():
            out |= {key: None if q is None else q.value, f"u_{key}": None if q is None else q.u}
        out |= {f"rmse_{channel}": value for channel, value in row.specimen.misfit.items()}
        rows.append(out | {"warnings": len(row.specimen.warnings)})
    return pd.DataFrame(rows)


def write_fleet(found: Fleet, out: Path) -> None:
    """Write every output of a fleet, or nothing."""
    from mffit import report

    known = later(found)
    read = [row.specimen.folder / combining.INFORMATION for row in found.rows]
    with output_folder(out, by="fleet", protected=read, outdated=WRITTEN) as folder:
        table(found).to_csv(folder / "fleet.csv", index=False)
        as_json.write(folder / "fleet.json", as_json.fleet(found))
        if known is not None:
            as_json.write(folder / "priors.json", known)
        report.write_fleet(found, folder, priors=known is not None)
