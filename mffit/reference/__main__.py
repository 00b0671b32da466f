import sys
from pathlib import Path

from mffit.reference import write

write(Path(sys.argv[1] if len(sys.argv) > 1 else "docs"))
