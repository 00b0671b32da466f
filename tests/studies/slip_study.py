"""Does a build with drive, brake and combined slip find the truth? `nice python tests/studies/slip_study.py 60`.

Draws tyres around a car's and a motorcycle's file, rigs with all errors from the declared uncertainties, the zero of Mz from
its usual size, and the noise of every channel; builds each campaign, without a base file or with one up to 30 % off, and
prints the tables of docs/recovery.md: misfit over noise, forces against the noise-free truth over the tested range, coverage of
coefficients and bands, and the worst draws with their seeds. With ``--exact`` the zeros of the angles and of Fy and Mz are right,
which on a flat track are hardly separable from ply-steer, conicity and residual torque.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import harness
import numpy as np
from drawn_rigs import SAMPLES, STAGED, Draw, half_of_mean, on_disk, scaled

import tir
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

    def drawn(self, off: float, rng: np.random.Generator) -> tir.Tyre:
        return drawn(tir.read(self.true).replace(**UNSETTLED, LONGVL=SPEED), off, rng)

    def content(
        self, sweeps: list[dict[str, Any]], faults: Mapping[str, float], noise: Mapping[str, float]
    ) -> Any:
        """The campaign as a ``rig.toml``."""
        return {
            "faults": {"draw": True, **faults},
            "noise": dict(noise),
            "conditions": {"V_mps": SPEED},
            "tyre": {"name": "drawn", "nominal_speed": SPEED, "side": "left", **self.tyre},
            "rig": {"type": "flat-track", "axes": "sae"},
            "sweep": sweeps,
        }


VEHICLES = {
    "car": Vehicle(
        SAMPLES / "flat-track-combined" / "true.tir",
        {"size": "225/45R17", "unloaded_radius": 0.3185, "width": 0.225, "rim_radius": 0.2159,
         "nominal_load": 4200.0, "nominal_pressure": 240.0},
        {"Fx_N": 15.0, "Fy_N": 12.0, "Mx_Nm": 6.0, "My_Nm": 0.8, "Mz_Nm": 1.5, "RL_m": 0.0002, "omega_radps": 0.02},
        4.0,
    ),
    "motorcycle": Vehicle(
        SAMPLES / "front-120-70" / "true.tir",
        {"size": "120/70R17", "unloaded_radius": 0.2992, "width": 0.12, "rim_radius": 0.2159,
         "nominal_load": 1400.0, "nominal_pressure": 250.0},
        {"Fx_N": 12.0, "Fy_N": 8.0, "Mx_Nm": 2.0, "My_Nm": 0.3, "Mz_Nm": 1.0, "RL_m": 0.0002, "omega_radps": 0.02},
        20.0,
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Kind:
    """A kind of campaign."""

    vehicle: Vehicle = VEHICLES["car"]
    base: bool = False  #: a base file up to 30 % off in every coefficient
    thin: bool = False  #: two loads, no camber
    one_sideslip: bool = False  #: combined slip at one sideslip, to one side
    first: int = 9000  #: of the seeds

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

    @property
    def swept(self) -> dict[str, float]:
        """Sideslip of the sweeps over it [deg]."""
        return {"from": -12, "to": 12, "step": 1.5}

    def noise(self, rng: np.random.Generator) -> dict[str, float]:
        """The noise of every channel."""
        return {key: float(x * NOISE_OFF ** rng.uniform(-1.0, 1.0)) for key, x in self.vehicle.noise.items()}

    def asymmetric(self, tyre: tir.Tyre, size: float, rng: np.random.Generator) -> tir.Tyre:
        """The tyre that is run, once the base file is drawn around it."""
        return tyre

    def ranges(self, rng: np.random.Generator) -> dict[str, dict[str, np.ndarray]]:
        """Conditions (n,) between those that were run: over sideslip, over slip, of both, and at other pressures."""
        vehicle, n = self.vehicle, CONDITIONS
        loads, lean = [vehicle.at(share) for share in self.shares], self.cambers
        p = np.full(n, 1e3 * vehicle.tyre["nominal_pressure"])
        Fz, gamma = rng.uniform(loads[0], loads[-1], n), np.radians(rng.uniform(lean[0], lean[-1], n))
        alpha, kappa = np.radians(rng.uniform(-12.0, 12.0, n)), rng.uniform(-0.2, 0.2, n)
        both = np.radians(rng.uniform(min(*self.sideslips, 0.0), max(self.sideslips), n))
        none, nominal = np.zeros(n), np.full(n, vehicle.at(1.0))
        other = p + 40e3 * rng.uniform(-1.0, 1.0, n)
        either = rng.random(n) < 0.5
        names = ("Fz", "alpha", "gamma", "kappa", "p")
        rows = {
            "sideslip": (Fz, alpha, gamma, none, p),
            "slip": (Fz, none, gamma, kappa, p),
            "ellipse, upright": (Fz, both, none, kappa, p),
            "ellipse, camber": (nominal, both, np.abs(gamma), kappa, p),
            "pressures": (nominal, np.where(either, alpha, 0.0), none, np.where(either, 0.0, kappa), other),
        }
        return {word: dict(zip(names, row, strict=True)) for word, row in rows.items()}


THIN, ONE = Kind(thin=True), Kind(one_sideslip=True)
CAMPAIGNS = {
    f"{name}{words}": replace(kind, base=bool(words))
    for name, kind in {"full": Kind(), "thin": THIN, "one sideslip": ONE}.items()
    for words in ("", ", base 30 % off")
}
KINDS = {
    f"{word}, {name}": replace(kind, vehicle=vehicle)
    for name, kind in CAMPAIGNS.items()
    for word, vehicle in VEHICLES.items()
}
SWEPT_SLIP = {"from": -0.2, "to": 0.2, "step": 0.02}


@dataclass(frozen=True)
class Gap:
    """Difference of a fitted channel from the truth over a range."""

    rms: float  #: [N] or [Nm]
    noise: float  #: of a point
    within: float  #: share of the conditions within twice the noise
    half: float  #: rms half width of the 95 % band
    banded: float  #: share of the conditions whose truth it contains

    @property
    def over(self) -> float:
        return self.rms / self.noise


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
    slip, sideslip = {"kappa": SWEPT_SLIP}, {"alpha_deg": kind.swept}
    combined = {**slip, "alpha_deg": kind.sideslips}
    out: list[dict[str, Any]] = []

    def run(name: str, load: Any, **angles: Any) -> None:
        out.append({"file": f"{name}.csv", "load_N": load, **angles})

    for load in map(vehicle.at, kind.shares):
        run(f"sideslip_{load:.0f}N", load, **sideslip, gamma_deg=kind.cambers)
        run(f"drive_{load:.0f}N", load, **slip, gamma_deg=kind.cambers)
        run(f"combined_{load:.0f}N", load, **combined)
    load = vehicle.at(1.0)
    run("sideslip_pressures", load, **sideslip, p_kPa=others)
    run("drive_pressures", load, **slip, p_kPa=others)
    if not kind.thin:
        run("combined_camber", load, **combined, gamma_deg=vehicle.camber)
    loads = [vehicle.at(s) for s in np.linspace(0.5 * kind.shares[0], kind.shares[-1], 6)]
    p = [others[0], nominal, others[1]]
    run("rolling", loads, p_kPa=p, V_mps=[8, SPEED, 30], free_rolling=True)
    return out


def one(job: harness.Job) -> SlipDraw:
    return built(job, KINDS[job.world])


def built(job: harness.Job, kind: Kind) -> SlipDraw:
    """Draw, simulate and build one campaign."""
    seed, given, rng = job.seed, job.given, np.random.default_rng(kind.first + job.seed)
    true, noise = kind.vehicle.drawn(given.off, rng), kind.noise(rng)
    own = np.random.default_rng([9000, seed])
    undeclared = {error: float(u * own.standard_normal()) for error, u in UNDECLARED.items()}
    base = drawn(true, 0.3, rng) if kind.base else None
    true = kind.asymmetric(true, given.size, rng)
    content = kind.vehicle.content(sweeps(kind), RIGHT if given.exact else undeclared, noise)
    draw = SlipDraw(kind=job.world, seed=seed)
    with on_disk(true, content, seed, base=base) as (path, known):
        result = harness.built(path)
    if isinstance(result, str):
        draw.refused = f"seed {seed}, {job.world}: {result}"
        return draw
    sigma = {name: noise[column] for name in CHANNELS for column in noise if column.startswith(f"{name}_")}
    _judge(draw, result, true, sigma)
    for name, (value, u) in result.fit.rig.items():
        draw.note(f"rig.{name}", value, u, known.to_json()["faults"][name])
    draw.gaps = _gaps(result.fit, true, kind.ranges(rng), sigma)
    draw.error = _radius_errors(result.fit.written, true, kind)
    return draw


def drawn(tyre: tir.Tyre, off: float, rng: np.random.Generator) -> tir.Tyre:
    tyre = scaled(tyre, off, rng, (*STAGED, *RADII, "QSY1"))
    return scaled(tyre, min(off, FREE_RADIUS), rng, ("Q_RE0",))


def _judge(draw: SlipDraw, result: Any, true: tir.Tyre, sigma: Mapping[str, float]) -> None:
    """Note misfits, coefficients and trust."""
    fit = result.fit
    draw.seconds, draw.doubted = fit.seconds, len(fit.doubts)
    draw.trusted, draw.reasons = result.trusted, tuple(result.trust.reasons)
    draw.at_bound = tuple(name for name, row in fit.coefficients.items() if row.at_bound)
    draw.misfit = {name: fit.channels[name].rmse / sigma[name] for name in CHANNELS}
    draw.note_coefficients(fit, true, [name for name in FOUND if true[name]])  # a factor moves no zero
    points = {name: fit.channels[name].n for name in CHANNELS}
    squares = sum(points[name] * draw.misfit[name] ** 2 for name in CHANNELS)
    # A number that its prior decides takes no freedom from the points.
    taken = sum(1.0 - (fit.search.stderr[n.name] / n.spread) ** 2 for n in fit.search.numbers)
    draw.overall = math.sqrt(squares / (sum(points.values()) - taken))


def _gaps(fit: Any, true: tir.Tyre, ranges: Mapping[str, Any], sigma: Mapping[str, float]) -> Any:
    gaps = {}
    for word, where in ranges.items():
        found, truth = (tyre(**where, Vx=SPEED, turn_slip=False) for tyre in (fit.written, true))
        points = make_points(**where, V=SPEED, phi_t=0.0)
        half = half_of_mean(fit, Simulation(fit.written.values, turn_slip=False), points)
        for name in CHANNELS:
            gap = np.abs(getattr(found, name) - getattr(truth, name))
            within, banded = (float(np.mean(gap < reach)) for reach in (2.0 * sigma[name], half[name]))
            gaps[word, name] = Gap(rms(gap), sigma[name], within, rms(half[name]), banded)
    return gaps


def _radius_errors(model: tir.Tyre, true: tir.Tyre, kind: Kind) -> dict[str, float]:
    """Rms errors of the loaded and the rolling radius [mm] and of the rolling moment [Nm] over the tested loads."""
    Fz = np.linspace(kind.vehicle.at(0.5 * kind.shares[0]), kind.vehicle.at(kind.shares[-1]), 13)
    p, V = 1e3 * kind.vehicle.tyre["nominal_pressure"], SPEED

    def rolling(tyre: tir.Tyre) -> tuple[np.ndarray, ...]:
        Re = tyre.state(Fz, Vx=V, p=p).Re
        loaded = loaded_radius(tyre.values, SimpleNamespace(Fx=0.0, Fy=0.0, Fz=Fz), 0.0, V / Re, p)
        return 1e3 * loaded, 1e3 * Re, tyre(Fz, Vx=V, p=p).My

    names = ("loaded radius [mm]", "rolling radius [mm]", "My [Nm]")
    return {name: rms(a - b) for name, a, b in zip(names, rolling(model), rolling(true), strict=True)}


def page(_: Any, found: Mapping[str, list[SlipDraw]]) -> Iterator[str]:
    draws, refused = harness.sound(d for rows in found.values() for d in rows)
    yield f"{len(draws)} builds"
    yield from refused
    groups: dict[str, list[SlipDraw]] = {}
    for draw in sorted(draws, key=lambda d: list(found).index(d.kind)):
        groups.setdefault(draw.kind.split(", ", 1)[1], []).append(draw)
    groups["all"] = draws
    yield from harness.misfits(groups)
    columns = {
        "misfit of all, with freedom": lambda of: harness.spread(d.overall for d in of),
        "in 0.95-1.05": lambda of: harness.percent([0.95 < d.overall < 1.05 for d in of]),
        "trusted": lambda of: sum(d.trusted for d in of),
        "at a bound": lambda of: sum(len(d.at_bound) for d in of),
    }
    for word, sort in {"fitted": "", "regularised": "(regularised)", "of the rig": "rig."}.items():
        columns[f"{word} inside 95 %"] = lambda of, sort=sort: _inside(of, sort)
    for name in draws[0].error:
        columns[f"{name} rms (largest)"] = lambda of, name=name: harness.largest(d.error[name] for d in of)
    yield from harness.by_group(
        groups, columns, "Coefficients inside their intervals, radii and rolling moment"
    )
    groups |= {vehicle: [d for d in draws if d.kind.startswith(vehicle)] for vehicle in VEHICLES}
    gaps = {
        f"{word}: {name}": [{c: d.gaps[word, c] for c in CHANNELS} for d in of]
        for word in dict.fromkeys(word for word, _ in draws[0].gaps)
        for name, of in groups.items()
    }
    cells = {c: lambda of, c=c: _against_truth([gap[c] for gap in of]) for c in CHANNELS}
    cells["within twice the noise"] = lambda of: (
        f"{np.mean([g.within for gap in of for g in gap.values()]):.1%}"
    )
    title = "Against the noise-free truth: rms error over the noise of a point, median (largest); "
    title += "rms error and half width of the 95 % band [N], [Nm]; conditions inside the band"
    yield from harness.by_group(gaps, cells, title, "range: campaign")
    yield from harness.coverage(draws)
    yield from _worst(draws)


def _inside(draws: Sequence[SlipDraw], sort: str) -> str:
    """Share of the coefficients of a sort inside their intervals."""

    def sort_of(name: str) -> str:
        return "rig." if name.startswith("rig.") else "(regularised)" if "(" in name else ""

    found = [x for d in draws for n, x in d.inside.items() if sort_of(n) == sort]
    return f"{np.mean(found):.1%} of {len(found)}" if found else "-"


def _against_truth(gaps: Sequence[Gap]) -> str:
    over, error, half, banded = np.array([(g.over, g.rms, g.half, g.banded) for g in gaps]).T
    return (
        f"{np.median(over):.2f} ({over.max():.2f}); {rms(error):.3g}, {rms(half):.3g}; {np.mean(banded):.1%}"
    )


def _worst(draws: Sequence[SlipDraw], most: int = 12) -> Iterator[str]:
    yield "\n## Largest errors\n"
    gaps = [(g.over, d, key) for d in draws for key, g in d.gaps.items()]
    for size, d, (word, channel) in sorted(gaps, key=lambda row: -row[0])[:most]:
        yield f"* {channel} over {word}: {size:.2f} of the noise ({d.gaps[word, channel].rms:.3g}); seed {d.seed}, {d.kind}"
    pulls = [(abs(x), x, d, n) for d in draws for n, x in d.pulls.items() if not d.inside[n]]
    for _, x, d, name in sorted(pulls, key=lambda row: -row[0])[:most]:
        yield f"* {name}: {x:+.1f} standard errors; seed {d.seed}, {d.kind}"
    bounds = Counter(name for d in draws for name in d.at_bound)
    yield "* at a bound: " + (", ".join(f"{n} {k}" for n, k in bounds.most_common()) or "none")
    yield from (f"* seed {d.seed}, {d.kind}: {'; '.join(d.reasons)}" for d in draws if not d.trusted)


if __name__ == "__main__":
    harness.study(one, page, worlds=KINDS, draws=60, in_turn=True, off=0.12, exact=False, size=1.0)
