#!/usr/bin/env python3
"""The wave of the fjord 2 km from its slide, by GeoClaw and by linear waves, handed over at several instants.

    CLAW=... FC=gfortran python3 benches/python/far_field.py runs/far [SPACING]

CLAW is a source folder of Clawpack 5.14 (its archive on PyPI has GeoClaw), whose Python package must be importable. The near field is
cases/fjord_rockslide.ron, run from instant to instant in the folder given, at 15 m unless a spacing is given; the far field is the fjord
of cases/fjord.py, 7.2 km long. Prints the leading crest at 2 km and its time for each instant and solver.
"""

import csv
import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PLACE = (0.0, 2000.0)  # of the gauge, in the scene's coordinates
HALF_LENGTH = 3600.0
WIDTH = (-900.0, 900.0)
TOPOGRAPHY_CELL = 25.0  # coarser than the hand-off, whose ground counts where it is
CELL = 10.0
UNTIL = 130.0
TIMES = (28, 32, 36, 40)  # of hand-off; s


def module(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


def write_topography(path, fjord):
    """The whole fjord as topotype 3, in map coordinates."""
    margin = 2 * TOPOGRAPHY_CELL
    n = [
        round((2 * side + 2 * margin) / TOPOGRAPHY_CELL) + 1
        for side in (0.5 * (WIDTH[1] - WIDTH[0]), HALF_LENGTH)
    ]
    corner = (WIDTH[0] - margin, -HALF_LENGTH - margin)
    with open(path, "w") as file:
        file.write(f"{n[0]} ncols\n{n[1]} nrows\n{corner[0] + fjord.ORIGIN[0]} xllcenter\n")
        file.write(f"{corner[1] + fjord.ORIGIN[1]} yllcenter\n{TOPOGRAPHY_CELL} cellsize\n-9999 nodata_value\n")
        for j in reversed(range(n[1])):
            heights = (fjord.height(corner[0] + i * TOPOGRAPHY_CELL, corner[1] + j * TOPOGRAPHY_CELL) for i in range(n[0]))
            file.write(" ".join(f"{z:.3f}" for z in heights) + "\n")


def geoclaw(folder, fjord):
    """Carries a hand-off on; times and surface of the gauge."""
    setrun = module(folder / "setrun.py").setrun
    here = Path.cwd()
    os.chdir(folder)
    try:
        write_topography("fjord.tt3", fjord)
        data = setrun()
        claw = data.clawdata
        low = (WIDTH[0] + fjord.ORIGIN[0], -HALF_LENGTH + fjord.ORIGIN[1])
        claw.lower[:] = low
        claw.upper[:] = [WIDTH[1] + fjord.ORIGIN[0], HALF_LENGTH + fjord.ORIGIN[1]]
        claw.num_cells[:] = [round((WIDTH[1] - WIDTH[0]) / CELL), round(2 * HALF_LENGTH / CELL)]
        claw.tfinal = UNTIL
        claw.num_output_times = 1
        data.topo_data.topofiles.insert(0, [3, "fjord.tt3"])
        x, y = (PLACE[k] + fjord.ORIGIN[k] for k in range(2))
        data.gaugedata.gauges.append([1, x, y, 0.0, 1e10])
        data.write()
        with open("make.log", "w") as log:
            subprocess.run(["make", ".exe"], check=True, stdout=log, stderr=subprocess.STDOUT)
            os.makedirs("_output", exist_ok=True)
            for name in Path().glob("*.data"):
                name.rename(Path("_output") / name)
            subprocess.run([str(Path("xgeoclaw").resolve())], cwd="_output", check=True, stdout=log, stderr=subprocess.STDOUT)
        rows = []
        for line in open("_output/gauge00001.txt"):
            if not line.startswith("#"):
                words = line.split()
                rows.append((float(words[1]), float(words[5])))
        return rows
    finally:
        os.chdir(here)


def linear(folder):
    """Times and surface of the gauge by linear waves over the mean depth, without shores."""
    with open(folder / "look.csv") as file:
        return [(float(row["time [s]"]), float(row["at_1 [m]"])) for row in csv.DictReader(file)]


def crest(rows):
    """Time and height of the leading crest: the first maximum above half of the largest."""
    largest = max(z for _, z in rows)
    for before, here, after in zip(rows, rows[1:], rows[2:]):
        if 0.5 * largest < here[1] and before[1] <= here[1] > after[1]:
            return here
    return max(rows, key=lambda row: row[1])


def main():
    run = Path(sys.argv[1])
    spacing = sys.argv[2] if 2 < len(sys.argv) else "15"
    program = os.environ.get("RIPRAP", str(ROOT / "target/release/riprap"))
    fjord = module(ROOT / "cases/fjord.py")
    columns = "hand-off [s],r_h [-],kd [-],quality [-],advice"
    print(columns + ",GeoClaw: crest [m],at [s],linear: crest [m],at [s]", flush=True)
    for k, until in enumerate(TIMES):
        command = [program, "run", str(ROOT / "cases/fjord_rockslide.ron"), "-o", str(run), "--until", str(until)]
        command += ["--set", f"fluid.resolution=Spacing({spacing})"]
        with open(f"{run}.log", "a") as log:
            subprocess.run(command + (["--resume"] if k else []), check=True, stdout=log, stderr=log)
            folder = Path(f"{run}_{until}")
            command = [program, "handoff", str(run), "-o", str(folder), "--format", "geoclaw", "--look", str(UNTIL - until)]
            subprocess.run(command + ["--at", f"{PLACE[0]},{PLACE[1]}"], check=True, stdout=log, stderr=log)
        numbers = json.loads((folder / "handoff.json").read_text())
        fit = numbers["fitness"]
        words = [f"{numbers['time_s']:.2f}"] + [f"{fit[key]:.2f}" for key in ("column_share", "kd", "quality")]
        words.append(fit["advice"])
        for time, height in (crest(geoclaw(folder / "geoclaw", fjord)), crest(linear(folder))):
            words += [f"{height:.3f}", f"{time:.1f}"]
        print(",".join(words), flush=True)


if __name__ == "__main__":
    main()
