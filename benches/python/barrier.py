#!/usr/bin/env python3
"""Dry debris against slit and sectional barriers: largest forces against the published ones.

    python3 benches/python/barrier.py --riprap PATH --runs DIR [--rows OB3,VB7,F] [--until 1.9] [--scene="--seed 2 --jitter 0.002"]
        [--set FIELD=VALUE ...]
    python3 benches/python/barrier.py --riprap PATH --runs DIR --slopes 20,30,40 --openings closed,4,7
    python3 benches/python/barrier.py --riprap PATH --runs DIR --regimes --slopes 35,30 --openings 3,4,5,6,7,9 --until 20
    python3 benches/python/barrier.py --riprap PATH --runs DIR --downstream --until 5

Standard library only. Scenes from cases/barrier.py, with the arguments of --scene. Published: a doctoral thesis on debris flow against open
rigid barriers by coupled DEM-LBM, tables 7.2 to 7.4: largest force on the whole barrier (kN), its time (s), and largest force on a sphere of
the barrier during the impact (kN), one run each of another code. The second line has no published values but of a closed barrier beside
slits: about the same at every slope. The third runs until nothing moves any more, and compares the class of clogging with the text of
section 7.2 (with `--set "numerics.resting=(displacement: 3e-4, load: 0.05)" --set numerics.block_time_step_factor=1` in the least time, a few minutes of one core
a row up to 40); the fourth ranks the kinetic energy of the grains downstream by the law of table 7.5. Finished runs are reused, others resumed.
"""

import argparse
import math
import subprocess
import sys
from pathlib import Path

from rows import CASES, read_rows, run_to_end, table, unexplained

sys.path.insert(0, str(CASES))
from barrier import GRAVITY, HEIGHT, RADIUS, SECTIONAL

# Interval of means; s.
MEAN = 0.01
# Speed (m/s) below which nothing moves any more, and time (s) for which it must hold; a slice clogs once it is calm for 1 s.
REST = (0.005, 1.2)
# Table 7.5: mean kinetic energy downstream over the slope in degrees, alpha S/r + beta P/r, in units of its own.
ENERGY_LAW = {30: (0.95, -0.47), 35: (1.41, -0.85), 40: (1.91, -1.29)}
# Classes of section 7.2 for one slit in a barrier at right angles to the bed, over slope and opening; where its text has both, both.
CLASSES = {
    (30, 3): ["sudden"], (30, 4): ["sudden", "progressive"], (30, 5): ["sudden", "progressive"], (30, 6): ["late"],
    (30, 7): ["late", "progressive"], (30, 9): ["late"],
    (35, 3): ["sudden"], (35, 4): ["sudden"], (35, 5): ["progressive"], (35, 6): ["late"], (35, 7): ["late"], (35, 9): ["none"],
}
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
        settings = [f"time.duration={args.until}", f"output.frame_interval={args.until}", forces]
        if args.regimes:
            settings.append(f"time.stop_at_rest=(speed: {REST[0]}, time: {REST[1]})")
        return text, settings

    end = f"rest_or_{args.until:g}s" if args.regimes else f"{args.until:g}s"
    return run_to_end(args, "_".join([*scene, *args.set, end]).replace("--", ""), prepare)


def number(value):
    """Two digits; nothing where there is no value, as of an arrival that never was."""
    return "" if value is None else f"{value:.2f}"


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
        on_time += time is not None and abs(time - at) <= 0.25
        local += 0.5 <= on_cell / on_sphere <= 2.0
        print(
            f"| {name} | {force:g} | {largest:.1f} | {largest / force:.2f} | {mean:.1f} | {mean / force:.2f} | {at:g} | {number(time)} | "
            f"{number(arrival)} | {on_sphere:.2f} | {on_cell:.2f} | {100 * summary['barriers'][0]['passed_share']:.0f} % | "
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
    over = lambda force, first: number(force / first if first else None)
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
                f"| {slope} | {opening} | {largest:.1f} | {over(largest, first[0])} | {number(time)} | {mean:.1f} | "
                f"{over(mean, first[1])} | {number(arrival)} | {unexplained(summary):+.0e} |",
                flush=True,
            )


def carried_at_end(folder, slope, passed):
    """Mean force along the bed of the last second on all that carries grains, and the weight along it of those that have not passed; N."""
    rows = [(float(row["time [s]"]), float(row["walls.fx [N]"])) for row in read_rows(folder / "reactions.csv")]
    last = [force for time, force in rows if rows[-1][0] - 1.0 < time]
    masses = (float(row["mass [kg]"]) for row in read_rows(folder / "bodies.csv") if row["kind"] == "free")
    return math.fsum(last) / len(last), (math.fsum(masses) - passed) * GRAVITY * math.sin(math.radians(slope))


def regimes(args):
    """Classes of clogging, forces at rest."""
    table([[
        "slope", "opening over radius", "class", "published", "arch over height", "stopped after arrival [s]", "passed",
        "on the barrier at rest [kN]", "on all walls [kN]", "weight along the bed [kN]", "largest step over that at rest", "end [s]",
        "unexplained", "wall [s]",
    ]])
    right = n = 0
    for slope in (args.slopes or "35,30").split(","):
        for opening in args.openings.split(","):
            folder, summary = run(args, f"slit {opening} --slope {slope}")
            barrier = summary["barriers"][0]
            found = barrier["openings"][0] if barrier["openings"] else {"clogging": "closed", "arch_height": math.nan, "stop_time": None}
            asked = CLASSES.get((float(slope), float(opening)) if barrier["openings"] else None, [])
            n += bool(asked)
            right += found["clogging"] in asked
            stopped = None if found["stop_time"] is None else found["stop_time"] - barrier["solid"]["first_arrival"]
            largest, at_rest = barrier["solid"]["largest"], barrier["solid"]["at_rest"]
            carried, along = carried_at_end(folder, float(slope), barrier["passed_mass"])
            print(
                f"| {slope} | {opening} | {found['clogging']} | {' or '.join(asked)} | {found['arch_height'] / HEIGHT:.2f} | "
                f"{number(stopped)} | {100 * barrier['passed_share']:.0f} % | {at_rest / 1e3:.1f} | {carried / 1e3:.1f} | "
                f"{along / 1e3:.1f} | {number(largest / at_rest if at_rest else None)} | {summary['simulated_time']:.1f} | {unexplained(summary):+.0e} | "
                f"{summary['wall_time']:.0f} |",
                flush=True,
            )
    print(f"\n{right} of {n} of the published class")


def ranks(values):
    """Places of values in ascending order, means of equal ones."""
    ordered = sorted(values)
    return [ordered.index(value) + 0.5 * (ordered.count(value) - 1) for value in values]


def rank_correlation(a, b):
    """Spearman's."""
    a, b = ranks(a), ranks(b)
    mean = 0.5 * (len(a) - 1)
    product = lambda a, b: sum((x - mean) * (y - mean) for x, y in zip(a, b))
    return product(a, b) / math.sqrt(product(a, a) * product(b, b))


def downstream(args):
    """Kinetic energy behind sectional barriers, against the law of table 7.5."""
    table([["slope", "row", "S/r", "P/r", "law", "mean kinetic energy downstream [kJ]", "largest [kJ]", "passed", "unexplained", "wall [s]"]])
    for slope in (args.slopes or "35").split(","):
        alpha, beta = ENERGY_LAW[int(slope)]
        laws, energies = [], []
        for name, (_, pile, opening) in SECTIONAL.items():
            folder, summary = run(args, f"sectional {name} --slope {slope}")
            barrier = summary["barriers"][0]
            arrival = barrier["solid"]["first_arrival"]
            rows = read_rows(folder / "barrier_barrier.csv")
            energy = [float(row["downstream.kinetic [J]"]) / 1e3 for row in rows if arrival <= float(row["time [s]"])]
            laws.append(alpha * opening + beta * pile / RADIUS)
            energies.append(math.fsum(energy) / len(energy))
            print(
                f"| {slope} | {name} | {opening} | {pile / RADIUS:g} | {laws[-1]:.1f} | {energies[-1]:.1f} | {max(energy):.1f} | "
                f"{100 * barrier['passed_share']:.0f} % | {unexplained(summary):+.0e} | {summary['wall_time']:.0f} |",
                flush=True,
            )
        print(f"\nRank correlation on {slope} degrees: {rank_correlation(laws, energies):.2f}")


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
    parser.add_argument("--regimes", action="store_true", help="of these slits, until nothing moves any more, at most --until")
    parser.add_argument("--downstream", action="store_true", help="kinetic energy behind the sectional barriers")
    args = parser.parse_args()
    if args.regimes:
        regimes(args)
    elif args.downstream:
        downstream(args)
    elif args.slopes:
        slopes(args)
    else:
        published(args)


if __name__ == "__main__":
    main()
