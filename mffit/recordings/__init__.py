"""What a recording holds, and the project to go with it: columns, units, axes, conditions, stretches."""

from mffit.recordings.project_file import project_text
from mffit.recordings.sniffed import Sniffed, sniff

__all__ = ["Sniffed", "project_text", "sniff"]
