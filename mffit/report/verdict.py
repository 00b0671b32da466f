"""The first facts about a build: whether to trust it, its main numbers, and which file is for which use."""

from typing import NamedTuple

from mffit.comparison.characteristics import DECIDED_BY, Tested, characteristics
from mffit.fit.agreement import Agreement
from mffit.measured.wording import SOURCES
from mffit.prediction import OnRoad
from mffit.prediction.road import lesser
from mffit.quantities import CHANNELS, CHARACTERISTICS, DIRECT, KEYS, OF_ROAD, QuantityName
from mffit.results import BuildResult
from mffit.rounding import AtLeast, number, stated, times
from mffit.tested import NO_FX, lacks_fx
from tir import Quantity
from tir.errors import begun, listed

JUDGED = {"distrusted": "NOT TO BE TRUSTED", "doubted": "in doubt", "sound": "sound"}
FOR = {
    "turn-slip": "simulators that compute turn slip (USE_MODE {mode:.0f})",
    "normal": "simulators without turn slip (USE_MODE {mode:.0f}); this one if you do not know",
    "both": "either use, each slightly less accurate (USE_MODE {mode:.0f})",
    "temperature": "simulators that know the tyre's temperature; holds at {T:.1f} degC",
}
"""Whom each file is for, by its use."""


FOUR = 4


class Headline(NamedTuple):
    """A number that a user came for."""

    name: str
    value: str
    note: str
    where: str = (
        ""  #: the load if it is not the nominal one, and where a largest force that is not a peak was reached
    )


def judgement(result: BuildResult) -> str:
    """The judgement as a key of :data:`JUDGED`."""
    return "distrusted" if result.reasons else "doubted" if result.trust.doubts else "sound"


def judged(result: BuildResult) -> str:
    """The judgement in words."""
    return JUDGED[judgement(result)]


def verdict(result: BuildResult) -> str:
    """The judgement and the misfit in a sentence."""
    fit, ratios = result.fit, result.trust.over_noise
    misfit = {name: f"{_rmse(name, a)} in {name}" for name, a in fit.channels.items() if a.n}
    for name in misfit:
        if (ratio := ratios.get(name, 0.0)) > 0.0:
            misfit[name] += f" ({times(ratio, 1.0)} the noise)"
    what = f"{len(result.points)} points are fitted to {listed([*misfit.values()])}"
    holds = ["for the mean of the runs"] * (fit.runs is not None)
    holds += [f"at {fit.speed.V_ref:g} m/s"] if fit.speed is not None else []
    if holds:
        left = [_rmse(name, a) for name, a in fit.of_file.items() if a.n]
        what += f"; the file, which holds {listed(holds)}, leaves {listed(left)}"
    return f"{result.tir_path} is {judged(result)}: {what}."


def _rmse(channel: str, found: Agreement) -> str:
    return f"{number(found.rmse, digits=3)} {CHANNELS[channel].unit}"


def over_noise(result: BuildResult, channel: str) -> float | None:
    """Misfit of the written file over the stated noise; None if none is stated, or if only the model has effects of the runs."""
    return result.trust.over_noise.get(channel) if result.fit.runs is None else None


def headlines(result: BuildResult) -> list[Headline]:
    """The four numbers that a user came for: of the direct method on a disc, then of the model where data decide them."""
    nominal, found = result.measured.nominal, []
    tyre = result.tyres[result.fitted]
    load = float(tyre["FNOMIN"])
    if result.measured.epsilon_gamma is not None and nominal is not None:
        carried = result.measured.carried
        by = f"PECP1 of the file, {SOURCES[carried.source]}" if carried else ""
        of_disc = (
            ("epsilon_gamma", result.measured.epsilon_of_file, by),
            ("C_phit", nominal.C_phit, "turn slip"),
        )
        found = [
            _headline(DIRECT[name], value, note, (nominal.load, load))
            for name, value, note in of_disc
            if value is not None
        ]
    of_model = characteristics(
        tyre, load, turn_slip=result.on_disc, known=result.fit.posterior, predictor=result.prediction
    )
    fitted = {name for name, a in result.fit.channels.items() if a.n}
    loads = dict.fromkeys(of_model, load)
    if nominal is not None and nominal.C_alpha_straight is not None:  # the same number as in result.json
        of_model[KEYS["C_alpha"]] = nominal.C_alpha_straight
        loads[KEYS["C_alpha"]] = nominal.load
    of_road = _of_road(result.road)
    of_model |= of_road
    tested = Tested.of([tyre])
    for key in filter(tested.varied, DECIDED_BY):
        value, by = of_model[key], "on the lesser side" if key in of_road else "of the model"
        if DECIDED_BY[key].channel in fitted and value.u:
            end = f"at {tested.end(key)}, the end of the tested range" if isinstance(value, AtLeast) else ""
            found.append(
                _headline(CHARACTERISTICS[key], value, f"{by}, straight path", (loads[key], load), end)
            )
    return found[:FOUR]


def _of_road(road: OnRoad | None) -> dict[str, Quantity]:
    """Characteristics of the tyre on the road, the lesser of both sides."""
    if road is None:
        return {}
    found = {
        key: lesser(getattr(side, name) for side in road.sides.values()) for key, name in OF_ROAD.items()
    }
    return {key: q for key, q in found.items() if q is not None}


def _headline(
    known: QuantityName, value: Quantity, note: str, loads: tuple[float, float], reached: str = ""
) -> Headline:
    """A number with a ``note``; ``loads`` are its own and the nominal one."""
    own, nominal = (f"at {number(load, 0)} N" for load in loads)
    name = f"{begun(known.word)} {known.ascii}"
    where = "; ".join(filter(None, (reached, own if own != nominal else "")))
    return Headline(
        name, stated(value, known.unit_behind), "; ".join(filter(None, (reached, f"{note} {own}"))), where
    )


def purposes(result: BuildResult) -> dict[str, str]:
    """Whom each written file is for, in words, by its name."""
    warm = result.fit.temperature
    found: dict[str, str] = {}
    for use, name in result.files.items():
        mode = result.tyres[use]["USE_MODE"] if use in result.tyres else 0.0
        text = FOR.get(use, use)
        if use == "normal" and "turn-slip" not in result.files:
            text = "simulators with turn slip off (USE_MODE {mode:.0f})"
        if result.fit.speed is not None:
            text += f"; holds at {result.fit.speed.V_ref:g} m/s"
        if use in result.tyres and lacks_fx(result.tyres[use]):
            text += f"; {NO_FX}"
        found.setdefault(name, text.format(mode=mode, T=warm.T_ref if warm else 0.0))
    if result.correction is not None:
        found[result.correction_name] = (
            f"simulations that add the model error to {result.files[result.fitted]}"
        )
    return found
