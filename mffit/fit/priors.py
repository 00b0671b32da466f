"""Priors of the coefficients: from similar tyres, from the table's defaults, or from a fleet."""

import json
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from mffit.config import Config
from mffit.errors import InputError
from mffit.fit import constants
from mffit.fit.stages import SMALL_ON_A_DISC
from mffit.suspicion.constants import DIFFERENCE_OF_ANOTHER_TYRE
from tir.parameters import BY_NAME

CONVERTED = "converted"
"""Origin of a base file's value that comes from a conversion, and the first word of its comment in that file."""
FROM_BASE = ("base", CONVERTED)
"""Origins of values that the base file states."""


class Prior(NamedTuple):
    """Prior of one coefficient."""

    expected: float
    spread: float  #: 1 sigma


def scatter(name: str, expected: float, *, from_base: bool, curved: bool, unseen_side: bool = False) -> float:
    """Standard deviation of this tyre's coefficient around its expected value.

    A base file's 0 counts as not stated. With ``unseen_side`` the data show one side of an asymmetry only; asymmetries differ
    from tyre to tyre, so the base file does not narrow them.
    """
    if curved and name in SMALL_ON_A_DISC:
        return SMALL_ON_A_DISC[name]
    if unseen_side and (alone := BY_NAME[name].side_spread) is not None:
        return alone
    row, stated = BY_NAME[name], from_base and expected
    share = constants.LEAST_SPREAD_BASE_FILE if stated else constants.LEAST_SPREAD_DEFAULT
    least = share * row.width if stated or row.tyres_spread is None else row.tyres_spread
    return max(constants.SIMILAR_TYRES_SPREAD * abs(expected), least)


def scatters(
    names: Mapping[str, float], origin: Mapping[str, str], *, curved: bool, unseen: Collection[str] = ()
) -> dict[str, float]:
    """Standard deviation of every named coefficient around its expected value; ``unseen`` as in :func:`scatter`."""
    return {
        n: scatter(n, value, from_base=origin[n] in FROM_BASE, curved=curved, unseen_side=n in unseen)
        for n, value in names.items()
    }


def fleet_content(nominal: Mapping[str, float], tyres: int, priors: Mapping[str, Prior]) -> dict[str, Any]:
    """Content of the priors file that a fleet writes for later builds; ``nominal`` has FNOMIN [N] and NOMPRES [Pa]."""
    return {
        "about": "What tyres like these have in common, for later builds: name this file as [tyre] priors in tyre.toml.",
        "tyres": tyres,
        "nominal": dict(nominal),
        "coefficients": {name: prior._asdict() for name, prior in priors.items()},
    }


def of_fleet(config: Config) -> dict[str, Prior]:
    """The prior of each coefficient from the file that ``[tyre] priors`` names; empty without that key.

    Raises InputError if the file is missing, was not written by a fleet, or holds at another nominal load or pressure.
    """
    path = config.priors_path
    if path is None:
        return {}

    def refused(sentence: str) -> InputError:
        return InputError(sentence, file=config.path, line=config.line_of("tyre.priors"), key="tyre.priors")

    try:
        nominal, found = _read(path)
    except FileNotFoundError:
        raise refused(f"there is no file {path}; `mffit fleet` writes one") from None
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        raise refused(f"{path} is not a priors.json of `mffit fleet`; name one") from None
    own = {"FNOMIN": config.tyre.nominal_load, "NOMPRES": 1e3 * config.tyre.nominal_pressure}
    for name, value in own.items():
        theirs = nominal.get(name, 0.0)
        if not abs(theirs - value) <= DIFFERENCE_OF_ANOTHER_TYRE * value:
            raise refused(
                f"{path} holds priors of tyres with {name} {theirs:g}, but this tyre has {value:g}, and coefficients are "
                f"relative to it; name the priors of tyres with the same {name}, or none"
            )
    wrong = sorted(n for n, p in found.items() if n not in BY_NAME or not p.spread > 0.0)
    if wrong:
        raise refused(
            f"{path}: {wrong[0]} is not a coefficient with a positive spread; write the file again with `mffit fleet`"
        )
    return found


def _read(path: Path) -> tuple[dict[str, float], dict[str, Prior]]:
    """Nominal load and pressure, and the priors, from a file with :func:`fleet_content`."""
    content = json.loads(path.read_text(encoding="utf-8"))
    nominal = {name: float(value) for name, value in content["nominal"].items()}
    priors = {
        str(name): Prior(float(row["expected"]), float(row["spread"]))
        for name, row in content["coefficients"].items()
    }
    return nominal, priors
