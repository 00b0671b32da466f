"""One build, read back from its folder."""

import json
import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

import tir
from mffit.errors import InputError
from mffit.fit.priors import scatter
from mffit.numbers import Numbers, from_json
from mffit.output import BUILT, folder_of_build
from mffit.prediction.road import lesser
from mffit.quantities import DIRECT, KEYS, OF_ROAD
from mffit.rig_errors import BESIDE, DECLARED, OF_RUN, ZEROS, error_of, number_of
from mffit.rounding import AtLeast
from mffit.sheets import file_of, sheet_of
from tir import Quantity, Tyre

RESOLVED, INFORMATION = "resolved.toml", "information.json"
MEASURED = ("PECP1",)
"""Coefficients without a prior, because the uncertainty with which a build holds them comes from the same points."""
HELD = "PECP2"
"""A coefficient that most builds hold exactly at 0."""


@dataclass(frozen=True, slots=True)
class Specimen:
    """A built tyre."""

    name: str
    folder: Path
    tyre: Tyre  #: the fitted model
    file: str  #: the property file with the plain name
    on_disc: bool
    rig: Mapping[str, Any]  #: the table [rig] of the build
    numbers: Numbers | None  #: of tyre and rig; None if nothing was free
    epsilon_gamma: Quantity | None  #: as the property file carries it
    misfit: Mapping[str, float]  #: rms by channel, [N] and [Nm]
    warnings: tuple[str, ...]
    reasons: tuple[str, ...] = ()  #: reasons against trusting the build; empty for a sound one
    in_doubt: tuple[str, ...] = ()  #: points that the engineer should check
    epsilon_direct: Quantity | None = None  #: eps_gamma of the direct method
    setups: tuple[str, ...] = ()  #: names of the set-ups that its sweeps declare
    readings: frozenset[tuple[str, ...]] = frozenset()
    """Of each recording the digest of its file, the sheet, and the lines that are left out."""
    on_road: Mapping[str, Quantity] = field(default_factory=dict)
    """Peaks on the road, of the lesser side, by their keys in ``mffit.quantities.OF_ROAD``."""
    without_spin: Quantity | None = None  #: cornering stiffness on a straight path, of a build on a disc
    size: str = ""  #: as declared, without spaces; empty if it is not
    budget: Mapping[str, float] = field(default_factory=dict)
    """Change of the measured eps_gamma by one standard uncertainty of each source of its budget."""

    @property
    def conditions(self) -> tuple[float, float]:
        """Nominal load [N] and pressure [Pa], to which the coefficients refer."""
        return float(self.tyre["FNOMIN"]), float(self.tyre["NOMPRES"])

    def at_least_stated(self, key: str, found: Quantity) -> Quantity:
        """A characteristic of the fitted model, with no less than the relative uncertainty that the build states for it.

        The coefficients of a disc do not know what the correction for the path's curvature adds to the cornering stiffness.
        """
        known = self.without_spin
        if known is None or key != KEYS["C_alpha"]:
            return found
        return found._replace(u=max(found.u, known.u * abs(found.value / known.value)))

    @property
    def numbers_of_setups(self) -> Numbers | None:
        """The numbers for a joint estimate, with every zero named after its set-up, so that builds can share it.

        Builds share a set-up if they give it the same name, on a rig of the same name. Other set-ups belong to this build only.
        """
        known = None if self.numbers is None else freed(self.numbers)
        return None if known is None else known.renamed([self._shared_name(name) for name in known.names])

    @property
    def moved_by(self) -> dict[tuple[str, str], dict[str, float]]:
        """Changes of the build's numbers by one standard uncertainty of each rig error.

        Keys are the shared name of the error, and the measured coefficient through which it acts (by the coefficient's budget) or
        "" if it acts through the readings.
        """
        known = self.numbers
        if known is None:
            return {}
        moves = {
            name: dict(zip(known.names, move.tolist(), strict=True))
            for name, move in known.moved_by().items()
            if error_of(name) or (name in known.held and name in MEASURED)
        }
        found = {(self._shared_name(name), ""): move for name, move in moves.items() if error_of(name)}
        for name in moves.keys() & set(MEASURED):
            for error, declared in DECLARED:
                if declared.source in self.budget:
                    share = self.budget[declared.source] / moves[name][name]
                    shared = {number: share * x for number, x in moves[name].items()}
                    found[self._shared_name(error.name), name] = shared
        return found

    def _shared_name(self, number: str) -> str:
        name, _, setup = number.partition(OF_RUN)
        error = error_of(number)
        if error is None:
            return number
        if not error.of_setup:  # numbers of runs belong to this build only
            return number_of(name, " of ".join((setup, str(self.folder)))) if setup else number
        if not setup and len(self.setups) == 1:
            setup = self.setups[0]
        declared = self.rig.get("name") and setup in self.setups
        return number_of(name, setup if declared else " of ".join(filter(None, (setup, str(self.folder)))))


def freed(numbers: Numbers) -> Numbers | None:
    """The numbers of a build, also the coefficients that it held; None if its readings contain no information.

    A held number of which they tell nothing is left out, and so is a held error of the rig that is no zero: a calibration looks
    like the tyre's own stiffness. Effects of the tyre that are not coefficients are left to readings and priors, as they are
    estimated anew in every build.
    """
    silent = {
        name
        for i, name in enumerate(numbers.names)
        if name in numbers.held
        and (error_of(name) not in (None, *ZEROS) or not numbers.information[i, i] > 0.0)
    }
    known = numbers.given(silent)
    if not known.names:
        return None
    spread = known.spread.copy()
    for i, name in enumerate(known.names):
        if name in MEASURED:
            spread[i] = math.inf
        elif name == HELD and spread[i] == 0.0:
            spread[i] = scatter(HELD, 0.0, from_base=False, curved=False)
    known = replace(known, spread=np.asarray(spread), held=frozenset())
    return known.without({error.name for error in BESIDE})


def read(folder: str | Path) -> Specimen:
    """The specimen of a folder that ``mffit build`` wrote.

    Raises
    ------
    InputError
        ``mffit build`` did not write the folder, or it is incomplete.
    """
    folder = folder_of_build(folder)
    if not (folder / BUILT).is_file():
        sentence = f"contains no {BUILT}, so `mffit build` did not write it; give a folder that it wrote"
        raise InputError(sentence, file=folder)
    result = _json(folder / BUILT)
    try:
        resolved = tomllib.loads((folder / RESOLVED).read_text(encoding="utf-8"))
        files, spin = result["files"], result["spin"]
        on_disc = resolved["rig"]["type"] == "rotating-disk"
        use = "turn-slip" if on_disc and "turn-slip" in files else next(iter(files))
        return Specimen(
            name=str(result["tyre"]["name"]),
            folder=folder,
            tyre=tir.read(folder / files[use]),
            file=str(result["tir"]),
            on_disc=on_disc,
            rig=resolved["rig"],
            numbers=read_numbers(folder / INFORMATION),
            epsilon_gamma=_stated(spin, "epsilon_gamma"),
            epsilon_direct=_stated(spin, "epsilon_gamma_direct"),
            misfit={name: row["rmse"] for name, row in result["fit"]["channels"].items() if row["n"]},
            warnings=tuple(result["warnings"]),
            reasons=tuple(result.get("reasons", ())),
            in_doubt=tuple(result.get("in_doubt", ())),
            budget={
                row["source"]: math.copysign(row["contribution"], row["sensitivity"])
                for row in spin.get("budget", ())
            },
            on_road=_on_road(result.get("road")),
            without_spin=_stated(spin, KEYS["C_alpha_straight"], "N/rad") if on_disc else None,
            size="".join(result["tyre"].get("size", "").split()).strip("-"),
            setups=tuple(dict.fromkeys(s["setup"] for s in resolved["sweep"] if "setup" in s)),
            readings=frozenset(_readings(resolved, result["made"]["inputs"])),
        )
    except (OSError, LookupError, TypeError, ValueError, AttributeError, StopIteration):
        raise InputError(
            "is incomplete, or not written by `mffit build`; build this tyre again", file=folder
        ) from None


def _readings(resolved: Mapping[str, Any], digests: Mapping[str, str]) -> Iterator[tuple[str, ...]]:
    """:attr:`Specimen.readings`; the resolved configuration names files from the folder of the results, the digests do not."""
    by_name = {Path(name).name: digest for name, digest in digests.items()}
    for name in (sweep["file"] for sweep in resolved["sweep"]):
        out = [one["lines"] for one in resolved["fit"].get("exclude", ()) if one["file"] == name]
        yield (by_name.get(file_of(name).name, name), sheet_of(name), *out)


def _stated(spin: Mapping[str, Any], key: str, unit: str = "-") -> Quantity | None:
    value = spin.get(key)
    return None if value is None else Quantity(float(value), float(spin[f"u_{key}"]), unit)


def _on_road(road: Mapping[str, Any] | None) -> dict[str, Quantity]:
    """The peaks of the record of the road, of the lesser side; empty without a record."""
    if road is None:
        return {}
    found = {}
    for key, name in OF_ROAD.items():
        unit = DIRECT[name].unit_behind
        sides = [side["_".join(filter(None, (name, unit)))] for side in road["sides"].values()]
        found[key] = lesser(None if side is None else _on_side(side, unit) for side in sides)
    return {key: q for key, q in found.items() if q is not None}


def _on_side(side: Mapping[str, Any], unit: str) -> Quantity:
    kind = AtLeast if side.get("at_least") else Quantity
    return kind(float(side["value"]), float(side["u"]), unit)


def read_numbers(path: Path) -> Numbers | None:
    """The content of an ``information.json``; None if nothing was free in its build.

    Raises InputError if the file is missing, or was not written by ``mffit build``.
    """
    if not path.is_file():
        raise InputError(
            "is missing, as after a build by an earlier version; build this tyre again", file=path
        )
    content = _json(path)
    try:
        return from_json(content) if content["names"] else None
    except (LookupError, TypeError, ValueError, AttributeError):
        raise InputError(
            "was not written by `mffit build`, or was changed; build this tyre again", file=path
        ) from None


def _json(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise InputError("cannot be read as JSON; build this tyre again", file=path) from None
