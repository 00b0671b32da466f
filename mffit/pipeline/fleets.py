"""``mffit fleet``: many builds of one rig, compared and combined."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import pandas as pd
from threadpoolctl import threadpool_limits

from mffit import as_json, prediction
from mffit import fleet as combining
from mffit.comparison import PEAKS
from mffit.constants import FEWEST
from mffit.csv_tables import write_csv
from mffit.errors import InputError
from mffit.fit import priors
from mffit.fit.influences.nuisances import of_run
from mffit.fleet import Fleet, Hierarchy, Row, Specimen, TyreEstimate
from mffit.numbers import Numbers
from mffit.output import Project, folder_of_build, output_folder, refuse_early
from mffit.pipeline.build_output import numbers
from mffit.pipeline.fleet_notes import fleet_notes, note_on_sharing
from mffit.progress import Progress, silent
from mffit.quantities import COMPARED, OF_ROAD
from mffit.rig_errors import OF_RUN, error_of
from mffit.rounding import AtLeast
from mffit.viewer.named import tell_apart
from tir import Quantity

WRITTEN = ("fleet.html", "fleet.json", "fleet.csv", "priors.json")
FLEET = Project("a fleet")


def fleet(
    folders: Sequence[str | Path], out: str | Path | None = None, *, progress: Progress = silent
) -> Fleet:
    """Compare built tyres, and estimate those of one rig together with common rig errors.

    Parameters
    ----------
    folders : two or more folders that ``mffit build`` wrote
    out : folder for ``fleet.html``, ``fleet.json``, ``fleet.csv`` and ``priors.json``; nothing is written if None
    progress : called with a sentence before each step

    Raises
    ------
    InputError
        A folder is not complete or not of a build, one is given twice, or fewer than two are given.
    """
    places = [folder_of_build(folder) for folder in folders]
    if len({place.resolve() for place in places}) < max(len(places), 2):
        raise InputError("a fleet needs two or more built tyres, each named once: mffit fleet DIR DIR...")
    if out is not None:
        refuse_early(Path(out), WRITTEN, of=FLEET)
    progress("reading the builds")
    specimens = _with_names_apart([combining.read(place) for place in places])
    rig_of = _rig_indices(specimens)
    with threadpool_limits(1):
        progress(f"estimating {len(specimens)} tyres together")
        rigs = tuple(
            _estimated([s for s, rig in zip(specimens, rig_of, strict=True) if rig == k])
            for k in range(max(rig_of) + 1)
        )
        together = [iter(() if rig is None else rig.tyres) for rig in rigs]
        rows = []
        for specimen, rig in zip(specimens, rig_of, strict=True):
            progress(f"comparing {specimen.name}")
            tyre = None if specimen.numbers is None else next(together[rig])
            rows.append(_row(specimen, rig, tyre))
    found = Fleet(tuple(rows), rigs, (*fleet_notes(rows, rigs), *note_on_sharing(specimens, rig_of)))
    if out is not None:
        progress("writing the page")
        write_fleet(found, Path(out))
    return found


def _with_names_apart(specimens: list[Specimen]) -> list[Specimen]:
    """The specimens; those with one name are called by their folders."""
    count = Counter(s.name for s in specimens)
    folders = tell_apart([s.folder.resolve() for s in specimens])
    return [
        replace(s, name=folder) if count[s.name] > 1 else s
        for s, folder in zip(specimens, folders, strict=True)
    ]


def _rig_indices(specimens: Sequence[Specimen]) -> list[int]:
    """The rig of each build, counted from 0; builds with the same [rig] table share a rig, but not its set-ups."""
    seen: list[Mapping[str, object]] = []
    out = []
    for specimen in specimens:
        if specimen.rig not in seen:
            seen.append(specimen.rig)
        out.append(seen.index(specimen.rig))
    return out


def _estimated(specimens: Sequence[Specimen]) -> Hierarchy | None:
    """The joint estimate of specimens, zeros shared as far as set-ups are; None if none has its information."""
    kinds = combining.kinds_of(specimens)
    known = [
        (kind, found)
        for kind, one in zip(kinds, specimens, strict=True)
        if (found := one.numbers_of_setups) is not None
    ]
    if not known:
        return None
    plain = _plainly_named([found for _, found in known])
    if len(set(kinds)) > 1:
        plain = [_of_kind(kind, found) for (kind, _), found in zip(known, plain, strict=True)]
    return combining.estimate(plain)


def _of_kind(kind: int, found: Numbers) -> Numbers:
    """The same, with coefficients that count for one kind of tyre only."""
    return found.renamed([name if error_of(name) else f"{name}{OF_RUN}{kind}" for name in found.names])


def _plainly_named(found: Sequence[Numbers]) -> list[Numbers]:
    """The same, with plain names for zeros that all tyres share: one set-up, declared as such."""
    zeros = {name for one in found for name in one.names if OF_RUN in name and not of_run(name)}
    setups = {name.partition(OF_RUN)[2] for name in zeros}
    if len(setups) != 1:
        return list(found)
    return [
        one.renamed([name if of_run(name) else name.partition(OF_RUN)[0] for name in one.names])
        for one in found
    ]


def _row(specimen: Specimen, rig: int, together: TyreEstimate | None) -> Row:
    """A build with its own estimate, and that ``together`` with the other tyres of its rig."""
    predictor = None
    with suppress(InputError):  # a build of an earlier version
        predictor, _, _ = prediction.load(specimen.folder)
    of_file = numbers(specimen.tyre, turn_slip=specimen.on_disc, known=specimen.numbers, predictor=predictor)
    stated = {key: specimen.at_least_stated(key, q) for key, q in of_file.items() if key not in OF_ROAD}
    stated |= specimen.on_road
    own = _estimated([specimen])
    alone = None if own is None else own.tyres[0]
    return Row(
        specimen,
        rig,
        numbers={key: stated[key] for key in COMPARED if key in stated},
        alone=_epsilon(alone),
        together=_epsilon(together),
        strain={} if together is None else together.strain,
    )


def _epsilon(found: TyreEstimate | None) -> Quantity | None:
    number = found.number("PECP1") if found is not None else None
    return None if number is None else Quantity(*number, "-")


def write_fleet(found: Fleet, out: Path) -> None:
    """Write every output of a fleet, or nothing."""
    from mffit import report

    known = priors_of_fleet(found)
    read = [row.specimen.folder / combining.INFORMATION for row in found.rows]
    with output_folder(out, by="fleet", protected=read, of=FLEET) as folder:
        write_csv(fleet_table(found), folder / "fleet.csv")
        as_json.write(folder / "fleet.json", found)
        if known is not None:
            as_json.write(folder / "priors.json", known)
        report.write_fleet(found, folder, priors=known is not None)


def priors_of_fleet(found: Fleet) -> dict[str, object] | None:
    """The content of ``priors.json``; None with too few tyres, several rigs or several nominal conditions."""
    if len(found.rigs) > 1 or len(set(found.kinds)) > 1:
        return None
    rig = found.rigs[0]
    return None if rig is None else priors_of_rig(rig, found.rows[0].specimen.conditions, len(found.rows))


def priors_of_rig(rig: Hierarchy, conditions: tuple[float, float], tyres: int) -> dict[str, object] | None:
    """The content of ``priors.json`` from ``tyres`` tyres of one nominal load [N] and pressure [Pa]; None if they are too few."""
    known = {
        name: priors.Prior(p.mean, math.hypot(p.u_mean, p.scatter))
        for name, p in rig.population.items()
        if p.tyres >= FEWEST
    }
    load, pressure = conditions
    return priors.fleet_content({"FNOMIN": load, "NOMPRES": pressure}, tyres, known) if known else None


def fleet_table(found: Fleet) -> pd.DataFrame:
    """The content of ``fleet.csv``: a row per specimen."""
    rows = []
    for row in found.rows:
        numbers = {f"epsilon_gamma_{key}": getattr(row, key) for key in combining.EPSILON} | dict(row.numbers)
        out = {"name": row.specimen.name, "folder": str(row.specimen.folder), "rig": row.rig + 1}
        for key, q in numbers.items():
            out |= {key: None if q is None else q.value, f"u_{key}": None if q is None else q.u}
            if key in PEAKS:
                out[f"{key}_at_least"] = isinstance(q, AtLeast)
        out |= {f"rmse_{channel}": value for channel, value in row.specimen.misfit.items()}
        rows.append(out | {"warnings": len(row.specimen.warnings)})
    return pd.DataFrame(rows)
