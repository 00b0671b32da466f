"""The JSON of all records, made only here, with the keys that users' scripts rely on."""

from mffit.results.as_json import of_measured, of_questions  # noqa: F401  state keys
from mffit.results.as_json.of_build import fit, write_information
from mffit.results.values import document, text, write

__all__ = ["document", "fit", "text", "write", "write_information"]
