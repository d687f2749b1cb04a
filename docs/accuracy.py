"""Pages on accuracy, made from the results in the repository: `python3 docs/accuracy.py FOLDER`."""

import sys
from pathlib import Path

folder = Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
(folder / "index.md").write_text("# How accurate it is\n")
