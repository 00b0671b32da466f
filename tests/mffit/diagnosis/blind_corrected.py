"""Sets that hide effects of the tyre among errors of the rig, and the score of the file that a diagnosis delivers."""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from blind_hard import _correlated, _gauss, _outliers, _student, rescattered
from blind_rig import Machine, report
from blind_scores import LOOK_ALIKE
from blind_set import (
    CAUSES,
    U_FY,
    U_MZ,
    Case,
    _hide,
    chi2_of_gap,
    disc_programme,
    inexact_names,
    random_tyre,
    write_case,
)

import tir
from mffit import pipeline
from mffit.diagnosis import Diagnosis
from tir import Tyre

NEVER_APART = ("turn-slip", "ply-steer", "conicity", "residual-torque", "camber-reduction-load")
"""Effects of the tyre that such a campaign cannot separate from an error of the rig, and those that dwarf all others."""
TYRE = tuple(name for name, hidden in CAUSES.items() if hidden.tyre and name not in NEVER_APART)
RIG = (
    "sideslip-misalignment", "camber-misalignment", "loadcell-offset-fy", "loadcell-offset-mz", "loadcell-gain",
    "crosstalk-fz-fy", "backlash", "path-radius", "steering-compliance", "temperature", "drift", "speed",
)  # fmt: skip
PLAIN_CHI2 = 500.0
"""Above this chi2 an effect of the tyre must be named."""
FIELDS = {
    "alpha_0_deg": "alpha_0_deg", "gamma_0_deg": "gamma_0_deg", "F0_N": "F0", "M0_Nm": "M0", "gain": "gain",
    "crosstalk": "crosstalk", "backlash_deg": "backlash_deg", "path_radius_m": "R", "compliance_deg_per_Nm": "compliance",
    "k_V_per_mps": "k_V", "k_t_per_s": "k_t",
}  # fmt: skip
"""By number of mffit, the field of the rig that has its true value."""
NOISE = {
    "white": _gauss,
    "AR 0.5": partial(_correlated, memory=0.5),
    "AR 0.9": partial(_correlated, memory=0.9),
    "outliers": _outliers,
    "student": _student,
}
USUAL = ("white", "white", "AR 0.5", "AR 0.9")
"""Noise of the sets, in turn."""


@dataclass(frozen=True)
class Score:
    """What was delivered, against the truth."""

    name: str
    causes: tuple[str, ...]
    chi2: tuple[float, ...]  #: of the gap that each tyre effect alone leaves
    exact: bool
    noise: str
    named: tuple[str, ...]
    ties: tuple[tuple[str, ...], ...]
    confidence: tuple[float, ...]
    headline: str
    unexplained: bool
    trusted: bool
    new_file: bool  #: whether another file than the given one is delivered
    given: tuple[float, float]
    """Rms miss of the given file off the hidden tyre, in units of noise: straight, on the disc."""
    delivered: tuple[float, float]  #: the same of the delivered file
    pulls: dict[str, float]  #: by number of a named cause, error over stated error
    seconds: float

    @property
    def ratio(self) -> float:
        """Miss of the delivered file over that of the given one, the worse of straight path and disc."""
        return max(d / max(g, 1e-3) for d, g in zip(self.delivered, self.given, strict=True))

    @property
    def known(self) -> set[str]:
        """Named effects and their ties."""
        return {*self.named, *(tie for ties in self.ties for tie in ties)}

    @property
    def false(self) -> list[str]:
        """Named effects that are neither hidden nor tied with a hidden one."""
        return [n for n, t in zip(self.named, self.ties, strict=True) if not {n, *t} & set(self.causes)]

    @property
    def missed(self) -> list[str]:
        """Tyre effects with plain chi2 that are not named."""
        tyre = [name for name in self.causes if CAUSES[name].tyre]
        return [
            n for n, size in zip(tyre, self.chi2, strict=True) if size > PLAIN_CHI2 and n not in self.known
        ]

    def line(self) -> str:
        kind = f"{'exact' if self.exact else 'inexact'} {self.noise}"
        named = ", ".join(
            f"{n}{list(t) if t else ''} {c:.2f}"
            for n, t, c in zip(self.named, self.ties, self.confidence, strict=True)
        )
        said = " UNEXPLAINED" * self.unexplained + " distrusted" * (not self.trusted) + " new" * self.new_file
        return (
            f"{self.name:5s} {kind:14s} {'+'.join(self.causes) or 'nothing'} -> {named or 'none'}{said}  ratio {self.ratio:.2f} "
            f"(given {self.given[0]:.1f} {self.given[1]:.1f})" + (f" FALSE {self.false}" if self.false else "")
            + (f" MISSED {self.missed}" if self.missed else "") + f"  {self.seconds:.0f} s"
        )  # fmt: skip


@dataclass(frozen=True)
class Plan:
    """What is hidden in a set, and how."""

    name: str
    seed: int
    tyre: tuple[str, ...]
    rig: tuple[str, ...]
    exact: bool
    noise: str
    inexactness: float = 0.004  #: relative, of every coefficient of an inexact model


def plans(
    seed: int, sets: int, nothing: int = 0, inexactness: float = 0.004, noises: Sequence[str] = USUAL
) -> Iterator[Plan]:
    """The sets of a study: exact and inexact in turn, then those with nothing hidden."""
    for k in range(sets + nothing):
        rng = np.random.default_rng((seed, k))
        while True:
            tyre = tuple(rng.choice(TYRE, 1 + int(rng.integers(2)), replace=False).tolist())
            rig = tuple(rng.choice(RIG, int(rng.integers(5)), replace=False).tolist())
            if not any(len({*tyre, *rig} & alike) > 1 for alike in LOOK_ALIKE):
                break
        if k >= sets:
            tyre, rig = (), ()
        noise, number = noises[k // 2 % len(noises)], int(rng.integers(1 << 31))
        yield Plan(f"{seed}-{k}", number, tyre, rig, bool(k % 2), noise, inexactness)


def draw(plan: Plan) -> tuple[Case, tuple[float, ...]]:
    """The case of a plan, and the chi2 of the gap of every tyre effect alone."""
    rng = np.random.default_rng(plan.seed)
    kind = "front" if rng.random() < 0.5 else "rear"
    true = random_tyre(kind, rng)
    run = disc_programme(1500.0 if kind == "front" else 1800.0, rng)
    u = 0.0 if plan.exact else plan.inexactness
    given, machine, sizes = true, Machine(), []
    for cause in (*plan.tyre, *plan.rig):
        given, true, machine = _hide(cause, None, given, true, machine, run, u, rng)
    weigh = chi2_of_gap(given, run, u)
    for cause in plan.tyre:
        alone = given.replace(**{name: float(true[name]) for name in CAUSES[cause].tyre})
        sizes.append(
            weigh(
                np.concatenate(report(alone, Machine(), run)) - np.concatenate(report(given, Machine(), run))
            )
        )
    if not plan.exact:
        given = given.replace(**{n: float(given[n]) * (1.0 + u * rng.normal()) for n in inexact_names(given)})
    Fy, Mz = report(true, machine, run)
    case = Case(
        plan.name,
        kind,
        (*plan.tyre, *plan.rig),
        "large",
        plan.exact,
        given,
        true,
        machine,
        u,
        True,
        run,
        Fy,
        Mz,
    )
    return rescattered(case, NOISE[plan.noise], np.random.default_rng(plan.seed + 1)), tuple(sizes)


def misses(tyre: Tyre, true: Tyre) -> tuple[float, float]:
    """Rms difference of Fy and Mz from the hidden tyre over its range, in units of noise: straight, and on the disc."""
    load = float(true["FNOMIN"])
    Fz, alpha, gamma, p = (
        x.ravel()
        for x in np.meshgrid(
            np.array([0.6, 1.0, 1.5]) * load, np.radians(np.linspace(-8.0, 8.0, 17)), np.radians(np.linspace(-40.0, 40.0, 9)),
            np.array([2.0e5, 2.5e5, 3.0e5]),
        )
    )  # fmt: skip
    out = []
    for phi_t in (0.0, -1.0 / 1.323):
        a, b = (one(Fz, alpha=alpha, gamma=gamma, phi_t=phi_t, p=p, Vx=6.0) for one in (tyre, true))
        out.append(float(np.sqrt(np.mean(((a.Fy - b.Fy) / U_FY) ** 2 + ((a.Mz - b.Mz) / U_MZ) ** 2))))
    return out[0], out[1]


def scored(plan: Plan) -> Score:
    """The score of a diagnosis from files, as a user would make it."""
    case, sizes = draw(plan)
    with tempfile.TemporaryDirectory() as scratch:
        folder, out = Path(scratch) / "case", Path(scratch) / "out"
        write_case(case, folder, Path(scratch) / "truth.json")
        began = time.process_time()
        found = pipeline.diagnose(folder / "tyre.toml", folder / "given.tir", out=out)
        seconds = time.process_time() - began
        path = (out / json.loads((out / "diagnosis.json").read_text())["model_after"]).resolve()
        delivered = tir.read(path)
    return Score(
        name=plan.name,
        causes=(*plan.tyre, *plan.rig),
        chi2=sizes,
        exact=plan.exact,
        noise=plan.noise,
        named=tuple(one.effect.id for one in found.effects),
        ties=tuple(one.tied_with for one in found.effects),
        confidence=tuple(one.confidence for one in found.effects),
        headline=found.headline,
        unexplained=found.unexplained,
        trusted=found.trusted,
        new_file=dict(delivered.values) != dict(case.given.values),
        given=misses(case.given, case.true),
        delivered=misses(delivered, case.true),
        pulls=_pulls(case, found),
        seconds=seconds,
    )


def _pulls(case: Case, found: Diagnosis) -> dict[str, float]:
    """Errors of the numbers of correctly named effects over their stated standard errors."""
    out = {}
    for one in found.effects:
        if one.effect.id not in case.causes:
            continue
        for name, (value, u) in one.parameters.items():
            if name in case.true.values:
                truth = float(case.true[name])
            elif name in FIELDS:
                truth = float(getattr(case.machine, FIELDS[name]))
            else:
                continue
            if u > 0.0:
                out[f"{one.effect.id}:{name}"] = (value - truth) / u
    return out
