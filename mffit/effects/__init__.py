"""The library of effects that a diagnosis can name."""

from mffit.effects.catalog import CATALOG, NAMES
from mffit.effects.effect import Effect, Free
from mffit.effects.needs import NEEDS, OF_CHANNEL
