#!/usr/bin/env python3
"""Discharge of a flat-bottomed hopper: rate against published simulations.

    python3 benches/python/hopper.py --riprap PATH --runs DIR [--depth 5] [--seeds 1,2] [--set FIELD=VALUE ...]

Standard library only. The case is cases/hopper.ron, at another depth if asked for. Published (Anand, Curtis, Wassgren, Hancock & Ketterhagen
2008, base case, periodic in depth): mass out of a slice of 5.6 mm over time, a straight line from 0.1 to 0.9 s after the slot opens.
Rates are those of a slice as deep, by least squares from 0.1 s after the slot opens to 0.6 s or the end of the run. Finished runs are
reused, others resumed.
"""

import argparse
import math
import shutil
from pathlib import Path

from rows import CASES, read_rows, run_to_end, table, unexplained

DIAMETER, DENSITY = 2.24e-3, 2500.0  # m, kg/m3
DEPTH, COUNT = 5, 13580  # of the case; diameters, beads
SLICE = 5.6e-3  # m
OPENS = 0.3  # s
# Mass out (g) at times (s) after the slot opens.
ANAND = [
    (0.07792, 5.254), (0.14211, 10.503), (0.20589, 15.672), (0.26721, 21.084), (0.33346, 26.292), (0.39929, 31.4), (0.46142, 36.69),
    (0.52397, 41.939), (0.58611, 47.209), (0.65194, 52.499), (0.71737, 57.809), (0.78279, 62.937), (0.85027, 68.187), (0.92801, 73.476),
]


def scene(depth, seed):
    """The case at another depth, in diameters, with other places of its beads."""
    text = (CASES / "hopper.ron").read_text()
    whole = lambda depth: f"{depth * DIAMETER:.4g}"
    beyond = lambda depth: f"{depth * DIAMETER + 7e-3:.4g}"
    for old, new in [
        (whole(DEPTH), whole(depth)),
        (beyond(DEPTH), beyond(depth)),
        (f"count: {COUNT}", f"count: {COUNT * depth / DEPTH:.0f}"),
        ("seed: 1", f"seed: {seed}"),
    ]:
        if old not in text:
            raise SystemExit(f"hopper.ron has no {old!r}")
        text = text.replace(old, new)
    return text


def run(args, seed):
    """Folder and summary of a run."""

    def prepare():
        shutil.copy(CASES / "hopper_gate.csv", args.runs)
        return scene(args.depth, seed), []

    return run_to_end(args, f"hopper_{args.depth:g}_{seed}" + "".join(args.set), prepare)


def rate(points, start, end):
    """Slope of the straight line through points from a time to another."""
    points = [(t, m) for t, m in points if start <= t <= end]
    n = len(points)
    t, m = (sum(column) / n for column in zip(*points))
    return sum((a - t) * (b - m) for a, b in points) / sum((a - t) ** 2 for a, _ in points)


def discharged(folder, depth):
    """Times after the slot opens (s) and mass out of a slice (g)."""
    bead = 1e3 * DENSITY * math.pi / 6 * DIAMETER**3
    return [
        (float(row["time [s]"]) - OPENS, bead * float(row["slot.passed [-]"]) * SLICE / (depth * DIAMETER))
        for row in read_rows(folder / "counters.csv")
    ]


def main():
    """The table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--riprap", default="target/release/riprap")
    parser.add_argument("--runs", default="runs/benches/hopper", type=Path)
    parser.add_argument("--depth", default=DEPTH, type=float, help="diameters")
    parser.add_argument("--seeds", default="1")
    parser.add_argument("--threads", default=1, type=int)
    parser.add_argument("--set", nargs="*", action="extend", default=[])
    args = parser.parse_args()
    table([[
        "seed", "fitted to [s]", "rate [g/s]", "published, same times [g/s]", "over published", "deepest overlap, of d", "unexplained",
        "wall [s]",
    ]])
    for seed in args.seeds.split(","):
        folder, summary = run(args, seed)
        points = discharged(folder, args.depth)
        end = min(0.6, points[-1][0])
        found, published = rate(points, 0.1, end), rate(ANAND, 0.1, max(end, 0.3))
        # the size is the cube root of the volume
        overlap = (math.pi / 6) ** (1 / 3) * summary["max_block_overlap_over_size"]
        print(
            f"| {seed} | {end:.2f} | {found:.1f} | {published:.1f} | {100 * (found / published - 1):+.1f} % | {100 * overlap:.1f} % | "
            f"{unexplained(summary):+.0e} | {summary['wall_time']:.0f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
