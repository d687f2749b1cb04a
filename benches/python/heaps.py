#!/usr/bin/env python3
"""Heaps of spheres by discharging: angles over sliding friction and rolling resistance against a published fit.

    python3 benches/python/heaps.py --riprap PATH --runs DIR [--pairs 0.0678:0.577,0.1:0.4] [--plate 20] [--drop 0] [--smooth]
        [--until 8] [--set FIELD=VALUE ...]

Standard library only. Spheres of 10 cm settle in a box, two outlets of 5 d at its sides open, and those that stay on the plate
between them form the heap, as in cases/heap.ron. Published (doctoral thesis on debris flow against open rigid barriers by coupled DEM-LBM,
209 heaps of spheres of 10 cm): 151.7 sqrt(mu_r mu_s) degrees for mu_r up to 0.12 and mu_s up to 0.7. As there, rolling resistance at
walls is twice that between spheres; dashpots are those of cases/barrier.py. The length of the published plate and the depth of the box
are not known: here 20 d and 4 d.

Angles are those of Theil-Sen lines through the highest spheres of cells of 1 d, from 1.5 d off the middle to 1.5 d before the edge
of the plate, one for each flank. Finished runs are reused, others resumed.
"""

import argparse
import math
import statistics
from pathlib import Path

from rows import read_rows, run_to_end, table

D = 0.1  # m
DEPTH, OUTLET, FILL = 4, 5, 10  # d
PAIRS = "0.02:0.2,0.02:0.4,0.05:0.4,0.1:0.4,0.0678:0.577"
# The gates are shut for so long; s.
SHUT = 1.0


def scene(rolling, sliding, args, gates):
    """Text of the scene; x = 0 in the middle of the plate."""
    half, wide = 0.5 * args.plate * D, (0.5 * args.plate + OUTLET) * D
    deep, high, angle = DEPTH * D, (2 * FILL + args.drop) * D, math.degrees(math.atan(sliding))
    n = round(FILL * (args.plate + 2 * OUTLET) * DEPTH * 0.6 / (math.pi / 6))
    box = lambda name, low, high, motion="Fixed", material="wall": (
        f'        (name: "{name}", material: "{material}", motion: {motion}, shape: Box(min: {low}, max: {high})),'
    )
    sides = "smooth" if args.smooth else "wall"
    blocks = "\n".join([
        box("plate", (-half, -0.3, -0.2), (half, deep + 0.3, 0)),
        box("left_gate", (-wide - 0.2, -0.2, -0.2), (-half, deep + 0.2, 0), f'Table(file: "{gates}")'),
        box("right_gate", (half, -0.2, -0.2), (wide + 0.2, deep + 0.2, 0), f'Table(file: "{gates}")'),
        box("left", (-wide - 0.2, -0.2, -1.2), (-wide, deep + 0.2, high)),
        box("right", (wide, -0.2, -1.2), (wide + 0.2, deep + 0.2, high)),
        box("front", (-wide - 0.2, -0.2, -1.2), (wide + 0.2, 0, high), material=sides),
        box("back", (-wide - 0.2, deep, -1.2), (wide + 0.2, deep + 0.2, high), material=sides),
    ])
    return f"""(
    title: "Heap of spheres, rolling resistance {rolling:g}, friction {sliding:g}",
    domain: (min: ({-wide - 0.2:g}, -0.2, -1), max: ({wide + 0.2:g}, {deep + 0.2:g}, {high:g})),
    materials: [
        (name: "grain", density: 2500, friction_angle_deg: {angle:.6g}, restitution: 0.3249, contact_stiffness: 1e6,
         shear_stiffness_ratio: 0.285714, rolling_friction: {rolling}),
        (name: "wall", density: 2500, friction_angle_deg: {angle:.6g}, restitution: 0.3249, contact_stiffness: 1e6,
         shear_stiffness_ratio: 0.285714),
        (name: "smooth", density: 2500, friction_angle_deg: 0, restitution: 0.3249, contact_stiffness: 1e6,
         shear_stiffness_ratio: 0.285714),
    ],
    joints: [
        (between: ("grain", "wall"), rolling_friction: {2 * rolling}),
        (between: ("grain", "smooth"), rolling_friction: 0),
    ],
    blocks: [
{blocks}
    ],
    grains: [(name: "grain", material: "grain", region: Box(min: ({-wide}, 0, {args.drop * D}), max: ({wide}, {deep}, {high})),
              diameter: ({D}, {D}), count: {n}, jitter: 0.02, seed: {args.seed})],
    numerics: (block_step_bound: Eigenvalues),
    time: (duration: {args.until}, stop_at_rest: (speed: 5e-3, time: 0.3)),
    output: (frame_interval: {args.until}, gauge_interval: 0.1, ledger_interval: 0.25),
)
"""


def run(args, rolling, sliding):
    """Folder and summary of a run."""
    name = f"heap_{rolling:g}_{sliding:g}_{args.plate:g}_{args.drop:g}_{args.seed}{'_smooth' * args.smooth}" + "".join(args.set)

    def prepare():
        gates = args.runs / "heap_gates.csv"
        ways = [(0, 0), (SHUT, 0), (SHUT + 0.4, -2), (1000, -2)]
        gates.write_text("time [s], x [m], y [m], z [m]\n" + "".join(f"{t}, 0, 0, {z}\n" for t, z in ways))
        return scene(rolling, sliding, args, gates.name), []

    return run_to_end(args, f"{name}_{args.until:g}s", prepare)


def last(folder):
    """Time of the last row (s), places of the spheres then (m) and the largest speed (m/s)."""
    rows, speeds, time = [], [], -1.0
    for row in read_rows(folder / "blocks.csv"):
        at = float(row["time [s]"])
        if at > time:
            time, rows, speeds = at, [], []
        rows.append(tuple(float(row[f"{axis} [m]"]) for axis in "xyz"))
        speeds.append(math.hypot(*(float(row[f"v{axis} [m/s]"]) for axis in "xyz")))
    return time, rows, max(speeds)


def flank(grains, side, half):
    """Angle of one side, NaN where nothing stays; degrees."""
    highest = {}
    for x, y, z in grains:
        if z > 0 and 1.5 * D < side * x < half - 1.5 * D:
            cell = (math.floor(side * x / D), math.floor(y / D))
            if cell not in highest or highest[cell][1] < z:
                highest[cell] = (side * x, z)
    points = list(highest.values())
    slopes = [(b[1] - a[1]) / (b[0] - a[0]) for k, a in enumerate(points) for b in points[k + 1 :] if abs(b[0] - a[0]) > 0.5 * D]
    return math.degrees(math.atan(-statistics.median(slopes))) if slopes else math.nan


def main():
    """The table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--riprap", default="target/release/riprap")
    parser.add_argument("--runs", default="runs/benches/heaps", type=Path)
    parser.add_argument("--pairs", default=PAIRS, help="rolling and sliding, MU_R:MU_S by comma")
    parser.add_argument("--plate", default=20, type=float, help="d")
    parser.add_argument("--drop", default=0, type=float, help="gap below the spheres at the start; d")
    parser.add_argument("--smooth", action="store_true", help="front and back without friction, as in a slice of a long heap")
    parser.add_argument("--until", default=8, type=float, help="s")
    parser.add_argument("--seed", default=1, type=int)
    parser.add_argument("--threads", default=1, type=int)
    parser.add_argument("--set", nargs="*", action="extend", default=[])
    args = parser.parse_args()
    table([[
        "rolling", "sliding", "fit [deg]", "measured: left, right [deg]", "minus fit",
        "spheres on the plate", "ends at [s]", "fastest then [m/s]", "wall [s]",
    ]])
    for pair in args.pairs.split(","):
        rolling, sliding = map(float, pair.split(":"))
        folder, summary = run(args, rolling, sliding)
        time, grains, fastest = last(folder)
        half = 0.5 * args.plate * D
        left, right = (flank(grains, side, half) for side in (-1, 1))
        on_plate = sum(z > 0 and abs(x) < half for x, _, z in grains)
        fit = 151.7 * math.sqrt(rolling * sliding)
        mean = 0.5 * (left + right)
        print(
            f"| {rolling:g} | {sliding:g} | {fit:.1f} | {mean:.1f}: {left:.1f}, {right:.1f} | {mean - fit:+.1f} | {on_plate} |"
            f" {time:.2f} | {fastest:.0e} | {summary['wall_time']:.0f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
