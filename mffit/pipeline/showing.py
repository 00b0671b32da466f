"""``mffit show``: property files, or projects with their measured points, as pages without a server."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from types import MappingProxyType

from mffit import viewer
from mffit.errors import InputError
from mffit.pipeline.building import build
from mffit.progress import Progress, silent
from mffit.report.verdict import judgement, verdict
from mffit.viewer import Page
from mffit.viewer.named import Given
from tir import Tyre


def show(
    tyres: Given | Mapping[str, Given] | Iterable[Given],
    out: str | Path | None = None,
    *,
    given: Mapping[str, float] = MappingProxyType({}),
    progress: Progress = silent,
) -> Page:
    """A page with the curves of property files, or with the points, curves and coefficients of a project.

    The page evaluates the tyres by itself, with code generated from the equations. It needs no network and no server.

    Parameters
    ----------
    tyres : a path or :class:`tir.Tyre`, several of them, or a mapping from names to them; or the path of one ``tyre.toml``,
        which is built, and nothing but the page is written
    out : file to write; nothing is written if None
    given : values [SI] of keys that a property file lacks, such as UNLOADED_RADIUS
    progress : called with a sentence before each step of a build

    Returns
    -------
    Page
        ``.html`` is the text, ``.write(path)`` saves it; a notebook shows it.

    Raises
    ------
    InputError, TirError
        On a file that cannot be read or drawn, or if ``out`` is another file.
    """
    if not isinstance(tyres, str | Path | Mapping | Tyre) and isinstance(tyres, Iterable):
        tyres = list(tyres)
    project = _project(tyres)
    if project is None:
        page = viewer.files_page(tyres, given)
    else:
        result = build(project, progress=progress)
        page = viewer.project_page(result, verdict=verdict(result), judgement=judgement(result))
    if out is not None:
        page.write(out)
    return page


def _project(given: object) -> Path | None:
    """The ``tyre.toml`` that is given; None if property files are."""
    among = given if isinstance(given, list) else [given]
    projects = [Path(one) for one in among if isinstance(one, str | Path) and Path(one).suffix == ".toml"]
    if not projects:
        return None
    if len(among) > 1:
        raise InputError(
            "shows one project at a time; give this file alone, or property files only", file=projects[0]
        )
    return projects[0]
