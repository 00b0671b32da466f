"""The property files of a build: their values, their ranges, the origin of every value, and how good each is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mffit.fit.known import Known
from mffit.fit.normal import (
    Road,
    derive_normal,
    inside,
    road_grid,
    weights,
)
from mffit.fit.ranges import NAMES, plausible_ranges, tested_ranges
from mffit.fit.start import camber_stiffness_terms
from mffit.points import Points, main_pressure
from tir import Tyre
from tir.parameters import TABLE

RADII = (100.0, 30.0, 10.0)
"""Radii of roads [m] for which the turn-slip force is stated that the file for turn slip off lacks."""
LONGEST = 66
"""Characters of a comment that fit on a line of the file."""
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
    straight: Mapping[str, Misfit]  #: by channel
    camber_stiffness: float  #: slope of Fy over camber at zero on a straight path [N/rad]


@dataclass(frozen=True, slots=True)
class Files:
    """The files of a build by use, "turn-slip" and "normal", and what they were made from."""

    by_use: Mapping[str, FileFigures]
    tested: Mapping[str, float]
    written: Mapping[str, float]
    changed: tuple[str, ...]  #: coefficients of the normal file that differ from the fitted model
    lacking: Mapping[float, float]  #: turn-slip force [N] at nominal load by radius of the road [m]

    @property
    def stiffness_loss(self) -> float:
        """Share of the camber stiffness at zero that the file for turn slip off lacks."""
        return 1.0 - self.by_use["normal"].camber_stiffness / self.by_use["turn-slip"].camber_stiffness


def make_files(
    config: Any,
    known: Known,
    points: Points,
    base: Tyre | None,
    comments: Mapping[str, str],
    C_gamma: Mapping[float, float],
) -> Files:
    """The files that leave a build: both on a disc, one on a flat track.

    Parameters
    ----------
    config : the validated ``tyre.toml``
    known : the fitted model and the origin of every value
    points : the points it was fitted to
    base : coefficients that were not fitted came from here
    comments : the comments of fitted values
    C_gamma : measured camber stiffness [N/rad] by load [N]; empty on a flat track
    """
    values = known.values
    disc = config.rig.type == "rotating-disk"
    symmetric = config.tyre.side == "symmetric"
    tested = tested_ranges(points)
    written = plausible_ranges(values, tested, turn_slip=disc)
    side = "RIGHT" if str(values["TYRESIDE"]).upper().startswith("R") else "LEFT"
    model = {**values, **written, "TYRESIDE": side, "FITTYP": 62}
    all_comments = {**_comments(known.origin, tested), **comments}

    changed: dict[str, float] = {}
    if disc:
        terms = camber_stiffness_terms(values, C_gamma, float(points.p[main_pressure(points)].mean()))
        changed = derive_normal(model, tested, written, terms, symmetric=symmetric)
    made = {
        "turn-slip": (model, all_comments),
        "normal": ({**model, **changed}, {**all_comments, **dict.fromkeys(changed, DERIVED)}),
    }
    road = road_grid(tested, written, float(model["FNOMIN"]))
    by_use = {
        use: _figures(content, remarks, base, use, model, road, tested, disc)
        for use, (content, remarks) in made.items()
        if disc or use == "normal"
    }
    return Files(by_use, tested, written, tuple(changed), _lacking(model) if disc else {})


DERIVED = "fitted to the model without path curvature"


def _figures(values, comments, base, use, model, road: Road, tested, disc: bool) -> FileFigures:
    tyre = (base or Tyre.from_values({})).replace(**{**values, "USE_MODE": use_mode(values, use)})
    with_spin = use == "turn-slip"
    here, target = road.forces(tyre.values, turn_slip=with_spin), road.forces(model, turn_slip=disc)
    weight, within = weights(road, tested), inside(road, tested)
    straight = {
        name: _misfit(getattr(here, name) - getattr(target, name), road, weight, within)
        for name in ("Fy", "Mz")
    }
    gamma = np.array([-1e-3, 1e-3])
    Fy = tyre(float(values["FNOMIN"]), gamma=gamma, turn_slip=with_spin).Fy
    return FileFigures(tyre.annotate(status=comments), straight, float(np.diff(Fy)[0] / np.diff(gamma)[0]))


def _misfit(difference: np.ndarray, road: Road, weight: np.ndarray, within: np.ndarray) -> Misfit:
    def rms(used: np.ndarray) -> float:
        return float(np.sqrt(np.mean(difference[used] ** 2))) if np.any(used) else 0.0

    return Misfit(
        rms=rms(within),
        weighted=float(np.sqrt(np.average(difference[within] ** 2, weights=weight[within]))),
        largest=float(np.max(np.abs(difference[within]))),
        lean_30=rms(within & (np.abs(road.gamma) < np.radians(30.5))),
        beyond=rms(~within),
    )


def use_mode(values: Mapping[str, Any], use: str) -> int:
    """USE_MODE of a file: contact, transient behaviour and forces as MF-Tyre's three digits.

    Hundreds 2 is the circular cross-section of a motorcycle tyre (one with MC_CONTOUR), 1 a smooth road; tens 2 the
    nonlinear transient; units 5 combined slip with turn slip, 4 without.
    """
    contact = 200 if float(values["MC_CONTOUR_A"]) > 0.0 else 100
    return contact + 20 + (5 if use == "turn-slip" else 4)


def _lacking(model: Mapping[str, Any]) -> dict[float, float]:
    """Turn-slip force [N] of the upright wheel at nominal load on roads of the radii."""
    tyre = Tyre.from_values(dict(model))
    load = float(model["FNOMIN"])
    straight = float(tyre(load, turn_slip=True).Fy)
    return {R: abs(float(tyre(load, phi_t=-1.0 / R).Fy) - straight) for R in RADII}


WORDS = {
    "base": "from base",
    "default": "default, not measured",
    "estimate": "estimate, not measured",
    "regularised": "tied to base value",
    "range": "estimate, checked plausible",
    "given": "given in tyre.toml",
}


def decisions(config: Any) -> dict[str, str]:
    """Origin of the values that the configuration or the build itself decides."""
    given = [name for name, key in GIVEN.items() if getattr(config.tyre, key) is not None]
    return {**dict.fromkeys(NAMES, "range"), **dict.fromkeys((*DECIDED, *given), "given")}


def _comments(status: Mapping[str, str], tested: Mapping[str, float]) -> dict[str, str]:
    """Where every value comes from, and what it is where that is no coefficient's name."""
    out = {}
    for row in TABLE:
        words = WORDS.get(status[row.name], status[row.name])
        if row.name in DECIDED:
            words = "given by this build"
        if row.name in tested:
            words = f"{words}, tested to {tested[row.name]:.6g} {row.unit}"
        elif not row.section.endswith("_COEFFICIENTS"):
            words = f"{words}: {row.description}"
        out[row.name] = whole_words(words)
    return out


def whole_words(text: str, longest: int = LONGEST) -> str:
    """The text, cut between words if it is too long for a line."""
    return text if len(text) <= longest else text[: longest + 1].rsplit(" ", 1)[0].rstrip(",:")


def sentences(files: Files, names: Mapping[str, str]) -> list[str]:
    """Which file is for what, first of all, and what the file for turn slip off costs."""
    if len(files.by_use) == 1:
        return [
            f"Give {names['normal']} to the simulator with turn slip off (USE_MODE "
            f"{int(files.by_use['normal'].tyre['USE_MODE'])}): a straight path does not measure turn slip.",
            ranges_sentence(files),
        ]
    normal = files.by_use["normal"]
    fy, mz = normal.straight["Fy"], normal.straight["Mz"]
    modes = {use: int(f.tyre["USE_MODE"]) for use, f in files.by_use.items()}
    lacking = ", ".join(f"{force:.0f} N at {radius:g} m" for radius, force in files.lacking.items())
    return [
        f"Give {names['turn-slip']} to a simulator that computes turn slip, which is the turning of the wheel about the "
        f"vertical along a curve (its USE_MODE ends in 5, here {modes['turn-slip']}); give {names['normal']} to every other "
        f"simulator (USE_MODE ends in 4, here {modes['normal']}). If you do not know, it is the second one. Swapped, "
        "camber forces come out wrong.",
        f"{names['turn-slip']} is the fitted model itself.",
        f"{names['normal']} reproduces it on a straight path to {fy.weighted:.0f} N and {mz.weighted:.1f} Nm rms where "
        f"vehicles run ({fy.rms:.0f} N and {mz.rms:.1f} Nm over everything tested, {fy.largest:.0f} N at most): camber "
        "changes grip through spin, and without spin the formula has no term of that shape. Upright the two are equal.",
        f"{names['normal']} has {files.stiffness_loss:.0%} {'less' if files.stiffness_loss >= 0 else 'more'} camber "
        f"stiffness at zero camber than the model, and lacks the turn-slip force of curved roads (upright, nominal load; "
        f"by radius): {lacking}.",
        ranges_sentence(files),
    ]


def ranges_sentence(files: Files) -> str:
    """What was tested and what the files allow."""
    t, w = files.tested, files.written
    tested_pressure = (
        f"{t['PRESMIN'] / 1e3:.0f} kPa only"
        if t["PRESMAX"] - t["PRESMIN"] < 0.05 * t["PRESMAX"]
        else f"{t['PRESMIN'] / 1e3:.0f} to {t['PRESMAX'] / 1e3:.0f} kPa"
    )
    return (
        f"Tested: {t['FZMIN']:.0f} to {t['FZMAX']:.0f} N, sideslip to {np.degrees(t['ALPMAX']):.1f} deg, camber to "
        f"{np.degrees(t['CAMMAX']):.1f} deg, {tested_pressure}. The ranges in the file are wider, as simulators clamp to them: "
        f"the model stays plausible, not measured, over {w['FZMIN']:.0f} to {w['FZMAX']:.0f} N, "
        f"{np.degrees(w['ALPMAX']):.0f} deg of sideslip, {np.degrees(w['CAMMAX']):.0f} deg of camber, "
        f"{w['PRESMIN'] / 1e3:.0f} to {w['PRESMAX'] / 1e3:.0f} kPa."
    )


def file_names(name: str, exact: str, on_disc: bool) -> dict[str, str]:
    """Names of the written files by use; ``exact`` carries the plain one."""
    if not on_disc:
        return {"normal": f"{name}.tir"}
    return {use: f"{name}.tir" if use == exact else f"{name}-{use}.tir" for use in ("turn-slip", "normal")}
