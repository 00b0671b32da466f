"""All rig errors in one list, in the order of the chain from set-point readings to force readings."""

import tomllib
from importlib import resources
from typing import Any

from mffit.rig_errors import constants
from mffit.rig_errors.formulae import CALIBRATES, CAMBER_STIFFNESS, FORCE_AT_ZERO, FORMULAE, over
from mffit.rig_errors.record import BEFORE_THE_TYRE, Appearance, Declared, Place, RigError

P_REF, T_REF, V_REF = "p_ref_kPa", "T_ref_degC", "V_ref_mps"
"""Numbers with the pressure, the temperature and the speed at which the fitted model holds."""


def rig_error(name: str, row: dict[str, Any]) -> RigError:
    """The record of a table of ``rig_errors.toml``, with the formulae of its name."""
    fields = _values(row)
    for seen in ("seen_as", "seen_per_run"):
        if seen in fields:
            fields[seen] = Appearance(**_values(fields[seen]))
    if "place" in fields:
        fields["place"] = Place[fields["place"]]
    if "declared" in fields:
        fields["declared"] = Declared(
            **{"default": None, **_values(fields["declared"])},
            force_at_zero=FORCE_AT_ZERO.get(name),
            camber_stiffness=CAMBER_STIFFNESS.get(name),
            calibrates=CALIBRATES.get(name),
        )
    formula = FORMULAE.get(name) or (over(fields["counts_from"]) if "counts_from" in fields else None)
    return RigError(name=name, formula=formula, **fields)


def _values(row: dict[str, Any]) -> dict[str, Any]:
    """The values of a table, with lists as tuples and numbers of judgement by their names."""
    values: dict[str, Any] = {k: tuple(x) if isinstance(x, list) else x for k, x in row.items()}
    if isinstance(named := values.get("default"), str):
        values["default"] = getattr(constants, named)
    return values


def _read() -> tuple[RigError, ...]:
    text = resources.files(__package__).joinpath("rig_errors.toml").read_text(encoding="utf-8")
    return tuple(rig_error(name, row) for name, row in tomllib.loads(text).items())


RIG_ERRORS = _read()
BY_NAME: dict[str, RigError] = {error.name: error for error in RIG_ERRORS}
BEFORE = tuple(error for error in RIG_ERRORS if error.place in BEFORE_THE_TYRE)
"""Errors that act between the readings of the set-points and the conditions of the tyre."""
AFTER = tuple(error for error in RIG_ERRORS if error.place not in (*BEFORE_THE_TYRE, None))
"""Errors that act between the forces of the tyre and their readings."""
DECLARED = tuple((error, error.declared) for error in RIG_ERRORS if error.declared is not None)
"""Errors whose uncertainty ``[rig]`` states, each with its declaration."""
ZEROS = tuple(error for error in RIG_ERRORS if error.of_setup)
"""Errors that differ from set-up to set-up."""
BESIDE = tuple(
    error for error in RIG_ERRORS if error.kind == "tyre" and error.place in (None, Place.COEFFICIENTS)
)
"""Effects of the tyre over known conditions, for which the formula has no coefficient, and the conditions they count from."""
CALIBRATED = {error.acts_on[0]: declared.key for error, declared in DECLARED if error.is_gain}
"""By channel with a calibration, the key of ``[rig]`` that states its uncertainty."""
