"""Print up to two kinds of processor, as OpenBLAS names them, whose kernels this one runs but does not choose: the second newest
and the oldest. The newest is what all tests run with.

Kernels of linear algebra differ by the vector instructions that they use, and each rounds in its own way. Nothing is printed
where the processor does not say what it has.
"""

from __future__ import annotations

from pathlib import Path

KINDS = {
    "SkylakeX": "avx512vl",
    "Haswell": "fma",
    "Sandybridge": "avx",
    "Nehalem": "sse4_2",
    "Prescott": "pni",
}
"""By kind, the newest first, the instructions that it needs, as Linux names them."""

if __name__ == "__main__":
    told = Path("/proc/cpuinfo")
    lines = told.read_text(encoding="utf-8").splitlines() if told.exists() else []
    has = {word for line in lines if line.startswith("flags") for word in line.split()}
    here = [kind for kind, needed in KINDS.items() if needed in has]
    print(*here[1:2], *here[2:][-1:])
