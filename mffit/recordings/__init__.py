"""Content of recordings (columns, units, axes, conditions, stretches), and a project for them."""

from mffit.recordings.disc import DiscPath, disc_signs
from mffit.recordings.project_file import Stated, project_text
from mffit.recordings.sniffed import Sniffed, sniff
