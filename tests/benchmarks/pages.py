"""How fast the page of a project is with many points, as ratios to a bare canvas in the same browser.

    python tests/benchmarks/pages.py [TYRE.TOML] [POINTS ...]

The points of the project (samples/flat-track without one) are repeated with a little noise in every column. Times are of the
page's main thread [ms]: a frame while a slider moves with layout and painting, a step of the pointer, choosing all points. The
bare canvas sets as many squares as there are points, once.
"""

from __future__ import annotations

import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))
import mffit
from mffit.points import Points
from mffit.viewer import project_page
from tests.browser import opened

SAMPLE = Path(__file__).parents[2] / "samples" / "flat-track" / "tyre.toml"
SIZES = (5900, 50_000, 500_000)
NOISE = 1e-3
"""Relative noise of the repeated points, so that their columns compress as badly as those of a rig."""
NOISY = ("alpha", "gamma", "Fz", "p", "V", "T", "t", "Fx", "Fy", "Mx", "My", "Mz", "RL", "omega")
READY = "return !!(window.mffit && mffit.data() && mffit.data().points.line)"
STEPS = 20
BARE = """
const n = arguments[0], canvas = Object.assign(document.createElement('canvas'), {width: 380, height: 250});
const pen = canvas.getContext('2d');
for (let i = 0; i < n; i++) pen.fillRect((i * 7919) % 380, (i * 104729) % 250, 2, 2);
pen.getImageData(0, 0, 1, 1);
"""
EACH_FRAME = """
const done = arguments[0], canvas = document.querySelector('.panel canvas'), box = canvas.getBoundingClientRect(); let k = 0;
const slider = document.querySelector('.coefficient[data-name=PCY1] .slider');
const frame = () => { if (k++ >= %d) return done(); %s; requestAnimationFrame(frame); };
requestAnimationFrame(frame);
"""
DRAG = "slider.value = +slider.min + (slider.max - slider.min) * k / 21; slider.dispatchEvent(new Event('input'))"
HOVER = "canvas.dispatchEvent(new PointerEvent('pointermove', {clientX: box.left + 60 + k * 12, clientY: box.top + 100}))"
CHOOSE = "canvas.dispatchEvent(new KeyboardEvent('keydown', {key: 'a', ctrlKey: true}))"


def many(points: Points, n: int) -> Points:
    """So many points."""
    rng = np.random.default_rng(0)
    found = points.select(np.arange(n) % len(points), with_table=False)
    columns = {name: getattr(found, name) * (1.0 + NOISE * rng.normal(size=n)) for name in NOISY}
    return found.replace(**columns, line=np.arange(n) + 2)


def spent(browser: Any) -> float:
    """Milliseconds that the page's main thread has computed."""
    found = browser.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]
    return 1e3 * next(one["value"] for one in found if one["name"] == "TaskDuration")


def main() -> None:
    given = sys.argv[1:]
    project = Path(given.pop(0)) if given and not given[0].isdigit() else SAMPLE
    result = mffit.build(project)
    print(
        f"{'points':>8}{'MB':>7}{'open s':>8}{'bare':>8}"
        + "".join(f"{x:>9}{'ratio':>7}" for x in ("frame", "hover", "all"))
    )
    for n in [int(x) for x in given] or SIZES:
        with tempfile.TemporaryDirectory() as folder:
            page = project_page(replace(result, points=many(result.points, n))).write(
                Path(folder) / "page.html"
            )
            begin = time.monotonic()
            with opened(page, 1280, 900) as browser:
                browser.set_script_timeout(300)
                while not browser.execute_script(READY):
                    time.sleep(0.05)
                ready = time.monotonic() - begin
                browser.execute_cdp_cmd("Performance.enable", {"timeDomain": "threadTicks"})
                times = []
                for steps, script in ((1, BARE), (STEPS, DRAG), (STEPS, DRAG), (STEPS, HOVER), (1, CHOOSE)):
                    before = spent(browser)
                    if script is BARE:
                        browser.execute_script(script, n)
                    else:
                        browser.execute_async_script(EACH_FRAME % (steps, script))
                    times.append((spent(browser) - before) / steps)
                    time.sleep(1.0)  # what is drawn after a slider rests does not count
            bare, _, *rest = times  # the first drag is that of code not yet compiled
            size = page.stat().st_size / 1e6
        row = "".join(f"{t:>9.1f}{t / bare:>7.2f}" for t in rest)
        print(f"{n:>8}{size:>7.2f}{ready:>8.1f}{bare:>8.1f}{row}", flush=True)


if __name__ == "__main__":
    main()
