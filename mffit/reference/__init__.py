"""Pages of the documentation that are written from records: ``python -m mffit.reference docs``."""

import importlib
import pkgutil
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

import mffit
import tir
from mffit.effects import CATALOG, NEEDS
from mffit.rig_errors import AFTER, BEFORE, BY_NAME, RIG_ERRORS
from mffit.suspicion.rule import Outcome, When
from mffit.suspicion.rules import RULES
from mffit.templates import environment
from tir.constant import Count, Real, Series

WRITTEN = ("effects.md", "rig-errors.md", "suspicion.md")
"""Generated pages in ``docs``; the build of the site adds the tables of ``constants.md``."""


def page(name: str) -> str:
    """The text of a page in Markdown, or the tables of ``constants.md``."""
    found = environment("mffit.reference", autoescape=False, keep_trailing_newline=True)
    found.filters["short"] = "{:g}".format
    return found.get_template(f"{name}.j2").render(
        effects=CATALOG,
        needs=NEEDS,
        rig_errors=BY_NAME,
        by_place=groupby((*BEFORE, *AFTER), key=lambda error: error.place),
        without_place=[error for error in RIG_ERRORS if error.place is None],
        rules=RULES,
        occasions=When,
        outcomes=Outcome,
        constants=dict(_constants()),
    )


def _constants() -> Iterator[tuple[str, dict[str, Real | Count | Series]]]:
    """By folder the numbers of judgement of its module ``constants``."""
    for package in (mffit, tir):
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            folder, _, name = found.name.rpartition(".")
            if name == "constants":
                module = importlib.import_module(found.name)
                yield folder, {n: x for n, x in vars(module).items() if isinstance(x, Real | Count | Series)}


def pages() -> dict[str, str]:
    """Text of every generated page in ``docs`` by its name."""
    return {name: page(name) for name in WRITTEN}


def write(folder: Path) -> None:
    """Write these pages."""
    for name, text in pages().items():
        (folder / name).write_text(text, encoding="utf-8")
