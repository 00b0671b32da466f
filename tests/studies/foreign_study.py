"""What does a build say of tyres that MF 6.2 does not describe? `python tests/studies/foreign_study.py 20 --jobs 2`.

Brush tyres on a disc and on a belt, and tyres of the formula with a term that it lacks (grip that bends with the load), on rigs
whose errors are drawn from what `tyre.toml` declares, with runs that differ; in further worlds a sweep or a load is spoilt, or
the rig has an error that nothing declares.
Printed: builds that are trusted, eps_gamma and its uncertainty, true forces and readings of new runs inside the 95 % intervals of
`mffit predict` with half width over error, and spoilt sweeps and errors that are named. Eight campaigns after each other are of
one tyre with a term, and its coefficients lie around their mean as their standard errors say; the drawn tyre's are those of
another formula.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import harness
import numpy as np
import pandas as pd
from brush import SHORT, SLIP, Brush
from disc_project import Project
from drawn_rigs import NO_FORCE_AT_REST, SAFE, SAMPLES, Draw, scaled
from harness import shares

import mffit
import tir
from mffit.comparison.characteristics import characteristics
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.rig_errors import words_of
from mffit.scatter import rms

NOISE, RADIUS = (6.0, 0.3), 1.323
RUN_OFFSET, RUN_SCALE = 4.0, 0.004
CAMPAIGNS = 8
"""Of one tyre with a term."""
Spoilt = Callable[[dict[str, pd.DataFrame], float], str]


def one(column: str, factor: float, kind: str) -> Spoilt:
    """A column of one sweep at the nominal load is multiplied."""

    def spoil(tables: dict[str, pd.DataFrame], load: float) -> str:
        tables[name := f"{kind}_{load:.0f}"][column] *= factor
        return name

    return spoil


def another_zero(tables: dict[str, pd.DataFrame], load: float) -> str:
    """The sideslip of all sweeps at the largest load is read 0.3 deg too high."""
    for name in tables:
        if f"_{1.5 * load:.0f}" in name:
            tables[name]["alpha_deg"] += 0.3
    return f"_{1.5 * load:.0f}"


SPOILT = {
    "load of a sweep x 1.05": one("Fz_N", 1.05, "sideslip"),
    "Fy of a sweep x 1.05": one("Fy_N", 1.05, "sideslip"),
    "Fy of a camber sweep x 0.9": one("Fy_N", 0.9, "camber"),
    "sideslip zero of a load": another_zero,
}
PLANTED = {
    "zero of Fy 30 N, turning with the direction": {"turning": 30.0},
    "load off by 8 % sin(camber)": {"load_odd": 0.08},
    "play of 0.4 deg": {"play": 0.4},
    "steering yields by 0.01 deg/Nm": {"give": 0.01},
    "camber skew of 1 deg": {"skew": 1.0},
    "load falls by 20 % sin^2(camber)": {"load_camber": -0.2},
}
"""Errors of the whole rig beside those that are drawn; another zero of Fy or camber is conicity or ply-steer for a belt."""
NAMES = {
    "turning": "F0_direction_N", "load_odd": "load_camber_odd", "play": "backlash_deg", "give": "compliance_deg_per_Nm",
    "skew": "camber_skew_deg", "load_camber": "load_camber",
}  # fmt: skip
BEYOND = {"Fz_N": (0.15, 0.35, 1.65), "alpha_deg": (-15.0, -11.0, 11.0, 15.0)}
"""Conditions on the road that no rig went to; loads over the nominal one."""
SLOPES = {
    "C_alpha_N_per_rad": (0, "alpha"), "C_gamma_N_per_rad": (0, "gamma"), "C_Mz_alpha_Nm_per_rad": (1, "alpha"),
    "C_phit_Nm": (0, "phi_t"),
}  # fmt: skip
"""Channel and slip of slopes at zero."""
STILL = {"alpha": np.zeros(1), "gamma": np.zeros(1), "phi_t": 0.0}
SMALL = 1e-4
WORLDS = ["brush on a disc", "brush on a belt", "term on a disc", "term on a belt"]
WORLDS += [f"{world}, {what}" for world in WORLDS[:2] for what in (*SPOILT, *PLANTED)]


class Bent(NamedTuple):
    """A tyre of the formula whose grip bends with the load, which MF 6.2 cannot follow."""

    tyre: tir.Tyre
    turns: bool  #: whether the camber of a straight path is spin too, as on a disc
    r_e: float = 0.3

    def forces(self, alpha, gamma, Fz, phi_t: float = 0.0, direction: float = 1.0):
        turned = make_points(alpha, gamma, Fz, p=250e3, V=6.0, phi_t=phi_t, direction=direction)
        plain, other = (
            Simulation.of(tyre, turn_slip=self.turns).readings(turned)
            for tyre in (self.tyre, self.tyre.replace(LMUY=1.04))
        )
        share = np.cos(2.0 * np.pi * (np.asarray(Fz) / float(self.tyre["FNOMIN"]) - 0.6) / 0.9)
        return tuple(plain[name] + share * (other[name] - plain[name]) for name in ("Fy", "Mz"))


def drawn(world: str, rng: np.random.Generator) -> tuple[Any, float]:
    """A tyre and its nominal load."""
    if world.startswith("term"):
        true = scaled(tir.read(SAMPLES / "front-120-70" / "true.tir").replace(**NO_FORCE_AT_REST), 0.1, rng)
        return Bent(true, "disc" in world), float(true["FNOMIN"])
    load = round(rng.uniform(1200.0, 2200.0), -1)
    unit = rng.uniform
    return Brush(
        a=unit(0.045, 0.06), stiffness=unit(3.2e6, 4.8e6), mu=unit(1.0, 1.4), mu_load=unit(-0.12, -0.04),
        fading=unit(0.3, 0.8), crown=unit(0.1, 0.5), reduction=unit(-0.25, 0.2), softening=unit(-0.25, -0.1),
        b=unit(0.015, 0.03), r_e=round(unit(0.29, 0.31), 4), nominal=load,
    ), load  # fmt: skip


def programme(load: float, disc: bool, loads: tuple[float, ...]) -> dict[str, tuple[Any, ...]]:
    """Sideslip [deg], camber [deg], load [N] and direction of every sweep."""
    lean = np.array([0, 5, 10, 15, 20, 30, 40, 50] if disc else [0, 2, 4, 6, 8, 10], dtype=float)
    lean, rows = np.concatenate([-lean[:0:-1], lean]), {}
    for Fz in (share * load for share in loads):
        rows[f"sideslip_{Fz:.0f}"] = (np.array(SLIP, dtype=float), 0.0, Fz, 1.0)
        rows[f"camber_{Fz:.0f}"] = (0.0, lean, Fz, 1.0)
        for way, sign in (("forward", 1.0), ("backward", -1.0)):
            rows[f"align_{Fz:.0f}_{way}"] = (np.linspace(-1.0, 1.0, 5), 0.0, Fz, sign)
    leans = (10, 20, 35, 20) if disc else (2, 4, 7, 4)
    for gamma, Fz in zip(leans, (load, load, load, 1.5 * load), strict=True):
        both = np.concatenate([np.full(len(SHORT), side * gamma) for side in (1.0, -1.0)])
        rows[f"coupled_{Fz:.0f}_{gamma}"] = (np.tile(np.array(SHORT, dtype=float), 2), both, Fz, 1.0)
    return {n: (*np.broadcast_arrays(a, g), Fz, way) for n, (a, g, Fz, way) in rows.items()}


def read(tyre, rows, rig: dict[str, float], disc: bool, rng: np.random.Generator) -> pd.DataFrame:
    """The readings of a run, which differs from others."""
    alpha, gamma, Fz, way = rows
    Fz = np.full(len(alpha), Fz) if np.isscalar(Fz) else Fz
    lean = np.radians(gamma + rig["gamma_0"])
    held = alpha + rig["alpha_0"] + rig.get("skew", 0.0) * np.sin(lean)
    share = rig.get("load_camber", 0.0) * np.sin(lean) ** 2 + rig.get("load_odd", 0.0) * np.sin(lean)
    load, turned = Fz * (1.0 + share), 0.0
    for _ in range(20 if rig.get("play") or rig.get("give") else 1):
        alpha_true = np.radians(held + turned)
        Fy, Mz = tyre.forces(alpha_true, lean, load, phi_t=-1.0 / rig["R"] if disc else 0.0, direction=way)
        bent = rig.get("give", 0.0) * Mz - 0.5 * rig.get("play", 0.0) * np.tanh(Mz)
        turned = 0.5 * (turned + bent)  # in small steps: the moment turns the wheel that makes it
    scale, offset = 1.0 + RUN_SCALE * rng.normal(), RUN_OFFSET * rng.normal()
    offset += way * rig.get("turning", 0.0)
    return pd.DataFrame(
        {
            "alpha_deg": alpha, "gamma_deg": gamma, "Fz_N": Fz, "p_kPa": 250.0, "V_mps": 6.0,
            "direction": "forward" if way > 0 else "backward",
            "Fy_N": scale * Fy + offset + rig["F0"] + NOISE[0] * rng.normal(size=len(Fz)),
            "Mz_Nm": Mz + NOISE[1] * rng.normal(size=len(Fz)), "u_Fy_N": NOISE[0], "u_Mz_Nm": NOISE[1],
        }
    )  # fmt: skip


def project(tyre, load: float, rig: dict[str, float], disc: bool, names) -> dict[str, Any]:
    """The tyre.toml; the effective radius is read with its declared error."""
    base = {"unloaded_radius": tyre.r_e / 0.98, "width": 0.15, "rim_radius": 0.2159, "nominal_load": load}
    declared = {"u_loadcell_offset_N": 10.0, "u_camber_alignment_deg": 0.5, "u_slip_alignment_N": 25.0}
    out = {
        "tyre": {"name": "foreign", "nominal_pressure": 250.0, "nominal_speed": 10, **base},
        "rig": {"type": "flat-track", "axes": "iso", "u_camber_skew_deg": 0.0, **declared},
        "sweep": [{"file": name} for name in names],
    }
    if disc:
        path = {"path_centre": "left", "path_radius": RADIUS, "u_path_radius": 0.0018, "backlash_deg": 0.0}
        out["rig"] |= {"type": "rotating-disk", **path}
        out["rolling_radius"] = {"load_N": load, "effective_radius": rig["r_e"], "u_effective_radius": 0.0005}
        out["camber_stiffness"] = {"angle_deg": 15}
    return out


@dataclass
class Foreign(Draw):
    """A draw of a tyre that the formula does not describe."""

    trusted: bool = False
    reasons: list[str] = field(default_factory=list)
    open: bool = False  #: sweeps are missed for an unknown reason
    found: bool = False  #: what is wrong is named, or a number of the fit
    found_as: dict[str, tuple[float, float]] = field(
        default_factory=dict
    )  #: coefficients and standard errors
    predicted: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    """Share of true forces or new readings inside 95 %, rms half width and rms error."""


def one(job: harness.Job) -> Foreign:
    """Draw, build and predict one campaign."""
    disc, rng = "disc" in job.world, np.random.default_rng(7000 + job.seed)
    term = job.world.startswith("term")
    tyre, load = drawn(job.world, np.random.default_rng(7000 + job.seed // CAMPAIGNS) if term else rng)
    rig = {"F0": 10.0 * rng.normal(), "gamma_0": 0.5 * rng.normal(), "alpha_0": 0.05 * rng.normal()}
    rig |= {"R": RADIUS + 0.0018 * rng.normal(), "r_e": tyre.r_e + 0.0005 * rng.normal()}
    fault = job.world.partition(", ")[2]
    rig |= PLANTED.get(fault, {})
    loads = (0.6, 0.8, 1.0, 1.25, 1.5) if term else (0.6, 1.0, 1.5)
    tables = {name: read(tyre, rows, rig, disc, rng) for name, rows in programme(load, disc, loads).items()}
    spoilt = SPOILT[fault](tables, load) if fault in SPOILT else ""
    with tempfile.TemporaryDirectory() as made:
        folder, files = Path(made), {f"{name}.csv": table for name, table in tables.items()}
        path = Project(folder, project(tyre, load, rig, disc, files), files).write()
        result = harness.built(path, out=folder / "out")
        if isinstance(result, str):
            return Foreign(refused=result, found=spoilt in result)
        said = [*result.trust.reasons, *(d.sentence for d in result.fit.doubts), *result.warnings]
        out = Foreign(trusted=result.trusted, reasons=list(result.trust.reasons))
        out.doubted = len(result.fit.doubts)
        out.found = bool(spoilt) and any(spoilt in text for text in said)
        for key in PLANTED.get(fault, {}):
            value, u = result.fit.rig.get(NAMES[key], (0.0, 1.0))
            out.found = any(words_of(NAMES[key]) in text for text in said) or abs(value) > SAFE * u
        out.open = any("misses whole sweeps" in text for text in result.trust.doubts)
        direct = result.measured.epsilon_gamma
        if direct is not None and isinstance(tyre, Brush):
            out.note("eps_gamma", direct.value, direct.u, tyre.reduction)
        if not fault:
            out.predicted = _predicted(folder / "out", tyre, load, rig, disc, rng)
            _slopes(out, result, tyre, load, disc)
            for n, row in result.fit.coefficients.items() if term else ():
                if row.stderr and not row.at_bound and row.status == "fitted":
                    out.found_as[n] = (row.value, row.stderr)
        return out


def _predicted(
    build: Path, tyre: Any, load: float, rig: dict[str, float], disc: bool, rng: np.random.Generator
):
    """True forces, of a disc also on the road, beyond the tested ranges, and readings of a dozen runs against the predictions."""
    lean, Fz = 45.0 if disc else 9.0, rng.uniform(0.6 * load, 1.5 * load, 12)
    runs = [(np.linspace(-7, 7, 15), np.full(15, x), np.full(15, F), 1.0)
            for x, F in zip(lean * rng.uniform(-1, 1, 12), Fz, strict=True)]  # fmt: skip
    new = pd.concat([read(tyre, run, rig, disc, rng) for run in runs])
    at = new.drop(columns=["Fy_N", "Mz_Nm", "u_Fy_N", "u_Mz_Nm", "direction"])
    angles, out = [np.radians(at[key].to_numpy()) for key in ("alpha_deg", "gamma_deg")], {}
    for where, phi_t in {"": -1.0 / RADIUS, " on the road": 0.0}.items() if disc else [("", 0.0)]:
        found = mffit.predict(build, at.assign(phi_t_per_m=phi_t))
        truth = tyre.forces(*angles, at.Fz_N.to_numpy(), phi_t=phi_t)
        for name, true in zip(("Fy_N", "Mz_Nm"), truth, strict=True):
            file, best, u = found[name], found[name.replace("_", "_best_")], "u_" + name.replace("_", "_{}_")
            out[f"{name}{where} best"] = shares(true - best, found[u.format("best")])
            out[f"{name}{where} file, true"] = (np.nan, np.nan, rms(true - file))
            if not where:
                out[f"{name} new run"] = shares(new[name].to_numpy() - best, found[u.format("run")])
                out[f"{name} new run, file"] = shares(new[name].to_numpy() - file, found[f"u_{name}"])
    sweep = {"alpha_deg": np.linspace(-7, 7, 8), "gamma_deg": np.linspace(-lean, lean, 5), "Fz_N": load}
    for what, ends in BEYOND.items():
        grid = np.meshgrid(*(sweep | {what: np.array(ends) * (load if what == "Fz_N" else 1.0)}).values())
        at = pd.DataFrame(
            {name: x.ravel() for name, x in zip(sweep, grid, strict=True)} | {"p_kPa": 250.0, "V_mps": 6.0}
        )
        found = mffit.predict(build, at.assign(phi_t_per_m=0.0))
        true, _ = tyre.forces(*np.radians(at[["alpha_deg", "gamma_deg"]].to_numpy().T), at.Fz_N.to_numpy())
        out[f"Fy_N best beyond the tested {what}"] = shares(true - found.Fy_best_N, found.u_Fy_best_N)
    return out


def _slopes(out: Foreign, result: Any, tyre: Any, load: float, disc: bool) -> None:
    """Notes the slopes at zero of the file on the road, with their true values."""
    known = {"known": result.fit.posterior, "predictor": result.prediction}
    found = characteristics(result.tyres[result.fitted], load, turn_slip=disc, **known)
    for key, (channel, over) in SLOPES.items():
        if key in found:
            ends = [
                tyre.forces(**{**STILL, "Fz": np.array([load]), over: SMALL * np.array([x])})
                for x in (-1.0, 1.0)
            ]
            true = float(ends[1][channel][0] - ends[0][channel][0]) / (2.0 * SMALL)
            out.note(key, found[key].value, found[key].u, true)


def page(world: str, rows: list[Foreign]) -> Iterator[str]:
    draws, refused = harness.sound(rows)
    yield f"\n## {world}: {len(rows)} builds, {len(refused)} refused"
    trusted, blamed, open_ = (
        sum(bool(getattr(d, key)) for d in draws) for key in ("trusted", "doubted", "open")
    )
    yield f"trusted {trusted}, with a doubted sweep {blamed}, with missed sweeps of unknown cause {open_}"
    yield from [f"* {text[:200]}" for d in draws for text in d.reasons][:4]
    if ", " in world:
        yield f"what is wrong is named, or a number of the fit, in {sum(d.found for d in draws)}"
    for key in draws[0].predicted if draws else ():
        share, half, error = np.array([d.predicted[key] for d in draws]).T
        ratio = rms(half) / rms(error)
        yield (
            f"{key}: inside {np.mean(share):.1%}, error {rms(error):.3g}, half width over error {ratio:.2f}"
            f", over the ideal {ratio / SAFE:.2f}"
        )
    again = [*_again(rows)]
    if inside := [hit for d in again for hit in d.inside.values()]:
        share = harness.percent(inside)
        yield f"coefficients within 95 % of those of the tyre's other campaigns: {share} of {len(inside)}"
    yield from harness.coverage([*draws, *again])


def _again(rows: list[Foreign]) -> Iterator[Draw]:
    """For each tyre with a term, its campaigns' coefficients around the mean of the others' that fitted them."""
    for k in range(0, len(rows), CAMPAIGNS):
        of_tyre = rows[k : k + CAMPAIGNS]
        for row in of_tyre:
            out = Draw()
            for name, (value, u) in row.found_as.items():
                others = [o.found_as[name][0] for o in of_tyre if o is not row and name in o.found_as]
                if len(others) > 1:  # the mean of the others scatters too
                    out.note(name, value, u * np.sqrt(1.0 + 1.0 / len(others)), float(np.mean(others)))
            if out.pulls:
                yield out


if __name__ == "__main__":
    harness.study(one, page, worlds=WORLDS, draws=20)
