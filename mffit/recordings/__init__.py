"""Content of recordings (columns, units, axes, conditions, stretches), and a project for them."""

from mffit.recordings.project_file import project_text
from mffit.recordings.sniffed import Sniffed, sniff

__all__ = ["Sniffed", "project_text", "sniff"]
