"""Seconds and memory of a build by number of points: a dense flat-track campaign, simulated with noise.

    python tests/benchmarks/scale.py [POINTS ...]
    python tests/benchmarks/scale.py --rows ROWS

With ``--rows``: of raw recordings with so many rows, until they are points.
Each build runs in a process of its own. Seconds are of the processor, with one thread; memory is the largest resident size.
The plan is that of samples/flat-track, its sweeps of 21 angles replaced by denser ones.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import tomli_w
from scipy.io import savemat

SAMPLE = Path(__file__).parents[2] / "samples" / "flat-track"
SIZES = (5000, 50_000, 485_600)
BUILD = """
import json, resource, sys, time
import mffit
steps = [("importing", time.process_time())]
mffit.build(sys.argv[1], sys.argv[2], progress=lambda said: steps.append((said, time.process_time())))
end, peak = time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps([end, peak, steps]))
"""
READ = """
import json, resource, sys, time
from mffit import config
from mffit.pipeline.inputs import read_points
begin = time.process_time()
points = read_points(config.load(sys.argv[1])).points
end, peak = time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps([end - begin, peak, len(points)]))
"""
PARTS = {
    "reading": ("reading sweeps",),
    "fit": ("measuring the camber reduction factor", "fitting ", "joint polish", "starting again"),
    "sweeps": ("predicting each sweep",),
    "judging": ("deriving", "judging"),
    "writing": ("writing",),
}
"""What the columns of the table contain, by the beginning of the messages of progress."""


def plan(points: int) -> dict:
    """The sample's campaign with so many points."""
    found = tomllib.loads((SAMPLE / "rig.toml").read_text(encoding="utf-8"))
    found["truth"]["tyre"] = str((SAMPLE / found["truth"]["tyre"]).resolve())
    for sweep in found["sweep"]:
        ends = sweep["alpha_deg"]
        sweep["alpha_deg"] = np.linspace(ends["from"], ends["to"], points // len(found["sweep"])).tolist()
    return found


def measured(points: int, folder: Path) -> tuple[float, float, dict[str, float]]:
    """Seconds, memory [GB] and seconds by part of one build."""
    (folder / "rig.toml").write_bytes(tomli_w.dumps(plan(points)).encode())
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    simulate = [sys.executable, "-m", "mffit", "simulate", "rig.toml", "--out", "."]
    subprocess.run(simulate, cwd=folder, env=environment, check=True, capture_output=True)
    run = [sys.executable, "-c", BUILD, "tyre.toml", "out"]
    out = subprocess.run(run, cwd=folder, env=environment, check=True, capture_output=True, text=True)
    end, peak, steps = json.loads(out.stdout.splitlines()[-1])
    parts = dict.fromkeys(PARTS, 0.0)
    for (said, begin), after in zip(steps, [*(at for _, at in steps[1:]), end], strict=True):
        for name, beginnings in PARTS.items():
            parts[name] += (after - begin) * said.startswith(beginnings)
    return end, peak / 1e6, parts


def recordings(rows: int, folder: Path) -> None:
    """The sample's sweeps as recordings with so many rows in all at 1000 Hz, in CSV and in MATLAB's format."""
    found = plan(21 * len(plan(0)["sweep"]))
    seconds = rows / len(found["sweep"]) / 1000.0
    for sweep in found["sweep"]:
        hold = seconds / 21 - 0.5  # a degree takes half a second
        sweep["recording"] = {"rate_Hz": 1000.0, "hold_s": hold, "steering_deg_per_s": 2.0, "noise_Fz_N": 5.0}
    (folder / "rig.toml").write_bytes(tomli_w.dumps(found).encode())
    subprocess.run(
        [sys.executable, "-m", "mffit", "simulate", "rig.toml", "--out", "."], cwd=folder, check=True
    )
    for path in folder.glob("*.csv"):
        table = pd.read_csv(path)
        savemat(path.with_suffix(".mat"), {name: table[name].to_numpy()[:, None] for name in table})
    text = (folder / "tyre.toml").read_text(encoding="utf-8")
    (folder / "matlab.toml").write_text(text.replace(".csv", ".mat"), encoding="utf-8")


def print_reading(rows: int) -> None:
    """A line for each format."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory() as name:
        recordings(rows, Path(name))
        print(f"{'format':>10}{'rows':>10}{'points':>10}{'seconds':>10}{'GB':>7}")
        for kind, project in (("CSV", "tyre.toml"), ("MATLAB", "matlab.toml")):
            run = [sys.executable, "-c", READ, project]
            out = subprocess.run(run, cwd=name, env=environment, check=True, capture_output=True, text=True)
            seconds, peak, points = json.loads(out.stdout.splitlines()[-1])
            print(f"{kind:>10}{rows:>10}{points:>10}{seconds:>10.1f}{peak / 1e6:>7.2f}", flush=True)


def main() -> None:
    if sys.argv[1:2] == ["--rows"]:
        print_reading(int(sys.argv[2]))
        return
    sizes = [int(x) for x in sys.argv[1:]] or SIZES
    print(
        f"{'points':>10}{'seconds':>10}{'us/point':>10}{'GB':>7}" + "".join(f"{name:>10}" for name in PARTS)
    )
    for points in sizes:
        with tempfile.TemporaryDirectory() as folder:
            seconds, memory, parts = measured(points, Path(folder))
        print(
            f"{points:>10}{seconds:>10.1f}{seconds / points * 1e6:>10.0f}{memory:>7.2f}"
            + "".join(f"{x:>10.1f}" for x in parts.values()),
            flush=True,
        )


if __name__ == "__main__":
    main()
