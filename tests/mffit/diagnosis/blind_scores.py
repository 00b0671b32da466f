"""The cases of a blind set, and the score of a diagnosis."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from blind_set import ADDED, CAUSES, STRUCTURES, Case, draw_case, write_case

from mffit import pipeline
from mffit.config import Config
from mffit.config import load as load_config
from mffit.diagnosis import Diagnosis
from mffit.points import Points, read
from mffit.rig import Simulation

LOOK_ALIKE = (
    {"sideslip-misalignment", "ply-steer"},
    {"path-radius", "camber-misalignment", "camber-reduction", "camber-reduction-load"},
    {"conicity", "crosstalk-fz-fy", "loadcell-offset-fy", "run-offsets-fy"},
    {"loadcell-offset-mz", "run-offsets-mz"},
    {"sideslip-misalignment", "run-offsets-alpha"},
    {"residual-torque", "loadcell-offset-mz"},
    {"spin-trail-loss", "trail-camber"},
)
"""Effects with one signature; the data cannot decide between two of a group."""


def loaded(case: Case, folder: Path) -> tuple[Config, Points]:
    """Configuration and points of a case, through its files."""
    write_case(case, folder / case.name, folder / f"{case.name}.json")
    settings = load_config(folder / case.name / "tyre.toml")
    return settings, read(settings).points


@dataclass(frozen=True)
class Plan:
    """A case that is drawn when it is needed."""

    name: str
    draw: Callable[[], Case]


@dataclass(frozen=True)
class Verdict:
    """Hidden and named causes, and the quality of the correction."""

    name: str
    causes: tuple[str, ...]
    structure: str
    named: tuple[str, ...]
    ties: tuple[tuple[str, ...], ...]
    unexplained: bool
    right_region: bool
    shrink: (
        float  #: gap to the noise-free truth before over after, at unmeasured set-points, in units of noise
    )
    seconds: float  #: of the processor
    confidence: tuple[float, ...] = ()  #: of each named effect

    @property
    def outright(self) -> bool:
        """Whether everything is right and nothing is left open."""
        if self.structure:
            return self.unexplained and self.right_region and not self.named
        return set(self.named) == set(self.causes) and not any(self.ties) and not self.unexplained

    @property
    def extra(self) -> int:
        """Named effects that were not hidden and are not tied with a hidden one."""
        tied = [set(ties) for ties in self.ties]
        return sum(
            n not in self.causes and not t & set(self.causes) for n, t in zip(self.named, tied, strict=True)
        )

    def found(self, cause: str) -> bool:
        """Whether a cause is named or tied with a named effect."""
        return cause in self.named or any(cause in ties for ties in self.ties)

    def line(self) -> str:
        named = " ".join(f"{n}{list(t) or ''}" for n, t in zip(self.named, self.ties, strict=True))
        return (
            f"{self.name:44s} -> {named or 'none'}" + (" unexplained" if self.unexplained else "")
            + (" right region" if self.right_region else "") + f"  x{self.shrink:.1f}"
        )  # fmt: skip


def suite(seed: int, repeats: int = 1) -> Iterator[Plan]:
    """Every effect at every size; pairs; nothing hidden; structure without a name. Exact and inexact models in turn."""
    for number in range(1000 * seed, 1000 * seed + repeats):
        yield from singles(number)
        yield from pairs(number)
        yield from nothing(number)
        yield from unknown(number)


def singles(seed: int, levels: Sequence[str] = ("large", "moderate", "faint")) -> Iterator[Plan]:
    """Every effect alone."""
    for k, cause in enumerate((*CAUSES, *ADDED)):
        for j, level in enumerate(levels):
            yield _plan((cause,), level, 1000 * seed + 3 * k + j, exact=bool((seed + k + j) % 2))


def pairs(seed: int, count: int = 20) -> Iterator[Plan]:
    """Two effects with different signatures; not turn slip, which would dwarf the other."""
    rng = np.random.default_rng(seed)
    names = [name for name in CAUSES if name != "turn-slip"]
    for k in range(count):
        while True:
            drawn = tuple(rng.choice(names, 2, replace=False).tolist())
            if not any(set(drawn) <= alike for alike in LOOK_ALIKE):
                break
        yield _plan(drawn, ("large", "moderate")[k % 2], 1000 * seed + 200 + k, exact=bool(k // 2 % 2))


def nothing(seed: int, count: int = 20) -> Iterator[Plan]:
    """A model that is right, or as inexact as declared."""
    for k in range(count):
        yield _plan((), "large", 1000 * seed + 400 + k, exact=bool(k % 2))


def unknown(seed: int, count: int = 12) -> Iterator[Plan]:
    """Structure without a name, all shapes in turn."""
    shapes = tuple(STRUCTURES)
    for k in range(count):
        yield _plan((), "large", 1000 * seed + 600 + k, exact=bool(k % 2), structure=shapes[k % len(shapes)])


def _plan(causes, level, seed, *, exact, structure=None) -> Plan:
    what = "+".join(causes) or structure or "none"
    name = f"{seed}-{what}-{level}-{'exact' if exact else 'inexact'}"
    return Plan(name, lambda: draw_case(name, causes, level, seed, exact=exact, structure=structure))


def judge(case: Case) -> Verdict:
    """Write the case to files, diagnose it as a user would, and compare with the hidden causes."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / "case"
        write_case(case, folder, Path(scratch) / "truth.json")
        began = time.process_time()
        diagnosis = pipeline.diagnose(folder / "tyre.toml", folder / "given.tir")
        seconds = time.process_time() - began
    return Verdict(
        name=case.name,
        causes=case.causes,
        structure=str(case.structure["shape"]) if case.structure else "",
        named=tuple(found.effect.id for found in diagnosis.effects),
        ties=tuple(tuple(found.tied_with) for found in diagnosis.effects),
        unexplained=diagnosis.unexplained,
        right_region=_right_region(case, diagnosis),
        shrink=_shrink(case, diagnosis),
        seconds=seconds,
        confidence=tuple(found.confidence for found in diagnosis.effects),
    )


def _right_region(case: Case, diagnosis: Diagnosis) -> bool:
    """Whether the first unexplained region contains the structure and is not half of the programme."""
    if case.structure is None or not diagnosis.unexplained_where:
        return False
    first = diagnosis.unexplained_where[0]
    low, high = first.region.get(str(case.structure["column"]), (np.nan, np.nan))
    width = float(case.structure["width"])  # type: ignore[arg-type]
    return (
        first.channel == case.structure["channel"] and low - width <= case.structure["centre"] <= high + width
        and high - low < 8.0 * width
    )  # fmt: skip


def _shrink(case: Case, diagnosis: Diagnosis) -> float:
    """Ratio of the gaps to the noise-free truth before and after, halfway between the measured angles."""
    run = case.run
    between = run.where(np.abs(run.alpha_deg) < 8.0)
    offset = np.where(between.gamma_deg == 0.0, 0.25, 0.0)
    between = type(run)(
        **{**vars(between), "alpha_deg": between.alpha_deg + offset, "gamma_deg": between.gamma_deg * 0.9}
    )
    points = diagnosis.points.select(np.flatnonzero(np.abs(np.degrees(diagnosis.points.alpha)) < 7.999))
    if len(points) != len(between.alpha_deg):  # a sweep was left out
        return np.nan
    points = points.replace(alpha=np.radians(between.alpha_deg), gamma=np.radians(between.gamma_deg))
    truth = case.noise_free(between)
    before = Simulation.of(case.given, turn_slip=case.turn_slip).readings(points)
    after = diagnosis.state.predict(points)
    n = len(points)
    gap = [
        sum(float(np.sum(((t - s) / u) ** 2)) for t, s, u in zip(truth, sides, (6.0, 0.6), strict=True))
        for sides in ((before.Fy, before.Mz), (after[:n], after[n:]))
    ]
    return float(np.sqrt(gap[0] / max(gap[1], 1e-12)))


def rates(verdicts: list[Verdict]) -> dict[str, tuple[float, float]]:
    """The rates of a set: hits and number of cases."""
    single = [v for v in verdicts if len(v.causes) == 1]
    pairs = [v for v in verdicts if len(v.causes) == 2]
    none = [v for v in verdicts if not v.causes and not v.structure]
    unknown = [v for v in verdicts if v.structure]
    caused = single + pairs
    first = [v for v in single if v.named and (v.named[0] == v.causes[0] or v.causes[0] in v.ties[0])]
    return {
        "named first outright": (sum(v.named[:1] == v.causes and not v.ties[0] for v in single), len(single)),
        "named first, tied or not": (sum(v.named[:1] == v.causes for v in single), len(single)),
        "first or inside its tie": (len(first), len(single)),
        "cases with a tie": (sum(any(v.ties) for v in single), len(single)),
        "nothing hidden, nothing named": (sum(not v.named and not v.unexplained for v in none), len(none)),
        "both of two found": (sum(all(v.found(c) for c in v.causes) for v in pairs), len(pairs)),
        "false extra effects": (sum(v.extra for v in verdicts), len(verdicts)),
        "false 'unexplained'": (sum(v.unexplained for v in caused + none), len(caused + none)),
        "unknown: unexplained, right region": (
            sum(v.unexplained and v.right_region for v in unknown),
            len(unknown),
        ),
        "unknown: not forced onto an effect": (sum(not v.named for v in unknown), len(unknown)),
        "median gap shrinkage": (float(np.nanmedian([v.shrink for v in caused] or [np.nan])), 0),
        "median seconds": (float(np.median([v.seconds for v in verdicts] or [np.nan])), 0),
    }
