"""Sentences about an alignment of the sideslip axis, for page, terminal and JSON."""

from __future__ import annotations

import math

from mffit.measured.alignment import Alignment


def advice(found: Alignment) -> list[str]:
    """What to do with the axis now, and why zeros differ from the report's."""
    correction, u = found.correction_deg, found.u_deg
    step = f"{correction:+.3f} +- {u:.3f} deg of the rig's own scale (k = 1)"
    if found.aligned:
        finer = (
            "its uncertainty"
            if abs(correction) <= u
            else f"what the axis can be turned by, {found.resolution_deg:g} deg"
        )
        out = [f"Aligned, stop: the correction {step} is within {finer}."]
    else:
        out = [f"Turn the sideslip axis by {step}, then measure both directions again."]
    if any(row.source == "guess" for row in found.last):
        out.append(
            "C_alpha is guessed from the load, which makes the correction uncertain; a sideslip sweep in tyre.toml, or a second "
            "iteration, gives it."
        )
    rows = [row for row in found.last if row.reported is not None]
    if rows:
        said = "; ".join(
            f"at {row.load:.0f} N "
            + " and ".join(
                f"{there:.1f} N {way} where it is {here:.1f} N here"
                for way, there, here in zip(
                    ("forwards", "backwards"),
                    row.reported or (),
                    (row.F_forward, row.F_backward),
                    strict=True,
                )
                if math.isfinite(there)
            )
            for row in rows
        )
        out.append(
            "The zeros above are plain means of the readings at zero, as the rig shows them. The report takes the play of the "
            f"axis off and, where five angles were run near zero, reads zero from a parabola through them: {said}."
        )
    return out
