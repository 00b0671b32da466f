"""Seconds and memory of a build by number of points: a dense flat-track campaign, simulated with noise.

    python tests/benchmarks/scale.py [POINTS ...]

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
import tomli_w

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


def main() -> None:
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
