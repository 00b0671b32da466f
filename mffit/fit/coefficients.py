"""One record per coefficient: its value, its uncertainty and their origin."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from mffit.as_json import keys
from mffit.constants import COVERAGE_FACTOR_95
from mffit.fit.by_hand import Hand
from mffit.fit.fitted import Fitted
from mffit.fit.known import Known
from mffit.fit.priors import Prior
from mffit.fit.written.files import Files
from mffit.least_squares import touches
from tir import Quantity
from tir.parameters import BY_NAME, TABLE


@dataclass(frozen=True, slots=True)
class Coefficient:
    """One coefficient of the written file and the origin of its value."""

    value: float
    stderr: float | None
    """Standard uncertainty: of the fit, or of the direct measurement if the value comes from it; None if held."""
    stage: str
    fixed: bool
    at_bound: bool
    status: str  #: its origin, as the table of docs/files.md names it
    correlated_with: str = ""  #: the coefficient with the largest correlation, if it is strong
    correlation: float = 0.0
    interval: tuple[float, float] | None = None  #: of 95 %; None if held
    origin: str = ""  #: as the file's comment states it
    by_hand: str = ""  #: its settings in [coefficients], in words; empty if there are none
    held: bool = False  #: held by hand at ``value``
    bounds: tuple[float, float] | None = None  #: set by hand
    prior: Prior | None = None  #: set by hand


keys(
    Coefficient,
    "value stderr stage fixed at_bound interval_95=interval status origin by held bounds prior correlated_with? correlation",
    origin=lambda row: row.origin or row.status,
    by=lambda row: "hand" if row.by_hand else None,
    prior=lambda row: row.prior and {"value": row.prior.expected, "u": row.prior.spread},
    correlation=lambda row: row.correlation if row.correlated_with else None,
)


def coefficient_records(
    known: Known, fitted: Fitted, fitted_after: Mapping[str, Quantity]
) -> dict[str, Coefficient]:
    """The record of every numeric coefficient of the fitted model.

    ``fitted_after`` has the coefficients that were determined after the main fit.
    """
    stderr = {name: u for name, u in known.u.items() if u and known.origin[name] == "measured"}
    stderr |= {name: q.u for name, q in fitted_after.items()}
    stderr |= {name: fitted.stderr[name] for name in fitted.values}
    out, hand = {}, known.hand
    for row in TABLE:
        if row.kind != "number":
            continue
        name, value, u = row.name, float(known.values[row.name]), stderr.get(row.name)
        partner, correlation = fitted.correlation.get(name, ("", 0.0))
        out[name] = Coefficient(
            value=value,
            stderr=u,
            stage=row.stage,
            fixed=u is None,
            at_bound=name in fitted.at_bound,
            status=known.origin[name],
            correlated_with=partner,
            correlation=correlation,
            interval=None if u is None else _within(_interval(value, u), hand, name),
            by_hand=hand.mark(name),
            held=name in hand.held,
            bounds=hand.bounded.get(name),
            prior=hand.priors.get(name),
        )
    return out


def with_u(record: Coefficient, u: float) -> Coefficient:
    """The record with the standard uncertainty that is known after the fit."""
    interval = _interval(record.value, u)
    if record.bounds is not None:
        interval = max(interval[0], record.bounds[0]), min(interval[1], record.bounds[1])
    origin = record.origin.replace(f"+- {record.stderr:.2g}", f"+- {u:.2g}")
    return replace(record, stderr=u, interval=interval, origin=origin)


def _interval(value: float, u: float) -> tuple[float, float]:
    """The 95 % interval of a normal distribution."""
    return value - COVERAGE_FACTOR_95 * u, value + COVERAGE_FACTOR_95 * u


def _within(interval: tuple[float, float], hand: Hand, name: str) -> tuple[float, float]:
    """The interval within the bounds that are set by hand."""
    lower, upper = hand.bounded.get(name, interval)
    return max(interval[0], lower), min(interval[1], upper)


def of_file(files: Files, use: str, coefficients: Mapping[str, Coefficient]) -> dict[str, Coefficient]:
    """The coefficient records of the file for one use; those refitted for this file have no standard error."""
    tyre = files.by_use[use].tyre
    derived = files.changed.get(use, ())
    out = {}
    for name, record in coefficients.items():
        value, origin = float(tyre[name]), tyre.status[name]
        out[name] = replace(record, value=value, origin=origin)
        if name in derived:
            out[name] = Coefficient(
                value=value,
                stderr=None,
                stage=record.stage,
                fixed=False,
                at_bound=touches(value, *(record.bounds or BY_NAME[name].bounds)),
                status="fitted",
                origin=origin,
                by_hand="bounds by hand" if record.bounds else "",
                bounds=record.bounds,
            )
    return out
