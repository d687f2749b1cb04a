#!/usr/bin/env python3
"""Dry debris against slit and sectional barriers: largest forces against the published ones.

    python3 benches/python/barrier.py --riprap PATH --runs DIR [--rows OB3,VB7,F] [--until 2.6] [--seed 1] [--set FIELD=VALUE ...]

Standard library only. Scenes from cases/barrier.py. Published: a doctoral thesis on debris flow against open rigid barriers by coupled
DEM-LBM, tables 7.2 to 7.4: largest force on the whole barrier (kN) and its time (s), one run each of another code. Existing runs are reused.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

CASES = Path(__file__).resolve().parents[2] / "cases"
# arguments of barrier.py, largest global force [kN], its time [s]
ROWS = {
    "OB": (["slit", "closed"], 88.3, 1.5),
    "VB": (["slit", "closed", "--upright"], 107.15, 1.4),
    "OB3": (["slit", "3"], 88.99, 1.5),
    "VB3": (["slit", "3", "--upright"], 109.74, 1.4),
    "OB7": (["slit", "7"], 78.47, 1.6),
    "VB7": (["slit", "7", "--upright"], 100.47, 1.5),
    "OB10": (["slit", "10"], 74.52, 1.6),
    "VB10": (["slit", "10", "--upright"], 82.51, 1.3),
    "A": (["sectional", "A"], 87.83, 1.7),
    "B": (["sectional", "B"], 81.35, 1.7),
    "C": (["sectional", "C"], 63.02, 1.6),
    "D": (["sectional", "D"], 46.28, 1.8),
    "E": (["sectional", "E"], 36.3, 1.7),
    "F": (["sectional", "F"], 81.59, 1.7),
    "G": (["sectional", "G"], 84.65, 1.5),
    "H": (["sectional", "H"], 81.92, 1.6),
    "I": (["sectional", "I"], 66.49, 1.7),
    "L": (["sectional", "L"], 71.41, 1.7),
}


def run(args, name):
    """Folder of a run."""
    key = f"{name}_{args.seed}" + "".join(args.set).replace(" ", "").replace("/", "_")
    folder = args.runs / key
    if not (folder / "summary.json").exists():
        args.runs.mkdir(parents=True, exist_ok=True)
        path = args.runs / f"{key}.ron"
        command = [sys.executable, CASES / "barrier.py", *ROWS[name][0], "--seed", str(args.seed)]
        path.write_text(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        command = [args.riprap, "run", str(path), "-o", str(folder), "--force", "--quiet", "--no-report"]
        for one in [f"time.duration={args.until}", f"output.frame_interval={args.until}", *args.set]:
            command += ["--set", one]
        subprocess.run(command, check=True)
    return folder


def result(summary):
    """Largest force of a step on the whole barrier and on a cell, mean of the last second (kN), arrival and time of the largest (s)."""
    solid = summary["barriers"][0]["solid"]
    kilo = lambda name: solid[name] / 1e3
    return kilo("largest"), solid["largest_time"], kilo("largest_local"), kilo("at_rest"), solid["first_arrival"]


def main():
    """The table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--riprap", default="target/release/riprap")
    parser.add_argument("--runs", default="runs/benches/barrier", type=Path)
    parser.add_argument("--rows", default=",".join(ROWS))
    parser.add_argument("--until", default=2.6, type=float, help="s")
    parser.add_argument("--seed", default=1, type=int)
    parser.add_argument("--set", nargs="*", default=[])
    args = parser.parse_args()
    print("| row | published [kN] | largest [kN] | over published | arrival [s] | time - published [s] | on a cell [kN] | last second [kN] | passed | unexplained | wall [s] |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    ratios = []
    for name in args.rows.split(","):
        _, published, at = ROWS[name]
        folder = run(args, name)
        summary = json.loads((folder / "summary.json").read_text())
        largest, time, local, end, arrival = result(summary)
        ratios.append(largest / published)
        released = sum(summary["energy"][key] for key in ("friction", "damping", "kinetic"))
        print(
            f"| {name} | {published:g} | {largest:.1f} | {100 * (largest / published - 1):+.0f} % | {arrival:.2f} | {time - at:+.2f} | "
            f"{local:.2f} | {end:.1f} | {100 * summary['barriers'][0]['passed_share']:.0f} % | {summary['energy']['residual'] / released:+.0e} | {summary['wall_time']:.0f} |",
            flush=True,
        )
    within = lambda share: sum(abs(ratio - 1) <= share for ratio in ratios)
    print(f"\n{within(0.15)} of {len(ratios)} within 15 %, {within(0.25)} within 25 %, mean {sum(ratios) / len(ratios):.3f}")


if __name__ == "__main__":
    main()
