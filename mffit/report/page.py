"""One HTML file that needs nothing else: templates filled, pictures embedded."""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mffit.measured import wording
from mffit.report import labels, rounding, style

if TYPE_CHECKING:
    from jinja2 import Environment
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture on disk and in the page."""

    name: str  #: file stem
    data: str  #: base64 of the PNG
    width: int  #: pixels


def draw(folder: Path, figures: Mapping[str, Callable[[], Figure]]) -> dict[str, Picture]:
    """Draw every figure into ``folder/plots/<name>.png``.

    Returns
    -------
    dict
        The pictures by name, for :func:`render`.
    """
    plots = folder / "plots"
    plots.mkdir(parents=True, exist_ok=True)
    pictures = {}
    with style.applied():
        for name, make in figures.items():
            figure, path = make(), plots / f"{name}.png"
            style.save(figure, path)
            data = base64.b64encode(path.read_bytes()).decode("ascii")
            pictures[name] = Picture(name, data, round(figure.get_figwidth() * style.DPI))
    return pictures


def render(template: str, path: Path, **content: Any) -> None:
    """Fill a template of ``templates/`` and write it as UTF-8."""
    path.write_text(_environment().get_template(template).render(**content), encoding="utf-8")


@cache
def _environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("mffit.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["note"] = wording.note
    environment.filters["typeset"] = labels.typeset
    for rounded in (rounding.number, rounding.with_u, rounding.stated, rounding.times, rounding.per_cent):
        environment.filters[rounded.__name__] = rounded
    return environment
