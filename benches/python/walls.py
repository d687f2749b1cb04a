"""How well the walls of a bench hold the water."""

import json
import sys


def print_walls(name, folder):
    """How well the walls of a run hold the water: a line of its `summary.json`, empty in older ones."""
    path = folder / "summary.json"
    summary = json.loads(path.read_text()) if path.exists() else {}
    gap = summary.get("wall_gap_over_spacing")
    if gap is not None:
        deepest = summary["max_wall_penetration_over_spacing"]
        print(f"{name}: water {gap:+.3f} spacings off the walls, at most {deepest:.3f} inside them", file=sys.stderr)
