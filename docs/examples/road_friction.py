"""An effect defined outside the library: the test road has another friction than the road of the model.

Run it on a campaign: ``python road_friction.py tyre.toml model.tir``.
"""

from __future__ import annotations

import sys

import mffit
from mffit.effects import CATALOG, Effect, Free

ROAD_FRICTION = Effect(
    id="road-friction",
    name="friction of the road",
    kind="tyre",
    physics="The friction of the test road differs from that of the road for which the model was made.",
    free=(Free("LMUY", spread=0.05, lower=0.3, upper=2.0),),
    needs=("slip",),
)

if __name__ == "__main__":
    diagnosis = mffit.diagnose(sys.argv[1], sys.argv[2], effects=(*CATALOG, ROAD_FRICTION))
    print(diagnosis.headline)
