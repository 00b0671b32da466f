"""Many builds and many tyres, for the terminal."""

from collections.abc import Sequence

from mffit.fleet import Fleet
from mffit.quantities import CHANNELS, DIRECT, SIDEWAYS, QuantityName
from mffit.report.text import filling
from mffit.report.text.layout import blocks, table
from mffit.results import BuildOutcome
from mffit.rounding import ascii_only, number, stated


def misfit_channels(found: Fleet) -> dict[str, QuantityName]:
    """The channels whose misfit is shown: Fy, Mz and every other that was fitted of any tyre."""
    fitted = {name for row in found.rows for name in row.specimen.misfit}
    return {name: known for name, known in CHANNELS.items() if name in fitted or name in SIDEWAYS}


def fleet_summary(found: Fleet) -> str:
    """The text that ``mffit fleet`` prints: eps_gamma of every tyre, scatter between tyres, errors of the rig."""
    return filling.text("fleet", fleet=found, misfits=misfit_channels(found))


def many_line(outcome: BuildOutcome, number_of: int, total: int) -> str:
    """The line that reports one finished build."""
    words = {
        "built": f"built in {outcome.seconds:.0f} s",
        "unchanged": "unchanged since the last build, not built again",
        "refused": "refused",
        "failed": "failed",
    }[outcome.state]
    return f"[{number_of}/{total}] {outcome.name}: {words}"


def many_summary(outcomes: Sequence[BuildOutcome]) -> str:
    """Per tyre eps_gamma, misfit, warnings and file; for the others the reason why there is no file."""
    whole = [o for o in outcomes if o.whole]
    channels = [name for name in CHANNELS if name in SIDEWAYS or any(name in o.misfit for o in whole)]
    head = (
        "tyre",
        DIRECT["epsilon_gamma"].ascii,
        *(CHANNELS[name].column(f"{name} rms") for name in channels),
        "warnings",
        "trusted",
    )
    rows = [
        (
            o.name,
            stated(o.epsilon_gamma),
            *(number(o.misfit.get(name), digits=3) for name in channels),
            str(o.warnings),
            "yes" if o.trusted else "NO",
        )
        for o in whole
    ]
    ends = ["file", "", *(f"{o.out}/{o.file}" + " (unchanged)" * (o.state == "unchanged") for o in whole)]
    lines = [
        f"{line}  {end}".rstrip() for line, end in zip(table(head, rows).splitlines(), ends, strict=True)
    ]
    rest = [lacking(o) for o in outcomes if not o.whole]
    return blocks(["\n".join(lines) if whole else "", ascii_only("\n".join(rest))])


def lacking(outcome: BuildOutcome) -> str:
    """The sentence why a tyre has no output, with the tyre's name."""
    known = outcome.sentence.startswith(outcome.name)
    return outcome.sentence if known else f"{outcome.name}: {outcome.sentence}"
