"""One HTML file that evaluates tyres by itself: parameters as JSON, equations as JavaScript, no network."""

import hashlib
import html
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from types import MappingProxyType

import mffit
from mffit.as_json import Json
from mffit.errors import InputError
from mffit.quantities import MODEL, QuantityName
from mffit.templates import environment
from mffit.viewer.bundle import script
from mffit.viewer.controls import FAN, OUTPUTS, PANELS, in_si, settings
from mffit.viewer.named import Given, described, named
from tir.codegen.javascript import javascript
from tir.codegen.program import INPUTS, Switches, trace
from tir.writing import replace_file

Models = Mapping[str, Mapping[str, str]]
"""Code by use and output, as :func:`code` gives it."""
SEAL = re.compile(r"<!-- written by mffit show, sha256 of the rest ([0-9a-f]{64}) -->\n\Z")


@dataclass(frozen=True, slots=True, repr=False)
class Page:
    """A page with the curves of tyres; a notebook shows it as its result."""

    html: str
    names: tuple[str, ...]  #: of the tyres, as in the page's legend

    def write(self, path: str | Path) -> Path:
        """Write the page; returns its path.

        Raises InputError if the path is another file or a page that was changed since, or if it cannot be written.
        """
        path = Path(path)
        if os.path.lexists(path) and not _is_ours(path):
            raise InputError(
                "exists already and is not a page that mffit show wrote; give another name", file=path
            )
        text = f"{self.html}<!-- written by mffit show, sha256 of the rest {_digest(self.html)} -->\n"
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            replace_file(path, text.encode())
        except OSError as error:
            raise InputError(f"cannot be written ({error.strerror}); give another name", file=path) from None
        return path

    def __repr__(self) -> str:
        return f"<Page of {', '.join(self.names)}: {len(self.html)} characters; .write(path) saves it>"

    def _repr_html_(self) -> str:
        frame = 'style="width:100%;height:900px;border:0" sandbox="allow-scripts allow-downloads"'
        return f'<iframe {frame} srcdoc="{html.escape(self.html)}"></iframe>'


def files_page(
    tyres: Given | Mapping[str, Given] | Iterable[Given],
    given: Mapping[str, float] = MappingProxyType({}),
) -> Page:
    """The page of property files; arguments and errors as those of :func:`mffit.show`."""
    found = named(tyres, given)
    names = sorted({name for on in (False, True) for name in trace(Switches(on), OUTPUTS).parameters})
    data = {
        "order": INPUTS,
        "controls": settings([*found.values()]),
        "panels": [{"key": panel.key, "word": panel.word, **asdict(panel)} for panel in PANELS],
        "quantities": {name: on_page(MODEL[name]) for name in (*INPUTS, *OUTPUTS)},
        "tyres": [described(name, tyre, names) for name, tyre in found.items()],
    }
    fan = ", ".join(f"±{angle:g}" for angle in FAN if angle > 0.0)
    models = code(OUTPUTS, Switches(False)) | code(OUTPUTS, Switches(True))
    title, names = ", ".join(found), [*found]
    filled = rendered("page", data, models, title=title, names=names, quantities=MODEL, fan=fan)
    return Page(filled, tuple(found))


def code(outputs: Iterable[str], switches: Switches) -> dict[str, dict[str, str]]:
    """JavaScript by use ("on" or "off" for turn slip) and output, each with code of its own: a curve pays for no other."""
    on, star = switches.turn_slip, switches.star
    return {"on" if on else "off": {name: javascript((name,), turn_slip=on, star=star) for name in outputs}}


def rendered(
    page: str, content: object, models: Models, *, title: str, module: str = "", **given: object
) -> str:
    """The template ``page`` with the script ``module`` (default: of that name), its content and code of models."""
    template = environment("mffit.viewer").get_template(f"{page}.html.j2")
    return template.render(
        {"window": None, "names": None, **given},
        content=content,
        models=models,
        title=title,
        script=script(module or page),
        version=mffit.__version__,
    )


def recordings_html(folder: str, to: str, here: Mapping[str, object]) -> str:
    """The page of a window with the recordings of a folder, for a new project or, if ``to`` names one, to add to it."""
    return rendered(
        "recordings", None, {}, title=f"{folder}: recordings", name=folder, to=to, here=here, window=True
    )


def on_page(quantity: QuantityName) -> dict[str, Json]:
    """A quantity as pages name and convert it."""
    return {
        "word": quantity.word,
        "symbol": quantity.symbol,
        "unit": quantity.unit_behind,
        "si": in_si(quantity.unit),
    }


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _is_ours(path: Path) -> bool:
    """Whether the file is a page of :meth:`Page.write` without changes."""
    try:
        text = path.read_bytes().decode()
    except (OSError, UnicodeDecodeError):
        return False
    found = SEAL.search(text)
    return found is not None and found[1] == _digest(text[: found.start()])
