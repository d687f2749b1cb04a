#!/usr/bin/env python3
"""The pile of cubes, the paddle's records and the scene of breakwater.ron; standard library only.

    python3 breakwater.py pile > pile.ron                               cubes above the slope, dry
    riprap run pile.ron -o pile                                         lowers them
    python3 breakwater.py scene pile/blocks_00010.vtp > breakwater.ron  the scene, cubes where they came to rest
    python3 breakwater.py paddle 0.6 > breakwater_paddle.csv            wave of 0.6 depths
    python3 breakwater.py paddle 0.15 > breakwater_paddle_low.csv

Cubes are lowered in four lots, each a checkerboard of its layer, so that none touches another before it lands. Their
final orientations are read from their corners, in any order.
"""

import math
import random
import re
import struct
import sys
import zlib
from pathlib import Path

# edge of a cube as it is lowered, still-water depth, width of the flume; m
EDGE = 0.06
DEPTH = 0.42
WIDTH = 0.54
SLOPE = math.atan(1 / 1.5)
# along and across the slope: 1.17 cubes per edge squared in two layers, a porosity of 47 % in a thickness of 2.2 edges
ROWS, COLUMNS = 23, 7
PITCH = 1.33 * EDGE
# positions of the paddle and of the end of the slope; m
PADDLE, CREST = -2.16, 1.08
GRAVITY = 9.81
# where the tails of the wave are truncated: 3 % of its height, a third of a spacing
FADE = 2.5


def on_slope(along, above):
    """A point by its way up the slope from the toe and its distance from it; x, z in m."""
    return (along * math.cos(SLOPE) - above * math.sin(SLOPE), along * math.sin(SLOPE) + above * math.cos(SLOPE))


def times(p, q):
    """Product of two rotations, quaternions with the real part first."""
    (a, b, c, d), (e, f, g, h) = p, q
    return (a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g,
            a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e)


def turn(axis, angle):
    """Quaternion of a rotation."""
    return (math.cos(angle / 2), *(math.sin(angle / 2) * c for c in axis))


def axis_angle(q):
    """Axis and angle in degrees of a quaternion."""
    q = q if q[0] >= 0 else tuple(-c for c in q)
    length = math.hypot(*q[1:])
    return ((0, 0, 1), 0.0) if length == 0 else (tuple(c / length for c in q[1:]),
                                                 math.degrees(2 * math.atan2(length, q[0])))


def lots():
    """Positions and orientations from which the cubes are lowered: name, center, rotation."""
    draw = random.Random(1)
    placed = []
    for layer in range(2):
        for row in range(ROWS - layer):
            for column in range(COLUMNS):
                # the upper layer lies between the cubes of the lower one
                along = 0.8 * EDGE + (row + 0.5 * layer) * PITCH
                x, z = on_slope(along, (0.55 + 1.1 * layer) * EDGE)
                y = (column + 0.5) / COLUMNS * WIDTH
                lift = (0.5 if (row + column) % 2 == 0 else 2.1) + 2.8 * layer
                # the cubes of the lower layer are nearly aligned with their bed, those above are randomly oriented
                yaw, tilt = ((20, 10), (45, 15))[layer]
                flat = turn((0, 1, 0), -SLOPE)
                q = times(flat, turn((0, 0, 1), math.radians(draw.uniform(-yaw, yaw))))
                way = draw.uniform(0, math.tau)
                q = times(q, turn((math.cos(way), math.sin(way), 0), math.radians(draw.uniform(0, tilt))))
                # clear of the side walls, between which a cube at 45 degrees just fits
                y = min(max(y + draw.uniform(-0.1, 0.1) * EDGE, 0.8 * EDGE), WIDTH - 0.8 * EDGE)
                x += draw.uniform(-0.1, 0.1) * EDGE
                placed.append((f"armour_{len(placed) + 1:03}", (x, y, z + lift * EDGE), axis_angle(q)))
    return placed


def points_of(path):
    """Points of a .vtp file of riprap: the first array of its appended data, in blocks of zlib."""
    text = Path(path).read_bytes()
    array = re.search(rb"<Points>\s*<DataArray[^>]*>", text).group(0)
    kind = "f" if b'"Float32"' in array else "d"
    offset = int(re.search(rb'offset="(\d+)"', array).group(1))
    data = text.index(b"_", text.index(b"<AppendedData")) + 1 + offset
    n_blocks = struct.unpack_from("<Q", text, data)[0]
    sizes = struct.unpack_from(f"<{n_blocks}Q", text, data + 24)
    start, raw = data + 24 + 8 * n_blocks, b""
    for size in sizes:
        raw += zlib.decompress(text[start:start + size])
        start += size
    flat = struct.unpack(f"<{len(raw) // struct.calcsize(kind)}{kind}", raw)
    return list(zip(flat[::3], flat[1::3], flat[2::3]))


def attitude(corners):
    """Center of a cube and its rotation from an axis-aligned one."""
    center = tuple(sum(c) / 8 for c in zip(*corners))
    first = corners[0]
    edges = sorted((tuple(a - b for a, b in zip(c, first)) for c in corners[1:]), key=lambda e: math.hypot(*e))[:3]
    x, y, z = (tuple(c / math.hypot(*e) for c in e) for e in edges)
    if sum(a * b for a, b in zip((x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]), z)) < 0:
        x, y = y, x
    # the quaternion of the matrix with columns x, y, z, by its largest component
    trace = (x[0] + y[1] + z[2], x[0] - y[1] - z[2], y[1] - x[0] - z[2], z[2] - x[0] - y[1])
    largest = max(range(4), key=lambda k: trace[k])
    q = ((1 + trace[0], y[2] - z[1], z[0] - x[2], x[1] - y[0]), (y[2] - z[1], 1 + trace[1], y[0] + x[1], z[0] + x[2]),
         (z[0] - x[2], y[0] + x[1], 1 + trace[2], z[1] + y[2]), (x[1] - y[0], z[0] + x[2], z[1] + y[2], 1 + trace[3]))
    length = math.hypot(*q[largest])
    return center, axis_angle(tuple(c / length for c in q[largest]))


def rested(path):
    """Names, centers and orientations of the cubes of a frame of the dry scene."""
    points = points_of(path)
    names = [name for name, _, _ in lots()]
    if len(points) != 8 * len(names):
        sys.exit(f"{path} has {len(points)} points, expected 8 of each of {len(names)} cubes")
    return [(name, *attitude(points[8 * k:8 * k + 8])) for k, name in enumerate(names)]


def armour(cubes, edge):
    """Blocks of the scene; sealed; for the reason see the header of breakwater.ron."""
    half = 0.5 * edge
    shape = f"Box(min: (-{half:g}, -{half:g}, -{half:g}), max: ({half:g}, {half:g}, {half:g}))"
    for name, place, (axis, angle) in cubes:
        axis, place = (", ".join(f"{c:.7f}" for c in v) for v in (axis, place))
        yield (f'        (name: "{name}", material: "concrete", sealed: true, shape: {shape},\n'
               f"         placement: (rotate: (axis: ({axis}), angle_deg: {angle:.5f}), translate: ({place}))),")


def structure():
    """Core, toe and side walls."""
    top_x, top_z = CREST * 1.5, CREST
    shoulder, foot = on_slope(0, 2.1 * EDGE), -2.8 * EDGE
    return f"""\
        // slope of 1 : 1.5, extended below the floor so that its toe is not sharp
        (name: "core", material: "concrete", motion: Fixed, shape: Extrusion(axis: Y, from: 0, to: {WIDTH:g}, polygon: [
            (0, -0.1), ({top_x + 0.2:g}, -0.1), ({top_x + 0.2:g}, {top_z:g}), ({top_x:g}, {top_z:g}), (0, 0),
        ])),
        // supports two layers at their toe
        (name: "toe", material: "concrete", motion: Fixed, shape: Extrusion(axis: Y, from: 0, to: {WIDTH:g}, polygon: [
            (0, 0), ({shoulder[0]:.5f}, {shoulder[1]:.5f}), ({foot:g}, 0),
        ])),
        (name: "south", material: "glass", motion: Fixed, shape: Box(min: ({PADDLE - 0.3:g}, -0.1, 0), max: ({top_x + 0.2:g}, 0, 1.4))),
        (name: "north", material: "glass", motion: Fixed,
         shape: Box(min: ({PADDLE - 0.3:g}, {WIDTH:g}, 0), max: ({top_x + 0.2:g}, {WIDTH + 0.1:g}, 1.4))),"""


MATERIALS = """\
    materials: [
        (name: "concrete", density: 2400, friction_angle_deg: 40, contact_stiffness: 4e5),
        // side walls keep the cubes in the flume with little friction
        (name: "glass", density: 2500, friction_angle_deg: 2, contact_stiffness: 4e5),
    ],"""


def pile():
    """The dry scene in which the cubes are lowered."""
    return f"""\
// Cubes lowered onto a slope: the pile of breakwater.ron, by breakwater.py.
(
    title: "Cubes lowered onto a slope",
    domain: (min: ({PADDLE - 0.4:g}, -0.12, -0.12), max: (2, {WIDTH + 0.12:g}, 2)),
{MATERIALS}
    blocks: [
{structure()}
{chr(10).join(armour(lots(), EDGE))}
    ],
    // they sink at half a meter per second
    numerics: (static_damping: MassProportional(20), expected_speed: 0.5),
    time: (duration: 2.5),
    gauges: [Displaced(name: "off", blocks: "armour", farther_than: {6 * EDGE:g})],
    output: (frame_interval: 0.25, ledger_interval: 0.05),
)"""


def scene(cubes):
    """The scene, with the header of the file of the same name beside this program."""
    path = Path(__file__).with_suffix(".ron")
    head = "\n".join(line for line in (path.read_text() if path.exists() else "").split("(\n")[0].splitlines())
    return f"""\
{head}
(
    title: "Rubble-mound breakwater: cubes under a wave",
    description: "{len(cubes)} cubes in two layers on 1 : 1.5 under a solitary wave of 0.6 depths; how many it displaces, \
at least: water in the pores is missing.",
    domain: (min: ({PADDLE - 0.4:g}, -0.12, -0.12), max: (2, {WIDTH + 0.12:g}, 1.6)),
{MATERIALS}
    blocks: [
        (name: "paddle", material: "glass", shape: Box(min: ({PADDLE - 0.1:g}, 0, 0), max: ({PADDLE:g}, {WIDTH:g}, 1)),
         motion: Table(file: "breakwater_paddle.csv")),
        (name: "floor", material: "concrete", motion: Fixed,
         shape: Box(min: ({PADDLE - 0.3:g}, -0.1, -0.1), max: (0, {WIDTH + 0.1:g}, 0))),
{structure()}
{chr(10).join(armour(cubes, EDGE))}
    ],
    fluid: (
        resolution: Spacing(0.02),
        regions: [(name: "flume", shape: Below(level: {DEPTH:g}, seed: (-1, {WIDTH / 2:g}, 0.2)))],
    ),
    numerics: (expected_speed: {math.sqrt(GRAVITY * 1.6 * DEPTH):.2f}),
    time: (duration: 3.2, settle: 0.1),
    gauges: [
        SurfaceElevation(name: "incident", x: -0.5, y: {WIDTH / 2:g}),
        SurfaceElevation(name: "before_the_toe", x: -0.2, y: {WIDTH / 2:g}),
        SurfaceElevation(name: "over_the_slope", x: 0.3, y: {WIDTH / 2:g}),
        // blocks that rocked or settled, and those displaced by laboratory standards
        Displaced(name: "moved", blocks: "armour", farther_than: {0.1 * EDGE:g}),
        Displaced(name: "half", blocks: "armour", farther_than: {0.5 * EDGE:g}),
        Displaced(name: "displaced", blocks: "armour", farther_than: {EDGE:g}),
    ],
    output: (frame_interval: 0.1, gauge_interval: 0.01, ledger_interval: 0.05, water_fields: [Velocity, Pressure]),
    camera: (position: (-1.8, -2.2, 1.6), look_at: (0.4, 0.3, 0.35), field_of_view_deg: 45),
)"""


def paddle(ratio):
    """Rows of the paddle's record: solitary wave of `ratio` depths after Goring (1978), as in solitary.py."""
    height, rows = ratio * DEPTH, 200
    k = math.sqrt(0.75 * ratio / (1 + ratio))
    celerity = math.sqrt(GRAVITY * (DEPTH + height))
    half_stroke = height / k
    for row in range(rows + 1):
        theta = FADE * (2 * row / rows - 1)
        # from the start of the record, at which theta is -FADE
        x = half_stroke * (math.tanh(theta) + math.tanh(FADE))
        yield ((theta + FADE) * DEPTH / k + x) / celerity, x


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["pile"]:
            print(pile())
        case ["scene", frame]:
            print(scene(rested(frame)))
        case ["paddle", ratio]:
            print(f"# solitary wave of {ratio} depths of {DEPTH:g} m, Goring (1978) with Rayleigh's outskirts; breakwater.py")
            print("time [s], x [m], y [m], z [m]")
            for time, x in paddle(float(ratio)):
                print(f"{time:.6f}, {x:.7f}, 0, 0")
        case _:
            sys.exit(__doc__)
