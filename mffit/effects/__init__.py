"""The library of effects that a diagnosis can name."""

from mffit.effects.catalog import CATALOG, FAULT_WORDS, NAMES
from mffit.effects.effect import Effect, Free
from mffit.effects.needs import NEEDS

__all__ = ["CATALOG", "FAULT_WORDS", "NAMES", "NEEDS", "Effect", "Free"]
