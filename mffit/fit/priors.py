"""What is known of a coefficient before its own tyre is measured."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, NamedTuple

from mffit.errors import InputError
from mffit.fit.stages import SMALL_ON_A_DISC
from tir.parameters import BY_NAME

RELATIVE = 0.3
"""How far coefficients of similar tyres scatter around each other, relative, 1 sigma."""
SIMILAR, ANY = 0.05, 0.1
"""Share of the width between a coefficient's bounds by which it scatters at least: around the value of another tyre, and
around the table's default."""

SAME = 0.01
"""Relative difference of nominal load or pressure up to which coefficients of two tyres mean the same."""


class Prior(NamedTuple):
    """What is known of one coefficient beforehand."""

    expected: float
    spread: float  #: 1 sigma


def scatter(name: str, expected: float, *, from_base: bool, curved: bool) -> float:
    """How far the coefficient of this tyre may be from the expected value, 1 sigma.

    Parameters
    ----------
    name : coefficient
    expected : value of the base file, else the default
    from_base : whether a base file states it; 0 in a base file states nothing
    curved : whether the path is curved
    """
    if curved and name in SMALL_ON_A_DISC:
        return SMALL_ON_A_DISC[name]
    share = SIMILAR if from_base and expected else ANY
    return max(RELATIVE * abs(expected), share * BY_NAME[name].width)


def scatters(names: Mapping[str, float], origin: Mapping[str, str], *, curved: bool) -> dict[str, float]:
    """The same of every named coefficient with its expected value."""
    return {n: scatter(n, value, from_base=origin[n] == "base", curved=curved) for n, value in names.items()}


def fleet_content(nominal: Mapping[str, float], tyres: int, priors: Mapping[str, Prior]) -> dict[str, Any]:
    """The file with which a fleet of tyres serves later builds; ``nominal`` has FNOMIN [N] and NOMPRES [Pa]."""
    return {
        "about": "What tyres like these have in common, for later builds: name this file as [tyre] priors in tyre.toml.",
        "tyres": tyres,
        "nominal": dict(nominal),
        "coefficients": {name: prior._asdict() for name, prior in priors.items()},
    }


def of_fleet(config: Any) -> dict[str, Prior]:
    """What the fleet that ``[tyre] priors`` names knows of each coefficient; empty if none is named.

    Raises
    ------
    InputError
        The file is not one of a fleet, or the fleet has another nominal load or pressure.
    """
    path = config.priors_path
    if path is None:
        return {}
    place = {"file": config.path, "line": config.line_of("tyre.priors"), "key": "tyre.priors"}
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        nominal = {name: float(value) for name, value in content["nominal"].items()}
        found = {
            str(name): Prior(float(row["expected"]), float(row["spread"]))
            for name, row in content["coefficients"].items()
        }
    except FileNotFoundError:
        raise InputError(f"there is no file {path}; `mffit fleet` writes one", **place) from None
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        raise InputError(f"{path} is not a priors.json of `mffit fleet`; name one", **place) from None
    own = {"FNOMIN": config.tyre.nominal_load, "NOMPRES": 1e3 * config.tyre.nominal_pressure}
    for name, value in own.items():
        if not abs(nominal.get(name, 0.0) - value) <= SAME * value:
            raise InputError(
                f"{path} is of tyres with {name} {nominal.get(name, 0.0):g}, and this one has {value:g}: coefficients "
                "count from it; name a fleet of the same, or none",
                **place,
            )
    wrong = sorted(n for n, p in found.items() if n not in BY_NAME or not p.spread > 0.0)
    if wrong:
        raise InputError(f"{path} has no use for {wrong[0]}; write it again with `mffit fleet`", **place)
    return found
