"""What does a build say of rigs whose errors `tyre.toml` does not declare? `python tests/studies/unlisted_study.py 40 --jobs 2`.

For every world it draws rigs and tyres, front and rear in turn, builds them, and prints the error of eps_gamma beside its
uncertainty, the misfit, how far the fitted model is from the truth, how many builds are marked as not to be trusted, how many
carry a warning or a suspected cause, and the coefficients and rig numbers that the world puts to the test.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import worlds
from drawn_rigs import (
    DECLARED,
    SAFE,
    backward_camber,
    front_or_rear,
    model_error,
    on_disk,
    plan_content,
    scaled,
)
from rig_error_study import NOT_DECLARED, numbers

import mffit
import tir
from mffit import as_json
from mffit.errors import InputError
from tir.parameters import TABLE

Edit = Callable[[dict[str, Any], np.random.Generator], None]


def with_backward_camber(content: dict[str, Any], rng: np.random.Generator) -> None:
    """Add cambers rolled backwards."""
    content["sweep"].append(backward_camber(content))


def both_sides(content: dict[str, Any], rng: np.random.Generator) -> None:
    """Repeat the uncoupled sweeps on the other side of the disc, the rig set up anew."""
    zeros = {
        "F0_N": DECLARED["u_loadcell_offset_N"] * rng.normal(),
        "gamma_0_deg": DECLARED["u_camber_alignment_deg"] * rng.normal(),
        "alpha_0_deg": 0.08 * rng.normal(),
    }
    again = [s for s in content["sweep"] if not ("alpha_deg" in s and "gamma_deg" in s)]
    content["sweep"] += [
        {
            **s,
            "file": f"right_{s['file']}",
            "path_centre": "right",
            "faults": {**s.get("faults", {}), **zeros},
        }
        for s in again
    ]


def warming(content: dict[str, Any], rng: np.random.Generator) -> None:
    """The tyre warms by 23 K over the campaign."""
    edges = np.linspace(25.0, 48.0, len(content["sweep"]) + 1)
    for sweep, low, high in zip(content["sweep"], edges[:-1], edges[1:], strict=True):
        sweep["T_degC"] = [float(low), float(high)]


def warm_camber(content: dict[str, Any], rng: np.random.Generator) -> None:
    """The tyre is 15 K warmer in camber sweeps than in all others."""
    for sweep in content["sweep"]:
        if "gamma_deg" in sweep and "alpha_deg" not in sweep:
            sweep["T_degC"] = COLD + 15.0


def without_temperature(folder: Path, rng: np.random.Generator) -> None:
    """Nobody recorded the temperature."""
    for path in folder.glob("*.csv"):
        table = pd.read_csv(path)
        table.drop(columns="T_degC", errors="ignore").to_csv(path, index=False)


def upright(content: dict[str, Any], rng: np.random.Generator) -> None:
    """No camber in any sweep."""
    content["sweep"] = [s for s in content["sweep"] if "gamma_deg" not in s]


def warps_one_load(folder: Path, rng: np.random.Generator) -> None:
    """The load of one sweep of sideslip is read 10 % low."""
    path = sorted(folder.glob("sideslip*.csv"))[1]
    table = pd.read_csv(path)
    table["Fz_N"] *= 0.9
    table.to_csv(path, index=False)


def diameter_as_radius(config: dict[str, Any]) -> None:
    """The path's diameter where its radius belongs, beside effective radii from elsewhere."""
    config["rig"].pop("path", None)
    config["rig"] |= {"path_radius": 2.0 * 1.323, "u_path_radius": 0.002}
    config["rolling_radius"] = [
        {
            "load_N": row["load_N"],
            "effective_radius": 0.985 * config["tyre"]["unloaded_radius"],
            "u_effective_radius": 0.0005,
        }
        for row in config["rolling_radius"]
    ]


@dataclass(frozen=True)
class World:
    """What is wrong with the rigs, and what their owner writes."""

    faults: Mapping[str, float] = field(default_factory=dict)
    drawn: Mapping[str, float] = field(default_factory=dict)  #: rig errors with their standard deviation
    declared: Mapping[str, float] = field(default_factory=dict)
    tyre: Mapping[str, float] = field(default_factory=dict)  #: coefficients of the true tyre
    base: Mapping[str, float] = field(default_factory=dict)  #: coefficients of the base file
    written: Callable[[dict[str, Any]], None] = lambda config: (
        None
    )  #: changes what the owner writes into tyre.toml
    edits: tuple[Edit, ...] = ()
    thin: bool = False  #: half of the angles, one pressure
    spoil: Callable[[Path, np.random.Generator], None] | None = None
    watched: tuple[str, ...] = ()  #: coefficients or rig numbers


WORLDS = {
    "as declared": World(),
    "as declared, half of the angles, one pressure": World(thin=True),
    "skew 0.3 deg, declared, one backward camber sweep": World(
        drawn={"camber_skew_deg": 0.3}, declared={"u_camber_skew_deg": 0.3}, edits=(with_backward_camber,)
    ),
    "skew 0.5 deg, not declared": World(faults={"camber_skew_deg": 0.5}, watched=("PKY6",)),
    "skew 0.5 deg, not declared, one backward camber sweep": World(
        faults={"camber_skew_deg": 0.5}, edits=(with_backward_camber,), watched=("camber_skew_deg",)
    ),
    "both sides, set up anew": World(edits=(both_sides,)),
    "load falls by 6 % sin^2": World(faults={"load_camber": -0.06}, watched=("load_camber",)),
    "warming by 23 K at -0.4 %/K": World(
        faults={"k_T_per_K": -0.004},
        edits=(warming,),
        watched=("PPY4", "PDY2", "k_T_grip_per_K", "k_T_stiffness_per_K"),
    ),
    "conicity of 1 % of the load": World(tyre={"PVY1": 0.01}),
    "no camber, base with PECP1 0.5": World(base={"PECP1": 0.5}, edits=(upright,)),
    "radius entered as diameter": World(written=diameter_as_radius),
    "load of one sweep 10 % low": World(spoil=warps_one_load),
    **{name: World(faults=faults) for name, faults in NOT_DECLARED.items()},
    "warming by 23 K at -0.4 %/K, temperature not recorded": World(
        faults={"k_T_per_K": -0.004}, edits=(warming,), spoil=without_temperature
    ),
    "camber sweeps 15 K warmer at -0.4 %/K, temperature not recorded": World(
        faults={"k_T_per_K": -0.004}, edits=(warm_camber,), spoil=without_temperature
    ),
    "errors 1.5 times the declared": World(
        drawn={"F0_N": 15.0, "gamma_0_deg": 0.75, "alpha_0_deg": 0.12, "camber_skew_deg": 0.15}
    ),
}
SIGNED = ("eps_gamma", "C_phit [Nm]", "C_gamma on the path [N/rad]", "C_alpha on the path [N/rad]")
"""Numbers of the direct method that must be right where nothing is said."""
PARAMETERS = {row.name for row in TABLE}
WARMED, PER_KELVIN, COLD = ("k_T_grip_per_K", "k_T_stiffness_per_K"), -0.004, 25.0
"""Terms by which a warming tyre is modelled; the true one, which holds at the temperature [degC] of the cold tyre."""


def one(job: tuple[int, str, Any]) -> dict[str, Any]:
    """Draw, simulate and build one rig."""
    seed, name, _ = job
    world, rng = WORLDS[name], np.random.default_rng(9000 + seed)
    sample, true = front_or_rear(seed, rng)
    true = true.replace(**world.tyre)
    content = plan_content(sample, pecp1="direct", thin=world.thin)
    content["faults"] |= world.faults
    content["faults"] |= {key: u * rng.normal() for key, u in world.drawn.items()}
    content["rig"] |= {**DECLARED, **world.declared}
    for edit in world.edits:
        edit(content, rng)
    base = scaled(true, 0.3, rng).replace(**world.base)
    with on_disk(true, content, seed, base=base, edit=world.written) as (path, known):
        if world.spoil is not None:
            world.spoil(path.parent, rng)
        try:
            result = mffit.build(path)
        except InputError as error:
            return {"refused": str(error)}
    return _found(result, true, known, world)


def _found(result: Any, true: tir.Tyre, known: Any, world: World) -> dict[str, Any]:
    written = as_json.document(result)
    spin, fit = written["spin"] or {}, written["fit"]
    out: dict[str, Any] = {
        "trusted": written["trusted"],
        "reasons": written["reasons"],
        "warnings": written["warnings"],
        "suspected": _suspected(written),
        "misfit": {c: row["over_noise"] for c, row in fit["channels"].items()},
        "disc": model_error(
            result.fit.tyre, true, -1.0 / known.nominal.R_m, np.unique(np.round(result.points.Fz, -2))
        )[0],
    }
    if spin.get("epsilon_gamma") is not None:
        out["eps"] = (spin["epsilon_gamma"], spin["u_epsilon_gamma"], known.nominal.epsilon_gamma)
    out["inside"] = {
        name: abs(value - truth) < SAFE * u
        for name, (value, u, truth) in numbers(result.measured, known, true).items()
        if name in SIGNED
    }
    faults = {**known.faults, **{name: _at_reference(fit["temperature"]) for name in WARMED}}
    rig = {**faults, **{n: float(true[n]) for n in world.watched if n in PARAMETERS}}
    rows = {**(fit["temperature"] or fit)["coefficients"], **fit["rig"]}
    out["watched"] = {
        n: (rows[n]["value"], rows[n].get("stderr") or np.nan, rig.get(n, 0.0))
        for n in world.watched
        if n in rows
    }
    return out


def _at_reference(temperature: dict[str, Any] | None) -> float:
    """The true temperature term relative to the force at the reference temperature of the build."""
    T_ref = COLD if temperature is None else temperature["T_ref_degC"]
    return PER_KELVIN / (1.0 + PER_KELVIN * (T_ref - COLD))


def _suspected(written: dict[str, Any]) -> str:
    """What the build names in words: an effect in its residuals, temperature as modelled, or a sweep."""
    residuals, named = written["residuals"], []
    if residuals["effect"] and residuals["effect"]["significant"]:
        named.append(residuals["effect"]["id"])
    if residuals["sweep"]:
        named.append("one sweep")
    return ", ".join([*named, *(row["id"] for row in written["fit"]["modelled"] if row["modelled"])])


def _without_numbers(text: str) -> str:
    """A sentence that is the same for builds with other numbers."""
    return re.sub(r"[-+]*\d[\d.e-]*", "#", text)


def lines(name: str, rows: list[dict[str, Any]]) -> list[str]:
    """The page of one world."""
    ended = [row["refused"] for row in rows if "refused" in row]
    sound = [row for row in rows if "refused" not in row]
    out = [f"\n## {name}: {len(rows)} rigs, {len(ended)} refused"]
    out += [f"* {times}x {text}" for text, times in Counter(text[:160] for text in ended).most_common(3)]
    if not sound:
        return out
    eps = np.array([row["eps"] for row in sound if "eps" in row])
    if len(eps):
        error = eps[:, 0] - eps[:, 2]
        inside = np.mean(np.abs(error) < SAFE * eps[:, 1])
        out.append(
            f"eps_gamma: rms {np.sqrt(np.mean(error**2)):.3f}, mean {np.mean(error):+.3f}, u {np.mean(eps[:, 1]):.3f}, "
            f"inside 95 % {inside:.0%}"
        )
    Fy = np.array([row["misfit"]["Fy"] for row in sound], dtype=float)
    disc = np.array([row["disc"] for row in sound])
    out.append(
        f"misfit of Fy over noise: median {np.median(Fy):.2f}, largest {np.max(Fy):.2f}; "
        f"on the disc {np.sqrt(np.mean(disc**2)):.1f} N"
    )
    out.append(
        f"not trusted {np.mean([not r['trusted'] for r in sound]):.0%}, "
        f"with a warning {np.mean([bool(r['warnings']) for r in sound]):.0%}"
    )
    out += _told_or_inside(sound)
    for key in ("reasons", "warnings"):
        said = Counter(
            alike for row in sound for alike in {_without_numbers(text)[:110] for text in row[key]}
        )
        out += [f"  {key}: {times}x {text}" for text, times in said.most_common(4)]
    out += [
        f"  suspected: {times}x {what}"
        for what, times in Counter(str(r["suspected"])[:90] for r in sound).most_common(5)
    ]
    for number in dict.fromkeys(n for row in sound for n in row["watched"]):
        value, u, truth = np.array([row["watched"][number] for row in sound if number in row["watched"]]).T
        pull = np.abs(value - truth) / u
        out.append(
            f"{number}: {len(value)} builds, rms error {np.sqrt(np.mean((value - truth) ** 2)):.3g}, mean u {np.nanmean(u):.3g}, "
            f"within 3 u {np.mean(pull < 3.0):.0%}, mean {np.mean(value):.4g}"
        )
    return out


def _told_or_inside(rows: list[dict[str, Any]]) -> list[str]:
    """How many rigs are told, modelled or measured rightly in spite of their error."""
    told = np.array([bool(row["reasons"] or row["warnings"]) for row in rows])
    named = np.array([bool(row["suspected"]) for row in rows])
    inside = np.array([all(row["inside"].values()) for row in rows])
    each = ", ".join(
        f"{name} {np.mean([row['inside'][name] for row in rows if name in row['inside']]):.0%}"
        for name in SIGNED
        if any(name in row["inside"] for row in rows)
    )
    eps = np.array([row["inside"].get("eps_gamma", True) for row in rows])
    return [
        f"told {np.mean(told):.0%}, an effect named or modelled {np.mean(named):.0%}, all inside 95 % {np.mean(inside):.0%} "
        f"({each}); any of these {np.mean(told | named | inside):.0%}, with eps_gamma alone {np.mean(told | named | eps):.0%}"
    ]


if __name__ == "__main__":
    worlds.run(one, lines, worlds.asked(40, WORLDS))
