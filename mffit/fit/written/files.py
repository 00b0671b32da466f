"""The property files of a build: their values, their ranges, the origin of every value, and their misfit."""

from __future__ import annotations

import math
from collections.abc import Container, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from mffit.as_json import document, keys
from mffit.config import Config
from mffit.fit import constants
from mffit.fit.known import Known
from mffit.fit.ranges import NAMES as RANGES
from mffit.fit.ranges import plausible_ranges, sideslips_with_slip, tested_ranges, with_room
from mffit.fit.written.misfit import FileFigures, figures
from mffit.fit.written.normal import derive
from mffit.fit.written.road import held_to_camber, road_grid
from mffit.points import Points, main_path
from tir import Tyre


@dataclass(frozen=True, slots=True)
class Files:
    """The files of a build with their ranges."""

    by_use: Mapping[str, FileFigures]
    """On a disc "turn-slip" and "normal", and "both" if asked for; on a flat track "normal"."""
    tested: Mapping[str, float]  #: ranges of the points
    written: Mapping[str, float]  #: ranges of the files
    changed: Mapping[str, tuple[str, ...]]  #: by use, coefficients that differ from the fitted model
    lacking: Mapping[float, float]
    """Turn-slip force [N] at nominal load, by radius of the road [m], that the file for turn slip off lacks."""
    weight: str = "everything"  #: of the file for turn slip off, see :func:`mffit.fit.written.road.weights`
    camber_limit: float | None = None  #: largest camber of the file for turn slip off [rad]
    wide_limit: float | None = None
    """Requested camber limit beyond the files' camber range, hence without effect [rad]."""
    sideslips_with_slip: tuple[float, ...] = ()  #: sideslips at which longitudinal slip was run [rad]
    untested: Mapping[str, str] = field(default_factory=dict)
    """By quantity that the sweeps do not vary, the origin of its written range, in words."""

    @property
    def stiffness_loss(self) -> float:
        """Relative shortfall of the camber stiffness at zero in the file for turn slip off."""
        return 1.0 - self.by_use["normal"].camber_stiffness / self.by_use["turn-slip"].camber_stiffness

    def annotated(self, comments: Mapping[str, Mapping[str, str]]) -> Files:
        """The files with comments on their values, by use and name."""
        by_use = {
            use: replace(file, tyre=file.tyre.annotate(status=comments[use]))
            for use, file in self.by_use.items()
        }
        return replace(self, by_use=by_use)


keys(
    Files,
    "**by_use ranges",
    by_use=lambda files: {use: _file(files, use) for use in files.by_use},
    ranges=lambda files: {"tested": files.tested, "written": files.written},
)


def _file(files: Files, use: str) -> dict[str, object]:
    """JSON of a written file: its misfits, and for the file without turn slip also the forces that it lacks."""
    file, out = files.by_use[use], dict[str, object](document(files.by_use[use]))
    if use in files.changed:
        out["coefficients"] = {name: file.tyre[name] for name in files.changed[use]}
    if use == "normal" and files.lacking:
        limit = files.camber_limit
        out |= {
            "camber_stiffness_loss": files.stiffness_loss,
            "weight": files.weight,
            "camber_max_deg": None if limit is None else math.degrees(limit),
            "turn_slip_force_lacking_N": {f"{r:g} m": force for r, force in files.lacking.items()},
        }
    return out


def make_files(
    config: Config, known: Known, points: Points, base: Tyre | None, *, only: str | None = None
) -> Files:
    """The files of a build: on a disc one for each use, on a flat track one; ``only`` limits them to one use."""
    disc = config.rig.on_disc
    tested = tested_ranges(points)
    stated = {} if base is None else {name: float(base[name]) for name in RANGES if name in base.present}
    plausible = plausible_ranges(known.values, tested, turn_slip=disc)
    written, untested = with_room(known.values, plausible, stated, turn_slip=disc)
    side = "RIGHT" if str(known.values["TYRESIDE"]).upper().startswith("R") else "LEFT"
    model = {**known.values, **written, "TYRESIDE": side, "FITTYP": 62}
    asked = config.normal.camber_max if disc else None
    camber = None if asked is None or asked >= written["CAMMAX"] else asked
    symmetric = config.tyre.side == "symmetric"

    def changed(use: str) -> dict[str, float]:
        """The coefficients in which the file for a use differs from the fitted model."""
        if use == "turn-slip" or not disc:
            return {}
        both = use == "both"
        to = None if both else camber
        return derive(
            model,
            held_to_camber(tested, to),
            held_to_camber(written, to),
            both_on=main_path(points) if both else None,
            symmetric=symmetric,
            hand=known.hand,
            weight="everything" if both else config.normal.weight,
        )

    def file(use: str, values: Mapping[str, float]) -> FileFigures:
        limit = camber if use == "normal" else None
        held, inside = held_to_camber(written, limit), held_to_camber(tested, limit)
        ends = {name: held[name] for name in ("CAMMIN", "CAMMAX")} if limit is not None else {}
        tyre = (base or Tyre.from_values({})).replace(
            **{**model, **values, **ends, "USE_MODE": use_mode(model, use)}
        )
        road = road_grid(inside, held, float(model["FNOMIN"]))
        return figures(tyre, use, model, road, inside, main_path(points))

    uses = dict.fromkeys(("turn-slip", "normal", config.spin.exact)) if disc else {"normal": None}
    own = {use: changed(use) for use in uses if only in (None, use)}
    return Files(
        by_use={use: file(use, values) for use, values in own.items()},
        weight=config.normal.weight,
        camber_limit=camber,
        wide_limit=asked if camber is None else None,
        tested=tested,
        written=written,
        changed={use: tuple(values) for use, values in own.items() if values},
        lacking=_turn_slip_forces(model) if disc else {},
        sideslips_with_slip=sideslips_with_slip(points),
        untested=untested,
    )


def _turn_slip_forces(model: Mapping[str, Any]) -> dict[float, float]:
    """Turn-slip force [N] of the upright wheel at nominal load by radius of the road [m]."""
    tyre = Tyre.from_values(dict(model))
    load = float(model["FNOMIN"])
    straight = float(tyre(load, turn_slip=True).Fy)
    return {
        R: abs(float(tyre(load, phi_t=-1.0 / R, turn_slip=True).Fy) - straight) for R in constants.ROAD_RADII
    }


def use_mode(values: Mapping[str, Any], use: str) -> int:
    """USE_MODE of a file: MF-Tyre's three digits for contact, transient behaviour and forces.

    Hundreds: 2 for the circular cross-section of a motorcycle tyre (one with MC_CONTOUR), 1 for a smooth road. Tens: 2 for the
    nonlinear transient. Units: 5 for combined slip with turn slip, 4 without.
    """
    contact = 200 if float(values["MC_CONTOUR_A"]) > 0.0 else 100
    return contact + 20 + (4 if use == "normal" else 5)


def name_at_temperature(name: str) -> str:
    """Name of the file that holds at one temperature."""
    return f"{name}-at-temperature.tir"


def fitted_use(uses: Container[str]) -> str:
    """The use whose file holds the fitted model."""
    return "turn-slip" if "turn-slip" in uses else "normal"


def plain_use(config: Config) -> str:
    """The use whose file has the plain name."""
    return config.spin.exact if config.rig.on_disc else "normal"


def file_names(name: str, exact: str, on_disc: bool) -> dict[str, str]:
    """Names of the written files by use; the file for the use ``exact`` has the plain name."""
    if not on_disc:
        return {"normal": f"{name}.tir"}
    uses = dict.fromkeys((exact, "turn-slip", "normal"))
    return {use: f"{name}.tir" if use == exact else f"{name}-{use}.tir" for use in uses}
