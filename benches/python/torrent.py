#!/usr/bin/env python3
"""Pebbles in a torrent over friction and seeds: arrivals, counts, rest, and the time a run takes.

    python3 benches/python/torrent.py --riprap PATH --runs DIR [--frictions 0,0.1,0.2] [--seeds 1,2,3] [--set FIELD=VALUE ...]

Standard library only. The case is cases/torrent.ron, the places of its pebbles from cases/torrent.py. Published (Zic, Bicanic, Koziara
& Ozanic 2014): first arrival at the upper tank. Existing runs are reused.
"""

import argparse
import csv
import json
import math
import re
import statistics
import subprocess
import sys
from pathlib import Path

CASES = Path(__file__).resolve().parents[2] / "cases"
ARRIVALS = {0.0: 8.415, 0.1: 10.33, 0.15: 10.48, 0.2: 10.56, 0.25: 10.78, 0.3: 10.83}  # s
# Speed above which a pebble is not at rest; m/s.
MOVING = 0.05


def scene(friction, seed):
    """The case with another friction and other places of its pebbles."""
    text = (CASES / "torrent.ron").read_text()
    made = subprocess.run(
        [sys.executable, CASES / "torrent.py", "blocks", str(seed)], check=True, capture_output=True, text=True
    ).stdout
    start, end = text.index("        // from torrent.py\n"), text.index("        // to here")
    text = text[:start] + "        // from torrent.py\n" + made + text[end:]
    angle = math.degrees(math.atan(friction))
    return re.sub(r"friction_angle_deg: [0-9.]+", f"friction_angle_deg: {angle:.9f}", text)


def run(args, friction, seed):
    """Folder of a run."""
    name = f"torrent_{friction:g}_{seed}" + "".join(args.set).replace(" ", "").replace("/", "_")
    folder = args.runs / name
    if not (folder / "summary.json").exists():
        args.runs.mkdir(parents=True, exist_ok=True)
        path = args.runs / f"{name}.ron"
        path.write_text(scene(friction, seed))
        command = [args.riprap, "run", str(path), "-o", str(folder), "--force", "--quiet", "--no-report"]
        for one in ["output.frame_interval=45", "output.ledger_interval=1", *args.set]:
            command += ["--set", one]
        subprocess.run(command, check=True)
    return folder


def fastest(folder):
    """Pebbles that are not at rest in the last row of each, and those that left."""
    last = {}
    with open(folder / "blocks.csv") as file:
        for row in csv.DictReader(file):
            last[row["block [-]"]] = row
    end = max(float(row["time [s]"]) for row in last.values())
    there = [row for row in last.values() if float(row["time [s]"]) == end]
    speed = lambda row: math.hypot(*(float(row[f"v{axis} [m/s]"]) for axis in "xyz"))
    return sum(MOVING < speed(row) for row in there), len(last) - len(there)


def main():
    """The table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--riprap", default="target/release/riprap")
    parser.add_argument("--runs", default="runs/benches", type=Path)
    parser.add_argument("--frictions", default="0,0.1,0.15,0.2,0.25,0.3")
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--set", nargs="*", default=[])
    args = parser.parse_args()
    seeds = [int(seed) for seed in args.seeds.split(",")]
    print("| friction | arrival [s] | over published | upper tank | lower tank | moving, left | energy unexplained | wall [s] |")
    print("|---|---|---|---|---|---|---|---|")
    for friction in map(float, args.frictions.split(",")):
        arrivals, upper, lower, ends, energies, walls = [], [], [], [], [], []
        for seed in seeds:
            folder = run(args, friction, seed)
            summary = json.loads((folder / "summary.json").read_text())
            counted = {one["name"]: one for one in summary["counters"]}
            arrivals.append(counted["upper_tank"]["first_time"])
            upper.append(counted["upper_tank"]["passed"])
            lower.append(counted["lower_tank"]["passed"])
            ends.append(fastest(folder))
            energy = summary["energy"]
            energies.append(abs(energy["residual"]) / (energy["friction"] + energy["damping"]))
            walls.append(summary["wall_time"])
        mean = statistics.mean(arrivals)
        told = [
            f"{friction:g}",
            f"{mean:.2f} ({min(arrivals):.2f} to {max(arrivals):.2f})",
            f"{100 * (mean / ARRIVALS[friction] - 1):+.1f} %" if friction in ARRIVALS else "",
            f"{statistics.mean(upper):.0f} ({', '.join(map(str, upper))})",
            f"{statistics.mean(lower):.0f} ({', '.join(map(str, lower))})",
            ", ".join(f"{moving} {left}" for moving, left in ends),
            f"{max(energies):.0e}",
            f"{statistics.mean(walls):.1f}",
        ]
        print("| " + " | ".join(told) + " |", flush=True)


if __name__ == "__main__":
    main()
