"""Every value of the file together with the word that says where it comes from."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Known:
    """Values by name, and the origin of each: measured, fitted, regularised, base, default, estimate, range or given."""

    values: Mapping[str, Any]
    origin: Mapping[str, str]

    def having(self, found: Mapping[str, Any], origin: str = "") -> Known:
        """The same with some values replaced; without a word their origin stays what it was."""
        words = dict.fromkeys(found, origin) if origin else {}
        return Known({**self.values, **found}, {**self.origin, **words})

    def deciding(self, origin: Mapping[str, str]) -> Known:
        """The same values, some of which someone has decided."""
        return dataclasses.replace(self, origin={**self.origin, **origin})
