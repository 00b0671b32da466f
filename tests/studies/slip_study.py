"""Does a build with drive, brake and combined slip find the truth? `nice python tests/studies/slip_study.py 60`.

Draws tyres around a car's and a motorcycle's file, rigs with all errors from the declared uncertainties, the zero of Mz from
its usual size, and the noise of every channel; builds each campaign, without a base file or with one up to 30 % off, and
prints the tables of docs/recovery.md: misfit over noise, forces against the noise-free truth over the tested range, coverage of
coefficients and bands, and the worst draws with their seeds. With ``--exact`` the zeros of the angles and of Fy and Mz are right,
which on a flat track are hardly separable from ply-steer, conicity and residual torque.
"""

from __future__ import annotations

import argparse
import math
import pickle
import sys
import time
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "fit"))

from drawn_rigs import SAMPLES, STAGED, Draw, half_of_mean, on_disk, scaled
from recovery_study import coverage

import mffit
import tir
from mffit.errors import InputError
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.rig_errors import DECLARED, ZEROS
from mffit.scatter import rms
from mffit.virtual_rig.machine import loaded_radius

RADII = ("VERTICAL_STIFFNESS", "Q_FZ2", "PFZ1", "BREFF", "DREFF", "FREFF")
"""Coefficients of the radii that are drawn like the staged ones."""
FREE_RADIUS = 0.003
"""Range of the drawn Q_RE0 to either side, relative."""
FOUND = (*STAGED, *RADII, "Q_RE0", "QSY1")
"""Coefficients whose intervals are compared with the truth."""
UNSETTLED = dict.fromkeys((f"QSX{k}" for k in (*range(4, 13), 14)), 0.0)
"""One form of the overturning moment for all drawn tyres: programs disagree about the others."""
DRAWN_ZEROS = ("Fx0_N", "Mx0_Nm", "My0_Nm")
RIGHT = {
    error.name: error.undisturbed
    for error, _ in DECLARED
    if error.name not in (*DRAWN_ZEROS, "path_radius_m") and math.isfinite(error.undisturbed)
}
"""Declared rig errors that are absent with ``--exact``, because coefficients take them up."""
UNDECLARED = {error.name: error.spread for error in ZEROS if not error.declared}
"""Usual size of the zeros that [rig] does not declare."""
CHANNELS = ("Fx", "Fy", "Mz", "Mx")
NOISE_OFF = 2.0
"""Largest factor on a channel's noise, up or down."""
SPEED = 16.7
"""Nominal speed and that of most sweeps [m/s]."""
CONDITIONS = 400
"""Drawn conditions at which forces are compared, per range."""


@dataclass(frozen=True)
class Vehicle:
    """What is drawn around, and how such a tyre is run."""

    true: Path
    tyre: Mapping[str, Any]  #: [tyre] of the project
    noise: Mapping[str, float]
    camber: float  #: [deg], to either side

    def at(self, share: float) -> float:
        """A load as a share of the nominal one, rounded [N]."""
        return float(round(share * self.tyre["nominal_load"], -2))


CAR = Vehicle(
    SAMPLES / "flat-track-combined" / "true.tir",
    {"size": "225/45R17", "unloaded_radius": 0.3185, "width": 0.225, "rim_radius": 0.2159,
     "nominal_load": 4200.0, "nominal_pressure": 240.0},
    {"Fx_N": 15.0, "Fy_N": 12.0, "Mx_Nm": 6.0, "My_Nm": 0.8, "Mz_Nm": 1.5, "RL_m": 0.0002, "omega_radps": 0.02},
    4.0,
)  # fmt: skip
MOTORCYCLE = Vehicle(
    SAMPLES / "front-120-70" / "true.tir",
    {"size": "120/70R17", "unloaded_radius": 0.2992, "width": 0.12, "rim_radius": 0.2159,
     "nominal_load": 1400.0, "nominal_pressure": 250.0},
    {"Fx_N": 12.0, "Fy_N": 8.0, "Mx_Nm": 2.0, "My_Nm": 0.3, "Mz_Nm": 1.0, "RL_m": 0.0002, "omega_radps": 0.02},
    20.0,
)  # fmt: skip
VEHICLES = {"car": CAR, "motorcycle": MOTORCYCLE}


@dataclass(frozen=True)
class Kind:
    """A kind of campaign."""

    vehicle: Vehicle = CAR
    base: bool = False  #: a base file up to 30 % off in every coefficient
    thin: bool = False  #: two loads, no camber
    one_sideslip: bool = False  #: combined slip at one sideslip, to one side

    @property
    def shares(self) -> tuple[float, ...]:
        """Loads over the nominal one."""
        return (0.5, 1.0) if self.thin else (0.5, 1.0, 1.5)

    @property
    def cambers(self) -> list[float]:
        return [0.0] if self.thin else [-self.vehicle.camber, 0.0, self.vehicle.camber]

    @property
    def sideslips(self) -> list[float]:
        """Those of combined slip [deg]."""
        return [4.0] if self.one_sideslip else [-6.0, -2.0, 2.0, 6.0]


CAMPAIGNS = {
    "full": Kind(),
    "full, base 30 % off": Kind(base=True),
    "thin": Kind(thin=True),
    "thin, base 30 % off": Kind(thin=True, base=True),
    "one sideslip": Kind(one_sideslip=True),
    "one sideslip, base 30 % off": Kind(one_sideslip=True, base=True),
}
KINDS = {
    f"{word}, {name}": replace(kind, vehicle=vehicle)
    for name, kind in CAMPAIGNS.items()
    for word, vehicle in VEHICLES.items()
}
SWEPT_SLIP = {"from": -0.2, "to": 0.2, "step": 0.02}
SWEPT_SIDESLIP = {"from": -12, "to": 12, "step": 1.5}


@dataclass(frozen=True)
class Gap:
    """Difference of a fitted channel from the truth over a range."""

    rms: float  #: [N] or [Nm]
    noise: float  #: of a point
    within: float  #: share of the conditions within twice the noise
    banded: float  #: share of the conditions whose truth the 95 % band contains


@dataclass
class SlipDraw(Draw):
    """A draw with everything that longitudinal slip adds."""

    kind: str = ""
    seed: int = 0
    trusted: bool = True
    reasons: tuple[str, ...] = ()
    at_bound: tuple[str, ...] = ()
    overall: float = 0.0
    """Misfit over noise of all channels together, with the freedom that the numbers of the fit take."""
    gaps: dict[tuple[str, str], Gap] = field(default_factory=dict)  #: by range and channel


def sweeps(kind: Kind) -> list[dict[str, Any]]:
    """The campaign: sideslip, drive and brake, combined slip, and free rolling over load, pressure and speed."""
    vehicle, nominal = kind.vehicle, kind.vehicle.tyre["nominal_pressure"]
    others = [nominal - 40.0, nominal + 40.0]
    out: list[dict[str, Any]] = []
    for share in kind.shares:
        load = vehicle.at(share)
        common = {"load_N": load, "gamma_deg": kind.cambers}
        out.append({"file": f"sideslip_{load:.0f}N.csv", "alpha_deg": SWEPT_SIDESLIP, **common})
        out.append({"file": f"drive_{load:.0f}N.csv", "kappa": SWEPT_SLIP, **common})
        out.append(
            {
                "file": f"combined_{load:.0f}N.csv",
                "load_N": load,
                "kappa": SWEPT_SLIP,
                "alpha_deg": kind.sideslips,
            }
        )
    load = vehicle.at(1.0)
    out.append(
        {"file": "sideslip_pressures.csv", "load_N": load, "alpha_deg": SWEPT_SIDESLIP, "p_kPa": others}
    )
    out.append({"file": "drive_pressures.csv", "load_N": load, "kappa": SWEPT_SLIP, "p_kPa": others})
    if not kind.thin:
        leant = {"gamma_deg": vehicle.camber, "alpha_deg": kind.sideslips, "kappa": SWEPT_SLIP}
        out.append({"file": "combined_camber.csv", "load_N": load, **leant})
    out.append(
        {
            "file": "rolling.csv",
            "load_N": [vehicle.at(s) for s in np.linspace(0.5 * kind.shares[0], kind.shares[-1], 6)],
            "p_kPa": [others[0], nominal, others[1]],
            "V_mps": [8, SPEED, 30],
            "free_rolling": True,
        }
    )
    return out


def one(seed: int, name: str, off: float, *, exact: bool = False) -> SlipDraw:
    """Draw, simulate and build one campaign."""
    rng, kind = np.random.default_rng(9000 + seed), KINDS[name]
    vehicle = kind.vehicle
    true = _drawn(tir.read(vehicle.true).replace(**UNSETTLED, LONGVL=SPEED), off, rng)
    noise = {key: float(x * NOISE_OFF ** rng.uniform(-1.0, 1.0)) for key, x in vehicle.noise.items()}
    draw = SlipDraw(kind=name, seed=seed)
    own = np.random.default_rng([9000, seed])
    undeclared = {error: float(u * own.standard_normal()) for error, u in UNDECLARED.items()}
    content = {
        "faults": {"draw": True, **(RIGHT if exact else undeclared)},
        "noise": noise,
        "conditions": {"V_mps": SPEED},
        "tyre": {"name": "drawn", "nominal_speed": SPEED, "side": "left", **vehicle.tyre},
        "rig": {"type": "flat-track", "axes": "sae"},
        "sweep": sweeps(kind),
    }
    base = _drawn(true, 0.3, rng) if kind.base else None
    with on_disk(true, content, seed, base=base) as (path, known):
        try:
            result = mffit.build(path)
        except InputError as error:
            draw.refused = str(error)
            return draw
    _compare(draw, result, true, known.to_json()["faults"], kind, noise, rng)
    return draw


def _drawn(tyre: tir.Tyre, off: float, rng: np.random.Generator) -> tir.Tyre:
    tyre = scaled(tyre, off, rng, (*STAGED, *RADII, "QSY1"))
    return scaled(tyre, min(off, FREE_RADIUS), rng, ("Q_RE0",))


def _compare(
    draw: SlipDraw,
    result: Any,
    true: tir.Tyre,
    faults: Mapping[str, float],
    kind: Kind,
    noise: Mapping[str, float],
    rng: np.random.Generator,
) -> None:
    fit = result.fit
    draw.seconds, draw.doubted = fit.seconds, len(fit.doubts)
    draw.trusted, draw.reasons = result.trusted, tuple(result.trust.reasons)
    draw.at_bound = tuple(name for name, row in fit.coefficients.items() if row.at_bound)
    sigma = {name: noise[column] for name in CHANNELS for column in noise if column.startswith(f"{name}_")}
    for name in CHANNELS:
        draw.misfit[name] = fit.channels[name].rmse / sigma[name]
    draw.overall = _with_freedom(draw.misfit, fit)
    draw.note_coefficients(fit, true, [name for name in FOUND if true[name]])  # a factor moves no zero
    for name, (value, u) in fit.rig.items():
        draw.note(f"rig.{name}", value, u, faults[name])
    for word, where in _ranges(kind, rng).items():
        found, truth = (tyre(**where, Vx=SPEED, turn_slip=False) for tyre in (fit.written, true))
        points = make_points(**where, V=SPEED, phi_t=0.0)
        half = half_of_mean(fit, Simulation(fit.written.values, turn_slip=False), points)
        for name in CHANNELS:
            gap = np.abs(getattr(found, name) - getattr(truth, name))
            within, banded = (float(np.mean(gap < reach)) for reach in (2.0 * sigma[name], half[name]))
            draw.gaps[word, name] = Gap(rms(gap), sigma[name], within, banded)
    draw.error |= _radius_errors(fit.written, true, kind)


def _with_freedom(misfit: Mapping[str, float], fit: Any) -> float:
    """Misfit over noise whose expected value is 1: a number that its prior decides takes no freedom from the points."""
    points = {name: fit.channels[name].n for name in CHANNELS}
    squares = sum(points[name] * misfit[name] ** 2 for name in CHANNELS)
    taken = sum(1.0 - (fit.search.stderr[n.name] / n.spread) ** 2 for n in fit.search.numbers)
    return math.sqrt(squares / (sum(points.values()) - taken))


def _ranges(kind: Kind, rng: np.random.Generator) -> dict[str, dict[str, np.ndarray]]:
    """Conditions (n,) between those that were run: over sideslip, over slip, of both together, and at other pressures."""
    vehicle, n = kind.vehicle, CONDITIONS
    loads = [vehicle.at(share) for share in kind.shares]
    p = np.full(n, 1e3 * vehicle.tyre["nominal_pressure"])
    Fz, gamma = (
        rng.uniform(loads[0], loads[-1], n),
        np.radians(rng.uniform(kind.cambers[0], kind.cambers[-1], n)),
    )
    alpha, kappa = np.radians(rng.uniform(-12.0, 12.0, n)), rng.uniform(-0.2, 0.2, n)
    low, high = min(*kind.sideslips, 0.0), max(kind.sideslips)
    both = np.radians(rng.uniform(low, high, n))
    none = np.zeros(n)
    nominal, other = np.full(n, vehicle.at(1.0)), p + 40e3 * rng.uniform(-1.0, 1.0, n)
    either = rng.random(n) < 0.5
    return {
        "sideslip": {"Fz": Fz, "alpha": alpha, "gamma": gamma, "kappa": none, "p": p},
        "slip": {"Fz": Fz, "alpha": none, "gamma": gamma, "kappa": kappa, "p": p},
        "ellipse, upright": {"Fz": Fz, "alpha": both, "gamma": none, "kappa": kappa, "p": p},
        "ellipse, camber": {"Fz": nominal, "alpha": both, "gamma": np.abs(gamma), "kappa": kappa, "p": p},
        "pressures": {
            "Fz": nominal,
            "alpha": np.where(either, alpha, 0.0),
            "gamma": none,
            "kappa": np.where(either, 0.0, kappa),
            "p": other,
        },
    }


def _radius_errors(model: tir.Tyre, true: tir.Tyre, kind: Kind) -> dict[str, float]:
    """Rms errors of the loaded and the rolling radius [mm] and of the rolling moment [Nm] over the tested loads."""
    Fz = np.linspace(kind.vehicle.at(0.5 * kind.shares[0]), kind.vehicle.at(kind.shares[-1]), 13)
    p, V = 1e3 * kind.vehicle.tyre["nominal_pressure"], SPEED

    def rolling(tyre: tir.Tyre) -> tuple[np.ndarray, ...]:
        Re = tyre.state(Fz, Vx=V, p=p).Re
        return (
            1e3 * loaded_radius(tyre.values, Fz, 0.0, 0.0, 0.0, V / Re, p),
            1e3 * Re,
            tyre(Fz, Vx=V, p=p).My,
        )

    names = ("loaded radius [mm]", "rolling radius [mm]", "My [Nm]")
    return {name: rms(a - b) for name, a, b in zip(names, rolling(model), rolling(true), strict=True)}


def tables(draws: Sequence[SlipDraw]) -> Iterable[str]:
    """Lines of all tables."""
    for d in draws:
        if d.refused:
            yield f"* seed {d.seed}, {d.kind}: refused: {d.refused}"
    draws = [d for d in draws if not d.refused]
    yield from _misfits(draws)
    yield from _against_truth(draws)
    yield from _summary_of_coverage(draws)
    yield from coverage(draws)
    yield from _worst(draws)


def _by_kind(draws: Sequence[SlipDraw]) -> dict[str, list[SlipDraw]]:
    """Draws by kind of campaign, both vehicles together, and all."""
    found = {name: [d for d in draws if d.kind.split(", ", 1)[1] == name] for name in CAMPAIGNS}
    return {name: rows for name, rows in found.items() if rows} | {"all": list(draws)}


def _misfits(draws: Sequence[SlipDraw]) -> Iterable[str]:
    yield "\n## Misfit over noise\n"
    yield (
        "| campaign | builds | "
        + " | ".join(f"{c} median (range)" for c in CHANNELS)
        + " | all, with freedom | of these in 0.95-1.05 | fit [s] |"
    )
    yield "|---" * (5 + len(CHANNELS)) + "|"
    for name, rows in _by_kind(draws).items():
        x = np.array([[d.misfit[c] for c in CHANNELS] for d in rows])
        cells = [f"{np.median(c):.2f} ({c.min():.2f}-{c.max():.2f})" for c in x.T]
        overall = np.array([d.overall for d in rows])
        inside = np.mean((overall > 0.95) & (overall < 1.05))
        cells.append(f"{np.median(overall):.2f} ({overall.min():.2f}-{overall.max():.2f})")
        seconds = np.median([d.seconds for d in rows])
        yield f"| {name} | {len(rows)} | " + " | ".join(cells) + f" | {inside:.0%} | {seconds:.1f} |"


def _against_truth(draws: Sequence[SlipDraw]) -> Iterable[str]:
    yield "\n## Rms error against the noise-free truth over the noise of a point: median (largest draw)\n"
    words = list(draws[0].gaps)
    yield "| range | campaign | " + " | ".join(CHANNELS) + " | within twice the noise |"
    yield "|---" * (3 + len(CHANNELS)) + "|"
    for word in dict.fromkeys(word for word, _ in words):
        for name, rows in _by_kind(draws).items():
            x = np.array([[d.gaps[word, c].rms / d.gaps[word, c].noise for c in CHANNELS] for d in rows])
            within = np.mean([d.gaps[word, c].within for d in rows for c in CHANNELS])
            cells = [f"{np.median(c):.2f} ({c.max():.2f})" for c in x.T]
            yield f"| {word} | {name} | " + " | ".join(cells) + f" | {within:.1%} |"
    yield "\n## Conditions whose truth the 95 % band contains (draws with more than half of them)\n"
    yield "| range | " + " | ".join(CHANNELS) + " |"
    yield "|---" * (1 + len(CHANNELS)) + "|"
    for word in dict.fromkeys(word for word, _ in words):
        inside = np.array([[d.gaps[word, c].banded for c in CHANNELS] for d in draws])
        cells = [f"{np.mean(c):.1%} ({np.mean(c > 0.5):.0%})" for c in inside.T]
        yield f"| {word} | " + " | ".join(cells) + " |"
    yield "\n## The same in N and Nm, rms of all draws\n"
    yield "| range | vehicle | " + " | ".join(CHANNELS) + " |"
    yield "|---" * (2 + len(CHANNELS)) + "|"
    for word in dict.fromkeys(word for word, _ in words):
        for vehicle in VEHICLES:
            rows = [d for d in draws if d.kind.startswith(vehicle)]
            if rows:
                cells = [f"{rms(np.array([d.gaps[word, c].rms for d in rows])):.3g}" for c in CHANNELS]
                yield f"| {word} | {vehicle} | " + " | ".join(cells) + " |"
    yield "\n## Radii and rolling moment, rms (largest)\n"
    names = list(draws[0].error)
    yield "| campaign | " + " | ".join(names) + " |"
    yield "|---" * (1 + len(names)) + "|"
    for name, rows in _by_kind(draws).items():
        x = np.array([[d.error[n] for n in names] for d in rows])
        yield f"| {name} | " + " | ".join(f"{rms(c):.2g} ({c.max():.2g})" for c in x.T) + " |"


def _summary_of_coverage(draws: Sequence[SlipDraw]) -> Iterable[str]:
    yield "\n## Coefficients inside their 95 % intervals\n"
    yield "| campaign | fitted | inside | regularised | inside | of the rig | inside | at a bound | trusted |"
    yield "|---" * 9 + "|"
    for name, rows in _by_kind(draws).items():
        cells = []
        for word in ("", "(regularised)", "rig."):
            found = [x for d in rows for n, x in d.inside.items() if _sort(n) == word]
            cells += [f"{len(found)}", f"{np.mean(found):.1%}" if found else ""]
        bounds = sum(len(d.at_bound) for d in rows)
        yield (
            f"| {name} | "
            + " | ".join(cells)
            + f" | {bounds} | {sum(d.trusted for d in rows)} of {len(rows)} |"
        )


def _sort(name: str) -> str:
    return "rig." if name.startswith("rig.") else "(regularised)" if "(" in name else ""


def _worst(draws: Sequence[SlipDraw], most: int = 12) -> Iterable[str]:
    yield "\n## Largest errors\n"
    gaps = [(g.rms / g.noise, d, key) for d in draws for key, g in d.gaps.items()]
    for size, d, (word, channel) in sorted(gaps, key=lambda row: -row[0])[:most]:
        yield f"* {channel} over {word}: {size:.2f} of the noise ({d.gaps[word, channel].rms:.3g}); seed {d.seed}, {d.kind}"
    pulls = [(abs(x), x, d, n) for d in draws for n, x in d.pulls.items() if not d.inside[n]]
    for _, x, d, name in sorted(pulls, key=lambda row: -row[0])[:most]:
        yield f"* {name}: {x:+.1f} standard errors; seed {d.seed}, {d.kind}"
    bounds = Counter(name for d in draws for name in d.at_bound)
    yield "* at a bound: " + (", ".join(f"{n} {k}" for n, k in bounds.most_common()) or "none")
    for d in draws:
        if not d.trusted:
            yield f"* seed {d.seed}, {d.kind}: {'; '.join(d.reasons)}"


def main() -> None:
    ask = argparse.ArgumentParser()
    ask.add_argument("builds", type=int, nargs="?", default=60)
    ask.add_argument(
        "--first", type=int, default=0, help="first seed; the kind of campaign follows from the seed"
    )
    ask.add_argument("--only", type=int, nargs="*", help="these seeds only")
    ask.add_argument("--off", type=float, default=0.12, help="largest relative distance of a coefficient")
    ask.add_argument("--minutes", type=float, default=1e9, help="no further build is started after this time")
    ask.add_argument(
        "--exact", action="store_true", help="rigs whose zeros are right, as far as coefficients take them up"
    )
    ask.add_argument("--pickle", help="file for all draws")
    given = ask.parse_args()
    seeds = given.only or range(given.first, given.first + given.builds)
    began, kinds, draws = time.monotonic(), list(KINDS), []
    for seed in seeds:
        if time.monotonic() - began > 60.0 * given.minutes:
            break
        draws.append(one(seed, kinds[seed % len(kinds)], given.off, exact=given.exact))
        if given.pickle:
            Path(given.pickle).write_bytes(pickle.dumps(draws))
    print(f"{len(draws)} builds\n")
    print("\n".join(tables(draws)))


if __name__ == "__main__":
    main()
