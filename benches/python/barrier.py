#!/usr/bin/env python3
"""Dry debris against slit and sectional barriers: largest forces against the published ones.

    python3 benches/python/barrier.py --riprap PATH --runs DIR [--rows OB3,VB7,F] [--until 1.9] [--scene="--seed 2 --jitter 0.002"]
        [--set FIELD=VALUE ...]
    python3 benches/python/barrier.py --riprap PATH --runs DIR --slopes 20,30,40 --openings closed,4,7

Standard library only. Scenes from cases/barrier.py, with the arguments of --scene. Published: a doctoral thesis on debris flow against open
rigid barriers by coupled DEM-LBM, tables 7.2 to 7.4: largest force on the whole barrier (kN), its time (s), and largest force on a sphere of
the barrier during the impact (kN), one run each of another code. The second line has no published values but of a closed barrier beside
slits: about the same at every slope. Finished runs are reused, others resumed.
"""

import argparse
import math
import subprocess
import sys
from pathlib import Path

from rows import CASES, read_rows, run_to_end, table, unexplained

# Interval of means; s.
MEAN = 0.01
# arguments of barrier.py, largest global force [kN], its time [s], largest local force [kN]
ROWS = {
    "OB": ("slit closed", 88.3, 1.5, 7.60),
    "VB": ("slit closed --upright", 107.15, 1.4, 6.66),
    "OB3": ("slit 3", 88.99, 1.5, 7.60),
    # printed 662
    "VB3": ("slit 3 --upright", 109.74, 1.4, 6.62),
    "OB7": ("slit 7", 78.47, 1.6, 7.60),
    "VB7": ("slit 7 --upright", 100.47, 1.5, 6.62),
    "OB10": ("slit 10", 74.52, 1.6, 7.60),
    "VB10": ("slit 10 --upright", 82.51, 1.3, 6.70),
    "A": ("sectional A", 87.83, 1.7, 5.38),
    "B": ("sectional B", 81.35, 1.7, 8.05),
    "C": ("sectional C", 63.02, 1.6, 5.80),
    "D": ("sectional D", 46.28, 1.8, 8.05),
    "E": ("sectional E", 36.3, 1.7, 6.59),
    "F": ("sectional F", 81.59, 1.7, 8.96),
    "G": ("sectional G", 84.65, 1.5, 6.79),
    "H": ("sectional H", 81.92, 1.6, 7.46),
    "I": ("sectional I", 66.49, 1.7, 7.72),
    "L": ("sectional L", 71.41, 1.7, 8.41),
}


def run(args, scene):
    """Folder and summary of the run of a scene, by its arguments of barrier.py."""
    scene = f"{scene} {args.scene}".split()

    def prepare():
        command = [sys.executable, CASES / "barrier.py", *scene]
        text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        piles = ", ".join(f'"pile_{number}"' for number in range(1, text.count('(name: "pile_') + 1))
        forces = f"forces=(blocks: [{piles}], interval: {MEAN})"
        return text, [f"time.duration={args.until}", f"output.frame_interval={args.until}", forces]

    return run_to_end(args, "_".join([*scene, *args.set, f"{args.until:g}s"]).replace("--", ""), prepare)


def result(summary):
    """Largest force of a step on the whole barrier, its time, largest on a cell, first arrival; kN, s."""
    solid = summary["barriers"][0]["solid"]
    return solid["largest"] / 1e3, solid["largest_time"], solid["largest_local"] / 1e3, solid["first_arrival"]


def largest_mean(folder):
    """Largest mean over `MEAN` of the force on the whole barrier (kN) and its time (s)."""
    sums = {}
    for row in read_rows(folder / "forces.csv"):
        force = sums.setdefault(float(row["time [s]"]), [0.0, 0.0, 0.0])
        for axis, name in enumerate("xyz"):
            force[axis] += float(row[f"contact_f{name} [N]"]) / 1e3
    return max((math.hypot(*force), time) for time, force in sums.items())


def published(args):
    """The published rows."""
    table([[
        "row", "published [kN]", "largest step [kN]", "ratio", "largest 10 ms [kN]", "ratio", "published at [s]", "step at [s]",
        "arrival [s]", "published, local [kN]", "on a cell [kN]", "passed by the end", "unexplained", "steps", "wall [s]",
    ]])
    steps, means, on_time, local = [], [], 0, 0
    for name in args.rows.split(","):
        scene, force, at, on_sphere = ROWS[name]
        folder, summary = run(args, scene)
        largest, time, on_cell, arrival = result(summary)
        mean, _ = largest_mean(folder)
        steps.append(largest / force)
        means.append(mean / force)
        on_time += abs(time - at) <= 0.25
        local += 0.5 <= on_cell / on_sphere <= 2.0
        print(
            f"| {name} | {force:g} | {largest:.1f} | {largest / force:.2f} | {mean:.1f} | {mean / force:.2f} | {at:g} | {time:.2f} | "
            f"{arrival:.2f} | {on_sphere:.2f} | {on_cell:.2f} | {100 * summary['barriers'][0]['passed_share']:.0f} % | "
            f"{unexplained(summary):+.0e} | {summary['steps']} | {summary['wall_time']:.0f} |",
            flush=True,
        )
    n = len(steps)
    for what, ratios in [("steps", steps), ("means of 10 ms", means)]:
        within = lambda share: sum(abs(ratio - 1) <= share for ratio in ratios)
        print(
            f"\nLargest {what} of {n}: {within(0.15)} within 15 %, {within(0.25)} within 25 %, mean ratio {sum(ratios) / n:.3f} "
            f"(least {min(ratios):.2f}, largest {max(ratios):.2f})"
        )
    print(f"\n{on_time} of {n} within 0.25 s; {local} of the local forces within a factor of 2")


def slopes(args):
    """Slits over slopes."""
    table([[
        "slope", "opening over radius", "largest step [kN]", "over the first", "at [s]", "largest 10 ms [kN]", "over the first",
        "arrival [s]", "unexplained",
    ]])
    for slope in args.slopes.split(","):
        first = ()
        for opening in args.openings.split(","):
            folder, summary = run(args, f"slit {opening} --slope {slope}")
            largest, time, _, arrival = result(summary)
            mean, _ = largest_mean(folder)
            first = first or (largest, mean)
            print(
                f"| {slope} | {opening} | {largest:.1f} | {largest / first[0]:.2f} | {time:.2f} | {mean:.1f} | "
                f"{mean / first[1]:.2f} | {arrival:.2f} | {unexplained(summary):+.0e} |",
                flush=True,
            )


def main():
    """The tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--riprap", default="target/release/riprap")
    parser.add_argument("--runs", default="runs/benches/barrier", type=Path)
    parser.add_argument("--rows", default=",".join(ROWS))
    parser.add_argument("--slopes", help="slopes of single slits in place of the published rows; degrees")
    parser.add_argument("--openings", default="closed,4,7", help="of these slits, over the mean radius")
    parser.add_argument("--until", default=1.9, type=float, help="s")
    parser.add_argument("--threads", default=1, type=int)
    parser.add_argument("--scene", default="", help="further arguments of cases/barrier.py")
    parser.add_argument("--set", nargs="*", action="extend", default=[])
    args = parser.parse_args()
    if args.slopes:
        slopes(args)
    else:
        published(args)


if __name__ == "__main__":
    main()
