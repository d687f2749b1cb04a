#!/usr/bin/env python3
"""Hulls of hulls_on_slope.ron; standard library only.

    python3 hulls_on_slope.py [SEED]     the lines of the scene between its two marks; seed 1 is that of the file

Each hull has the eight corners of a box of random size, each moved at random, in a random attitude. The centers of these boxes are on a
loose lattice above the slope, four across, ten along it and five above each other, each shifted at random. Lengths in meters; x runs
down and out of the slope from its toe, y across, z up.
"""

import math
import random
import sys

SLOPE = math.radians(35.0)
PITCH = 1.3  # of the lattice
ACROSS, ALONG, ABOVE = 4, 10, 5
WIDTH = 6.0  # between the side walls
NEAREST = 6.5  # lowest row from the toe, along the slope
HALF = (0.26, 0.46)  # half edges of the boxes
MOVED = 0.25  # of a corner, over its own place
RADIUS = 0.61  # at most, from the center: hulls of the lattice do not touch
SHIFT = 0.03


def attitude(draw):
    """Columns of a random rotation, from a unit quaternion."""
    while True:
        q = [draw.uniform(-1, 1) for _ in range(4)]
        norm = math.sqrt(sum(c * c for c in q))
        if 0.1 < norm <= 1:
            break
    w, x, y, z = (c / norm for c in q)
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def hull(draw, center):
    """Corners of a hull."""
    half = [draw.uniform(*HALF) for _ in range(3)]
    corners = [
        [side * length * (1 + draw.uniform(-MOVED, MOVED)) for side, length in zip(sides, half)]
        for sides in ((i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1))
    ]
    scale = min(1.0, RADIUS / max(math.hypot(*corner) for corner in corners))
    turn = attitude(draw)
    return [
        tuple(c + scale * sum(t * p for t, p in zip(row, corner)) for c, row in zip(center, turn)) for corner in corners
    ]


def hulls(seed):
    """Lines of the scene."""
    draw = random.Random(seed)
    number = 0
    for above in range(ABOVE):
        for along in range(ALONG):
            for across in range(ACROSS):
                s, n = NEAREST + PITCH * along, PITCH * (above + 0.5)
                place = (
                    -s * math.cos(SLOPE) + n * math.sin(SLOPE),
                    0.5 * WIDTH + PITCH * (across - 0.5 * (ACROSS - 1)),
                    s * math.sin(SLOPE) + n * math.cos(SLOPE),
                )
                center = [c + draw.uniform(-SHIFT, SHIFT) for c in place]
                number += 1
                points = ", ".join(f"({x:.3f}, {y:.3f}, {z:.3f})" for x, y, z in hull(draw, center))
                yield f'        (name: "hull.{number:03}", material: "rock", shape: Hull(points: [{points}])),'


if __name__ == "__main__":
    print("\n".join(hulls(int(sys.argv[1]) if 1 < len(sys.argv) else 1)))
