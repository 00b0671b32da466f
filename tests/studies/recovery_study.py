"""How often the intervals hold the truth: `python tests/studies/recovery_study.py 100` prints the table of docs/recovery.md."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "mffit" / "fit"))

from drawn_rigs import report

if __name__ == "__main__":
    print(report(int(sys.argv[1]) if len(sys.argv) > 1 else 100))
