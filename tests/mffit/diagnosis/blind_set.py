"""Blind cases: a campaign, the model that a simulation would use, and, kept apart, the hidden causes.

A cause is drawn with its sign and direction. Its size is set by the chi2 of the gap that it leaves in noise-free
readings after the declared inexactness of the given model is projected out.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from blind_rig import Machine, Programme, disc_programme, report
from disc_files import write_project, write_sweep

import tir
from tir import Tyre

SAMPLES = Path(__file__).parents[3] / "samples"
TYRES = {"front": "front-120-70", "rear": "rear-190-55"}
U_FY, U_MZ = 6.0, 0.6  # N, Nm
CHI2 = {"large": None, "moderate": 500.0, "faint": 70.0}  # large: as large as such causes are, plain to see
INEXACT = re.compile(r"P.Y\d+|Q.Z\d+")
PRESSURE = ("PPY1", "PPY2", "PPY3", "PPY5", "PPZ1")


@dataclass(frozen=True)
class Hidden:
    """One cause of the truth: its change at size 1, and where it starts."""

    tyre: Mapping[str, float] = field(default_factory=dict)  #: change of a coefficient
    relative: bool = False  #: changes are relative to the coefficient
    absent: bool = True  #: the given model has zero there
    machine: Mapping[str, float] = field(default_factory=dict)
    sign: bool = True  #: either sign occurs


CAUSES: dict[str, Hidden] = {
    "camber-reduction": Hidden({"PECP1": 0.35}, absent=False),
    "camber-reduction-load": Hidden({"PECP2": 1.5}),
    "ply-steer": Hidden({"PHY1": 0.0025}),
    "conicity": Hidden({"PVY1": 0.012}),
    "camber-stiffness": Hidden({"PKY6": 0.12}, relative=True, absent=False),
    "camber-thrust-curvature": Hidden({"PVY3": 0.3}),
    "camber-grip": Hidden({"PDY3": 0.3}),
    "camber-cornering-stiffness": Hidden({"PKY3": 0.12}),
    "load-grip": Hidden({"PDY2": 0.2}),
    "load-cornering-stiffness": Hidden({"PKY2": 0.15}, relative=True, absent=False),
    "pressure": Hidden(dict.fromkeys(PRESSURE, 0.3)),
    "curvature-asymmetry": Hidden({"PEY3": 0.2}),
    "trail-load": Hidden({"QDZ2": 0.03}),
    "trail-camber": Hidden({"QDZ3": 0.08, "QDZ4": 0.2}),
    "residual-torque": Hidden({"QDZ6": 0.005}),
    "residual-torque-camber": Hidden({"QDZ8": 0.06}),
    "spin-grip-loss": Hidden({"PDYP1": 0.5}, sign=False),
    "spin-stiffness-loss": Hidden({"PKYP1": 0.8}, sign=False),
    "spin-trail-loss": Hidden({"QDTP1": 3.0}, sign=False),
    "spin-torque": Hidden({"QCRP1": 0.12}, sign=False),
    "turn-slip": Hidden(),
    "sideslip-misalignment": Hidden(machine={"alpha_0_deg": 0.4}),
    "camber-misalignment": Hidden(machine={"gamma_0_deg": 0.8}),
    "loadcell-offset-fy": Hidden(machine={"F0": 25.0}),
    "loadcell-offset-mz": Hidden(machine={"M0": 2.5}),
    "loadcell-gain": Hidden(machine={"gain": 0.04}),
    "crosstalk-fz-fy": Hidden(machine={"crosstalk": 0.03}),
    "backlash": Hidden(machine={"backlash_deg": 0.3}, sign=False),
    "path-radius": Hidden(machine={"R": 0.06}),
    "temperature": Hidden(machine={"k_T": 0.002}),
    "speed": Hidden(machine={"k_V": 0.006}),
    "drift": Hidden(machine={"k_t": 2e-6}),
    "steering-compliance": Hidden(machine={"compliance": 0.006}),
    "run-offsets-fy": Hidden(machine={"run_Fy": 12.0}),
    "run-offsets-mz": Hidden(machine={"run_Mz": 1.2}),
    "run-offsets-alpha": Hidden(machine={"run_alpha_deg": 0.12}),
}
"""Every effect that steady points on a disc can show. Its order and length draw the cases: leave both as they are."""
ADDED: dict[str, Hidden] = {}
"""Effects added since, at the end; each is hidden alone, so the other cases stay the same."""


@dataclass(frozen=True)
class Case:
    """One campaign and its hidden causes."""

    name: str
    kind: str
    causes: tuple[str, ...]
    level: str
    exact: bool
    given: Tyre  #: the model handed over
    true: Tyre
    machine: Machine
    u_coefficients: float
    turn_slip: bool  #: of the simulation
    run: Programme
    Fy: np.ndarray  #: with noise [N]
    Mz: np.ndarray  #: with noise [Nm]
    structure: Mapping[str, object] | None = None  #: what no effect describes

    def noise_free(self, run: Programme) -> tuple[np.ndarray, np.ndarray]:
        """Truth at other set-points, to compare a corrected model with."""
        Fy, Mz = report(self.true, self.machine, run)
        return _with_structure(self.structure, run, Fy, Mz, self.true)


def draw_case(
    name: str,
    causes: tuple[str, ...],
    level: str,
    seed: int,
    *,
    exact: bool = True,
    structure: str | None = None,
    inexactness: float = 0.004,
) -> Case:
    """A tyre, a programme and hidden causes, all drawn from ``seed``."""
    rng = np.random.default_rng(seed)
    kind = "front" if rng.random() < 0.5 else "rear"
    true = random_tyre(kind, rng)
    run = disc_programme(1500.0 if kind == "front" else 1800.0, rng)
    u_coefficients = 0.0 if exact else inexactness
    turn_slip = "turn-slip" not in causes
    given, machine = true, Machine()
    for cause in causes:
        given, true, machine = _hide(cause, CHI2[level], given, true, machine, run, u_coefficients, rng)
    if not exact:
        given = given.replace(
            **{n: float(given[n]) * (1.0 + u_coefficients * rng.normal()) for n in inexact_names(given)}
        )
    drawn = draw_structure(structure, rng) if structure else None
    Fy, Mz = _with_structure(drawn, run, *report(true, machine, run), true)
    Fy, Mz = Fy + rng.normal(0.0, U_FY, len(run)), Mz + rng.normal(0.0, U_MZ, len(run))
    return Case(
        name, kind, causes, level, exact, given, true, machine, u_coefficients, turn_slip, run, Fy, Mz, drawn
    )


def random_tyre(kind: str, rng: np.random.Generator) -> Tyre:
    """A sample tyre with every force coefficient some per cent different."""
    tyre = tir.read(SAMPLES / TYRES[kind] / "true.tir")
    names = [n for n in inexact_names(tyre) if n != "PCY1"] + ["PPZ1", "PKYP1", "PDYP1", "QDTP1", "QCRP1"]
    changes = {n: float(tyre[n]) * (1.0 + 0.08 * rng.normal()) for n in names}
    # a reduction factor of zero would leave nothing for its load dependence to act on
    changes |= {"PECP1": float(rng.uniform(-0.25, 0.1)), "PECP2": 0.0}
    return tyre.replace(**changes)


def inexact_names(tyre: Tyre) -> list[str]:
    """The coefficients that ``u_coefficients`` refers to."""
    return [n for n, value in tyre.values.items() if INEXACT.fullmatch(n) and value]


def _hide(cause, target, given: Tyre, true: Tyre, machine: Machine, run, u_coefficients, rng):
    """Add one cause to the truth, at the size whose gap has the wanted chi2; the given model lacks it."""
    hidden = (CAUSES | ADDED)[cause]
    if cause.startswith("run-offsets"):
        machine = machine.with_faults({"draw": int(rng.integers(1 << 31))})
    names = [*hidden.tyre, *hidden.machine]
    signs = {n: (rng.choice((-1.0, 1.0)) if hidden.sign else 1.0) * rng.uniform(0.6, 1.4) for n in names}
    if cause == "camber-reduction-load":
        given, true = given.replace(PECP1=-0.25), true.replace(PECP1=-0.25)
    base = dict.fromkeys(hidden.tyre, 0.0) if hidden.absent else {n: float(given[n]) for n in hidden.tyre}
    given, true = given.replace(**base), true.replace(**base)

    def of_size(size: float) -> tuple[Tyre, Machine]:
        factor = {n: size * signs[n] * (abs(base[n]) if hidden.relative else 1.0) for n in hidden.tyre}
        tyre = true.replace(**{n: base[n] + hidden.tyre[n] * factor[n] for n in hidden.tyre})
        faults = {n: getattr(machine, n) + unit * size * signs[n] for n, unit in hidden.machine.items()}
        return tyre, machine.with_faults(faults)

    if not names:
        return given, true, machine
    if target is None:
        return given, *of_size(float(rng.uniform(0.7, 1.3)))
    without = np.concatenate(report(true, machine, run))
    weigh = chi2_of_gap(given, run, u_coefficients)
    size = _size_with(target, lambda s: weigh(np.concatenate(report(*of_size(s), run)) - without))
    return given, *of_size(size)


def _size_with(target: float, chi2: Callable[[float], float]) -> float:
    """Size at which the gap has the wanted chi2, by bisection of its logarithm, up to that of a large cause."""
    low, high = np.log(1e-4), np.log(1.3)
    if chi2(float(np.exp(high))) < target:
        return float(np.exp(high))
    for _ in range(14):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if chi2(float(np.exp(middle))) < target else (low, middle)
    return float(np.exp(0.5 * (low + high)))


def chi2_of_gap(given: Tyre, run: Programme, u_coefficients: float) -> Callable[[np.ndarray], float]:
    """chi2 of a gap (2n,), relative errors ``u_coefficients`` of the coefficients integrated out."""
    u = np.repeat([U_FY, U_MZ], len(run))
    if not u_coefficients:
        return lambda gap: float(np.sum((gap / u) ** 2))
    columns = []
    for name in inexact_names(given):
        values = [
            np.concatenate(report(given.replace(**{name: float(given[name]) * f}), Machine(), run))
            for f in (1.001, 0.999)
        ]
        columns.append((values[0] - values[1]) / 0.002 * u_coefficients / u)
    J = np.column_stack(columns)
    # Woodbury: (1 + J J')^-1 = 1 - J (1 + J' J)^-1 J'
    inner = np.linalg.inv(np.eye(J.shape[1]) + J.T @ J)
    return lambda gap: float(np.sum((gap / u) ** 2) - (gap / u) @ J @ inner @ J.T @ (gap / u))


STRUCTURES: dict[str, dict[str, object]] = {
    "sideslip-bump": {"channel": "Fy", "column": "alpha_deg", "centre": (2.0, 5.0), "width": 0.9, "size": 65.0},
    "wide-bump": {"channel": "Fy", "column": "alpha_deg", "centre": (3.0, 6.0), "width": 1.6, "size": 50.0},
    "camber-bump": {"channel": "Fy", "column": "gamma_deg", "centre": (12.0, 32.0), "width": 6.0, "size": 60.0},
    "moment-bump": {"channel": "Mz", "column": "alpha_deg", "centre": (2.0, 5.0), "width": 0.9, "size": 6.0},
    "one-load-bump": {
        "channel": "Fy", "column": "alpha_deg", "centre": (2.0, 5.0), "width": 0.9, "size": 65.0, "only": ("Fz", 0.9, 1.1)
    },
    "leaned-bump": {
        "channel": "Fy", "column": "alpha_deg", "centre": (2.0, 5.0), "width": 0.9, "size": 65.0,
        "only": ("gamma_deg", 15.0, 40.0),
    },
}  # fmt: skip
"""Local structure that no effect of the library describes; loads in ``only`` are relative to the nominal one."""


def draw_structure(shape: str, rng: np.random.Generator) -> dict[str, object]:
    """Structure of one shape, with drawn side, sign and size."""
    drawn = dict(STRUCTURES[shape], shape=shape)
    drawn["centre"] = float(rng.choice((-1.0, 1.0)) * rng.uniform(*drawn["centre"]))
    drawn["size"] = float(rng.choice((-1.0, 1.0)) * rng.uniform(0.7, 1.3) * drawn["size"])
    return drawn


def _with_structure(structure, run: Programme, Fy, Mz, tyre: Tyre) -> tuple[np.ndarray, np.ndarray]:
    """Readings with the structure added; it grows with load."""
    if structure is None:
        return Fy, Mz
    load = run.Fz / float(tyre["FNOMIN"])
    x = getattr(run, structure["column"])
    bell = load * structure["size"] * np.exp(-0.5 * ((x - structure["centre"]) / structure["width"]) ** 2)
    if "only" in structure:
        name, low, high = structure["only"]
        y = load if name == "Fz" else getattr(run, name)
        bell = bell * ((y >= low) & (y <= high))
    return (Fy + bell, Mz) if structure["channel"] == "Fy" else (Fy, Mz + bell)


def write_case(case: Case, folder: Path, truth: Path) -> None:
    """Write the campaign to ``folder`` and its hidden causes to the file ``truth``."""
    folder.mkdir(parents=True)
    case.given.write(folder / "given.tir")
    run, names = case.run, list(dict.fromkeys(case.run.sweep.tolist()))
    conditions = (run.alpha_deg, run.gamma_deg, run.Fz, run.p_kPa, run.V, run.backward, run.t, run.T)
    for name in names:
        rows = run.sweep == name
        write_sweep(
            folder / f"{name}.csv", *(column[rows] for column in conditions),
            Fy=case.Fy[rows], Mz=case.Mz[rows], u=(U_FY, U_MZ),
        )  # fmt: skip
    write_project(
        folder, case.name, case.given, names, path_radius=Machine().R, effective_radius=_rolling_radius(case),
        turn_slip=case.turn_slip, u_coefficients=case.u_coefficients,
    )  # fmt: skip
    secret = {
        "causes": case.causes,
        "level": case.level,
        "exact": case.exact,
        "machine": asdict(case.machine),
    }
    truth.write_text(json.dumps(secret | {"structure": case.structure}, indent=1))
    case.true.write(truth.with_suffix(".tir"))


def _rolling_radius(case: Case) -> float:
    """Effective radius from a revolution of the disc at the nominal load [m]."""
    return float(case.true.state(float(case.true["FNOMIN"]), Vx=6.0).Re)
