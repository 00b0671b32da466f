"""What was tested, as comments of a property file say it: writing and reading."""

import re

from tir import Tyre

NOT_MEASURED = ("default", "estimate")
"""First words of the comments of values that were not measured."""
NO_FX = "Fx is estimated"


def words_on_tested(end: float, unit: str) -> str:
    """The comment on a limit of a range, up to which it was tested."""
    return f"tested to {end:.6g} {unit}"


def end_tested(comment: str) -> float | None:
    """The tested limit in SI; None if the comment has none."""
    found = re.search(r"\btested to (-?[\d.]+(?:e[+-]?\d+)?)", comment)
    return float(found[1]) if found else None


def tested_limit(tyre: Tyre, key: str) -> float:
    """The limit of a range in SI: the tested one if the file states it, else that of the file."""
    found = end_tested(tyre.status.get(key, ""))
    return float(tyre[key]) if found is None else found


def lacks_fx(tyre: Tyre) -> bool:
    """Whether the longitudinal force was not measured: by the comments of the file its stiffness is an estimate."""
    return tyre.status.get("PKX1", "").startswith(NOT_MEASURED)
