#!/usr/bin/env python3
"""Terrain and boulders of rockfall.ron, from closed forms; standard library only.

    python3 rockfall.py grid > rockfall.asc     the terrain, an ESRI ASCII grid
    python3 rockfall.py boulders                the lines of rockfall.ron between its two marks

Edit a parameter and run both for another scene; a test holds the committed files to this script.
Lengths in meters. x runs down the slope, y across it, z up.
"""

import math
import sys

CELL = 2.5  # grid spacing
COLUMNS, ROWS = 97, 41  # x from 0 to 240, y from -50 to 50
HALF_WIDTH = 50.0

# The section along y = 0: where each stretch ends, and its slope in degrees, down if positive.
SECTION = [
    (16.0, 12.0),  # plateau
    (30.0, 42.0),  # head of the slope, where the boulders start
    (42.0, 68.0),  # cliff, 30 m high
    (84.0, 35.0),  # upper talus
    (94.0, 6.0),  # bench
    (126.0, 35.0),  # lower talus
    (176.0, 0.0),  # valley floor
    (240.0, -10.0),  # counter-slope
]
TOP = 100.0  # height at x = 0
# A break of slope is rounded over this length to either side.
ROUNDING = 4.0


def bend(d):
    """Distance past a break of slope, rounded: 0 before it, `d` after it; its derivative is a smooth step."""
    share = min(max((d + ROUNDING) / (2 * ROUNDING), 0.0), 1.0)
    return 2 * ROUNDING * (share**3 - 0.5 * share**4) + max(d - ROUNDING, 0.0)


def section(x):
    """Elevation along y = 0 relative to x = 0; m."""
    falls = [math.tan(math.radians(degrees)) for _, degrees in SECTION]
    total = falls[0] * x
    for (end, _), before, after in zip(SECTION, falls, falls[1:]):
        total += (after - before) * bend(x - end)
    return -total


def rise(x, start, end):
    """0 before `start`, 1 after `end`, smooth between."""
    share = min(max((x - start) / (end - start), 0.0), 1.0)
    return share * share * (3 - 2 * share)


def height(x, y):
    """Elevation of the terrain; m."""
    # gullies: three furrows that start below the brink and run out into the valley, meandering slightly
    furrow = math.cos(2 * math.pi * (y + 2.5 * math.sin(x / 17.0)) / 23.0)
    gully = -1.6 * (0.5 + 0.5 * furrow) ** 2 * rise(x, 24, 48) * (1 - rise(x, 112, 134))
    # the brink and the foot are not straight
    shift = 3.0 * math.sin(y / 9.0 + 0.6) + 2.0 * math.sin(y / 4.3)
    # raised sides keep the boulders in the scene
    side = 0.032 * max(abs(y) - 23.0, 0.0) ** 2
    # a rough surface: waves of 6 to 15 m, calmer in the valley
    rough = (
        math.sin(0.71 * x + 0.43 * y)
        + math.sin(0.52 * x - 0.83 * y + 1.0)
        + math.sin(1.03 * x + 0.19 * y + 2.0)
        + math.sin(0.23 * x - 1.07 * y + 3.0)
    )
    calm = 0.22 - 0.16 * rise(x, 118, 140)
    return TOP + section(x + shift * (1 - rise(x, 120, 150))) + gully + side + calm * rough


def grid():
    """The terrain as text, north first."""
    yield f"ncols {COLUMNS}"
    yield f"nrows {ROWS}"
    yield "xllcenter 0"
    yield f"yllcenter {-HALF_WIDTH:g}"
    yield f"cellsize {CELL:g}"
    yield "NODATA_value -9999"
    for row in reversed(range(ROWS)):
        y = -HALF_WIDTH + row * CELL
        # adding zero avoids -0.00
        yield " ".join(f"{round(height(k * CELL, y), 2) + 0.0:.2f}" for k in range(COLUMNS))


def ground(x, y):
    """Elevation of the triangulated grid: the higher one of the two diagonals of a cell."""
    i, j = int(x / CELL), int((y + HALF_WIDTH) / CELL)
    a, b, c, d = (
        height((i + k) * CELL, -HALF_WIDTH + (j + l) * CELL) for k, l in ((0, 0), (1, 0), (0, 1), (1, 1))
    )
    u, v = x / CELL - i, (y + HALF_WIDTH) / CELL - j
    rising = a + u * (b - a) + v * (d - b) if v < u else a + v * (c - a) + u * (d - c)
    falling = a + u * (b - a) + v * (c - a) if u + v < 1 else d + (1 - u) * (c - d) + (1 - v) * (b - d)
    return max(rising, falling)


class Random:
    """The minimal standard generator of Park & Miller: the same numbers everywhere."""

    def __init__(self, seed):
        self.state = seed

    def between(self, low, high):
        self.state = self.state * 48271 % 2147483647
        return low + (high - low) * self.state / 2147483647


def direction(random):
    """A direction, uniformly distributed."""
    z, turn = random.between(-1, 1), random.between(0, 2 * math.pi)
    r = math.sqrt(1 - z * z)
    return (r * math.cos(turn), r * math.sin(turn), z)


def hull(random, size):
    """6 to 12 well separated points on an ellipsoid of mean diameter `size`: 8 to 20 faces."""
    axes = [0.5 * size * random.between(0.75, 1.25) for _ in range(3)]
    points = []
    n = int(random.between(6, 13))
    while len(points) < n:
        # the candidate farthest from the others
        candidates = [direction(random) for _ in range(12)]
        far = lambda c: min((math.dist(c, p) for p in points), default=0.0)
        points.append(max(candidates, key=far))
    return [tuple(a * c for a, c in zip(axes, p)) for p in points]


def boulders():
    """One line of rockfall.ron per boulder."""
    random = Random(2024)
    number = 0
    for row in range(4):
        for place in range(12):
            number += 1
            # few large ones, many small ones: diameters 0.4 to 2 m, uniform in the logarithm
            size = 0.4 * (2.0 / 0.4) ** random.between(0, 1)
            name = "small" if size < 0.7 else "medium" if size < 1.2 else "large"
            x = 19.0 + 3.0 * row + random.between(-0.3, 0.3)
            y = 3.0 * (place - 5.5) + random.between(-0.3, 0.3)
            is_ball = number % 8 == 0
            points = hull(random, size)
            reach = 0.5 * size if is_ball else max(math.hypot(*p) for p in points)
            around = [(reach * i / 4, reach * j / 4) for i in range(-4, 5) for j in range(-4, 5)]
            # clear of the ground wherever it rises within reach
            z = max(
                ground(x + dx, y + dy) + math.sqrt(max(reach**2 - dx**2 - dy**2, 0.0))
                for dx, dy in around
                if dx**2 + dy**2 <= reach**2
            ) + 0.15
            if is_ball:
                shape = f"Sphere(center: ({x:.2f}, {y:.2f}, {z:.2f}), radius: {reach:.3f})"
            else:
                text = ", ".join(f"({x + a:.3f}, {y + b:.3f}, {z + c:.3f})" for a, b, c in points)
                shape = f"Hull(points: [{text}])"
            yield f'        (name: "boulder_{number:02}", material: "{name}", shape: {shape}),'


if __name__ == "__main__":
    parts = {"grid": grid, "boulders": boulders}
    if len(sys.argv) != 2 or sys.argv[1] not in parts:
        sys.exit(__doc__)
    print("\n".join(parts[sys.argv[1]]()))
