"""Six measuring campaigns with known truth, and the score of any property file against it.

    python benchmark.py make DIR
    python benchmark.py score DIR disc FILE.tir

``make`` writes a folder for each campaign: ``tyre.toml`` and the sweeps for a fit, sweeps that are ``held`` back, and the truth.
``score`` prints how far a file is from the true tyre, as share of the largest force: within the tested conditions, and beyond
them (loads from 0.7 to 1.3 times as far, sideslip and slip 1.5 times, camber to the other side); and how far it is from the
readings of the sweeps held back, which contain noise and the errors of the rig. Files of MF 6.1, 6.2, 5.2 and PAC2002 are read.
"""

from __future__ import annotations

import argparse
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import tir
from mffit import config as configuration
from mffit import points, virtual_rig
from mffit.conversion import convert, is_old
from mffit.scatter import rms

HERE = Path(__file__).parent
CAMPAIGNS: Mapping[str, Any] = tomllib.loads((HERE / "campaigns.toml").read_text(encoding="utf-8"))
CONDITIONS = 4000
NAMES = {"Fz_N": "Fz", "alpha_deg": "alpha", "gamma_deg": "gamma", "kappa": "kappa"}
BEYOND = {"alpha_deg": 1.5, "gamma_deg": 1.0, "kappa": 1.5}


def make(out: Path, name: str) -> Path:
    """Run a campaign into ``out/name``; gives its ``tyre.toml``."""
    campaign = CAMPAIGNS[name]
    rig = HERE / campaign["rig"]
    plan = tomllib.loads(rig.read_text(encoding="utf-8"))
    folder = out / name
    folder.mkdir(parents=True, exist_ok=True)
    tyre = tir.read(rig.parent / plan["truth"]["tyre"])
    tyre = tyre.replace(**{key: tyre[key] * times for key, times in campaign["tyre"].items()})
    on_disc = plan["rig"]["type"] == "rotating-disk"
    tyre.replace(USE_MODE=125 if on_disc else 124).write(folder / "true.tir")
    plan["truth"]["tyre"] = str((folder / "true.tir").resolve())
    if "base" in plan["tyre"]:
        plan["tyre"]["base"] = str((rig.parent / plan["tyre"]["base"]).resolve())
    plan |= {"seed": campaign["seed"], "faults": campaign["faults"]}
    plan["noise"] = campaign.get("noise", plan["noise"])
    wanted = campaign.get("only", [sweep["file"] for sweep in plan["sweep"]])
    given = [sweep for sweep in plan["sweep"] if sweep["file"] in wanted]
    virtual_rig.simulate(
        {**plan, "sweep": [s for s in given if s["file"] in campaign["held"]]}, folder / "held"
    )
    virtual_rig.simulate(
        {**plan, "sweep": [s for s in given if s["file"] not in campaign["held"]]}, folder / "given"
    )
    return folder / "given" / "tyre.toml"


def drawn(within: Mapping[str, Any], *, beyond: bool) -> dict[str, np.ndarray]:
    """Conditions (n,) within the ranges or beyond them, in SI and radians."""
    rng = np.random.default_rng(1)
    found = {}
    for key, name in NAMES.items():
        low, high = within.get(key, (0.0, 0.0))
        if beyond:
            low, high = (
                (0.7 * low, 1.3 * high) if key == "Fz_N" else (-BEYOND[key] * high, BEYOND[key] * high)
            )
        found[name] = rng.uniform(low, high, CONDITIONS) * (np.pi / 180.0 if key.endswith("deg") else 1.0)
    return found


def score(out: Path, name: str, file: Path) -> dict[str, float]:
    """Errors of a file by channel: rms over the largest true value [%], and rms from the sweeps held back [N, Nm].

    A file that computes turn slip is scored on the path of the disc, too.
    """
    within = CAMPAIGNS[name]["within"]
    tyre = convert(file).tyre if is_old(file) else tir.read(file)
    true = tir.read(out / name / "true.tir")
    held = points.read(configuration.load(out / name / "held" / "tyre.toml")).points
    channels = ["Fx", "Fy", "Mz"] if "kappa" in within else ["Fy", "Mz"]
    regions = {"tested": (False, 0.0), "beyond": (True, 0.0)}
    if tyre.turn_slip:
        regions["on the disc"] = (False, float(held.phi_t[0]))
    rows = {}
    for region, (beyond, phi_t) in regions.items():
        at = drawn(within, beyond=beyond)
        curved = {"phi_t": phi_t} if phi_t else {}
        read, wanted = tyre(**at, **curved), true(**at, **curved)
        for channel in channels:
            error, force = getattr(read, channel) - getattr(wanted, channel), getattr(wanted, channel)
            rows[f"{channel} {region} [%]"] = 100.0 * rms(error) / float(np.max(np.abs(force)))
    curved = {"phi_t": held.phi_t} if tyre.turn_slip else {}
    read = tyre(held.Fz, held.alpha, held.gamma, held.kappa, p=held.p, **curved)
    for channel in channels:
        unit = "Nm" if channel == "Mz" else "N"
        rows[f"{channel} held back [{unit}]"] = rms(getattr(read, channel) - held.channel(channel))
    return rows


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ways = ask.add_subparsers(dest="way", required=True)
    ways.add_parser("make").add_argument("out", type=Path)
    scored = ways.add_parser("score")
    scored.add_argument("out", type=Path)
    scored.add_argument("campaign", choices=CAMPAIGNS)
    scored.add_argument("files", type=Path, nargs="+")
    given = ask.parse_args()
    if given.way == "make":
        for name in CAMPAIGNS:
            print(make(given.out, name))
    else:
        found = {str(file): score(given.out, given.campaign, file) for file in given.files}
        print(pd.DataFrame(found).round(2).to_string())


if __name__ == "__main__":
    main()
