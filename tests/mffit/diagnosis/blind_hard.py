"""Blind campaigns under laboratory conditions: noise other than stated, inexact models, effects outside the library."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np
from blind_rig import Programme
from blind_scores import Plan
from blind_set import CAUSES, U_FY, U_MZ, Case, draw_case

Scatter = Callable[[np.random.Generator, Programme, np.ndarray, float], np.ndarray]


def _gauss(rng, run, force, u):
    return rng.normal(0.0, u, len(force))


def _outliers(rng, run, force, u):
    wild = rng.random(len(force)) < 0.02
    return _gauss(rng, run, force, u) + wild * rng.choice((-15.0, 15.0), len(force)) * u


def _student(rng, run, force, u):
    return u * rng.standard_t(2.5, len(force))


def _double(rng, run, force, u):
    return _gauss(rng, run, force, 2.0 * u)


def _growing(rng, run, force, u):
    return rng.normal(0.0, np.hypot(u, 0.015 * force))


def _correlated(rng, run, force, u, memory=0.9):
    noise = _gauss(rng, run, force, u)
    for i in range(1, len(force)):
        if run.sweep[i] == run.sweep[i - 1]:
            noise[i] = memory * noise[i - 1] + np.sqrt(1.0 - memory**2) * noise[i]
    return noise


def _continued(rng, run, force, u, memory=0.9):
    """The same memory, but not begun anew with each sweep."""
    noise = _gauss(rng, run, force, u)
    for i in range(1, len(force)):
        noise[i] = memory * noise[i - 1] + np.sqrt(1.0 - memory**2) * noise[i]
    return noise


SCATTERS: dict[str, Scatter] = {
    "plain": _gauss,
    "outliers": _outliers,
    "student": _student,
    "half": _double,
    "growing": _growing,
    "correlated": _correlated,
    "inexact": _gauss,
    "compliance": _gauss,
    "runs": _gauss,
}
"""Every row of the study and its noise, the same for both channels."""

ASKED = {
    "compliance": ("steering-compliance",),
    "runs": ("run-offsets-fy", "run-offsets-mz", "run-offsets-alpha"),
}
"""Causes that have a row of their own."""
USUAL = [name for name in CAUSES if not any(name in causes for causes in ASKED.values())]


def _drifting(rng, run, force, u, memory=0.97, again=_correlated):
    """Errors that drift along a sweep, and independent ones beside them."""
    return 0.8 * again(rng, run, force, u, memory) + _gauss(rng, run, force, 0.6 * u)


MEMORIES = {
    **{f"memory {m:g}": (m, _correlated, _continued) for m in (0.0, 0.6, 0.9, 0.96)},
    "drift": (0.97, _drifting, partial(_drifting, again=_continued)),
}
"""Rows of the study of correlated errors: correlation to the next point, and errors that begin anew with each sweep, or not."""
BESIDE_A_MEMORY = (
    ((), "large"),
    ((), "large"),
    (("run-offsets-fy",), "large"),
    (("run-offsets-fy",), "gross"),
    (("run-offsets-mz",), "large"),
    (("run-offsets-alpha",), "large"),
    (("backlash",), "large"),
    (("sideslip-misalignment",), "moderate"),
    (("camber-misalignment",), "moderate"),
)
"""Causes and their sizes in that study; one more is drawn for each memory."""
GROSS_OFFSETS = 33.0  # N

SMOOTH: dict[str, Callable[[Programme, np.ndarray], np.ndarray]] = {
    "slip wave": lambda run, Fy: 45.0 * np.sin(np.radians(20.0) * run.alpha_deg) * (run.Fz / 1500.0),
    "leaned sink": lambda run, Fy: 40.0 * (run.gamma_deg / 30.0) ** 2 * (run.alpha_deg / 5.0),
    "tidal gain": lambda run, Fy: 0.04 * Fy * np.sin(run.t / 3000.0),
    "load hump": lambda run, Fy: 50.0 * np.cos(2.5 * run.Fz / run.Fz.mean()) * np.tanh(run.alpha_deg / 2.0),
}
"""Smooth changes of Fy outside the library."""


def hard(row: str, seed: int, singles: int = 12, empty: int = 6) -> Iterator[Plan]:
    """Cases of one row: single causes, plain and moderate in turn, then cases without any."""
    rng = np.random.default_rng((seed, *row.encode()))
    causes = rng.choice(USUAL, singles, replace=False).tolist()
    if row in ASKED:
        causes = [name for name in ASKED[row] for _ in range(singles // len(ASKED[row]))]
    for k in range(singles + empty):
        hidden = (str(causes[k]),) if k < singles else ()
        yield _plan(row, hidden, ("large", "moderate")[k % 2], int(rng.integers(1 << 31)))


def correlated(row: str, seed: int) -> Iterator[Plan]:
    """Cases whose errors are correlated along each sweep; in the second one without a cause the memory never restarts."""
    memory, scatter, continued = MEMORIES[row]
    rng = np.random.default_rng((seed, round(100 * memory)))
    drawn = ((str(rng.choice(USUAL)),), "moderate")
    for k, (causes, level) in enumerate((*BESIDE_A_MEMORY, drawn)):
        number = int(rng.integers(1 << 31))
        name = f"{row}-{'+'.join(causes) or 'none'}-{level}-{number}"
        errors = partial(continued if k == 1 else scatter, memory=memory)
        yield Plan(name, partial(_remembering, name, causes, level, number, errors))


def _remembering(name: str, causes: tuple[str, ...], level: str, seed: int, scatter: Scatter) -> Case:
    case = draw_case(name, causes, "large" if level == "gross" else level, seed)
    if level == "gross":
        case = replace(case, level=level, machine=replace(case.machine, run_Fy=GROSS_OFFSETS))
    return rescattered(case, scatter, np.random.default_rng(seed + 1))


def smooth(seed: int, repeats: int = 3) -> Iterator[Plan]:
    """Smooth effects outside the library, exact models."""
    for k in range(repeats * len(SMOOTH)):
        shape = list(SMOOTH)[k % len(SMOOTH)]
        yield Plan(f"smooth-{k}-{shape}", lambda shape=shape, k=k: _smooth(shape, 100 * seed + k))


def triples(seed: int, count: int = 10) -> Iterator[Plan]:
    """Three causes with different signatures, exact models."""
    from blind_scores import LOOK_ALIKE

    rng = np.random.default_rng((seed, 3))
    names = [name for name in USUAL if name != "turn-slip"]
    for k in range(count):
        while True:
            drawn = tuple(rng.choice(names, 3, replace=False).tolist())
            if not any(len(set(drawn) & alike) > 1 for alike in LOOK_ALIKE):
                break
        number = int(rng.integers(1 << 31))
        name = f"triple-{k}-{'+'.join(drawn)}"
        yield Plan(name, lambda name=name, drawn=drawn, n=number: draw_case(name, drawn, "large", n))


def doubtful(seed: int) -> Iterator[Plan]:
    """Doubtful cases under every condition: faint and moderate causes, single, in pairs, and none."""
    from blind_scores import LOOK_ALIKE

    rng = np.random.default_rng((seed, 17))
    names = [name for name in CAUSES if name != "turn-slip"]
    for row in (row for row in SCATTERS if row not in ASKED):
        singles = [(str(name),) for name in rng.choice(names, 9, replace=False)]
        pairs = [tuple(rng.choice(names, 2, replace=False).tolist()) for _ in range(3)]
        pairs = [pair for pair in pairs if not any(set(pair) <= alike for alike in LOOK_ALIKE)]
        for k, causes in enumerate([*singles, *pairs, ()]):
            level = ("faint", "faint", "moderate")[k % 3]
            yield _plan(row, causes, level, int(rng.integers(1 << 31)))


def _plan(row: str, causes: tuple[str, ...], level: str, seed: int) -> Plan:
    name = f"{row}-{'+'.join(causes) or 'none'}-{level}-{seed}"

    def draw() -> Case:
        case = draw_case(name, causes, level, seed, exact=row != "inexact", inexactness=0.03)
        return rescattered(case, SCATTERS[row], np.random.default_rng(seed + 1))

    return Plan(name, draw)


def rescattered(case: Case, scatter: Scatter, rng: np.random.Generator) -> Case:
    """The case with other noise."""
    Fy, Mz = case.noise_free(case.run)
    return replace(case, Fy=Fy + scatter(rng, case.run, Fy, U_FY), Mz=Mz + scatter(rng, case.run, Mz, U_MZ))


def _smooth(shape: str, seed: int) -> Case:
    case = draw_case(f"smooth-{seed}-{shape}", (), "large", seed)
    rng = np.random.default_rng(seed)
    sign = rng.choice((-1.0, 1.0)) * rng.uniform(0.7, 1.3)
    return replace(case, Fy=case.Fy + sign * SMOOTH[shape](case.run, case.Fy))
