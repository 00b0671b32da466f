"""A diagnosis, for the terminal."""

from mffit.diagnosis import Diagnosis, wording
from mffit.diagnosis.notes import NotVisible
from mffit.effects import NEEDS
from mffit.report.text import filling

MOST_NUMBERS = 5
"""Most numbers of an effect that a terminal shows."""


def diagnosis_summary(diagnosis: Diagnosis) -> str:
    """What ``mffit diagnose`` prints: the answer, what to do, the gap effect by effect, the effects, what is unexplained.

    What to do is never cut, however many effects there are.
    """
    unseen = [note for note in diagnosis.notes if isinstance(note, NotVisible)]
    return filling.text(
        "diagnosis",
        d=diagnosis,
        say=wording,
        most_numbers=MOST_NUMBERS,
        seen=[said for said in wording.notes(diagnosis) if said not in {note.sentence for note in unseen}],
        unseen=sum(len(note.effects) for note in unseen),
        lack="; ".join(dict.fromkeys(NEEDS[need] for note in unseen for need in note.needs)),
    )


def models_written(diagnosis: Diagnosis) -> list[str]:
    """Names of the property files that a diagnosis writes."""
    corrected = [diagnosis.model_after] if diagnosis.delivers or diagnosis.written_anyway else []
    return [*corrected, *([diagnosis.model_with_terms] if diagnosis.model_with_terms else [])]
