"""The library of effects that a diagnosis can name."""

from mffit.effects.catalog import CATALOG
from mffit.effects.effect import Effect, Free
from mffit.effects.needs import NEEDS

__all__ = ["CATALOG", "NEEDS", "Effect", "Free"]
