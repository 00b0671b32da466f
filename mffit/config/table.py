"""The base of every table of ``tyre.toml``."""

from pydantic import BaseModel, ConfigDict


class Table(BaseModel):
    """One table of the file, frozen: unknown keys, values of another type and NaN are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


def list_of_tables(given: object) -> object:
    """One table or a list of tables, as TOML gives them, as a tuple."""
    return (given,) if isinstance(given, dict) else tuple(given) if isinstance(given, list) else given
