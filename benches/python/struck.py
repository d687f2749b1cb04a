#!/usr/bin/env python3
"""A square column struck by a bore, at three spacings: impulse, peaks, and forces against the momentum of the water.

    python3 benches/python/struck.py --riprap PATH --runs DIR [--spacings 0.02,0.014,0.01] [--settings SET ...]

Needs numpy and vtk. The case is benches/scenes/laboratory/struck_column.ron. Impulse: of the force of water on the column along the
tank, over the run. Peak: largest mean over 10 ms. Closure: largest difference, over the frames, of the momentum of the water and the
impulse of all walls, over the largest momentum. Order: of the impulse in the spacing, from all three.
"""

import argparse
import csv
import json
import math
import subprocess
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

CASE = Path(__file__).resolve().parents[1] / "scenes/laboratory/struck_column.ron"
# of the water; kg
MASS = 1000 * 0.3 * (0.4 * 0.3 + (1.2 - 0.06 * 0.12 / 0.3) * 0.04)
SOURCES = ("pressure", "shear", "joint_water", "pushed_back")


def forces(folder):
    """Ends of the intervals (s), and the force of water along the tank on each block by name (N)."""
    with open(folder / "forces.csv") as file:
        rows = list(csv.DictReader(file))
    time, found = [], {}
    for row in rows:
        if not time or row["time [s]"] != time[-1]:
            time.append(row["time [s]"])
        force = sum(float(row[f"{source}_fx [N]"]) for source in SOURCES)
        found.setdefault(row["name [-]" if "name [-]" in row else "name"], []).append(force)
    return np.array(time, float), {name: np.array(values) for name, values in found.items()}


def momentum(frame):
    """Momentum of the water of a frame along the tank; kg m/s."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(frame))
    reader.Update()
    velocity = vtk_to_numpy(reader.GetOutput().GetPointData().GetArray("Velocity")).astype(float)
    return MASS * float(velocity[:, 0].mean())


def measured(folder):
    """Impulse on the column (N s), its largest mean over 10 ms (N), closure."""
    time, found = forces(folder)
    steps = np.diff(time, prepend=0)
    gone = np.concatenate([[0], np.cumsum(found["struck"] * steps)])
    impulse = float(gone[-1])
    ends = np.concatenate([[0], time])
    starts = np.arange(0, time[-1] - 0.01, 0.001)
    means = (np.interp(starts + 0.01, ends, gone) - np.interp(starts, ends, gone)) / 0.01
    given = np.concatenate([[0], np.cumsum(sum(found.values()) * steps)])
    frames = json.loads((folder / "water.vtp.series").read_text())["files"]
    momenta = np.array([momentum(folder / frame["name"]) for frame in frames])
    taken = np.interp([frame["time"] for frame in frames], ends, given)
    return impulse, float(means.max()), float(np.abs(momenta + taken).max() / np.abs(momenta).max())


def main():
    """The table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--riprap", default="target/release/riprap")
    parser.add_argument("--runs", default="runs/benches", type=Path)
    parser.add_argument("--spacings", default="0.02,0.014,0.01")
    parser.add_argument("--settings", nargs="*", default=[])
    args = parser.parse_args()
    spacings = [float(one) for one in args.spacings.split(",")]
    impulses = []
    print("| spacing | impulse [N s] | largest 10-ms mean [N] | closure |\n|---|---|---|---|")
    for spacing in spacings:
        folder = args.runs / f"struck_{1000 * spacing:g}mm{''.join(args.settings)}".replace(" ", "")
        if not (folder / "summary.json").exists():
            command = [args.riprap, "run", str(CASE), "-o", str(folder), "--force", "--quiet", "--no-report"]
            for one in [f"fluid.resolution=Spacing({spacing})", *args.settings]:
                command += ["--set", one]
            subprocess.run(command, check=True)
        impulse, peak, closure = measured(folder)
        impulses.append(impulse)
        print(f"| {1000 * spacing:g} mm | {impulse:.3f} | {peak:.1f} | {closure:.4f} |", flush=True)
    if len(spacings) == 3:
        fit(spacings, impulses)


def fit(spacings, impulses):
    """Prints the order by which three impulses converge, if they do."""
    (a, b, c), (far, mid, near) = spacings, impulses
    ratio = (far - mid) / (mid - near)
    orders = np.linspace(0.1, 6, 591)
    off = [abs((a**p - b**p) / (b**p - c**p) - ratio) for p in orders]
    if ratio <= math.log(a / b) / math.log(b / c):
        print(f"no order: differences {far - mid:+.3f}, {mid - near:+.3f} N s, {100 * (mid / near - 1):+.1f} % of the finest")
        return
    p = orders[int(np.argmin(off))]
    if p in (orders[0], orders[-1]):
        print(f"no order: differences {far - mid:+.3f}, {mid - near:+.3f} N s")
        return
    limit = near - (mid - near) * c**p / (b**p - c**p)
    print(f"order {p:.1f}, limit {limit:.3f} N s, the finest {100 * (near / limit - 1):+.1f} % off it")


if __name__ == "__main__":
    main()
