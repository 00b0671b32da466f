"""The files that a command reads."""

import os
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import NamedTuple

import tir
from mffit import points
from mffit.config import Config, SweepTable
from mffit.config.models import given_values
from mffit.errors import InputError
from mffit.fit.at_nominal import CONDITIONS, Nominal, tyre_at_nominal
from mffit.fit.same_curve import tyre_in_one_form
from mffit.output import Project, digest
from mffit.points.loading import Reading
from mffit.sheets import file_of, sheet_of
from mffit.suspicion import before_the_fit
from mffit.sweeps import formats
from tir import Tyre
from tir.errors import TirError
from tir.formula import is_old


def read_points(config: Config, *, continuous: bool = False) -> Reading:
    """The points of a configuration, refused or warned about if they are not plausible; ``continuous`` as in
    :func:`mffit.points.read`.
    """
    with formats.reading_once():
        found = points.read(config, continuous=continuous)
    return found._replace(warnings=(*found.warnings, *before_the_fit(found.points, config)))


class Usable(NamedTuple):
    """Points of the sweeps that can be used together."""

    config: Config  #: of these sweeps
    reading: Reading | None  #: None if no sweeps can be
    refused: dict[str, str]  #: by the file of a sweep, why it was left out
    problem: str  #: why there is no reading


@formats.reading_once()
def read_usable(config: Config, required: Collection[str], doubted: Collection[str] = ()) -> Usable:
    """As :func:`read_points`, without the sweeps that make the points unusable.

    If all together are refused, those whose file is ``required`` are read alone, without a file that the refusal names. The
    others are then added in their order, each unless the points are refused with it, those of which this is ``doubted`` last.
    """

    def of(sweeps: Sequence[SweepTable]) -> Config:
        return config.model_copy(update={"sweep": tuple(sweeps)})

    def together(sweeps: Sequence[SweepTable]) -> Reading | InputError | None:
        try:
            return read_points(of(sweeps)) if sweeps else None
        except InputError as error:
            return error

    found = together(config.sweep)
    if not isinstance(found, InputError):
        return Usable(config, found, {}, "")
    taken = [sweep for sweep in config.sweep if sweep.file in required]
    refused: dict[str, str] = {}
    foreign: dict[str, str] = {}
    while isinstance(found := together(taken), InputError) and found.file is not None:
        named = {sweep.file: str(found) for sweep in taken if Path(sweep.file).name == found.file.name}
        if not named:
            break
        refused |= named
        taken = [sweep for sweep in taken if sweep.file not in named]
    further = [sweep for sweep in config.sweep if sweep.file not in required]
    groups = [
        [one for one in further if one.file not in doubted],
        *([one] for one in further if one.file in doubted),
    ]
    while groups:
        group = groups.pop(0)
        more = together([*taken, *group])
        if isinstance(more, Reading):
            taken, found = [*taken, *group], more
        elif len(group) > 1:
            groups = [[sweep] for sweep in group] + groups
        else:
            foreign |= {sweep.file: str(more) for sweep in group}
    if isinstance(found, InputError):
        return Usable(of([*taken, *further]), None, refused, str(found))
    return Usable(of(taken), found, refused | foreign, "")


def read_base(config: Config) -> Tyre | None:
    """The base file that the configuration names, at the nominal conditions of ``[tyre]``; None without one.

    A file of MF 5.2 or PAC2002 is converted.
    """
    if config.tyre.base is None:
        return None
    path = config.folder / config.tyre.base
    if not path.is_file():
        raise InputError(
            f"the base file {path} {'is a folder' if path.is_dir() else 'does not exist'}: correct [tyre] base or remove it",
            file=config.path,
            key="tyre.base",
        )
    found = _converted(path) if is_old(path) else tir.read(path)
    wanted = Nominal.of(given_values(config.tyre))
    try:
        return tyre_at_nominal(tyre_in_one_form(found), wanted)
    except ArithmeticError as error:
        raise InputError(
            f"the base file {config.tyre.base} cannot be converted to the nominal conditions of [tyre], at which a factor of its "
            f"formulae vanishes ({error}): give conditions nearer to its own, or another base",
            file=config.path,
            line=config.line_of("tyre.base"),
            key="tyre.base",
        ) from None


def _converted(path: Path) -> Tyre:
    from mffit.conversion import convert  # a fit, which few projects need

    return convert(path).tyre


def check_named_files(config: Config) -> None:
    """Refuse as a build does, with InputError, a base file or priors that cannot be used as the configuration uses them."""
    from mffit.fit.by_hand import hand_of  # of a fit, which few questions need
    from mffit.fit.priors import of_fleet

    try:
        hand_of(config, read_base(config))
    except TirError as error:
        raise InputError(str(error), key="tyre.base") from None
    of_fleet(config)


def base_notes(config: Config, base: Tyre | None) -> tuple[str, ...]:
    """A remark on a base file for other nominal conditions."""
    if base is None or CONDITIONS not in base.provenance:
        return ()
    return (
        f"The base file {config.tyre.base} is at other nominal conditions: {base.provenance[CONDITIONS]}.",
    )


def base_warnings(config: Config, base: Tyre | None) -> tuple[str, ...]:
    """Warnings about a base file that was converted from another version of the formula."""
    from mffit.conversion.convert import MISFIT, ORIGIN

    if base is None or ORIGIN not in base.provenance:
        return ()
    missed = base.provenance.get(MISFIT, "its misfit is not stated")
    return (
        f"the base file {config.tyre.base} is converted ({', '.join(base.provenance[ORIGIN].split(', ')[:2])}): {missed}; "
        "coefficients that the sweeps do not determine have this misfit",
    )


def inputs_of(config: Config) -> list[Path]:
    """Every file that a command reads for this configuration."""
    files = [config.folder / name for name in input_names(config)]
    return files if config.path is None else [config.path, *files]


def project_of(config: Config) -> Project:
    """The project of a configuration, for the record of its output folder."""
    return Project(config.tyre.name, "" if config.path is None else str(config.path))


def input_hashes(config: Config) -> dict[str, str]:
    """SHA-256 in hex of every input file that can be read, by its name, in the order of :func:`input_names`."""
    found = {name: config.folder / name for name in input_names(config)}
    return {name: digest(path) for name, path in found.items() if path.is_file() and os.access(path, os.R_OK)}


def input_names(config: Config) -> list[str]:
    """The files that a configuration names: sweeps in their order, base file, priors."""
    named = (*(sweep.file for sweep in config.sweep), config.tyre.base, config.tyre.priors)
    return list(dict.fromkeys(file_of(name).as_posix() if sheet_of(name) else name for name in named if name))
