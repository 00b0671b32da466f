"""The library of effects that a diagnosis can name."""

from mffit.effects.catalog import CATALOG
from mffit.effects.effect import Effect, Free

__all__ = ["CATALOG", "Effect", "Free"]
