#!/usr/bin/env python3
"""Scenes of the half ellipse of cases/landslide_flume.ron for eight of Sue's runs; standard library only.

    python3 ellipse.py FOLDER

Sue, Nokes & Walters (2006), Sci. Tsunami Hazards 24, 267-287, and Sue's thesis (Canterbury, NZ). SG1 to SG5 are specific
gravities of the block, IS5 to IS2 starts from shallow to deep. All is as in the case except the start and the motion of
the block: its speed along the bed is linear between knots fitted to each measured displacement, with the largest error of the
displacement up to 4.4 s noted. `free` writes the same block released on the ramp, with its base on it and water below its front.

The submergence published, d = 0.05 to 0.2 m, is said to be that of the center of mass; in the records it is that of the top
within 2 mm, for all starts. Blocks start at the start of their record.

Measured, walls of particles: crests and troughs mostly 10 to 40 % too high, those of the slowest block (SG1_IS5) up to 63 %,
arrival within 5 % except for that one (9 %) and the deepest start (15 %). SG1_IS5 with 7 mm for 10 mm: crests at 2.5 to 4.5 m
+30, +40, +45 % for +38, +55, +67 %, the trough at 2.5 m no better. After 1 s at rest: within 6 % of the same. SG3_IS5 with
a block 5 % flatter, so that its volume is the published one, 2.419 l, instead of that of half an ellipse: 5 to 8 % lower. Integrals
make waves 1 to 18 % higher than particles; penalty walls make troughs up to 168 % too deep.

Released, with water in the joint beneath it and a friction of 0.02 fitted to SG3_IS5, the block is within 4 % of its displacement
until 2.4 s; the same friction is 6 to 12 % short for SG2_IS5 from 0.8 s on. Its waves are too high by up to 53 %, and it lifts off
the bed by 6 to 17 mm on the bend and after. Sealed, with 0.008, it lags and stops at the end of the bend.
"""

import importlib.util
import math
import sys
from pathlib import Path

CASES = Path(__file__).resolve().parents[2] / "cases"
NUMBERS = importlib.util.spec_from_file_location("landslide_flume", CASES / "landslide_flume.py")

# middle of the base along the ramp, m; time and speed along the bed, s and m/s
MOTIONS = {
    # 5, 7, 6, 11, 17, 13, 6, 5 mm off
    "SG1_IS5": (0.2938, [(0, 0), (0.2, 0.173), (1, 0.686), (1.75, 0.971), (2.31, 0.669), (2.91, 0.779), (3.98, 0.636),
                         (4.76, 0.362), (6, 0)]),
    "SG2_IS5": (0.2965, [(0, 0), (0.68, 0.743), (1.45, 1.31), (1.73, 0.908), (2.23, 0.986), (2.88, 0.766), (3.11, 0.84),
                         (4.96, 0.326), (6, 0)]),
    # as in the case
    "SG3_IS5": None,
    "SG4_IS5": (0.2975, [(0, 0), (0.58, 0.835), (1.25, 1.647), (1.42, 1.282), (1.71, 1.369), (3.02, 0.75), (3.84, 0.572),
                         (4.73, 0)]),
    "SG5_IS5": (0.2929, [(0, 0), (0.79, 1.201), (1.27, 1.664), (1.38, 1.324), (1.71, 1.39), (2.82, 0.946), (3.74, 0.591),
                         (4.82, 0.337), (6, 0)]),
    "SG3_IS3": (0.6762, [(0, 0), (0.57, 0.777), (1.1, 1.238), (1.28, 0.976), (1.83, 1.075), (2.55, 0.924), (2.9, 0.693),
                         (4.93, 0)]),
    "SG3_IS4": (0.4813, [(0, 0), (0.63, 0.853), (1.18, 1.394), (1.46, 1.01), (2.02, 1.126), (3.29, 0.619), (3.45, 0.635),
                         (4.69, 0.102), (6, 0)]),
    "SG4_IS2": (0.8726, [(0, 0), (0.42, 0.653), (0.89, 1.184), (1.02, 1.034), (1.5, 1.104), (2.38, 0.897), (2.58, 0.769),
                         (4.73, 0)]),
}
# volume of the block over its width, as published; m2
SECTION = 2.419e-3 / 0.25


def flume(name, height=None):
    """Parameters and functions of landslide_flume.py, for another run, and another height of the block (m)."""
    module = importlib.util.module_from_spec(NUMBERS)
    NUMBERS.loader.exec_module(module)
    module.HEIGHT = height or module.HEIGHT
    if MOTIONS[name]:
        module.START, module.KNOTS = MOTIONS[name]
    return module


def table(module):
    """The prescribed motion."""
    middle, first = module.centroid(module.outline()), None
    rows = ["time [s], x [m], y [m], z [m], rx [deg], ry [deg], rz [deg]"]
    for time, pose in module.poses():
        x, z = module.place(middle, pose)
        first = first or (x, z, pose[2])
        turn = math.degrees(pose[2] - first[2])
        rows.append(f"{time:.2f}, {x - first[0]:.6f}, 0, {z - first[1]:.6f}, 0, {turn:.4f}, 0")
    return "\n".join(rows) + "\n"


def polygon(corners):
    """Polygon in the format of a scene."""
    return "[" + ", ".join(f"({x:.5f}, {z:.5f})" for x, z in corners) + "]"


def text(name, block):
    """The scene with another block."""
    scene = (CASES / "landslide_flume.ron").read_text()
    start = scene.index('        (name: "block"')
    end = scene.index("    ],\n    fluid:")
    return f"// {name}, by benches/python/ellipse.py\n" + scene[:start] + block + scene[end:]


def prescribed(name, folder, height=None):
    """Writes scene and measured motion of one run; returns the scene's path."""
    module = flume(name, height)
    start = next(module.poses())[1]
    corners = polygon(module.place(corner, start) for corner in module.outline())
    (folder / f"ellipse_{name}.csv").write_text(table(module))
    path = folder / f"ellipse_{name}.ron"
    path.write_text(text(name, f"""        (name: "block", material: "aluminium", motion: Table(file: "ellipse_{name}.csv"),
         shape: Extrusion(axis: Y, from: -0.05, to: 0.3, polygon: {corners})),
"""))
    return path


def free(name, folder, friction, sealed):
    """Writes the scene of one run with the block released; returns its path."""
    module = flume(name)
    start = next(module.poses())[1]
    outline = module.outline()[1:-1]
    area = sum(x0 * z1 - x1 * z0 for (x0, z0), (x1, z1) in zip(outline, outline[1:] + outline[:1])) / 2
    density = 1000 * {"SG1": 1.63, "SG2": 2.23, "SG3": 2.83, "SG4": 3.42, "SG5": 4.02}[name[:3]] * SECTION / abs(area)
    corners = polygon(module.place(corner, start) for corner in outline)
    kind = "sealed" if sealed else "open"
    path = folder / f"ellipse_free_{name}_{kind}_{friction:g}.ron"
    scene = text(name, f"""        (name: "block", material: "aluminium", sealed: {str(sealed).lower()},
         shape: Extrusion(axis: Y, from: 0, to: 0.25, polygon: {corners})),
""")
    angle = math.degrees(math.atan(friction))
    scene = scene.replace('"aluminium", density: 2700, friction_angle_deg: 30',
                          f'"aluminium", density: {density:.1f}, friction_angle_deg: {angle:.4f}')
    path.write_text(scene.replace("    output: (", "    forces: (interval: 0.01),\n    output: (ledger_interval: 0.01, "))
    return path


if __name__ == "__main__":
    target = Path(sys.argv[1])
    for run in MOTIONS:
        print(prescribed(run, target))
