"""How fast a tyre is evaluated, as ratios to the equations run by numpy. Nothing else in the tests is timed.

    python tests/benchmarks/speed.py

Times are of the processor (all threads together), best of several runs, in microseconds per condition. The exported C is
left out without a compiler, the compiled rows without llvmlite. Run it on an idle machine: neighbours on the same core nearly
double every number, but hardly change the ratios.
"""

from __future__ import annotations

import ctypes
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

import tir
from tir import kernels
from tir.codegen.cpython import kernel
from tir.codegen.program import INPUTS, Switches
from tir.evaluate import evaluate

ROOT = Path(__file__).parents[2]
SIZES = (1, 100, 10_000, 1_000_000)


def seconds(run: Callable[[], object], clock: Callable[[], float] = time.process_time) -> float:
    """Of one run: the best of several series; what the first one prepares does not count."""
    run()
    start = clock()
    run()
    once = max(clock() - start, 1e-7)
    repeats = max(1, math.ceil(0.02 / once))
    series = []
    for _ in range(7):
        start = clock()
        for _ in range(repeats):
            run()
        series.append((clock() - start) / repeats)
    return min(series)


def conditions(tyre: tir.Tyre, n: int) -> list[np.ndarray]:
    rng = np.random.default_rng(0)
    return [
        tyre["FNOMIN"] * rng.uniform(0.2, 2.0, n),
        rng.uniform(-0.2, 0.2, n),
        rng.uniform(-0.3, 0.3, n),
        rng.uniform(-0.1, 0.1, n),
        rng.uniform(-0.3, 0.3, n),
        rng.uniform(5.0, 40.0, n),
        tyre["NOMPRES"] * rng.uniform(0.8, 1.2, n),
    ]


def call(tyre: tir.Tyre, x: list, turn_slip: bool) -> Callable[[], object]:
    Fz, alpha, gamma, kappa, phi_t, Vx, p = x if len(x[0]) > 1 else [float(v[0]) for v in x]
    return lambda: tyre(Fz, alpha, gamma, kappa, phi_t, Vx, p, turn_slip=turn_slip)


def row(name: str, times: list[float]) -> None:
    print(f"{name:<44}" + "".join(f"{t * 1e6:12.3f}" if t == t else f"{'-':>12}" for t in times))


def of_exported_c(tyre: tir.Tyre, turn_slip: bool) -> list[float]:
    """The loop over conditions is C too."""
    with tempfile.TemporaryDirectory() as folder:
        code = tir.export_c(tyre, name="t", turn_slip=turn_slip)
        (Path(folder) / "t.h").write_text(code.header)
        (Path(folder) / "t.c").write_text(code.source)
        arguments = ", ".join(f"x[{i} * n + i_]" for i in range(len(INPUTS)))
        (Path(folder) / "loop.c").write_text(
            '#include "t.h"\nvoid loop(long n, const double *x, t_forces *out)\n'
            f"{{ for (long i_ = 0; i_ < n; ++i_) out[i_] = t_evaluate({arguments}); }}\n"
        )
        library = Path(folder) / "t.so"
        subprocess.run(
            ["cc", "-O2", "-march=native", "-std=c99", "-shared", "-fPIC", "t.c", "loop.c", "-lm", "-o", library],
            cwd=folder, check=True,
        )  # fmt: skip
        loop, times = ctypes.CDLL(str(library)).loop, []
        for n in SIZES:
            x, out = np.ascontiguousarray(conditions(tyre, n)), np.empty((n, 6))
            pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (x, out)]
            times.append(
                seconds(lambda n=n, pointers=pointers: loop(ctypes.c_long(n), *pointers)) / n
                if n > 1
                else math.nan
            )
        return times


def main() -> None:
    tyre = tir.read(ROOT / "tests" / "tir" / "vectors" / "MagicFormula62.tir")
    compiled = kernel.obstacle() is None
    found = dict(kernels.WORTH_LOADING)
    kernels.WORTH_LOADING.update(dict.fromkeys(found, 10**12))  # only when asked
    for turn_slip in (False, True):
        print(f"\nturn slip {'on' if turn_slip else 'off'}; us per condition, calls of" .ljust(45)
              + "".join(f"{n:>12}" for n in SIZES))  # fmt: skip
        switches = Switches(turn_slip)._asdict()
        inputs = [conditions(tyre, n) for n in SIZES]
        kernels.meter.cache_clear()
        plain = [
            seconds(partial(evaluate, tyre.p, *(x if len(x[0]) > 1 else [v[0] for v in x]), **switches))
            / len(x[0])
            for x in inputs
        ]
        row("equations in numpy, in one piece", plain)
        numpy_path = [seconds(call(tyre.replace(), x, turn_slip)) / len(x[0]) for x in inputs]
        row("call, not compiled", numpy_path)
        rows = [("call, not compiled", numpy_path)]
        if compiled:
            tir.compile_kernels(turn_slip=turn_slip)
            rows.append(
                ("call, compiled", [seconds(call(tyre.replace(), x, turn_slip)) / len(x[0]) for x in inputs])
            )
            row(*rows[-1])
        if hasattr(tir, "export_c") and shutil.which("cc"):
            rows.append(("exported C, -O2", of_exported_c(tyre, turn_slip)))
            row(*rows[-1])
        print("as ratio to the first row")
        for name, times in rows:
            print(
                f"{name:<44}"
                + "".join(
                    f"{b / a:12.4f}" if b == b else f"{'-':>12}" for a, b in zip(plain, times, strict=True)
                )
            )
    kernels.WORTH_LOADING.update(found)
    found_by_itself(tyre)
    started()


def found_by_itself(tyre: tir.Tyre) -> None:
    """A loop of scalar calls and loops of short arrays by a user who asks for nothing; the cache is filled."""
    if kernel.obstacle() is not None:
        return
    tir.compile_kernels(turn_slip=False)
    x = [float(v[0]) for v in conditions(tyre, 1)]
    kinds = {
        "floats": x,
        "numpy's floats": [np.float64(v) for v in x],
        "integers among them": [int(x[0]), *x[1:5], 10, np.float64(x[6])],
    }
    print(
        "\na loop of 30 000 scalar calls, us per call of its halves, and ratio of the second to that with floats"
    )
    base = math.nan
    for name, given in kinds.items():
        kernels.meter.cache_clear()
        fresh, halves = tyre.replace(), []
        for _ in range(2):
            start = time.process_time()
            for _ in range(15_000):
                fresh(*given)
            halves.append((time.process_time() - start) / 15_000)
        base = halves[1] if name == "floats" else base
        print(f"{name:<44}" + "".join(f"{t * 1e6:12.2f}" for t in halves) + f"{halves[1] / base:12.2f}")
    print("arrays after 300 calls, us per call, and ratio to numpy")
    for n in (100, 1000):
        kernels.meter.cache_clear()
        fresh, arrays = tyre.replace(), conditions(tyre, n)
        kernels.meter("batch", Switches()).left = math.inf
        numpy_path = seconds(lambda fresh=fresh, arrays=arrays: fresh(*arrays, turn_slip=False))
        kernels.meter.cache_clear()
        for _ in range(300):
            fresh(*arrays, turn_slip=False)
        taken = seconds(lambda fresh=fresh, arrays=arrays: fresh(*arrays, turn_slip=False))
        print(f"{n:<44}{taken * 1e6:12.1f}{taken / numpy_path:12.3f}")


def started() -> None:
    """What the first moments cost, in fresh processes and a fresh cache."""
    print("\nseconds of the processor, in a fresh process")
    with tempfile.TemporaryDirectory() as cache:
        for name, code in (
            ("import numpy", "import numpy"),
            ("import numpy, tir", "import tir"),
            ("the same and compile everything", "import tir; tir.compile_kernels()"),
            ("the same, from the cache", "import tir; tir.compile_kernels()"),
        ):
            if "compile" in code and kernel.obstacle() is not None:
                continue
            code = f"import time; t = time.process_time(); {code}; print(time.process_time() - t)"
            found = subprocess.run(
                [sys.executable, "-c", code], env={**os.environ, "XDG_CACHE_HOME": cache}, capture_output=True,
                text=True, check=True,
            )  # fmt: skip
            print(f"{name:<44}{float(found.stdout):12.3f}")


if __name__ == "__main__":
    main()
