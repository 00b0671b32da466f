"""How close does the file for turn slip off come to the limit of the formula? ``python tests/studies/normal_study.py``.

For tyres of known truth (``--tyres FILE.tir ...``, otherwise the samples'). All misfits are rms over the box of conditions of
``normal_outcome``, against the tyre itself with turn slip on and a straight path.
"""

from __future__ import annotations

from pathlib import Path

import harness
from normal_outcome import limit, outcome

import tir


def row(path: Path) -> tuple[str, ...]:
    tyre = tir.read(path)
    o, (Fy, Mz) = outcome(tyre), limit(tyre)
    forces = (f"{Fy:.1f}", f"{o.Fy:.1f}", f"{o.Fy / Fy:.2f}", f"{o.weighted_Fy:.1f}", f"{o.largest_Fy:.0f}")
    moments = (f"{Mz:.2f}", f"{o.Mz:.2f}", f"{o.Mz / Mz:.2f}", f"{o.stiffness:.2f}", f"{o.seconds:.2f}")
    return (f"{path.parent.name}/{path.stem}", *forces, *moments)


if __name__ == "__main__":
    given = harness.arguments(__doc__, tyres=sorted(harness.SAMPLES.glob("*/true.tir"))).parse_args()
    head = (
        "tyre",
        "limit Fy",
        "Fy",
        "ratio",
        "weighted",
        "largest",
        "limit Mz",
        "Mz",
        "ratio",
        "stiffness",
        "s",
    )
    print("\n".join(harness.table(head, map(row, given.tyres))))
