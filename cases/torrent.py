#!/usr/bin/env python3
"""Channel and pebbles of torrent.ron; standard library only.

    python3 torrent.py blocks [seed]     the lines of torrent.ron between its two marks

A test holds the committed scene to this script. Lengths in meters; x runs down the channel, y across it, z up; x = 0 and z = 0 at the
upper lip of the upper tank.
"""

import math
import random
import sys

BANK = 2.5  # height of the banks, which rise 1:1
BOTTOM = -6.0  # of the ground
DIAMETER = 0.3
OFF_BED = 0.17  # of the centers at the start, at right angles to the bed
PITCH = 0.33
SHIFT = 0.01  # largest, of each center

# Bed along the channel: x, z. Half width 1.5.
UPSTREAM = [(-35.12, 1.672), (-23.0, 0.46), (0.0, 0.0)]
SILL = [(3.0, 0.0), (3.3, 0.0), (3.5, -2.0)]
DOWNSTREAM = [(9.5, -2.0), (60.0, -3.01)]
HALF_WIDTH = 1.5
# Tanks: opening from x to x at z, floor 0.2 inside of it on all sides, at z.
TANKS = {"upper_tank": (0.0, 3.0, 0.0, -0.5), "lower_tank": (3.5, 9.5, -2.0, -3.0)}
RIM = 0.2


def line(name, points):
    """A vertical prism with `points` (x, y, z) as its upper face."""
    corners = points + [(x, y, BOTTOM) for x, y, _ in points]
    text = ", ".join(f"({x:.9g}, {y:.9g}, {z:.9g})" for x, y, z in corners)
    return f'        (name: "{name}", material: "rock", motion: Fixed, shape: Hull(points: [{text}])),'


def bed(name, start, end):
    (x0, z0), (x1, z1) = start, end
    return line(name, [(x, y, z) for x, z in (start, end) for y in (-HALF_WIDTH, HALF_WIDTH)])


def banks(name, start, end):
    for side, sign in (("left", 1), ("right", -1)):
        feet = [(x, sign * HALF_WIDTH, z) for x, z in (start, end)]
        heads = [(x, y + sign * BANK, z + BANK) for x, y, z in feet]
        yield line(f"{name}_{side}_bank", feet + heads)


def reach(name, stations):
    for number, (start, end) in enumerate(zip(stations, stations[1:]), 1):
        yield bed(f"{name}_{number}", start, end)
        yield from banks(f"{name}_{number}", start, end)


def tank(name):
    x0, x1, top, floor = TANKS[name]
    inner = [(x0 + RIM, x1 - RIM), (-HALF_WIDTH + RIM, HALF_WIDTH - RIM)]
    outer = [(x0, x1), (-HALF_WIDTH, HALF_WIDTH)]
    yield line(f"{name}_floor", [(x, y, floor) for x in inner[0] for y in inner[1]])
    for end, side in ((0, "upstream"), (1, "downstream")):
        points = [(box[0][end], y, z) for box, z in ((outer, top), (inner, floor)) for y in box[1]]
        yield line(f"{name}_{side}_wall", points)
    for end, side in ((1, "left"), (0, "right")):
        points = [(x, box[1][end], z) for box, z in ((outer, top), (inner, floor)) for x in box[0]]
        yield line(f"{name}_{side}_wall", points)
    yield from banks(name, (x0, top), (x1, top))


def pebbles(seed):
    numbers = random.Random(seed)
    slope = (UPSTREAM[1][1] - UPSTREAM[0][1]) / (UPSTREAM[1][0] - UPSTREAM[0][0])
    for number in range(34 * 8 + 7 * 8):
        layer, rest = divmod(number, 34 * 8)
        row, column = divmod(rest, 8)
        x = UPSTREAM[1][0] - 0.70 - PITCH * row + numbers.uniform(-SHIFT, SHIFT)
        y = PITCH * (column - 3.5) + numbers.uniform(-SHIFT, SHIFT)
        z = UPSTREAM[1][1] + slope * (x - UPSTREAM[1][0])
        z += OFF_BED * math.hypot(1.0, slope) + PITCH * layer
        yield (
            f'        (name: "pebble_{number + 1:03}", material: "rock", '
            f"shape: Sphere(center: ({x:.6f}, {y:.6f}, {z:.6f}), radius: {DIAMETER / 2})),"
        )


def blocks(seed):
    yield from reach("channel", UPSTREAM)
    yield from tank("upper_tank")
    yield from reach("sill", SILL)
    yield from tank("lower_tank")
    yield from reach("outlet", DOWNSTREAM)
    yield from pebbles(seed)


if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1] != "blocks":
        sys.exit(__doc__)
    print("\n".join(blocks(int(sys.argv[2]) if 2 < len(sys.argv) else 1)))
