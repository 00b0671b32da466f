"""An effect of your own, in your own file: the road under the tyre is not that of the model.

Run it beside a campaign: ``python road_friction.py tyre.toml model.tir``.
"""

from __future__ import annotations

import sys

import mffit
from mffit.effects import CATALOG, Effect, Free

ROAD_FRICTION = Effect(
    id="road-friction",
    name="friction of the road",
    kind="tyre",
    physics="The road of the test has another friction than the one that the model was made for.",
    free=(Free("LMUY", spread=0.05, lower=0.3, upper=2.0),),
    needs=("slip",),
    parity="as Fy",
    confusable_with=("loadcell-gain", "load-grip"),
)

if __name__ == "__main__":
    diagnosis = mffit.diagnose(sys.argv[1], sys.argv[2], effects=(*CATALOG, ROAD_FRICTION))
    print(diagnosis.headline)
