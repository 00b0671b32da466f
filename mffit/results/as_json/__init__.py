"""The JSON of all records, made only here, with the keys that users' scripts rely on."""

from mffit.results.as_json import of_measured  # noqa: F401  states keys
from mffit.results.as_json.of_build import fit, write_information
from mffit.results.as_json.of_questions import conversion, problems
from mffit.results.values import document, text, write

alignment = build = comparison = diagnosis = fleet = outcome = plan = sniffed = spin = document
"""What is written of each answer: the JSON of its record."""

__all__ = [
    "alignment",
    "build",
    "comparison",
    "conversion",
    "diagnosis",
    "document",
    "fit",
    "fleet",
    "outcome",
    "plan",
    "problems",
    "sniffed",
    "spin",
    "text",
    "write",
    "write_information",
]
