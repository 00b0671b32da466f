"""How a build treats broken data: `python tests/studies/broken_study.py --help`; prints the table of docs/broken-data.md.

The campaigns of the samples on drawn rigs, each with one mistake in a random file. "named": the build refuses a file with the
mistake by name. "doubted": it warns about that sweep, or lists the reading as an outlier. The other draws are sound; their
false alarms are counted.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import tomllib
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import tomli_w

import mffit
from mffit import virtual_rig
from mffit.errors import InputError

SAMPLES = Path(__file__).parents[2] / "samples"
NAMES = ("flat-track", "front-120-70", "rear-190-55")


@dataclass
class Campaign:
    """A simulated campaign whose files can be changed before it is built."""

    folder: Path
    config: dict[str, Any]
    tables: dict[str, pd.DataFrame]

    def varied(self, column: str) -> list[str]:
        """Files that sweep an angle."""
        return [name for name, table in self.tables.items() if table[column].nunique() > 5]

    def write(self) -> Path:
        for name, table in self.tables.items():
            table.to_csv(self.folder / name, index=False)
        path = self.folder / "tyre.toml"
        path.write_text(tomli_w.dumps(self.config), encoding="utf-8")
        return path


Spoil = Callable[[Campaign, np.random.Generator], list[str]]
"""Puts a mistake into a campaign; returns the files with the mistake, none if the campaign has no suitable file."""


def scaled(column: str, factor: float, swept: str = "") -> Spoil:
    """A mistake that multiplies a column of one file."""

    def spoil(campaign: Campaign, rng: np.random.Generator) -> list[str]:
        names = campaign.varied(swept) if swept else list(campaign.tables)
        if not names:
            return []
        name = str(rng.choice(names))
        campaign.tables[name][column] *= factor
        return [name]

    return spoil


def everywhere(column: str, factor: float) -> Spoil:
    """A mistake that multiplies a column of every file."""

    def spoil(campaign: Campaign, rng: np.random.Generator) -> list[str]:
        for table in campaign.tables.values():
            table[column] *= factor
        return list(campaign.tables)

    return spoil


def reading(column: str, value: float) -> Spoil:
    """A mistake that replaces one reading."""

    def spoil(campaign: Campaign, rng: np.random.Generator) -> list[str]:
        name = str(rng.choice(list(campaign.tables)))
        table = campaign.tables[name]
        table.loc[rng.integers(len(table)), column] = value
        return [name]

    return spoil


def off(column: str, amount: float) -> Spoil:
    """A mistake that adds an offset to a column of one file."""

    def spoil(campaign: Campaign, rng: np.random.Generator) -> list[str]:
        name = str(rng.choice(list(campaign.tables)))
        campaign.tables[name][column] += amount
        return [name]

    return spoil


def swapped(campaign: Campaign, rng: np.random.Generator) -> list[str]:
    """Headings of sideslip and camber exchanged in one file."""
    name = str(rng.choice([*campaign.varied("alpha_deg"), *campaign.varied("gamma_deg")]))
    names = {"alpha_deg": "gamma_deg", "gamma_deg": "alpha_deg"}
    campaign.tables[name] = campaign.tables[name].rename(columns=names)
    return [name]


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


def sound(campaign: Campaign, rng: np.random.Generator) -> list[str]:
    """No mistake."""
    return []


MISTAKES: dict[str, Spoil] = {
    "sign of sideslip reversed in one file": scaled("alpha_deg", -1.0, "alpha_deg"),
    "sign of camber reversed in one file": scaled("gamma_deg", -1.0, "gamma_deg"),
    "sign of side force reversed in one file": scaled("Fy_N", -1.0),
    "sign of moment reversed in one file": scaled("Mz_Nm", -1.0),
    "headings of sideslip and camber exchanged": swapped,
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


def drawn(sample: str, seed: int, folder: Path) -> Campaign:
    """A sample's campaign on a drawn rig; recorded sweeps as finished points."""
    content = tomllib.loads((SAMPLES / sample / "rig.toml").read_text(encoding="utf-8"))
    content["faults"] = {"draw": True}
    for entry in content["sweep"]:
        entry.pop("recording", None)
    plan = virtual_rig.load_plan(content, folder=SAMPLES / sample)
    virtual_rig.simulate(plan, folder, seed=seed)
    config = tomllib.loads((folder / "tyre.toml").read_text(encoding="utf-8"))
    return Campaign(
        folder, config, {entry["file"]: pd.read_csv(folder / entry["file"]) for entry in config["sweep"]}
    )


def outcome(sample: str, spoil: Spoil, seed: int) -> str:
    """The verdict of a build: named, doubted, another file or silent; "-" if the campaign has no suitable file."""
    with tempfile.TemporaryDirectory() as made:
        campaign = drawn(sample, seed, Path(made))
        files = spoil(campaign, np.random.default_rng(seed))
        if not files and spoil is not sound:
            return "-"
        path = campaign.write()
        try:
            result = mffit.build(path)
        except InputError as error:
            message = str(error)
            return "named" if any(name in message for name in files) else f"another file: {message}"
        suspected = [doubt.file for doubt in result.fit.doubts] + [row.file for row in result.fit.outliers]
        if any(name in files for name in suspected):
            return "doubted"
        return "another file: " + ", ".join(suspected) if suspected else "silent"


def draws(count: int) -> Iterator[tuple[str, str, int]]:
    """Mistake, sample and seed of every draw."""
    cases = [(mistake, sample) for mistake in MISTAKES for sample in NAMES]
    for k in range(count):
        yield *cases[k % len(cases)], k


def main(count: int, clean: int) -> None:
    """Print the table, and the draws whose mistake was not found."""
    table: dict[tuple[str, str], Counter[str]] = {}
    for mistake, sample, seed in draws(count):
        verdict = outcome(sample, MISTAKES[mistake], seed)
        table.setdefault((mistake, sample), Counter())[verdict.split(":")[0]] += 1
        if verdict not in ("named", "doubted", "-"):
            print(f"{mistake}, {sample}, seed {seed}: {verdict}", file=sys.stderr, flush=True)
    print(f"| mistake | {' | '.join(NAMES)} |")
    print("|---|" + "---|" * len(NAMES))
    for mistake in MISTAKES:
        cells = [table.get((mistake, sample), Counter()) for sample in NAMES]
        texts = [
            ", ".join(f"{n} {word}" if word != "-" else "-" for word, n in cell.items()) for cell in cells
        ]
        print(f"| {mistake} | {' | '.join(texts)} |")
    alarms = [(s, k) for k in range(clean) for s in NAMES if outcome(s, sound, 10_000 + k) != "silent"]
    print(f"\nSound campaigns: {len(alarms)} alarms in {clean * len(NAMES)} builds {alarms or ''}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=200, help="campaigns with a mistake")
    parser.add_argument("--sound", type=int, default=20, help="sound rigs of each sample")
    options = parser.parse_args()
    main(options.draws, options.sound)
