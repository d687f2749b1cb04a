"""Landslide tsunamis: comparison with formulas, convergence, sleeping water, and energy transfer.

    python3 benches/python/landslides.py [ROW ...] --riprap target/release/riprap --runs runs/landslides

Prints a table for each row: required, measured, CPU seconds. Existing runs are reused. Scenes are those of
`cases/` with some fields set, and a channel defined here. Needs only Python.

    still       fjord and reservoir without their slides, 60 s after settling: speed of the water over sqrt(g H), volume
    masses      a rigid, a jointed and a granular slide of equal mass and speed into a channel, against Heller & Hager (2010)
    spacings    the fjord at three spacings: first crest and run-up, with the grid convergence index
    sleeping    the fjord with and without sleep of water and blocks
    energy      balance of the potential energy of the slides
"""

import argparse
import csv
import itertools
import json
import math
import os
import subprocess
import sys
from pathlib import Path

from walls import print_walls

CASES = Path(__file__).resolve().parents[2] / "cases"
G = 9.81
ROWS = ["still", "masses", "spacings", "sleeping", "energy"]
COARSE = "fluid.resolution=Spacing(15)"


class Run:
    """A run folder and its CPU seconds."""

    def __init__(self, folder):
        self.folder = folder
        self.cpu = float((folder / "ended").read_text())
        self.summary = json.loads((folder / "summary.json").read_text())
        if not self.summary["completed"]:
            sys.exit(f"{folder}: {self.summary['stop_reason']}")

    def table(self, name):
        """Columns of one of its tables, by name without unit; empty cells are NaN."""
        with open(self.folder / name, newline="") as file:
            head, *rows = list(csv.reader(file))
        columns = zip(*([float(x) if x else math.nan for x in row] for row in rows))
        return {key.rsplit(" [", 1)[0]: list(column) for key, column in zip(head, columns)}


def run(args, name, case, *settings):
    """The run of a case, executed unless it exists."""
    folder = args.runs / name
    if not (folder / "ended").exists():
        command = [args.riprap, "run", str(case), "-o", str(folder), "--force", "--quiet", "--allow-outside"]
        for setting in settings:
            command += ["--set", setting]
        args.runs.mkdir(parents=True, exist_ok=True)
        before = os.times()
        done = subprocess.run(command, stderr=subprocess.PIPE, text=True)
        after = os.times()
        if not folder.is_dir() or not (folder / "summary.json").exists():
            sys.exit(f"{name}: {done.stderr}")
        used = after.children_user + after.children_system - before.children_user - before.children_system
        (folder / "ended").write_text(f"{used:.1f}\n")
    print_walls(name, folder)
    return Run(folder)


def table(head, rows):
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def highest(times, values):
    """The highest value and its time."""
    return max((value, time) for time, value in zip(times, values) if not math.isnan(value))


def first_crest(times, values, threshold):
    """The first maximum above a threshold followed by a drop of a tenth, and its time."""
    best = (-math.inf, math.nan)
    for time, value in zip(times, values):
        if value > best[0]:
            best = (value, time)
        elif best[0] > threshold and value < 0.9 * best[0]:
            break
    return best


# --- rows


def still(args):
    """Water at rest over terrain."""
    rows = []
    cases = [
        ("fjord_rockslide", 120.0, COARSE, "numerics=(expected_speed: 45)"),
        ("reservoir_overtopping", 70.0, "fluid.resolution=Spacing(7)", "numerics=(expected_speed: 40)"),
    ]
    calm = ["slides=[]", "joints=[]", "gauges=[]", "time.settle=30", "time.duration=60"]
    for (name, depth, spacing, awake), is_awake in itertools.product(cases, (True, False)):
        folder = f"still_{name}" + ("" if is_awake else "_asleep")
        made = run(args, folder, CASES / f"{name}.ron", spacing, *calm, *([awake] if is_awake else []))
        energy = made.table("energy.csv")
        mass = made.summary["fluid_mass"][0]
        speeds = [math.sqrt(2 * k / mass) / math.sqrt(G * depth) for k in energy["kinetic"]]
        sunk = (energy["potential"][-1] - energy["potential"][0]) / (mass * G)
        rows.append([
            name + ("" if is_awake else ", asleep as in the case"),
            f"{100 * speeds[0]:.2f}, {100 * max(speeds):.2f}, {100 * speeds[-1]:.2f} %",
            f"{sunk:+.3f} m",
            str(made.summary["particles_escaped"]),
            f"{made.cpu:.0f}",
        ])
    table(["still", "rms speed over sqrt(gH): start, most, end", "center of mass", "escaped", "cpu s"], rows)


# A channel of still water with a ramp, with the parameters of Heller & Hager in the range of their tests.
DEPTH, WIDTH, LENGTH, SPACING = 0.3, 0.16, 4.5, 0.02
ANGLE = math.radians(45)
SLIDE_LENGTH, THICKNESS, SPEED, ROCK = 0.4, 0.12, 2.5, 2500.0
BALL = 0.05
PLACES = {f"x{k}": 0.9 + 0.2 * k for k in range(13)}
SPLASH_ENDS = 2.2  # m; jets of jointed slides come down before, and gauges count them


def on_ramp(along, off):
    """A point by its distance up the ramp from the shoreline and its distance from the ramp; x and z in m."""
    return (-along * math.cos(ANGLE) + off * math.sin(ANGLE), along * math.sin(ANGLE) + off * math.cos(ANGLE))


def channel(slide):
    """The scene with a slide."""
    foot = DEPTH / math.tan(ANGLE)
    wall = f"(-2, {-DEPTH - 0.2}), ({foot}, {-DEPTH - 0.2}), ({foot}, {-DEPTH}), (-1.4, 1.4), (-2, 1.4)"
    return f"""(
    title: "a slide into a channel",
    domain: (min: (-1.9, 0, {-DEPTH - 0.1}), max: ({LENGTH}, {WIDTH}, 1.6)),
    materials: [
        (name: "rock", density: {ROCK}, friction_angle_deg: 34, restitution: 0.4, contact_stiffness: 2e5),
        (name: "ramp", density: 2500, friction_angle_deg: 24, restitution: 0.4, contact_stiffness: 2e5),
        (name: "glass", density: 2500, friction_angle_deg: 0, restitution: 0.4, contact_stiffness: 2e5),
    ],
    {slide}
        (name: "ramp", material: "ramp", motion: Fixed, shape: Extrusion(axis: Y, from: -0.1, to: {WIDTH + 0.1}, polygon: [{wall}])),
        (name: "floor", material: "ramp", motion: Fixed,
         shape: Box(min: ({foot}, -0.1, {-DEPTH - 0.2}), max: ({LENGTH + 0.2}, {WIDTH + 0.1}, {-DEPTH}))),
        (name: "south", material: "glass", motion: Fixed, shape: Box(min: (-2, -0.1, {-DEPTH - 0.2}), max: ({LENGTH + 0.2}, 0, 1.6))),
        (name: "north", material: "glass", motion: Fixed,
         shape: Box(min: (-2, {WIDTH}, {-DEPTH - 0.2}), max: ({LENGTH + 0.2}, {WIDTH + 0.1}, 1.6))),
        (name: "end", material: "glass", motion: Fixed,
         shape: Box(min: ({LENGTH}, -0.1, {-DEPTH - 0.2}), max: ({LENGTH + 0.2}, {WIDTH + 0.1}, 1.6))),
    ],
    fluid: (resolution: Spacing({SPACING}), regions: [(name: "channel", shape: Below(level: 0, seed: (3, {WIDTH / 2}, -0.1)))]),
    numerics: (expected_speed: 4),
    time: (duration: 1.6),
    gauges: [{", ".join(f'SurfaceElevation(name: "{name}", x: {x:.2f}, y: {WIDTH / 2})' for name, x in PLACES.items())}],
    masses: [(name: "slide", blocks: "slide")],
    output: (gauge_interval: 0.01, frame_interval: 0.1, water_fields: [Velocity]),
)
"""


def velocity():
    return f"({SPEED * math.cos(ANGLE):.6f}, 0, {-SPEED * math.sin(ANGLE):.6f})"


def rigid():
    """One block with its lower front edge at the shoreline."""
    corners = [on_ramp(0, 0), on_ramp(0, THICKNESS), on_ramp(SLIDE_LENGTH, THICKNESS), on_ramp(SLIDE_LENGTH, 0)]
    polygon = ", ".join(f"({x:.9f}, {z:.9f})" for x, z in corners)
    return f"""blocks: [
        (name: "slide", material: "rock", velocity: {velocity()}, shape: Extrusion(axis: Y, from: 0, to: {WIDTH}, polygon: [{polygon}])),"""


def jointed():
    """The same rock in 5 by 2 by 2 blocks, all with the speed of the slide."""
    blocks = []
    for i in range(5):
        for j in range(2):
            for k in range(2):
                along = [SLIDE_LENGTH * (i + step) / 5 for step in (0, 1)]
                off = [THICKNESS * (j + step) / 2 for step in (0, 1)]
                y = [WIDTH * (k + step) / 2 for step in (0, 1)]
                places = [(along[0], off[0]), (along[0], off[1]), (along[1], off[1]), (along[1], off[0])]
                polygon = ", ".join("({:.9f}, {:.9f})".format(*on_ramp(*place)) for place in places)
                blocks.append(f"""        (name: "slide.{i}{j}{k}", material: "rock", velocity: {velocity()},
         shape: Extrusion(axis: Y, from: {y[0]}, to: {y[1]}, polygon: [{polygon}])),""")
    return "blocks: [\n" + "\n".join(blocks)


def spheres():
    """Spheres of the same mass in rows of three by three, slightly apart."""
    volume = SLIDE_LENGTH * THICKNESS * WIDTH
    count = round(volume / (math.pi / 6 * BALL**3))
    pitch = 1.04 * BALL
    blocks = []
    for n in range(count):
        i, j, k = n // 9, n // 3 % 3, n % 3
        x, z = on_ramp(pitch * (i + 0.5), pitch * (j + 0.5))
        y = WIDTH / 2 + (k - 1) * pitch
        blocks.append(f"""        (name: "slide.{n}", material: "rock", velocity: {velocity()},
         shape: Sphere(center: ({x:.6f}, {y:.6f}, {z:.6f}), radius: {BALL / 2})),""")
    return "blocks: [\n" + "\n".join(blocks)


def masses(args):
    """Three kinds of slides into the channel."""
    froude = SPEED / math.sqrt(G * DEPTH)
    relative_mass = ROCK / 1000 * SLIDE_LENGTH * THICKNESS / DEPTH**2
    product = froude * math.sqrt(THICKNESS / DEPTH) * relative_mass**0.25 * math.sqrt(math.cos(6 / 7 * ANGLE))
    expected = 4 / 9 * product**0.8 * DEPTH
    rows = []
    for kind in (rigid, jointed, spheres):
        args.runs.mkdir(parents=True, exist_ok=True)
        case = args.runs / f"channel_{kind.__name__}.ron"
        case.write_text(channel(kind()))
        made = run(args, f"masses_{kind.__name__}", case)
        gauges = made.table("gauges.csv")
        crest, at = max((first_crest(gauges["time"], gauges[name], 0.01), x) for name, x in PLACES.items() if SPLASH_ENDS < x)
        mass = made.table("masses.csv")
        given = max(mass["water.work"])
        rows.append([
            kind.__name__,
            f"{crest[0] / DEPTH:.3f} at x = {at:.1f} m",
            f"{expected / DEPTH:.3f}, {100 * (crest[0] / expected - 1):+.0f} %",
            f"{given / (0.5 * ROCK * SLIDE_LENGTH * THICKNESS * WIDTH * SPEED**2):.2f}",
            f"{made.cpu:.0f}",
        ])
    head = [f"slide, P = {product:.2f}", "highest crest over depth", "formula, +-30 %", "work over kinetic energy at impact", "cpu s"]
    table(head, rows)


def spacings(args):
    """The fjord at three spacings that divide its depth, each about 1.4 times finer."""
    rows, found = [], []
    for spacing in (15, 10.909, 8):
        made = run(args, f"fjord_{spacing:g}", CASES / "fjord_rockslide.ron", f"fluid.resolution=Spacing({spacing})")
        gauges = made.table("gauges.csv")
        time = gauges["time"]
        numbers = [first_crest(time, gauges["near"], 3)[0], first_crest(time, gauges["middle"], 3)[0],
                   highest(time, gauges["run_up_opposite"])[0], highest(time, gauges["run_up_north"])[0]]
        found.append((spacing, numbers))
        rows.append([f"{spacing:g} m"] + [f"{x:.1f}" for x in numbers] + [f"{made.cpu:.0f}"])
    (coarse, of_coarse), (middle, of_middle), (fine, of_fine) = found
    uncertainty = []
    for a, b, c in zip(of_coarse, of_middle, of_fine):
        # observed order, limited to that of the scheme; grid convergence index of the finest, safety factor 1.25 (Roache 1994)
        ratio = math.log(middle / fine)
        order = abs(math.log(abs((a - b) / (b - c)))) / ratio if b != c and a != b else 1.0
        order = min(max(order, 0.5), 2.0)
        uncertainty.append(f"+-{1.25 * abs(b - c) / ((middle / fine) ** order - 1):.1f}")
    rows.append(["uncertainty of the finest"] + uncertainty + [""])
    table(["spacing", "crest `near` [m]", "crest `middle` [m]", "run-up opposite [m]", "run-up north [m]", "cpu s"], rows)


def slab(motion):
    """The blocks of the fjord with a slab, half of it in the ground, that moves down the western slope into the water."""
    down = math.radians(42)
    corners = []
    for along, off in ((0, -20), (0, 20), (-250, 20), (-250, -20)):
        corners.append((-450 + along * math.cos(down) + off * math.sin(down), -along * math.sin(down) + off * math.cos(down)))
    polygon = ", ".join(f"({x:.6f}, {z:.6f})" for x, z in corners)
    return f"""[(name: "ground", material: "ground", motion: Fixed, shape: Terrain),
        (name: "slab", material: "rock", motion: Table(file: "{motion}"), shape: Extrusion(axis: Y, from: -115, to: 115, polygon: [{polygon}]))]"""


def sleeping(args):
    """The fjord, coarse, with the open water asleep until a wave arrives, and all awake. The motion of the slide is prescribed, since the
    fall of hundreds of blocks depends on round-off, which changes crests by a twentieth."""
    stroke, takes, down = 170.0, 10.0, math.radians(42)
    args.runs.mkdir(parents=True, exist_ok=True)
    motion = (args.runs / "slab.csv").resolve()
    rows = []
    for n in range(401):
        way = 0.5 * stroke * (1 - math.cos(math.pi * min(n / 200, 1)))
        rows.append(f"{takes * n / 200:.3f}, {way * math.cos(down):.6f}, 0, {-way * math.sin(down):.6f}")
    motion.write_text("\n".join([*rows, "100, " + rows[-1].split(", ", 1)[1]]) + "\n")
    told = ["slides=[]", "joints=[]", f"blocks={slab(motion)}"]
    case = CASES / "fjord_rockslide.ron"
    awake = run(args, "awake_15", case, COARSE, *told, "numerics=(expected_speed: 45)")
    asleep = run(args, "asleep_15", case, COARSE, *told)
    rows = []
    highest_crest = 0.0
    for name in ("near", "middle", "far", "along"):
        crests = [first_crest(made.table("gauges.csv")["time"], made.table("gauges.csv")[name], 1)[0] for made in (awake, asleep)]
        highest_crest = max(highest_crest, crests[0])
        off = crests[1] - crests[0]
        of_crests = [f"{100 * off / crest:+.2f} %" for crest in (crests[0], highest_crest)]
        rows.append([name, f"{crests[0]:.2f}", f"{crests[1]:.2f}", *of_crests])
    rows.append(["share awake", "1", f"{asleep.summary['awake_share']:.2f}", "", ""])
    rows.append(["cpu s", f"{awake.cpu:.0f}", f"{asleep.cpu:.0f}", f"x {awake.cpu / asleep.cpu:.2f}", ""])
    table(["first crest [m]", "awake", "asleep", "off", "of the highest"], rows)


def energy(args):
    """Energy balance, relative to the potential energy lost by the slide."""
    rows = []
    for name, case, setting in [("fjord_15", "fjord_rockslide", COARSE), ("reservoir_7", "reservoir_overtopping", "fluid.resolution=Spacing(7)")]:
        made = run(args, name, CASES / f"{case}.ron", setting)
        mass, book = made.table("masses.csv"), made.table("energy.csv")
        lost = mass["slide.potential"][0] - mass["slide.potential"][-1]
        shares = [mass["water.work"][-1], book["friction"][-1], book["damping"][-1], mass["slide.kinetic"][-1], book["residual"][-1]]
        rows.append([name, f"{lost:.3e} J"] + [f"{100 * x / lost:.2f} %" for x in shares])
    table(["run", "lost in height", "work on water", "friction", "contact damping", "still moving", "unexplained"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", nargs="*", metavar="ROW", help=f"of {', '.join(ROWS)}; all when left out")
    parser.add_argument("--riprap", default="target/release/riprap", help="the program")
    parser.add_argument("--runs", default="runs/landslides", type=Path, help="folder of the runs")
    args = parser.parse_args()
    unknown = [row for row in args.rows if row not in ROWS]
    if unknown:
        parser.error(f"no row {', '.join(unknown)}; there are {', '.join(ROWS)}")
    for row in args.rows or ROWS:
        globals()[row](args)


if __name__ == "__main__":
    main()
