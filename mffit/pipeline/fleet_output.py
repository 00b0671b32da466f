"""The files that a fleet writes."""

from __future__ import annotations

import math
from pathlib import Path

import pandas as pd

from mffit import fleet as combining
from mffit.csv_tables import write_csv
from mffit.fit import priors
from mffit.fleet import Fleet, Hierarchy
from mffit.output import output_folder
from mffit.results import as_json
from tir import Tyre

WRITTEN = ("fleet.html", "fleet.json", "fleet.csv", "priors.json")


def write_fleet(found: Fleet, out: Path) -> None:
    """Write every output of a fleet, or nothing."""
    from mffit import report

    known = priors_of_fleet(found)
    read = [row.specimen.folder / combining.INFORMATION for row in found.rows]
    with output_folder(out, by="fleet", protected=read, outdated=WRITTEN) as folder:
        write_csv(fleet_table(found), folder / "fleet.csv")
        as_json.write(folder / "fleet.json", as_json.fleet(found))
        if known is not None:
            as_json.write(folder / "priors.json", known)
        report.write_fleet(found, folder, priors=known is not None)


def priors_of_fleet(found: Fleet) -> dict[str, object] | None:
    """The content of ``priors.json``; None with too few tyres, several rigs or several nominal conditions."""
    if len(found.rigs) > 1 or len({nominal_conditions(row.specimen.tyre) for row in found.rows}) > 1:
        return None
    rig = found.rigs[0]
    return None if rig is None else priors_of_rig(rig, found.rows[0].specimen.tyre, len(found.rows))


def priors_of_rig(rig: Hierarchy, tyre: Tyre, tyres: int) -> dict[str, object] | None:
    """The content of ``priors.json`` from ``tyres`` tyres of the kind of ``tyre``; None if there are too few."""
    known = {
        name: priors.Prior(p.mean, math.hypot(p.u_mean, p.scatter))
        for name, p in rig.population.items()
        if p.tyres >= combining.constants.FEWEST_TYRES_FOR_SCATTER
    }
    load, pressure = nominal_conditions(tyre)
    return priors.fleet_content({"FNOMIN": load, "NOMPRES": pressure}, tyres, known) if known else None


def nominal_conditions(tyre: Tyre) -> tuple[float, float]:
    """Nominal load [N] and pressure [Pa], to which the coefficients refer."""
    return float(tyre["FNOMIN"]), float(tyre["NOMPRES"])


def fleet_table(found: Fleet) -> pd.DataFrame:
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
