"""What was tested, as comments of a property file say it: writing and reading."""

import re

from tir import Tyre
from tir.parameters import TABLE

NOT_MEASURED = ("default", "estimate")
"""First words of the comments of values that were not measured."""
NO_FX = "Fx is estimated"
OF_OUTPUT = {
    **dict.fromkeys(("Fx", "K_xk"), ("PKX1",)),
    **{name: tuple(row.name for row in TABLE if row.channel == name) for name in ("Mx", "My")},
    "sigma_y": ("LATERAL_STIFFNESS",),
    "Re": ("BREFF", "DREFF", "FREFF"),
}
"""By output of the model that a test may leave out, the coefficients of which it measures at least one."""


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


def estimated(tyre: Tyre) -> list[str]:
    """The outputs that were not measured: by the comments of the file, all their coefficients are estimates or defaults."""
    return [
        output
        for output, names in OF_OUTPUT.items()
        if all(tyre.status.get(name, "").startswith(NOT_MEASURED) for name in names)
    ]


def lacks_fx(tyre: Tyre) -> bool:
    """Whether the longitudinal force was not measured."""
    return "Fx" in estimated(tyre)
