"""How a build treats broken data: `python tests/studies/broken_study.py 130`; prints the table of docs/broken-data.md.

The campaigns of the samples on drawn rigs, each with one mistake in a random file, mistakes and samples in turn. "named": the
build refuses a file with the mistake by name. "doubted": it warns about that sweep, or lists the reading as an outlier.
``--sound`` rigs of each sample have no mistake; their false alarms are counted.
"""

from __future__ import annotations

import tempfile
import tomllib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import harness
import numpy as np
import pandas as pd
from disc_project import Project

from mffit import virtual_rig

NAMES = ("flat-track", "front-120-70", "rear-190-55")
SOUND = "no mistake"
FIRST_SOUND = 10_000


class Campaign(Project):
    """A simulated campaign whose files can be changed before it is built."""

    def drawn(self, rng: np.random.Generator, *swept: str) -> str:
        """One of the files, or of those that sweep one of some angles; "" if there is none."""
        names = [n for column in swept for n, table in self.tables.items() if table[column].nunique() > 5]
        names = names if swept else list(self.tables)
        return str(rng.choice(names)) if names else ""


Spoil = Callable[[Campaign, np.random.Generator], list[str]]
"""Puts a mistake into a campaign; returns the files with the mistake, none if the campaign has no suitable file."""


def in_one(change: Callable[[pd.DataFrame, np.random.Generator], None], *swept: str) -> Spoil:
    """A mistake in one file."""

    def spoil(campaign: Campaign, rng: np.random.Generator) -> list[str]:
        name = campaign.drawn(rng, *swept)
        if name:
            change(campaign.tables[name], rng)
        return [name] if name else []

    return spoil


def scaled(column: str, factor: float, *swept: str) -> Spoil:
    """A mistake that multiplies a column of one file."""
    return in_one(lambda table, rng: table.__setitem__(column, table[column] * factor), *swept)


def off(column: str, amount: float) -> Spoil:
    """A mistake that adds an offset to a column of one file."""
    return in_one(lambda table, rng: table.__setitem__(column, table[column] + amount))


def reading(column: str, value: float) -> Spoil:
    """A mistake that replaces one reading."""
    return in_one(lambda table, rng: table.loc.__setitem__((rng.integers(len(table)), column), value))


def everywhere(column: str, factor: float) -> Spoil:
    """A mistake that multiplies a column of every file."""
    return lambda campaign, rng: campaign.each(**{column: factor}) or list(campaign.tables)


def swapped(table: pd.DataFrame, rng: np.random.Generator) -> None:
    """Headings of sideslip and camber exchanged."""
    table.rename(columns={"alpha_deg": "gamma_deg", "gamma_deg": "alpha_deg"}, inplace=True)


def undeclared(campaign: Campaign, rng: np.random.Generator) -> list[str]:
    """Backward runs that are not declared as backward."""
    found = [entry for entry in campaign.config["sweep"] if entry.pop("direction", "") == "backward"]
    return [entry["file"] for entry in found]


def twice(campaign: Campaign, rng: np.random.Generator) -> list[str]:
    """A sweep under two names."""
    entry = campaign.config["sweep"][rng.integers(len(campaign.config["sweep"]))]
    campaign.tables["copy.csv"] = campaign.tables[entry["file"]].copy()
    campaign.config["sweep"].append({**entry, "file": "copy.csv"})
    return ["copy.csv", entry["file"]]


MISTAKES: dict[str, Spoil] = {
    "sign of sideslip reversed in one file": scaled("alpha_deg", -1.0, "alpha_deg"),
    "sign of camber reversed in one file": scaled("gamma_deg", -1.0, "gamma_deg"),
    "sign of side force reversed in one file": scaled("Fy_N", -1.0),
    "sign of moment reversed in one file": scaled("Mz_Nm", -1.0),
    "headings of sideslip and camber exchanged": in_one(swapped, "alpha_deg", "gamma_deg"),
    "backward runs not declared": undeclared,
    "load in kgf in one file": scaled("Fz_N", 1.0 / 9.80665),
    "side force in kN in every file": everywhere("Fy_N", 1e-3),
    "side force in kN in one file": scaled("Fy_N", 1e-3),
    "side force in kgf in one file": scaled("Fy_N", 1.0 / 9.80665),
    "moment in N mm in one file": scaled("Mz_Nm", 1e3),
    "moment in kN m in one file": scaled("Mz_Nm", 1e-3),
    "moment zero in every file": everywhere("Mz_Nm", 0.0),
    "moment zero in one file": scaled("Mz_Nm", 0.0),
    "sideslip in rad in one file": scaled("alpha_deg", np.pi / 180.0, "alpha_deg"),
    "camber in rad in one file": scaled("gamma_deg", np.pi / 180.0, "gamma_deg"),
    "pressure in psi in one file": scaled("p_kPa", 1.0 / 6.894757),
    "a sweep listed twice": twice,
    "one side force of 99999 N": reading("Fy_N", 99999.0),
    "one load of 99999 N": reading("Fz_N", 99999.0),
    "one moment of 300 Nm": reading("Mz_Nm", 300.0),
    "side force 150 N off in one file": off("Fy_N", 150.0),
    "sideslip 0.7 deg off in one file": off("alpha_deg", 0.7),
}
CASES = [(mistake, sample) for mistake in MISTAKES for sample in NAMES]


class Outcome(NamedTuple):
    """What a build said of a mistake."""

    mistake: str
    sample: str
    seed: int
    verdict: str  #: named, doubted, another file or silent; "-" if the campaign has no suitable file

    def line(self) -> str:
        return ", ".join(map(str, self))


def drawn(sample: str, seed: int, folder: Path) -> Campaign:
    """A sample's campaign on a drawn rig; recorded sweeps as finished points."""
    content = tomllib.loads((harness.SAMPLES / sample / "rig.toml").read_text(encoding="utf-8"))
    content["faults"] = {"draw": True}
    for entry in content["sweep"]:
        entry.pop("recording", None)
    plan = virtual_rig.load_plan(content, folder=harness.SAMPLES / sample)
    virtual_rig.simulate(plan, folder, seed=seed)
    config = tomllib.loads((folder / "tyre.toml").read_text(encoding="utf-8"))
    files = [entry["file"] for entry in config["sweep"]]
    return Campaign(folder, config, {file: pd.read_csv(folder / file) for file in files})


def one(job: harness.Job) -> Outcome:
    mistake, sample = CASES[job.seed % len(CASES)]
    if job.seed >= FIRST_SOUND:
        mistake, sample = SOUND, NAMES[(job.seed - FIRST_SOUND) % len(NAMES)]
    seed = job.seed if mistake != SOUND else FIRST_SOUND + (job.seed - FIRST_SOUND) // len(NAMES)
    return Outcome(mistake, sample, seed, verdict(mistake, sample, seed))


def verdict(mistake: str, sample: str, seed: int) -> str:
    """What the build says."""
    with tempfile.TemporaryDirectory() as made:
        campaign = drawn(sample, seed, Path(made))
        files = MISTAKES[mistake](campaign, np.random.default_rng(seed)) if mistake != SOUND else []
        if not files and mistake != SOUND:
            return "-"
        result = harness.built(campaign.write())
    if isinstance(result, str):
        return "named" if any(name in result for name in files) else f"another file: {result}"
    suspected = [doubt.file for doubt in result.fit.doubts] + [row.file for row in result.fit.outliers]
    if any(name in files for name in suspected):
        return "doubted"
    return "another file: " + ", ".join(suspected) if suspected else "silent"


def page(_: Any, found: Mapping[str, list[Outcome]]) -> Iterator[str]:
    outcomes = [outcome for rows in found.values() for outcome in rows]

    def cell(mistake: str, sample: str) -> str:
        of = [o.verdict.split(":")[0] for o in outcomes if (o.mistake, o.sample) == (mistake, sample)]
        return ", ".join("-" if word == "-" else f"{n} {word}" for word, n in Counter(of).items())

    rows = [(mistake, *(cell(mistake, sample) for sample in NAMES)) for mistake in MISTAKES]
    yield from harness.table(("mistake", *NAMES), rows)
    clean = [o for o in outcomes if o.mistake == SOUND]
    alarms = [o.line() for o in clean if o.verdict != "silent"]
    yield f"\nSound campaigns: {len(alarms)} alarms in {len(clean)} builds"
    yield from alarms


def seeds(_: Any, given: Any) -> list[int]:
    sound = range(FIRST_SOUND, FIRST_SOUND + len(NAMES) * given.sound)
    return [*range(given.first, given.first + given.draws), *sound]


if __name__ == "__main__":
    harness.study(one, page, draws=200, seeds=seeds, in_turn=True, sound=20)
