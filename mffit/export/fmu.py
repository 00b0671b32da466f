"""A property file as a functional mock-up unit of FMI 2.0 or 3.0: description, C sources, binary for this machine."""

import hashlib
import tempfile
import uuid
import zipfile
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any, Unpack

import mffit
import tir
from mffit.errors import InputError
from mffit.export import compiler, variables
from mffit.export.code import CodeOfFile, code_of
from mffit.output import output_folder
from mffit.templates import environment
from tir.codegen.c99 import taken
from tir.mode import SwitchOptions, words

DEFINITIONS: dict[int, tuple[str, ...]] = {2: (), 3: ("FMI3_OVERRIDE_FUNCTION_PREFIX",)}
"""Preprocessor definitions for a shared library, by version of FMI."""
LATE = "in co-simulation the outputs after a step are one communication step behind the inputs"
READABLE = 0o644
EARLIEST = (1980, 1, 1, 0, 0, 0)
"""Date of every file in the archive: the same tyre gives the same bytes."""


def write_fmu(
    path: str | Path,
    out: str | Path,
    *,
    fmi: int = 2,
    name: str | None = None,
    transient: bool = False,
    sources_only: bool = False,
    **switches: Unpack[SwitchOptions],
) -> Path:
    """Write a property file as an FMU for model exchange and co-simulation.

    The model has no states unless ``transient``: outputs are functions of the inputs. Inputs Fz, kappa, alpha, gamma, phi_t, Vx,
    p; outputs Fx, Fy, Fz_out, Mx, My, Mz, K_ya, K_xk, sigma_x, sigma_y, Re, omega, trail. Tunable parameters: the scaling
    factors (LMUY, LKY, ...), and T_degC if the file has temperature terms. SI units, radians, ISO-W.

    Parameters
    ----------
    path : the property file
    out : folder to write ``<name>.fmu`` to
    fmi : 2 or 3, for FMI 2.0 or 3.0
    name, switches : model identifier, turn_slip, star and limits, as in :func:`mffit.export.write_c`
    transient : with the lag of the contact (see :mod:`tir.transient`), for co-simulation: inputs are the slip speeds Vsx and Vsy
        instead of kappa and alpha, and damping; the deflections u and v are states, and outputs with kappa and alpha
    sources_only : without a binary; the program that imports the FMU compiles the sources

    Returns
    -------
    Path
        The FMU.

    Raises
    ------
    InputError
        There is no compiler, the version of FMI is unknown, or as in :func:`mffit.export.write_c`.
    TirError
        The file cannot be read.
    """
    if fmi not in DEFINITIONS:
        raise InputError(f"FMI {fmi} is not available, only {' and '.join(map(str, DEFINITIONS))}")
    path, out = Path(path), Path(out)
    export = partial(tir.export_c, tunable=True, lag=transient)
    known = code_of(path, name, export, taken, **switches)
    name, files = known.name, _texts(known, path.name, fmi, transient=transient)
    if not sources_only:
        files[f"binaries/{compiler.host_folder(fmi)}/{name}{compiler.suffix()}"] = _binary(files, name, fmi)
    with output_folder(out, by="export", protected=[path]) as folder:
        _archive(folder / f"{name}.fmu", files)
    return out / f"{name}.fmu"


def _texts(known: CodeOfFile, file: str, fmi: int, *, transient: bool) -> dict[str, bytes]:
    """The files of the archive by their path in it; ``file`` is the name of the property file."""
    tyre, name, switches, code = known
    interface = variables.Interface.of(tyre, transient=transient)
    model = f"MF 6.2 {'with lag' if transient else 'in steady state'}"
    content = {
        "fmi": fmi,
        "name": name,
        "title": f"{Path(file).stem}, {words(switches)}",
        "version": mffit.__version__,
        "token": "{" + str(uuid.UUID(hashlib.sha256(f"{fmi} {code.source}".encode()).hexdigest()[:32])) + "}",
        "description": f"Tyre {file}: {model}, {words(switches)}; axes ISO-W; {LATE}",
        "transient": transient,
        **interface._asdict(),
        "units": variables.units_of(x for part in interface for x in part),
        "arguments": variables.arguments(interface.inputs),
        "compiled": [f"{name}.c", f"{name}_fmi{fmi}.c"],
    }
    texts = {
        "modelDescription.xml": _filled("modelDescription.xml.j2", content),
        f"sources/{name}.h": code.header,
        f"sources/{name}.c": code.source,
        f"sources/{name}_instance.h": _filled("instance.h.j2", content),
        f"sources/{name}_fmi{fmi}.c": _filled("interface.c.j2", content),
    }
    if fmi == 3:
        texts["sources/buildDescription.xml"] = _filled("buildDescription.xml.j2", content)
    return {place: text.encode("utf-8") for place, text in texts.items()}


def _archive(path: Path, files: Mapping[str, bytes]) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for place, content in files.items():
            entry = zipfile.ZipInfo(place, EARLIEST)
            entry.external_attr = READABLE << 16
            archive.writestr(entry, content, zipfile.ZIP_DEFLATED)


def _binary(files: Mapping[str, bytes], name: str, fmi: int) -> bytes:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for file, content in files.items():
            (folder / file).parent.mkdir(exist_ok=True)
            (folder / file).write_bytes(content)
        library = folder / f"{name}{compiler.suffix()}"
        sources = [folder / file for file in files if file.endswith(".c")]
        compiler.compile_shared(sources, library, DEFINITIONS[fmi])
        return library.read_bytes()


def _filled(template: str, content: Mapping[str, Any]) -> str:
    templates = environment("mffit.export", autoescape=".xml" in template, keep_trailing_newline=True)
    return templates.get_template(template).render(**content)
