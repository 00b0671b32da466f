"""The JSON of all records, made only here, with the keys that users' scripts rely on."""

from mffit.results.as_json.of_build import build, fit, spin, write_information
from mffit.results.as_json.of_conversion import conversion
from mffit.results.as_json.of_diagnosis import diagnosis
from mffit.results.as_json.of_fleet import fleet, outcome
from mffit.results.as_json.of_input import alignment, problems, sniffed
from mffit.results.as_json.of_plan import comparison, plan
from mffit.results.as_json.of_verification import verification
from mffit.results.as_json.values import text, write

__all__ = [
    "alignment",
    "build",
    "comparison",
    "conversion",
    "diagnosis",
    "fit",
    "fleet",
    "outcome",
    "plan",
    "problems",
    "sniffed",
    "spin",
    "text",
    "verification",
    "write",
    "write_information",
]
