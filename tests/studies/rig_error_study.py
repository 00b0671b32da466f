"""Do the uncertainties of the direct method hold on rigs with errors of one kind?

`python tests/studies/rig_error_study.py 200 --jobs 2`

For every world (what is wrong with the rig, what is declared of it, which sweeps are run) it draws rigs and tyres, front and
rear in turn, measures eps_gamma and the numbers beside it, and prints rms error, mean standard uncertainty and the share of
95 % intervals (k = 1.96) that contain the truth. Conicity and ply-steer of the tyres are drawn from their usual sizes. With
`--build` it fits every rig, which takes seconds, and adds the numbers that need a model.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import worlds
from drawn_rigs import DECLARED, SAFE, backward_camber, front_or_rear, on_disk, plan_content

import mffit
import tir
from mffit.errors import InputError
from mffit.rig_errors import CALIBRATED

STEP = 1e-5  # rad, for the slopes of the true tyre


@dataclass(frozen=True)
class World:
    """What is wrong with the rigs, what they declare, and what they run."""

    faults: Mapping[str, float] = field(default_factory=dict)  #: beside the drawn ones
    declared: Mapping[str, float] = field(default_factory=dict)  #: keys of [rig] in tyre.toml
    drawn_from: Mapping[str, float] = field(default_factory=dict)  #: other keys of [rig] for the draw
    backward_camber: bool = False
    other_side: bool = False  #: every load on the other side of the disc too, the rig set up anew in between
    setups: int = (
        1  #: how often the rig is set up on the usual path, with zeros at the nominal load every time
    )
    flipped: bool = False  #: zeros with the tyre turned on its rim, too
    lacking: bool = False  #: no backward zeros at the nominal load; ply-steer changes over load
    conicity: float = 0.002  #: standard deviation of the drawn conicity, over load
    warm_camber: float = 0.0  #: temperature of camber sweeps above that of the others [K]


YIELDING, COMPLIANT = {"compliance_deg_per_Nm": 0.006}, {"u_steering_compliance_deg_per_Nm": 0.005}
COEFFICIENTS = ("PKY1", "PDY1", "PKY6", "QDZ1")
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
PLY_STEER = 0.002  # rad, standard deviation


def _zeros(factor: float) -> dict[str, float]:
    """The declared uncertainties of the zeros of a set-up times a factor."""
    return {name: factor * u for name, u in DECLARED.items() if name != "u_camber_skew_deg"}


WORLDS = {
    "as declared": World(),
    "as declared, backward camber": World(backward_camber=True),
    "skew 0.3 deg, declared": World(declared={"u_camber_skew_deg": 0.3}),
    "skew 0.3 deg, declared, backward camber": World(
        declared={"u_camber_skew_deg": 0.3}, backward_camber=True
    ),
    "skew 0.5 deg, not declared": World(faults={"camber_skew_deg": 0.5}),
    "skew 0.5 deg, not declared, backward camber": World(
        faults={"camber_skew_deg": 0.5}, backward_camber=True
    ),
    "conicity 1 %, declared": World(conicity=0.01, declared={"u_conicity": 0.01}),
    "conicity 1 %, not declared": World(conicity=0.01),
    "conicity 1 %, not declared, flipped zeros": World(conicity=0.01, flipped=True),
    "camber sweeps 15 K warmer, stiffness -0.2 % per K": World(
        faults={"k_T_stiffness_per_K": -0.002}, warm_camber=15.0
    ),
    "load falls by 6 % sin^2": World(faults={"load_camber": -0.06}),
    "axis off by 0.35 deg, backward zeros at the other loads only": World(
        faults={"alpha_0_deg": 0.35}, lacking=True
    ),
    "both sides, set up anew": World(other_side=True),
    "both sides, set up anew, 1.5 times the declared": World(
        other_side=True, drawn_from={name: 1.5 * u for name, u in DECLARED.items()}
    ),
    "three set-ups on one path": World(setups=3),
    "three set-ups on one path, twice the declared": World(setups=3, drawn_from=_zeros(2.0)),
    "five set-ups on one path, twice the declared": World(setups=5, drawn_from=_zeros(2.0)),
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
    "all errors 1.5 times the declared": World(drawn_from={name: 1.5 * u for name, u in DECLARED.items()}),
}


@dataclass(frozen=True)
class Found:
    """Value, standard uncertainty and truth by quantity; the refusal of a campaign that was not measured."""

    numbers: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    trusted: bool = True
    refused: str = ""


def one(job: tuple[int, str, Any]) -> Found:
    """Draw, simulate and measure one rig."""
    seed, name, given = job
    world, rng = WORLDS[name], np.random.default_rng(5000 + seed)
    sample, true = front_or_rear(seed, rng)
    conicity, ply_steer = rng.normal(0.0, (world.conicity, PLY_STEER))
    true = true.replace(PVY1=conicity, PHY1=ply_steer, PVY2=0.0, PHY2=0.0)
    content = plan_content(sample)
    content["faults"] |= world.faults
    declared = {**content["rig"], **DECLARED, **world.declared}
    content["rig"] = {**declared, **world.drawn_from}
    if world.backward_camber:
        content["sweep"].append(backward_camber(content))
    if world.other_side:
        content["sweep"] += _other_side(content)
    content["sweep"] += _again(content, world.setups)
    if world.flipped:
        content["sweep"] += _flipped(content)
    if world.lacking:
        true = true.replace(PHY2=rng.normal(0.0, PLY_STEER))
        content["sweep"] = [sweep for sweep in content["sweep"] if not _backward_at_nominal(sweep, content)]
    elif not given.build:  # eps_gamma at the nominal load needs no other sweeps
        content["sweep"] = [sweep for sweep in content["sweep"] if _needed(sweep, content)]
    for sweep in content["sweep"]:
        if world.warm_camber and "gamma_deg" in sweep and "alpha_deg" not in sweep:
            sweep["T_degC"] = 28.0 + world.warm_camber
    with on_disk(true, content, seed, edit=lambda config: config["rig"].update(declared)) as (path, known):
        try:
            result = mffit.build(path) if given.build else mffit.spin(path)
        except InputError as error:
            return Found(refused=str(error))
    measured = result.measured if given.build else result
    fitted = _fitted(result.fit, known, true) if given.build else {}
    return Found({**numbers(measured, known, true), **fitted}, trusted=result.trusted)


def _fitted(fit: Any, known: Any, true: tir.Tyre) -> dict[str, tuple[float, float, float]]:
    """Coefficients, and the compliance of the steering where it was a number of the fit."""
    found = {
        name: (fit.coefficients[name].value, fit.coefficients[name].stderr, true[name])
        for name in COEFFICIENTS
    }
    for name in YIELDING.keys() & fit.rig.keys():
        found[name] = (*fit.rig[name], known.faults[name])
    return found


def _other_side(content: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The upright and the camber sweeps at the usual pressure with the centre of the disc on the other side."""
    usual = content["rig"].get("path_centre", "left")
    other = {"path_centre": "right" if usual == "left" else "left"}
    plain = [s for s in content["sweep"] if "p_kPa" not in s and not ("alpha_deg" in s and "gamma_deg" in s)]
    return [{**sweep, "file": f"other_{sweep['file']}", **other} for sweep in plain]


def _again(content: Mapping[str, Any], setups: int) -> list[dict[str, Any]]:
    """Zeros both ways in further set-ups at the nominal load; all other sweeps belong to the first one."""
    if setups < 2:
        return []
    for sweep in content["sweep"]:
        sweep["setup"] = "1"
    load = content["tyre"]["nominal_load"]
    return [
        {
            "file": f"{way}_{k}.csv",
            "load_N": load,
            "alpha_deg": [-0.5, 0, 0.5],
            "direction": way,
            "setup": str(k),
        }
        for k in range(2, setups + 1)
        for way in ("forward", "backward")
    ]


def _needed(sweep: Mapping[str, Any], content: Mapping[str, Any]) -> bool:
    """Whether a sweep is one of the nominal load and pressure, over one angle."""
    at_nominal = sweep["load_N"] == content["tyre"]["nominal_load"] and "p_kPa" not in sweep
    return at_nominal and not {"alpha_deg", "gamma_deg"} <= sweep.keys()


def _backward_at_nominal(sweep: Mapping[str, Any], content: Mapping[str, Any]) -> bool:
    """Whether a sweep has backward zeros of the nominal load."""
    return sweep["load_N"] == content["tyre"]["nominal_load"] and sweep.get("direction") == "backward"


def _flipped(content: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Zeros of the nominal load with the tyre turned on its rim, in both directions."""
    load, angles = content["tyre"]["nominal_load"], [-1, -0.5, 0, 0.5, 1]
    zeros = {"load_N": load, "alpha_deg": angles, "mount": "flipped"}
    return [{**zeros, "file": f"flipped_{way}.csv", "direction": way} for way in ("forward", "backward")]


def numbers(measured: Any, known: Any, true: tir.Tyre) -> dict[str, tuple[float, float, float]]:
    """By quantity of the nominal load: value, standard uncertainty and truth."""
    row, truth, faults = measured.nominal, known.nominal, known.faults
    phi_t = -1.0 / truth.R_m

    def slope(angle: str, phi_t: float = phi_t) -> float:
        forces = (
            true(truth.load_N, phi_t=phi_t, Vx=6.0, turn_slip=True, **{angle: s}).Fy for s in (STEP, -STEP)
        )
        up, down = forces
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


def table(name: str, rows: list[Found]) -> list[str]:
    """Lines of one world."""
    sound = [row.numbers for row in rows if not row.refused]
    distrusted = sum(not row.trusted for row in rows)
    out = [f"\n## {name}: {len(rows)} rigs, {len(rows) - len(sound)} refused, {distrusted} not trusted\n"]
    out += [
        "| quantity | rms error | mean u | inside 95 % | mean pull | sd of pull |",
        "|---|---|---|---|---|---|",
    ]
    for key in dict.fromkeys(key for row in sound for key in row):
        value, u, truth = np.array([row[key] for row in sound if key in row]).T
        pull = (value - truth) / u
        inside = np.mean(np.abs(pull) < SAFE)
        error = np.sqrt(np.mean((value - truth) ** 2))
        out.append(
            f"| {key} | {error:.3g} | {np.mean(u):.3g} | {inside:.0%} | {np.mean(pull):+.2f} | {np.std(pull):.2f} |"
        )
    out += [f"* {row.refused}" for row in rows if row.refused]
    return out


if __name__ == "__main__":
    ask = worlds.asked(200, WORLDS)
    ask.add_argument(
        "--build", action="store_true", help="build whole files, which know the bias of finite spin"
    )
    worlds.run(one, table, ask)
