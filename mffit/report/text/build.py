"""The summary of a build, for the terminal: one screen, and the rest on request."""

import math
from collections.abc import Iterable, Sequence

from mffit.diagnosis import wording
from mffit.fit import zeros_listed
from mffit.measured import wording as of_direct
from mffit.prediction import road_sentences
from mffit.quantities import CHANNELS, CONDITIONS, DIRECT, KEYS, SIDEWAYS
from mffit.report import constants
from mffit.report.text import filling
from mffit.report.text.direct import estimates, setups_table, spin_numbers
from mffit.report.text.layout import steps, table
from mffit.report.verdict import headlines, over_noise, purposes, verdict
from mffit.results import BuildResult
from mffit.rounding import stated
from tir.errors import counted
from tir.parameters import BY_NAME

FORCES = "_COEFFICIENTS"
"""End of the sections whose coefficients are those of a force or moment."""


def build_summary(result: BuildResult, written: str = "", following: Sequence[tuple[str, str]] = ()) -> str:
    """What ``mffit build`` prints: the verdict, the files and whom they are for, the numbers, and what to do next.

    ``following`` are commands to run next, each with what it does.
    """
    return filling.text(
        "build",
        **_content(result),
        written=written,
        reasons=_verdict_because(result) if result.reasons else (),
        doubts=() if result.reasons else _verdict_because(result),
        numbers=_of_model(result),
        following=steps(following),
    )


def _content(result: BuildResult) -> dict[str, object]:
    """What the summary and the explanation of a build share."""
    counts = {
        "reading left out by hand": sum(row.count for row in result.left_out if row.by == "hand"),
        "reading without weight": len(result.fit.outliers),
        "sweep in doubt": len(result.fit.doubts),
        "limit of what the file can say": len(result.trust.remarks),
    }
    return {
        "build": result,
        "verdict": verdict(result),
        "road": _of_road(result),
        "road_said": _said_of_road(result),
        "purposes": purposes(result),
        "said": [counted(number, what) for what, number in counts.items() if number],
    }


def build_explained(result: BuildResult) -> str:
    """What ``mffit build --explain`` prints: the summary, what each file is and is not, limits, residuals, statuses."""
    nominal = result.measured.nominal
    # The cornering stiffness that a user came for is the tyre's, not the one along the path of the disc.
    hidden = {"C_alpha"} if nominal is not None and nominal.C_alpha_straight is not None else set()
    of_forces = [c for name, c in result.fit.coefficients.items() if BY_NAME[name].section.endswith(FORCES)]
    return filling.text(
        "explained",
        **_content(result),
        written="",
        following="",
        reasons=result.reasons,
        doubts=result.trust.doubts,
        over_noise=lambda channel: over_noise(result, channel),
        zeros=zeros_listed(result.fit.rig),
        numbers=spin_numbers(result.measured, [name for name in KEYS if name not in hidden])
        if result.measured.epsilon_gamma is not None
        else _of_model(result),
        estimates=estimates(result.measured),
        setups=setups_table(result.measured),
        of_spin=of_direct,
        of_residuals=wording,
        coefficients_of_forces=of_forces,
    )


def few(warnings: Iterable[str]) -> list[str]:
    """The first warnings, and how many more there are; none is cut, because its end says what to do."""
    every = list(warnings)
    more = len(every) - constants.MOST_REASONS
    return every[: constants.MOST_REASONS] + ([f"{more} more: --explain shows them"] if more > 0 else [])


def warnings_beside(result: BuildResult) -> list[str]:
    """The warnings to print beside the summary, which has those that its verdict rests on; few, and how many more there are."""
    return few(said for said in result.warnings if not said.endswith(_verdict_because(result)))


def _verdict_because(result: BuildResult) -> tuple[str, ...]:
    """The sentences below the verdict of the summary."""
    return (result.reasons or result.trust.doubts)[: constants.MOST_REASONS]


def _of_road(result: BuildResult) -> str:
    """The table of the road: a line for each side of zero sideslip."""
    road = result.road
    if road is None:
        return ""
    names = [
        name for name in ("Fy", "Mz", "mu_y", "M_zmax") if getattr(road.sides["positive"], name) is not None
    ]
    units = CHANNELS | DIRECT
    head = [f"road, {CONDITIONS['Fz_N'].of(road.load)}"]
    head += [f"{units[name].ascii}{' there' if name in SIDEWAYS else ''}" for name in names]
    rows = [
        [
            f"{sign * math.degrees(road.sideslip):+.3g} deg of sideslip",
            *(stated(getattr(road.sides[side], name), units[name].unit_behind) for name in names),
        ]
        for side, sign in (("negative", -1.0), ("positive", 1.0))
    ]
    return table(head, rows)


def _said_of_road(result: BuildResult) -> list[str]:
    """The sentences on the road."""
    return [] if result.road is None else road_sentences(result.road, result.files.get("normal", ""))


def _of_model(result: BuildResult) -> str:
    """The numbers that a user came for, a line each."""
    found = headlines(result)
    width = max((len(one.name) for one in found), default=0)
    return "\n".join(f"{one.name:<{width}}  {one.value} {one.where}".rstrip() for one in found)
