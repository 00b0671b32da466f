"""Table rows about every stretch of a recording, and sentences about left-out samples and stretches."""

from collections.abc import Sequence

import numpy as np

from mffit.constants import NAMED_IN_SENTENCE
from mffit.points.faulty import Fault
from mffit.points.stretch import PLATEAU, SWEEP, Stretch, StretchNote
from mffit.scatter import finite_median
from mffit.sweeps import Sweep

COLUMN_OF = {"alpha": "alpha_deg", "gamma": "gamma_deg", "kappa": "kappa", "Fz": "Fz_N"}
"""Column of each setting that a sweep moves."""


def faulty(sweep: Sweep, wrong: Sequence[Fault]) -> tuple[str, ...]:
    """Sentences about faulty samples or finished points, each with its first line."""
    out = []
    for fault in wrong:
        first, number = int(np.argmax(fault.which)), int(np.sum(fault.which))
        more = f" and {number - 1} more" if number > 1 else ""
        out.append(f"{sweep.file}:{int(sweep.line[first])}: {fault.reason} here{more}; left out")
    return tuple(out)


def dropped(sweep: Sweep, tried: Sequence[Stretch]) -> tuple[str, ...]:
    """Sentences about plateaus and sweeps that are left out."""
    out = []
    for kind, what in ((PLATEAU, "steady stretches"), (SWEEP, "sweeps")):
        of_kind = [stretch for stretch in tried if stretch.kind == kind]
        lost = [f"at {sweep.time[s.begin]:.1f} s {s.dropped}" for s in of_kind if s.dropped]
        if lost:
            more = f" and {len(lost) - NAMED_IN_SENTENCE} more" if len(lost) > NAMED_IN_SENTENCE else ""
            named = "; ".join(lost[:NAMED_IN_SENTENCE])
            out.append(f"{sweep.file}: {len(lost)} of {len(of_kind)} {what} are left out: {named}{more}")
    return tuple(out)


def note(sweep: Sweep, stretch: Stretch, label: str, points: int) -> StretchNote:
    """The row about a stretch."""
    part = slice(stretch.begin, stretch.end)
    last = stretch.end - 1
    seen = np.degrees(sweep.alpha[part][np.isfinite(sweep.alpha[part])])
    low, high = (float(seen.min()), float(seen.max())) if len(seen) else (np.nan, np.nan)
    has_slip = "kappa" in sweep.table
    return StretchNote(
        file=sweep.file,
        sweep=label,
        kind=stretch.kind,
        swept=COLUMN_OF.get(stretch.swept, ""),
        begin_s=float(sweep.time[stretch.begin]),
        end_s=float(sweep.time[last]),
        first_line=int(sweep.line[stretch.begin]),
        last_line=int(sweep.line[last]),
        alpha_from_deg=low,
        alpha_to_deg=high,
        kappa_from=float(np.min(sweep.kappa[part])) if has_slip else np.nan,
        kappa_to=float(np.max(sweep.kappa[part])) if has_slip else np.nan,
        gamma_deg=float(np.degrees(finite_median(sweep.gamma[part]))),
        Fz_N=finite_median(sweep.Fz[part]),
        p_kPa=1e-3 * finite_median(sweep.p[part]),
        T_degC=finite_median(sweep.T[part]),
        points=points,
        dropped=stretch.dropped,
    )
