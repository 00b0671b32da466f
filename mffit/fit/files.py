"""The property files of a build: their values, their ranges, the origin of every value, and how good each is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from mffit.fit.imitation import forces
from mffit.fit.known import Known
from mffit.fit.normal import derive_both, derive_normal
from mffit.fit.ranges import NAMES, plausible_ranges, tested_ranges
from mffit.fit.road import Road, inside, road_grid, weights
from mffit.fit.start import camber_stiffness_terms
from mffit.points import Points, main_path, main_pressure
from mffit.quantities import CHANNELS
from mffit.scatter import rms
from tir import Tyre

RADII = (100.0, 30.0, 10.0)
"""Radii of roads [m] for which the turn-slip force is stated that the file for turn slip off lacks."""
DECIDED = ("TYRESIDE", "USE_MODE", "FITTYP")
"""Values that the build itself decides."""
GIVEN = {
    "FNOMIN": "nominal_load",
    "NOMPRES": "nominal_pressure",
    "INFLPRES": "nominal_pressure",
    "LONGVL": "nominal_speed",
    "UNLOADED_RADIUS": "unloaded_radius",
    "WIDTH": "width",
    "RIM_RADIUS": "rim_radius",
}
"""Values that [tyre] of tyre.toml states, by its keys."""


@dataclass(frozen=True, slots=True)
class Misfit:
    """How a file differs from the fitted model on a straight path, over the tested ranges."""

    rms: float  #: every condition alike
    weighted: float  #: what a vehicle visits counts more than the corners
    largest: float
    lean_30: float  #: rms to 30 deg of camber
    beyond: float  #: rms of the conditions that only the written ranges hold


@dataclass(frozen=True, slots=True)
class FileFigures:
    """What is known of one written file."""

    tyre: Tyre
    misfit: Mapping[
        str, Mapping[str, Misfit]
    ]  #: by place and channel; "straight" is the path that every file has
    camber_stiffness: float  #: slope of Fy over camber at zero on a straight path [N/rad]

    @property
    def straight(self) -> Mapping[str, Misfit]:
        """By channel on a straight path, in the file's own use; turn slip off for a file that serves both."""
        return self.misfit["straight"]


@dataclass(frozen=True, slots=True)
class Files:
    """The files of a build by use, "turn-slip" and "normal", and what they were made from."""

    by_use: Mapping[
        str, FileFigures
    ]  #: "turn-slip" and "normal"; on a flat track the latter; if asked for, "both"
    tested: Mapping[str, float]
    written: Mapping[str, float]
    changed: Mapping[str, tuple[str, ...]]  #: by use, coefficients that differ from the fitted model
    lacking: Mapping[float, float]  #: turn-slip force [N] at nominal load by radius of the road [m]

    @property
    def stiffness_loss(self) -> float:
        """Share of the camber stiffness at zero that the file for turn slip off lacks."""
        return 1.0 - self.by_use["normal"].camber_stiffness / self.by_use["turn-slip"].camber_stiffness

    def annotated(self, comments: Mapping[str, Mapping[str, str]]) -> Files:
        """The same with comments on the values, by use and name."""
        told = {use: replace(f, tyre=f.tyre.annotate(status=comments[use])) for use, f in self.by_use.items()}
        return replace(self, by_use=told)


def make_files(
    config: Any, known: Known, points: Points, base: Tyre | None, C_gamma: Mapping[float, float]
) -> Files:
    """The files that leave a build: on a disc one for each use, one on a flat track.

    Parameters
    ----------
    config : the validated ``tyre.toml``
    known : the fitted model and the origin of every value
    points : the points it was fitted to
    base : coefficients that were not fitted came from here
    C_gamma : measured camber stiffness [N/rad] by load [N]; empty on a flat track
    """
    values = known.values
    disc = config.rig.on_disc
    symmetric = config.tyre.side == "symmetric"
    tested = tested_ranges(points)
    written = plausible_ranges(values, tested, turn_slip=disc)
    side = "RIGHT" if str(values["TYRESIDE"]).upper().startswith("R") else "LEFT"
    model = {**values, **written, "TYRESIDE": side, "FITTYP": 62}
    changed: dict[str, dict[str, float]] = {} if disc else {"normal": {}}
    if disc:
        terms = camber_stiffness_terms(values, C_gamma, float(points.p[main_pressure(points)].mean()))
        changed["turn-slip"] = {}
        changed["normal"] = derive_normal(model, tested, written, terms, symmetric=symmetric)
    phi_t = main_path(points)
    if disc and config.spin.exact == "both":
        changed["both"] = derive_both(model, tested, written, terms, phi_t, symmetric=symmetric)
    road = road_grid(tested, written, float(model["FNOMIN"]))
    judge = _Judge(model, road, tested, phi_t)
    tyres = {
        use: (base or Tyre.from_values({})).replace(**{**model, **values, "USE_MODE": use_mode(model, use)})
        for use, values in changed.items()
    }
    return Files(
        {use: judge.figures(tyre, use) for use, tyre in tyres.items()},
        tested,
        written,
        {use: tuple(values) for use, values in changed.items() if values},
        _lacking(model) if disc else {},
    )


class _Judge(NamedTuple):
    """Compares files with the fitted model over the ranges."""

    model: Mapping[str, Any]
    road: Road
    tested: Mapping[str, float]
    phi_t: float  #: of the disc's path; 0 on a flat track

    def figures(self, tyre: Tyre, use: str) -> FileFigures:
        spin = {"turn-slip": (True,), "normal": (False,), "both": (False, True)}[use]
        misfit = {"straight": self._misfits(tyre, turn_slip=spin[0], phi_t=0.0)}
        if len(spin) > 1:
            misfit["straight_with_turn_slip"] = self._misfits(tyre, turn_slip=True, phi_t=0.0)
            misfit["disc"] = self._misfits(tyre, turn_slip=True, phi_t=self.phi_t)
        gamma = np.array([-1e-3, 1e-3])
        Fy = tyre(float(self.model["FNOMIN"]), gamma=gamma, turn_slip=spin[0]).Fy
        return FileFigures(tyre, misfit, float(np.diff(Fy)[0] / np.diff(gamma)[0]))

    def _misfits(self, tyre: Tyre, *, turn_slip: bool, phi_t: float) -> dict[str, Misfit]:
        here = forces(tyre.values, self.road, turn_slip=turn_slip, phi_t=phi_t)
        target = forces(self.model, self.road, turn_slip=bool(self.phi_t), phi_t=phi_t)
        weight, within = weights(self.road, self.tested), inside(self.road, self.tested)
        return {
            name: _misfit(own - aim, self.road, weight, within)
            for name, own, aim in zip(CHANNELS, here, target, strict=True)
        }


def _misfit(difference: np.ndarray, road: Road, weight: np.ndarray, within: np.ndarray) -> Misfit:
    return Misfit(
        rms=rms(difference[within]),
        weighted=float(np.sqrt(np.average(difference[within] ** 2, weights=weight[within]))),
        largest=float(np.max(np.abs(difference[within]))),
        lean_30=rms(difference[within & (np.abs(road.gamma) < np.radians(30.5))]),
        beyond=rms(difference[~within]) if np.any(~within) else 0.0,
    )


def use_mode(values: Mapping[str, Any], use: str) -> int:
    """USE_MODE of a file: contact, transient behaviour and forces as MF-Tyre's three digits.

    Hundreds 2 is the circular cross-section of a motorcycle tyre (one with MC_CONTOUR), 1 a smooth road; tens 2 the
    nonlinear transient; units 5 combined slip with turn slip, 4 without.
    """
    contact = 200 if float(values["MC_CONTOUR_A"]) > 0.0 else 100
    return contact + 20 + (4 if use == "normal" else 5)


def _lacking(model: Mapping[str, Any]) -> dict[float, float]:
    """Turn-slip force [N] of the upright wheel at nominal load on roads of the radii."""
    tyre = Tyre.from_values(dict(model))
    load = float(model["FNOMIN"])
    straight = float(tyre(load, turn_slip=True).Fy)
    return {R: abs(float(tyre(load, phi_t=-1.0 / R).Fy) - straight) for R in RADII}


def decisions(config: Any) -> dict[str, str]:
    """Origin of the values that the configuration or the build itself decides."""
    given = [name for name, key in GIVEN.items() if getattr(config.tyre, key) is not None]
    return {**dict.fromkeys(NAMES, "range"), **dict.fromkeys((*DECIDED, *given), "given")}


def file_names(name: str, exact: str, on_disc: bool) -> dict[str, str]:
    """Names of the written files by use; ``exact`` carries the plain one."""
    if not on_disc:
        return {"normal": f"{name}.tir"}
    uses = dict.fromkeys((exact, "turn-slip", "normal"))
    return {use: f"{name}.tir" if use == exact else f"{name}-{use}.tir" for use in uses}
