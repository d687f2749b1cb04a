#!/usr/bin/env python3
"""Speed of one run over the number of threads, by phase: a dam break of 50,000 and of a million particles, and the fjord.

    python3 benches/python/threads.py --riprap PATH --runs DIR [--threads 1,2,4] [--scenes small,fjord,large] [--repeat 1] [--csv FILE]

Standard library only. The fjord is brought to 20 s, when its wave crosses, with as many threads as there are, and continued from its
checkpoint for 2 s with each number of threads. Times are those of summary.json, output included, without set-up; of several repetitions the
fastest. Efficiency is the time of the fewest threads over the time, over the ratio of threads. The state at the end must have the same hash
for every number of threads.
"""

import argparse
import csv
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DAM_BREAK = ROOT / "benches/scenes/threads/dam_break.ron"
FJORD = ROOT / "cases/fjord_rockslide.ron"
SCENES = {
    "small": (DAM_BREAK, ["fluid.resolution=Spacing(0.0276)"], None, 0.4),
    "fjord": (FJORD, [], 20.0, 22.0),
    "large": (DAM_BREAK, ["fluid.resolution=Spacing(0.0102)"], None, 0.04),
}


def run(riprap, scene, settings, folder, threads, until, more=()):
    """One run, or the rest of one; its summary."""
    command = [riprap, "run", str(scene), "-o", str(folder), "--threads", str(threads), "--until", str(until)]
    command += ["--no-report", "--quiet", *more]
    for setting in settings:
        command += ["--set", setting]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")
    return json.loads((folder / "summary.json").read_text())


def timed(arguments, name, threads, repetition):
    """Seconds by phase of one run, and the hash of its end."""
    scene, settings, start, end = SCENES[name]
    folder = arguments.runs / f"{name}_{threads}"
    shutil.rmtree(folder, ignore_errors=True)
    before = {"wall_time": 0.0, "time_by_phase": {}, "steps": 0, "particle_steps": 0}
    more = []
    if start is not None:
        begun = arguments.runs / f"{name}_begun"
        if not begun.exists():
            run(arguments.riprap, scene, settings, begun, os.cpu_count(), start)
        # the checkpoint is of a time before its end: to just beyond that alone, and then as far as asked
        more = ["--resume"]
        shutil.copytree(begun, folder)
        before = run(arguments.riprap, scene, settings, folder, threads, start + 0.05, more)
        shutil.rmtree(folder)
        shutil.copytree(begun, folder)
    summary = run(arguments.riprap, scene, settings, folder, threads, end, more)
    phases = {
        phase: seconds - before["time_by_phase"].get(phase, 0.0)
        for phase, seconds in summary["time_by_phase"].items()
    }
    wall = summary["wall_time"] - before["wall_time"]
    return {
        "scene": name,
        "particles": summary["fluid_particles"],
        "threads": threads,
        "repetition": repetition,
        "steps": summary["steps"] - before["steps"],
        "particle_steps": summary["particle_steps"] - before["particle_steps"],
        "wall": wall,
        **phases,
        "rest": wall - sum(phases.values()),
        "hash": summary["state_hash"],
    }


def show(rows):
    """A table of one scene: seconds by phase, a column for each number of threads."""
    counts = [row["threads"] for row in rows]
    first = rows[0]
    print(f"\n{first['scene']}: {first['particles']} particles, {first['steps']} steps; seconds, and efficiency with {counts[-1]} threads")
    print(f"{'threads':>18}" + "".join(f"{n:9d}" for n in counts))
    phases = [key for key in first if key not in ("scene", "particles", "threads", "repetition", "steps", "particle_steps", "hash")]
    for phase in phases:
        seconds = [row[phase] for row in rows]
        efficiency = seconds[0] * counts[0] / (seconds[-1] * counts[-1]) if seconds[-1] > 0.0 else float("nan")
        print(f"{phase:>18}" + "".join(f"{t:9.3f}" for t in seconds) + f"   {efficiency:.2f}")
    print(f"{'times as fast':>18}" + "".join(f"{first['wall'] / row['wall']:9.2f}" for row in rows))
    print(f"{'output, % of wall':>18}" + "".join(f"{100 * row['output'] / row['wall']:9.2f}" for row in rows))
    print(f"{'1e6 part.-steps/s':>18}" + "".join(f"{row['particle_steps'] / row['wall'] / 1e6:9.2f}" for row in rows))
    if len({row["hash"] for row in rows}) != 1:
        sys.exit(f"{first['scene']}: the number of threads changes the result")


def main():
    """Runs, table, file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--riprap", default=str(ROOT / "target/release/riprap"))
    parser.add_argument("--runs", type=Path, required=True)
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--scenes", default="small,fjord,large")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--csv", type=Path)
    arguments = parser.parse_args()
    arguments.runs.mkdir(parents=True, exist_ok=True)
    rows = []
    for name in arguments.scenes.split(","):
        best = []
        for threads in map(int, arguments.threads.split(",")):
            tries = [timed(arguments, name, threads, k) for k in range(arguments.repeat)]
            best.append(min(tries, key=lambda row: row["wall"]))
        show(best)
        sys.stdout.flush()
        rows += best
        if arguments.csv:
            with open(arguments.csv, "w", newline="", encoding="utf-8") as file:
                table = csv.DictWriter(file, fieldnames=list(rows[0]))
                table.writeheader()
                table.writerows(rows)


if __name__ == "__main__":
    main()
