#!/usr/bin/env python3
"""Two hundred hulls on a slope, by springs and by contact dynamics: center of mass, run-out and cost over draws of the hulls.

    python3 benches/python/hulls.py --riprap PATH --runs DIR [--settings "NAME;..."] [--seeds 1,2,3] [--table-only]

Standard library only. The case is benches/trade/cases/hulls_on_slope.ron, its hulls are those of hulls_on_slope.py. Values are means over
draws with their standard deviation; differences are to the mean of the runs by springs with the same hulls, with the standard error of
their mean. Cost is processor time of one thread, from start to end of the run, over the simulated time. Existing runs are reused.
"""

import argparse
import csv
import json
import math
import os
import statistics
import subprocess
import sys
from pathlib import Path

CASES = Path(__file__).resolve().parents[1] / "trade" / "cases"
END = 4.0  # s, when the center of mass is at rest within centimeters
EARLY = 2.0  # s, while most hulls move
REFERENCE = ("springs 2.5e7", "springs 1e8", "springs 1.6e9")
MATERIALS = ("rock", "side")


def springs(stiffness):
    """Settings of a run by springs."""
    return ["numerics.blocks=CentralDifference"] + [
        f"materials.{name}.contact_stiffness={stiffness}" for name in MATERIALS
    ]


def dynamics(step, *more):
    """Settings of a run by contact dynamics."""
    return [f"numerics.blocks=ContactDynamics({', '.join([f'time_step: {step}', *more])})"]


def restitution(value):
    """The same restitution of all materials."""
    return [f"materials.{name}.restitution={value}" for name in MATERIALS]


SETTINGS = {
    "springs 6.25e6": springs("6.25e6"),
    "springs 2.5e7": springs("2.5e7"),
    "springs 1e8": springs("1e8"),
    "springs 1.6e9": springs("1.6e9"),
    "20 ms": dynamics(0.02),
    "10 ms": dynamics(0.01),
    "5 ms": dynamics(0.005),
    "2 ms": dynamics(0.002),
    "1 ms": dynamics(0.001),
    "0.3 ms": dynamics(0.0003),
    "0.15625 ms": dynamics(0.00015625),
    "5 ms, 1e-2": dynamics(0.005, "tolerance: 0.9e-2"),
    "5 ms, 1e-3": dynamics(0.005, "tolerance: 1e-3"),
    "5 ms, 1e-6": dynamics(0.005, "tolerance: 1e-6"),
    "5 ms, sweeps": dynamics(0.005, "solver: GaussSeidel"),
    "5 ms, gradient": dynamics(0.005, "solver: Gradient"),
    "20 ms, 1e-2": dynamics(0.02, "tolerance: 0.9e-2"),
    "2 ms, 1e-2": dynamics(0.002, "tolerance: 0.9e-2"),
    "1 ms, 1e-2": dynamics(0.001, "tolerance: 0.9e-2"),
    # what a hit leaves
    "5 ms, restitution 0": dynamics(0.005) + restitution(0),
    "5 ms, restitution 0.4": dynamics(0.005) + restitution(0.4),
    "springs 1e8, restitution 0": springs("1e8") + restitution(0),
    "springs 1e8, restitution 0.4": springs("1e8") + restitution(0.4),
    "springs 1e8, shear 0.2": springs("1e8") + [f"materials.{name}.shear_stiffness_ratio=0.2" for name in MATERIALS],
    # as many sweeps a second in all
    "5 ms x 32": dynamics(0.005, "tolerance: 1e-9", "sweeps: 32", "solver: GaussSeidel"),
    "2.5 ms x 16": dynamics(0.0025, "tolerance: 1e-9", "sweeps: 16", "solver: GaussSeidel"),
    "1.25 ms x 8": dynamics(0.00125, "tolerance: 1e-9", "sweeps: 8", "solver: GaussSeidel"),
    "0.625 ms x 4": dynamics(0.000625, "tolerance: 1e-9", "sweeps: 4", "solver: GaussSeidel"),
    "0.3125 ms x 2": dynamics(0.0003125, "tolerance: 1e-9", "sweeps: 2", "solver: GaussSeidel"),
    "0.15625 ms x 1": dynamics(0.00015625, "tolerance: 1e-9", "sweeps: 1", "solver: GaussSeidel"),
}


def scene(args, seed):
    """The case with other hulls."""
    path = args.runs / f"hulls_{seed}.ron"
    if not path.exists():
        text = (CASES / "hulls_on_slope.ron").read_text()
        made = subprocess.run(
            [sys.executable, CASES / "hulls_on_slope.py", str(seed)], check=True, capture_output=True, text=True
        ).stdout
        mark = "        // from hulls_on_slope.py\n"
        start, end = text.index(mark) + len(mark), text.index("        // to here")
        path.write_text(text[:start] + made + text[end:])
    return path


def run(args, name, seed):
    """Folder of a run, which may have failed; None if it is not there."""
    folder = args.runs / f"hulls_{name}_{seed}".replace(",", "").replace(" ", "_")
    done = folder / "ended"
    if not done.exists() and not args.table_only:
        args.runs.mkdir(parents=True, exist_ok=True)
        command = [args.riprap, "run", str(scene(args, seed)), "-o", str(folder), "--force", "--quiet", "--no-report"]
        command += ["--threads", "1"]
        for one in [f"time.duration={END}", f"output.frame_interval={END}", *SETTINGS[name]]:
            command += ["--set", one]
        with open(f"{folder}.log", "w") as log:
            to_log = [(os.POSIX_SPAWN_DUP2, log.fileno(), descriptor) for descriptor in (1, 2)]
            child = os.posix_spawn(args.riprap, command, os.environ, file_actions=to_log)
            _, status, used = os.wait4(child, 0)
        done.write_text(f"{os.waitstatus_to_exitcode(status)} {used.ru_utime + used.ru_stime:.3f}\n")
    return folder if done.exists() else None


def at(rows, time, column):
    """Value of a column at a time, interpolated."""
    for before, after in zip(rows, rows[1:]):
        early, late = float(before["time [s]"]), float(after["time [s]"])
        if time <= late + 1e-6:
            share = (time - early) / (late - early)
            return float(before[column]) + share * (float(after[column]) - float(before[column]))
    raise ValueError(f"no row at {time} s")


def far(folder, share):
    """x that this share of the mass has not passed at the end; m."""
    with open(folder / "bodies.csv") as file:
        mass = {row["name"]: float(row["mass [kg]"]) for row in csv.DictReader(file)}
    with open(folder / "blocks.csv") as file:
        rows = [row for row in csv.DictReader(file) if float(row["time [s]"]) < END + 0.05]
    last = {row["name"]: float(row["x [m]"]) for row in rows}
    total, passed = sum(mass[name] for name in last), 0.0
    for name in sorted(last, key=last.get):
        passed += mass[name]
        if share * total <= passed:
            return last[name]
    return math.nan


def measured(folder):
    """Quantities of a run; None if it did not reach its end."""
    code, processor = (folder / "ended").read_text().split()
    if code != "0":
        return None
    summary = json.loads((folder / "summary.json").read_text())
    with open(folder / "masses.csv") as file:
        rows = list(csv.DictReader(file))
    solution = summary.get("contact_solution") or {}
    return {
        "x2": at(rows, EARLY, "hulls.x [m]"),
        "x": at(rows, END, "hulls.x [m]"),
        "z": at(rows, END, "hulls.z [m]"),
        "x95": far(folder, 0.95),
        "left": 200 - float(rows[-1]["hulls.blocks [-]"]),
        "cost": float(processor) / END,
        "steps": summary["steps"],
        "sweeps": solution.get("mean_sweeps", math.nan),
        "unsolved": solution.get("unsolved_steps", 0),
        "overlap": summary["max_block_overlap_over_size"],
    }


def stopped(folder):
    """The last words of a run that did not reach its end."""
    lines = [line.strip() for line in Path(f"{folder}.log").read_text().splitlines() if line.strip()]
    return next((line for line in lines if "error" in line), lines[-1] if lines else "no message")


def told(values):
    """Mean and standard deviation."""
    if len(values) < 2:
        return f"{values[0]:.2f}"
    return f"{statistics.mean(values):.2f} ± {statistics.stdev(values):.2f}"


def difference(found, reference, key):
    """Mean difference of the same draws in mm, with the standard error of the mean."""
    values = [1000 * (found[seed][key] - reference[seed][key]) for seed in found if seed in reference]
    if not values:
        return ""
    if len(values) < 2:
        return f"{values[0]:+.0f}"
    return f"{statistics.mean(values):+.0f} ± {statistics.stdev(values) / math.sqrt(len(values)):.0f}"


def by_springs(all_found, seeds):
    """Mean of the runs by springs of each draw: stiffness matters less than chance."""
    reference = {}
    for seed in seeds:
        runs = [all_found[name][seed] for name in REFERENCE if seed in all_found.get(name, {})]
        if runs:
            reference[seed] = {key: statistics.mean(one[key] for one in runs) for key in ("x2", "x", "z", "x95")}
    return reference


def main():
    """The table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--riprap", default="target/release/riprap")
    parser.add_argument("--runs", default="runs/benches", type=Path)
    parser.add_argument("--settings", default=";".join(SETTINGS), help="names of settings, by semicolon")
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--table-only", action="store_true", help="no runs: the table of those that are there")
    args = parser.parse_args()
    args.runs.mkdir(parents=True, exist_ok=True)
    seeds, names = [int(seed) for seed in args.seeds.split(",")], args.settings.split(";")
    all_found, ends = {}, {}
    for name in names:
        for seed in seeds:
            folder = run(args, name, seed)
            values = folder and measured(folder)
            if values:
                all_found.setdefault(name, {})[seed] = values
            elif folder:
                ends.setdefault(name, []).append(stopped(folder))
    reference = by_springs(all_found, seeds)
    print("| setting | draws | x at 2 s, less that by springs [mm] | x, z at 4 s [m] | less those by springs [mm] | 95 % x [m] "
          "| steps | sweeps, unsolved | overlap | s a second | over 5 ms |")
    print("|---" * 11 + "|")
    unit = {seed: one["cost"] for seed, one in all_found.get("5 ms", {}).items()}
    for name in names:
        found = all_found.get(name)
        for message in ends.get(name, []):
            print(f"{name}: stopped: {message}", file=sys.stderr)
        if not found:
            continue
        of = lambda key: [one[key] for one in found.values()]
        swept = f"{statistics.mean(of('sweeps')):.1f}, {max(of('unsolved')):.0f}" if math.isfinite(of("sweeps")[0]) else ""
        ratios = [one["cost"] / unit[seed] for seed, one in found.items() if seed in unit]
        cells = [
            name,
            str(len(found)),
            f"{told(of('x2'))}, {difference(found, reference, 'x2')}",
            f"{told(of('x'))}, {told(of('z'))}",
            f"{difference(found, reference, 'x')}, {difference(found, reference, 'z')}",
            told(of("x95")),
            f"{statistics.mean(of('steps')):.0f}",
            swept,
            f"{max(of('overlap')):.3f}",
            f"{statistics.mean(of('cost')):.2f}",
            f"{statistics.mean(ratios):.2f}" if ratios else "",
        ]
        print("| " + " | ".join(cells) + " |", flush=True)
        if any(of("left")):
            print(f"{name}: blocks left: {of('left')}", file=sys.stderr)


if __name__ == "__main__":
    main()
