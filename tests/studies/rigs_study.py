"""What do the direct method and a build say of rigs with errors of one kind? `python tests/studies/rigs_study.py 60 --jobs 2`.

For every world (what is wrong with the rig, what is declared of it, which sweeps are run) it draws rigs and tyres, front and
rear in turn, and prints the coverage of what is measured. `--worlds` takes patterns:

* `"direct: *"`: eps_gamma and the numbers reported with it, of tyres with conicity and ply-steer of usual size. With `--build` it
  fits every rig, which takes seconds, and adds the numbers that need a model.
* `"unlisted: *"`: builds of rigs whose errors `tyre.toml` does not declare. In addition to the coverage of what the world puts to
  the test: misfit, distance of the model from the truth, how many builds are marked as not to be trusted, and how many carry a
  warning or a suspected cause.
* `"warming: *"`: the tread warms from 25 to 48 degC over the campaign, in the order of its sweeps, and the force changes with it.
* `"runs: *"`: every sweep has a friction and a cornering stiffness of its own.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path
from typing import Any

import harness
import numpy as np
import pandas as pd
from drawn_rigs import (
    DECLARED,
    Draw,
    backward_camber,
    front_or_rear,
    model_error,
    on_disk,
    plan_content,
    scaled,
)

import mffit
import tir
from mffit.errors import InputError
from mffit.rig import Simulation
from mffit.rig_errors import CALIBRATED
from mffit.scatter import rms

STEP = 1e-5  # rad, for the slopes of the true tyre
COLD, WARMING, SHARE = 25.0, 23.0, 0.4
"""First temperature [degC], its change, and the share of the test in which 63 % of the change is covered."""
TERMS = ("k_T_grip_per_K", "k_T_stiffness_per_K", "k_T_camber_per_K")
RUN_NUMBERS = ("run_grip", "run_stiffness")
CONICITY, PLY_STEER = 0.002, 0.002  # over load; rad
Content = dict[str, Any]
Edit = Callable[[Content, np.random.Generator], None]


@dataclass(frozen=True)
class World:
    """What is wrong with the rigs, what they declare, and what they run."""

    faults: Mapping[str, float] = field(default_factory=dict)  #: in addition to the drawn ones
    drawn: Mapping[str, float] = field(default_factory=dict)  #: further faults, by standard deviation
    declared: Mapping[str, float] = field(default_factory=dict)  #: keys of [rig] in tyre.toml
    drawn_from: Mapping[str, float] = field(default_factory=dict)  #: other keys of [rig] for the draw
    drawn_tyre: Mapping[str, float] = field(default_factory=dict)  #: coefficients, by standard deviation
    tyre: Mapping[str, float] = field(default_factory=dict)  #: coefficients of the true tyre
    base: Mapping[str, float] | None = field(default_factory=dict)
    """Coefficients of the base file, others up to 30 % off; None: no base file."""
    edits: tuple[Edit, ...] = ()  #: changes of the programme
    written: Callable[[Content], None] = lambda config: None  #: changes of tyre.toml
    spoil: Callable[[Path, np.random.Generator], None] | None = None  #: changes of the files
    watched: tuple[str, ...] = ()  #: coefficients and rig numbers to report
    thin: bool = False  #: half of the angles, one pressure
    all_loads: bool = False  #: the direct method needs sweeps of other loads
    pecp1: str = "direct"
    first: int = 9000  #: of the seeds


def one_way(sweep: Mapping[str, Any]) -> bool:
    """Whether a sweep is over one angle."""
    return not {"alpha_deg", "gamma_deg"} <= sweep.keys()


def with_backward_camber(content: Content, rng: np.random.Generator) -> None:
    """Add cambers rolled backwards."""
    content["sweep"].append(backward_camber(content))


def other_side(content: Content, rng: np.random.Generator) -> None:
    """Repeat the uncoupled sweeps at the usual pressure with the centre of the disc on the other side."""
    other = {"path_centre": "right" if content["rig"].get("path_centre", "left") == "left" else "left"}
    plain = [sweep for sweep in content["sweep"] if "p_kPa" not in sweep and one_way(sweep)]
    content["sweep"] += [{**sweep, "file": f"other_{sweep['file']}", **other} for sweep in plain]


def setups(count: int) -> Edit:
    """Zeros both ways in further set-ups at the nominal load; all other sweeps belong to the first one."""

    def edit(content: Content, rng: np.random.Generator) -> None:
        for sweep in content["sweep"]:
            sweep["setup"] = "1"
        zeros = {"load_N": content["tyre"]["nominal_load"], "alpha_deg": [-0.5, 0, 0.5]}
        for k, way in product(range(2, count + 1), ("forward", "backward")):
            content["sweep"].append({"file": f"{way}_{k}.csv", **zeros, "direction": way, "setup": str(k)})

    return edit


def flipped(content: Content, rng: np.random.Generator) -> None:
    """Zeros of the nominal load with the tyre turned on its rim, in both directions."""
    zeros = {"load_N": content["tyre"]["nominal_load"], "alpha_deg": [-1, -0.5, 0, 0.5, 1]}
    for way in ("forward", "backward"):
        content["sweep"].append({**zeros, "file": f"flipped_{way}.csv", "direction": way, "mount": "flipped"})


def no_backward_zeros(content: Content, rng: np.random.Generator) -> None:
    """Leave out the backward sweeps of the nominal load."""
    load = content["tyre"]["nominal_load"]
    content["sweep"] = [
        s for s in content["sweep"] if s["load_N"] != load or s.get("direction") != "backward"
    ]


def warm_camber(T_degC: float) -> Edit:
    """Camber sweeps at another temperature than all others."""

    def edit(content: Content, rng: np.random.Generator) -> None:
        for sweep in content["sweep"]:
            if "gamma_deg" in sweep and "alpha_deg" not in sweep:
                sweep["T_degC"] = T_degC

    return edit


def both_sides(content: Content, rng: np.random.Generator) -> None:
    """Repeat the uncoupled sweeps on the other side of the disc, the rig set up anew."""
    zeros = {
        "F0_N": DECLARED["u_loadcell_offset_N"] * rng.normal(),
        "gamma_0_deg": DECLARED["u_camber_alignment_deg"] * rng.normal(),
        "alpha_0_deg": 0.08 * rng.normal(),
    }
    content["sweep"] += [
        {
            **s,
            "file": f"right_{s['file']}",
            "path_centre": "right",
            "faults": {**s.get("faults", {}), **zeros},
        }
        for s in content["sweep"]
        if one_way(s)
    ]


def warm(sweeps: list[dict[str, Any]], change: float = WARMING, *, steadily: bool = False) -> None:
    """Let the tyre warm up over sweeps in their order, steadily or fast at first."""
    time = np.linspace(0.0, 1.0, len(sweeps) + 1)
    ends = (COLD + change * (time if steadily else 1.0 - np.exp(-time / SHARE))).tolist()
    for sweep, *own in zip(sweeps, ends[:-1], ends[1:], strict=True):
        sweep["T_degC"] = own


def warming(content: Content, rng: np.random.Generator) -> None:
    warm(content["sweep"], steadily=True)


def warmed(apart: bool) -> Edit:
    """A tyre that warms up, by terms of all forces, or by one each of friction and stiffnesses."""

    def edit(content: Content, rng: np.random.Generator) -> None:
        size = rng.choice([-1.0, 1.0]) * rng.uniform(0.002, 0.005)
        factors = zip(TERMS, rng.uniform(0.4, 1.6, 3), strict=True) if apart else [("k_T_per_K", 1.0)]
        content["faults"] |= {name: size * factor for name, factor in factors}
        warm(content["sweep"])

    return edit


def runs_differ(scatter: float) -> Edit:
    """Friction and stiffness of every sweep."""

    def edit(content: Content, rng: np.random.Generator) -> None:
        for sweep in content["sweep"]:
            sweep["faults"] = dict(zip(RUN_NUMBERS, (scatter * rng.standard_normal(2)).tolist(), strict=True))

    return edit


def without_temperature(folder: Path, rng: np.random.Generator) -> None:
    """Nobody recorded the temperature."""
    for path in folder.glob("*.csv"):
        table = pd.read_csv(path)
        table.drop(columns="T_degC", errors="ignore").to_csv(path, index=False)


def upright(content: Content, rng: np.random.Generator) -> None:
    """No camber in any sweep."""
    content["sweep"] = [s for s in content["sweep"] if "gamma_deg" not in s]


def warps_one_load(folder: Path, rng: np.random.Generator) -> None:
    """The load of one sweep of sideslip is read 10 % low."""
    path = sorted(folder.glob("sideslip*.csv"))[1]
    table = pd.read_csv(path)
    table["Fz_N"] *= 0.9
    table.to_csv(path, index=False)


def diameter_as_radius(config: Content) -> None:
    """The path's diameter where its radius belongs, with effective radii from elsewhere."""
    config["rig"].pop("path", None)
    config["rig"] |= {"path_radius": 2.0 * 1.323, "u_path_radius": 0.002}
    radius = {"effective_radius": 0.985 * config["tyre"]["unloaded_radius"], "u_effective_radius": 0.0005}
    config["rolling_radius"] = [{"load_N": row["load_N"], **radius} for row in config["rolling_radius"]]


def without_run_scale(config: Content) -> None:
    config["fit"] = {"run_scale": False}


YIELDING, COMPLIANT = {"compliance_deg_per_Nm": 0.006}, {"u_steering_compliance_deg_per_Nm": 0.005}
NOT_DECLARED = {
    "crosstalk of 2 % of the load that grows with camber": {"crosstalk_camber": 0.02},
    "crown: contact point moves by 80 mm sin(camber)": {"crown_m": 0.08},
    "disc tilts by 0.4 deg per kN": {"disc_tilt_deg_per_kN": 0.4},
    "camber zero moves by 0.6 deg per kN": {"gamma_0_deg_per_kN": 0.6},
    "friction falls by 4 % along every sweep": {"sweep_heating": -0.04},
    "load off by 4 % sin(camber)": {"load_camber_odd": 0.04},
    "load cell off by 10 N, turning with the direction": {"F0_direction_N": 10.0},
}
"""Rig errors that no key of [rig] declares, of a size that a rig may have."""
LARGER = {name: 1.5 * u for name, u in DECLARED.items()}
TWICE = {name: 2.0 * u for name, u in DECLARED.items() if name != "u_camber_skew_deg"}
"""The declared uncertainties of the zeros of a set-up, doubled."""
SKEWED, SKEW = {"u_camber_skew_deg": 0.3}, {"camber_skew_deg": 0.5}
PER_KELVIN = {"k_T_per_K": -0.004}
BACK = (with_backward_camber,)
DIRECT = {
    "as declared": World(),
    "as declared, backward camber": World(edits=BACK),
    "skew 0.3 deg, declared": World(declared=SKEWED),
    "skew 0.3 deg, declared, backward camber": World(declared=SKEWED, edits=BACK),
    "skew 0.5 deg, not declared": World(faults=SKEW),
    "skew 0.5 deg, not declared, backward camber": World(faults=SKEW, edits=BACK),
    "conicity 1 %, declared": World(drawn_tyre={"PVY1": 0.01}, declared={"u_conicity": 0.01}),
    "conicity 1 %, not declared": World(drawn_tyre={"PVY1": 0.01}),
    "conicity 1 %, not declared, flipped zeros": World(drawn_tyre={"PVY1": 0.01}, edits=(flipped,)),
    "camber sweeps 15 K warmer, stiffness -0.2 % per K": World(
        faults={"k_T_stiffness_per_K": -0.002}, edits=(warm_camber(43.0),)
    ),
    "load falls by 6 % sin^2": World(faults={"load_camber": -0.06}),
    "axis off by 0.35 deg, backward zeros at the other loads only": World(
        faults={"alpha_0_deg": 0.35},
        drawn_tyre={"PHY2": PLY_STEER},
        edits=(no_backward_zeros,),
        all_loads=True,
    ),
    "both sides, set up anew": World(edits=(other_side,)),
    "both sides, set up anew, 1.5 times the declared": World(edits=(other_side,), drawn_from=LARGER),
    "three set-ups on one path": World(edits=(setups(3),)),
    "three set-ups on one path, twice the declared": World(edits=(setups(3),), drawn_from=TWICE),
    "five set-ups on one path, twice the declared": World(edits=(setups(5),), drawn_from=TWICE),
    "calibration of Fy 1.5 %": World(declared={"u_Fy_gain": 0.015}),
    "calibration of the load 1.5 %": World(declared={"u_Fz_gain": 0.015}),
    "calibration of the angles 1 %": World(declared={"u_alpha_gain": 0.01, "u_gamma_gain": 0.01}),
    "calibration of everything 1 %": World(declared=dict.fromkeys(CALIBRATED.values(), 0.01)),
    "steering compliance 0.006 deg/Nm, 0.005 declared": World(faults=YIELDING, declared=COMPLIANT),
    "steering compliance drawn from 0.005 deg/Nm": World(declared=COMPLIANT),
    "steering compliance 0.006 deg/Nm, not declared": World(faults=YIELDING),
    "steering compliance -0.006 deg/Nm, not declared": World(faults={"compliance_deg_per_Nm": -0.006}),
    **{name: World(faults=faults) for name, faults in NOT_DECLARED.items()},
    "crosstalk that grows with camber drawn from 2 %": World(declared={"u_crosstalk_camber": 0.02}),
    "crown drawn from 80 mm": World(declared={"u_crown_m": 0.08}),
    "disc tilt drawn from 0.4 deg per kN": World(declared={"u_disc_tilt_deg_per_kN": 0.4}),
    "all errors 1.5 times the declared": World(drawn_from=LARGER),
}
UNLISTED = {
    "as declared": World(),
    "as declared, half of the angles, one pressure": World(thin=True),
    "skew 0.3 deg, declared, one backward camber sweep": World(
        drawn={"camber_skew_deg": 0.3}, declared=SKEWED, edits=BACK
    ),
    "skew 0.5 deg, not declared": World(faults=SKEW, watched=("PKY6",)),
    "skew 0.5 deg, not declared, one backward camber sweep": World(
        faults=SKEW, edits=BACK, watched=("camber_skew_deg",)
    ),
    "both sides, set up anew": World(edits=(both_sides,)),
    "load falls by 6 % sin^2": World(faults={"load_camber": -0.06}, watched=("load_camber",)),
    "warming by 23 K at -0.4 %/K": World(faults=PER_KELVIN, edits=(warming,), watched=("PPY4", "PDY2")),
    "conicity of 1 % of the load": World(tyre={"PVY1": 0.01}),
    "no camber, base with PECP1 0.5": World(base={"PECP1": 0.5}, edits=(upright,)),
    "radius entered as diameter": World(written=diameter_as_radius),
    "load of one sweep 10 % low": World(spoil=warps_one_load),
    **{name: World(faults=faults) for name, faults in NOT_DECLARED.items()},
    "warming by 23 K at -0.4 %/K, temperature not recorded": World(
        faults=PER_KELVIN, edits=(warming,), spoil=without_temperature
    ),
    "camber sweeps 15 K warmer at -0.4 %/K, temperature not recorded": World(
        faults=PER_KELVIN, edits=(warm_camber(COLD + 15.0),), spoil=without_temperature
    ),
    "errors 1.5 times the declared": World(
        drawn={"F0_N": 15.0, "gamma_0_deg": 0.75, "alpha_0_deg": 0.12, "camber_skew_deg": 0.15}
    ),
}
COEFFICIENTS = ("PKY1", "PDY1", "PKY6", "QDZ1", *YIELDING)
WARM = World(watched=("PPY4", "PDY2"), pecp1="model", first=7000)
RUN = World(watched=("PDY1", "PDY2", "PKY1", "PKY2", "PPY1", "PPY3"), pecp1="model")
SCATTERS = (0.0, 0.003, 0.01, 0.02)


def _direct(world: World) -> World:
    """With conicity and ply-steer of usual size, at the nominal load only."""
    drawn, none = {"PVY1": CONICITY, "PHY1": PLY_STEER} | world.drawn_tyre, {"PVY2": 0.0, "PHY2": 0.0}
    own = {"base": None, "pecp1": "model", "first": 5000, "watched": COEFFICIENTS}
    return replace(world, drawn_tyre=drawn, tyre=none, **own)


WORLDS = {
    **{f"direct: {name}": _direct(world) for name, world in DIRECT.items()},
    **{f"unlisted: {name}": world for name, world in UNLISTED.items()},
    "warming: all forces": replace(WARM, edits=(warmed(apart=False),)),
    "warming: grip and stiffness apart": replace(WARM, edits=(warmed(apart=True),)),
    "warming: without an effect": replace(WARM, edits=(lambda content, rng: warm(content["sweep"]),)),
    **{
        f"runs: {100 * x:g} %{words}": replace(RUN, edits=(runs_differ(x),), written=written)
        for x in SCATTERS
        for words, written in {"": RUN.written, ", run_scale = false": without_run_scale}.items()
    },
}
SIGNED = ("eps_gamma", "C_phit [Nm]", "C_gamma on the path [N/rad]", "C_alpha on the path [N/rad]")
"""Numbers of the direct method that must be right where nothing is said."""


@dataclass
class Told(Draw):
    """A draw with what is said of it."""

    trusted: bool = True
    reasons: Sequence[str] = ()
    warnings: Sequence[str] = ()
    suspected: str = ""  #: what the build suspects or models


def one(job: harness.Job) -> Told:
    """Draw, simulate, and measure or build one rig."""
    name, world, seed = job.world, WORLDS[job.world], job.seed
    direct = name.startswith("direct") and not job.given.build
    rng = np.random.default_rng(world.first + seed)
    sample, true = front_or_rear(seed, rng)
    true = true.replace(**dict(world.tyre) | {n: rng.normal(0.0, u) for n, u in world.drawn_tyre.items()})
    content = plan_content(sample, pecp1=world.pecp1, thin=world.thin)
    content["faults"] |= {**world.faults, **{key: u * rng.normal() for key, u in world.drawn.items()}}
    for edit in world.edits:
        edit(content, rng)
    if direct and not world.all_loads:  # eps_gamma at the nominal load needs no other sweeps
        load = content["tyre"]["nominal_load"]
        at_nominal = [s for s in content["sweep"] if s["load_N"] == load and "p_kPa" not in s]
        content["sweep"] = [sweep for sweep in at_nominal if one_way(sweep)]
    usual = DECLARED if name.startswith(("direct", "unlisted")) else {}
    declared = {**content["rig"], **usual, **world.declared}
    content["rig"] = {**declared, **world.drawn_from}

    def written(config: Content) -> None:
        config["rig"] |= {key: declared[key] for key in world.drawn_from}
        world.written(config)

    base = None if world.base is None else scaled(true, 0.3, rng).replace(**world.base)
    faults = dict(content["faults"])
    with on_disk(true, content, seed, base=base, edit=written) as (path, known):
        if world.spoil is not None:
            world.spoil(path.parent, rng)
        try:
            out = path.with_name("out")
            result = mffit.spin(path) if direct else mffit.build(path, out, with_report=False)
            said = {} if direct else json.loads((out / "result.json").read_text(encoding="utf-8"))
        except InputError as error:
            return Told(refused=str(error))
    draw = Told(trusted=result.trusted)
    measured = numbers(result if direct else result.measured, known, true)
    for key, row in measured.items():
        if name.startswith("direct") or key in SIGNED:
            draw.note(key, *row)
    if not direct:
        _note_build(draw, result, true, known, {**known.faults, **faults}, world.watched)
        _note_words(draw, said)
    return draw


def _note_build(
    draw: Told, result: Any, true: tir.Tyre, known: Any, faults: Mapping[str, Any], watched: Sequence[str]
) -> None:
    fit, found = result.fit, result.fit.temperature
    draw.seconds = fit.seconds
    noise, points = float(np.sqrt(np.nanmean(result.points.u_Fy**2))), result.points
    draw.misfit["Fy"] = fit.channels["Fy"].rmse / noise
    loads = np.unique(np.round(points.Fz, -2))
    draw.error["Fy on the disc [N]"] = model_error(fit.tyre, true, -1.0 / known.nominal.R_m, loads)[0]
    own, aim = (Simulation.of(tyre).readings(points).Fy for tyre in (fit.tyre, true))
    draw.error["Fy of the file at the points [N]"] = rms(own - aim)
    draw.error |= {f"{name} found [%]": 100.0 * size for name, size in fit.choice.scatter.items() if fit.runs}
    files = {"": fit.coefficients}
    if found is not None:
        files = {" of the plain file": fit.coefficients, "": found.coefficients}
        draw.misfit["Fy at temperature"] = found.channels["Fy"].rmse / noise
        for name, (value, u) in found.terms.items():
            at_cold = faults.get(name) or faults.get("k_T_per_K", 0.0)
            k = at_cold / (1.0 + at_cold * (found.T_ref - COLD))  # relative to the reference of the build
            draw.note(f"rig.{name}", value, u, k)
            if k:
                draw.error[f"{name} over its truth"] = value / k
    for name in watched:
        for word, coefficients in files.items():
            if name in coefficients and coefficients[name].stderr:
                draw.note(name + word, coefficients[name].value, coefficients[name].stderr, true[name])
        if name in fit.rig:
            draw.note(f"rig.{name}", *fit.rig[name], faults.get(name, 0.0))


def _note_words(draw: Told, written: Mapping[str, Any]) -> None:
    """What ``result.json`` says: reasons, warnings, and an effect, a sweep or an influence that is suspected or modelled."""
    draw.reasons, draw.warnings = written["reasons"], written["warnings"]
    residuals = written["residuals"]
    named = [residuals["effect"]["id"]] if residuals["effect"] and residuals["effect"]["significant"] else []
    named += ["one sweep"] if residuals["sweep"] else []
    draw.suspected = ", ".join(
        [*named, *(row["id"] for row in written["fit"]["modelled"] if row["modelled"])]
    )


def numbers(measured: Any, known: Any, true: tir.Tyre) -> dict[str, tuple[float, float, float]]:
    """By quantity of the nominal load: value, standard uncertainty and truth."""
    row, truth, faults = measured.nominal, known.nominal, known.faults
    phi_t = -1.0 / truth.R_m

    def slope(angle: str, phi_t: float = phi_t) -> float:
        up, down = (
            true(truth.load_N, phi_t=phi_t, Vx=6.0, turn_slip=True, **{angle: s}).Fy for s in (STEP, -STEP)
        )
        return float(up - down) / (2.0 * STEP)

    axis, ply_steer = np.radians(faults["alpha_0_deg"]), float(true["PHY1"])
    pairs = {
        "eps_gamma": (row.epsilon_gamma, truth.epsilon_gamma),
        "eps_gamma debiased": (measured.epsilon_gamma_debiased, truth.epsilon_gamma),
        "C_phit [Nm]": (row.C_phit, truth.C_phit_secant_Nm),
        "F_phit [N]": (row.F_phit, truth.F_phit_N),
        "C_gamma on the path [N/rad]": (row.C_gamma, slope("gamma")),
        "C_alpha on the path [N/rad]": (row.C_alpha, slope("alpha")),
        "C_alpha without spin [N/rad]": (row.C_alpha_straight, slope("alpha", 0.0)),
        "r_e [m]": (row.r_e, truth.r_e_m),
        "R [m]": (row.R, truth.R_m),
        "alpha_M, the sum [rad]": (row.alpha_M, axis + ply_steer),
        "misalignment [rad]": (row.misalignment, axis),
        "ply-steer [rad]": (row.ply_steer, ply_steer),
        "camber skew [deg]": (measured.camber_skew, faults["camber_skew_deg"]),
        "conicity [N]": (row.conicity, float(true["PVY1"]) * truth.load_N),
    }
    return {key: (q.value, q.u, float(t)) for key, (q, t) in pairs.items() if q is not None}


def page(name: str, rows: list[Told]) -> Iterator[str]:
    draws, refused = harness.sound(rows)
    yield f"\n## {name}: {len(rows)} rigs, {len(refused)} refused, not trusted {sum(not d.trusted for d in draws)}"
    yield from harness.counted((text[:160] for text in refused), 3)
    for key in dict.fromkeys(key for d in draws for key in (d.misfit | d.error)):
        x = np.array([(d.misfit | d.error)[key] for d in draws if key in d.misfit | d.error])
        word = " over noise" if key.startswith("Fy") and "[N]" not in key else ""
        yield f"{key}{word}: median {np.median(x):.3g}, {x.min():.3g} to {x.max():.3g}, rms {rms(x):.3g}, in {len(x)}"
    if draws and draws[0].misfit:
        yield from _told(draws)
    yield from harness.coverage(draws)


def _told(draws: Sequence[Told]) -> Iterator[str]:
    told = [bool(d.reasons or d.warnings) for d in draws]
    named = [bool(d.suspected) for d in draws]
    right = [all(d.inside.get(n, True) for n in SIGNED) for d in draws]
    eps = [d.inside.get("eps_gamma", True) for d in draws]
    shares = {
        "with a warning": [d.warnings for d in draws],
        "told": told,
        "an effect named or modelled": named,
        "all inside 95 %": right,
        "any of these": np.any([told, named, right], axis=0),
        "with eps_gamma alone": np.any([told, named, eps], axis=0),
    }
    yield ", ".join(f"{word} {harness.percent(hits)}" for word, hits in shares.items())
    for key in ("reasons", "warnings"):
        said = (t for d in draws for t in {re.sub(r"[-+]*\d[\d.e-]*", "#", t)[:110] for t in getattr(d, key)})
        yield from harness.counted((f"{key}: {text}" for text in said), 4)
    yield from harness.counted(f"suspected: {d.suspected[:90]}" for d in draws)
    yield f"fit {harness.median([d.seconds for d in draws]):.1f} s"


if __name__ == "__main__":
    harness.study(one, page, worlds=WORLDS, draws=60, build=False)
