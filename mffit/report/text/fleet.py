"""Many tyres, for the terminal."""

from __future__ import annotations

from mffit.fleet import EPSILON, Fleet
from mffit.quantities import CHANNELS, COMPARED, DIRECT, SIDEWAYS, QuantityName
from mffit.report.text.layout import blocks, paragraphs, table
from mffit.rig_errors import unit_of, words_of
from mffit.rounding import as_good_as, number, stated, with_u


def misfit_channels(found: Fleet) -> dict[str, QuantityName]:
    """The channels whose misfit is shown: Fy, Mz and every other that was fitted of any tyre."""
    fitted = {name for row in found.rows for name in row.specimen.misfit}
    return {name: known for name, known in CHANNELS.items() if name in fitted or name in SIDEWAYS}


def fleet_summary(found: Fleet) -> str:
    """The text that ``mffit fleet`` prints: eps_gamma of every tyre, scatter between tyres, errors of the rig."""
    known = [key for key in EPSILON if any(found.numbers(key))]
    channels = misfit_channels(found)
    misfits = [channel.column(name) for name, channel in channels.items()]
    head = ("tyre", *(EPSILON[key] for key in known), *misfits)
    rows = [
        (
            row.specimen.name,
            *(stated(getattr(row, key)) for key in known),
            *(number(row.specimen.misfit.get(name), digits=3) for name in channels),
        )
        for row in found.rows
    ]
    words = {**{key: f"{DIRECT['epsilon_gamma'].ascii}, {EPSILON[key]}" for key in known}}
    words |= {key: quantity.column(quantity.ascii) for key, quantity in COMPARED.items()}
    scatters = [
        (label, as_good_as(s.mean, s.u), number(s.sd, digits=2), number(s.u, digits=2))
        for key, label in words.items()
        if (s := found.scatter(key)) is not None
    ]
    rigs = [
        (
            f"rig {i}: {words_of(name)}" if len(found.rigs) > 1 else words_of(name),
            with_u(value, u, unit_of(name)),
        )
        for i, rig in enumerate(found.rigs, 1)
        if rig is not None
        for name, (value, u) in rig.rig.items()
    ]
    return blocks(
        [
            table(head, rows),
            table(("number", "mean", "scatter", "uncertainty"), scatters),
            table(("error of the rig", "all tyres together"), rigs) if rigs else "",
            paragraphs(found.notes),
        ]
    )
