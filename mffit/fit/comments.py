"""Comments of the property file: origin and uncertainty of each value."""

from collections.abc import Mapping

from mffit.fit import constants
from mffit.fit.coefficients import Coefficient
from mffit.fit.known import DECIDED
from mffit.fit.priors import CONVERTED, FROM_BASE
from mffit.fit.written.files import Files
from mffit.tested import words_on_tested
from tir.parameters import TABLE, Parameter

DERIVED = {
    "normal": "fitted to the model without path curvature",
    "both": "fitted to the model with and without turn slip",
}
TIED = "tied to its expected value"
HELD = "held by hand"
FROM_DATA = ("measured", "fitted", "regularised")
"""Origins of values that the data determine."""
WORDS = {
    "base": "from base",
    CONVERTED: "from base, converted",
    "fleet": "as tyres of its fleet have it",
    "default": "default, not measured",
    "estimate": "estimate, not measured",
    "regularised": TIED,
    "range": "estimate, checked plausible",
    "given": "given in tyre.toml",
}


def file_comments(
    files: Files, origin: Mapping[str, str], coefficients: Mapping[str, Coefficient]
) -> dict[str, dict[str, str]]:
    """By use of a file, the comment of every value: origin, standard uncertainty, and meaning if it is not a coefficient."""
    comments = {row.name: _comment(row, origin[row.name], files.tested) for row in TABLE}
    comments |= {name: _data_comment(c) for name, c in coefficients.items() if c.status in FROM_DATA}
    comments |= {
        name: f"{comments[name]}, {c.by_hand}"
        for name, c in coefficients.items()
        if c.by_hand and c.status not in FROM_DATA
    }
    comments |= {name: _held_comment(c) for name, c in coefficients.items() if c.held}
    derived = {
        use: {name: _derived_comment(use, coefficients.get(name)) for name in files.changed.get(use, ())}
        for use in files.by_use
    }
    if files.camber_limit is not None and "normal" in files.by_use:
        for name in ("CAMMIN", "CAMMAX"):
            end = float(files.by_use["normal"].tyre[name])
            derived["normal"][name] = f"given by [normal] camber_max_deg, {words_on_tested(end, 'rad')}"
    return {use: {**comments, **derived[use]} for use in files.by_use}


def _held_comment(coefficient: Coefficient) -> str:
    """The comment of a value held by hand."""
    return f"{WORDS[coefficient.status]}, {HELD}" if coefficient.status in FROM_BASE else HELD


def _derived_comment(use: str, coefficient: Coefficient | None) -> str:
    """The comment of a value that was refitted for the file of this use."""
    bounded = coefficient is not None and coefficient.bounds is not None
    return DERIVED.get(use, "") + (", bounds by hand" if bounded else "")


def _comment(row: Parameter, origin: str, tested: Mapping[str, float]) -> str:
    words = "given by this build" if row.name in DECIDED else WORDS.get(origin, origin)
    if row.name in tested:
        words = f"{words}, {words_on_tested(tested[row.name], row.unit)}"
    elif not row.section.endswith("_COEFFICIENTS"):
        words = f"{words}: {row.description}"
    return whole_words(words)


def _data_comment(coefficient: Coefficient) -> str:
    """The comment of a value that the data determine."""
    text = TIED if coefficient.status == "regularised" else coefficient.status
    if coefficient.stderr is not None and not coefficient.fixed:
        text += f" +- {coefficient.stderr:.2g}"
    text += f", {coefficient.by_hand}" if coefficient.by_hand else ""
    return text + (", at bound" if coefficient.at_bound else "")


def whole_words(text: str, longest: int = constants.COMMENT_LENGTH) -> str:
    """The text, cut between words if it is longer than ``longest``."""
    return text if len(text) <= longest else text[: longest + 1].rsplit(" ", 1)[0].rstrip(",:")
