"""Which files does a killed build leave? `python tests/studies/kill_study.py 50`.

A small tyre is built, then built again with a change and killed with SIGKILL at a random moment, repeatedly. After every kill
the output must be the complete earlier one or the complete later one, and the next complete run must leave no temporary
folder.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit"))

from small_rigs import LOADS, disc, simulated

from mffit.output import RECORD, digest

ROOT = Path(__file__).parents[2]


def command(folder: Path) -> list[str]:
    return [sys.executable, "-m", "mffit.cli", "build", str(folder / "tyre.toml"), "--quiet"]


def started(folder: Path) -> subprocess.Popen:
    return subprocess.Popen(
        command(folder), env=os.environ | {"PYTHONPATH": str(ROOT)}, stderr=subprocess.DEVNULL
    )


def state(out: Path) -> str:
    """The tyre size that a complete output states; otherwise what is wrong with it."""
    record = json.loads((out / RECORD).read_text(encoding="utf-8"))["files"]
    wrong = [
        n for n, entry in record.items() if not (out / n).is_file() or digest(out / n) != entry.split(":")[1]
    ]
    if wrong:
        return f"incomplete: {wrong[0]} and {len(wrong) - 1} more"
    return json.loads((out / "result.json").read_text(encoding="utf-8"))["tyre"]["size"]


def litter(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir() if path.name.startswith(".out-")]


def main() -> None:
    ask = argparse.ArgumentParser()
    ask.add_argument("kills", type=int, nargs="?", default=50)
    ask.add_argument(
        "--writing", action="store_true", help="kill within a second of the first file being written"
    )
    given = ask.parse_args()
    rng = random.Random(1)
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made) / "tyre"
        simulated(disc(LOADS[:2], rolling_radius=[{"load_N": 1400}]), folder)
        text = (folder / "tyre.toml").read_text(encoding="utf-8")

        def sized(size: str) -> None:
            changed = text.replace("[tyre]\n", f'[tyre]\nsize = "{size}"\n')
            (folder / "tyre.toml").write_text(changed, encoding="utf-8")

        sized("run 0")
        began = time.perf_counter()
        started(folder).wait()
        length = time.perf_counter() - began
        print(f"an undisturbed build takes {length:.1f} s")
        found: Counter[str] = Counter()
        left: Counter[int] = Counter()
        known = "run 0"
        for k in range(1, given.kills + 1):
            sized(f"run {k}")
            process = started(folder)
            if given.writing:
                while not litter(folder) and process.poll() is None:
                    time.sleep(0.01)
                time.sleep(rng.uniform(0.0, 1.0))
            else:
                time.sleep(length * rng.uniform(0.0, 1.1))
            ended = process.poll() is not None
            process.send_signal(signal.SIGKILL)
            process.wait()
            now = state(folder / "out")
            word = {known: "the earlier one, complete", f"run {k}": "the later one, complete"}.get(now, now)
            found[word + (" (ended before the kill)" if ended else "")] += 1
            left[len(litter(folder))] += 1
            known = now if now.startswith("run") else known
        sized("last")
        started(folder).wait()
        print(f"{given.kills} kills; the output then was:")
        for word, count in found.most_common():
            print(f"  {count:3d}  {word}")
        print(
            "temporary folders after a kill: "
            + ", ".join(f"{n} ({count} times)" for n, count in sorted(left.items()))
        )
        print(
            f"after a last undisturbed build: {state(folder / 'out')}, temporary folders: {len(litter(folder))}"
        )


if __name__ == "__main__":
    main()
