#!/usr/bin/env python3
"""Motion of the block of landslide_flume.ron, from a closed form; standard library only.

    python3 landslide_flume.py > landslide_flume_block.csv
    python3 landslide_flume.py shape

The speed of the block's middle along the bed is linear between KNOTS, fitted to the displacement measured by Sue (run
SG3_IS5). Both ends of its base, a chord of 0.5 m, stay on the bed, so that it rotates as it leaves the ramp.
"""

import math
import sys

# time, speed along the bed; s, m/s
KNOTS = [(0, 0), (0.6, 0.792), (1.35, 1.521), (1.55, 1.091), (2.1, 1.094), (3, 0.821), (4.5, 0.215), (5.3, 0)]
# initial position of the middle of the base, along the ramp from the shoreline; m
START = 0.2948
CHORD, DEPTH = 0.5, 0.435
# of half an ellipse of the published volume, 2.419 l in 0.25 m; the published 0.026 m would be 5.5 % more
HEIGHT = 2.419e-3 / 0.25 / (math.pi / 4 * CHORD)
# the block extends below its base, into the bed: no water enters beneath it
SKIRT = 0.045
# ends of the pieces of the bed; m
BENDS = [1.297 + 0.085 * k for k in range(7)]
ROWS = 265


def curve(x):
    """Elevation of the laboratory bed over the still-water level; m."""
    if x < BENDS[0]:
        return -math.tan(math.radians(15)) * x
    q = x - BENDS[0]
    return -DEPTH if BENDS[-1] <= x else max(0.19 * q**3 + 0.1024 * q**2 - 0.2728 * q - 0.3475, -DEPTH)


def bed(x):
    """Elevation of the bed in the case: straight between the bends; m."""
    for left, right in zip(BENDS, BENDS[1:]):
        if left <= x < right:
            share = (x - left) / (right - left)
            return (1 - share) * curve(left) + share * curve(right)
    return curve(x)


def chord(rear):
    """Middle of the base and its dip, with the rear end at `rear`; m, m, rad."""
    low, high = rear, rear + CHORD
    for _ in range(60):
        front = 0.5 * (low + high)
        far = CHORD < math.hypot(front - rear, bed(front) - bed(rear))
        low, high = (low, front) if far else (front, high)
    return 0.5 * (rear + low), 0.5 * (bed(rear) + bed(low)), math.atan2(bed(rear) - bed(low), low - rear)


def outline(n=24):
    """Corners of the block about the middle of its base, along and across it; m."""
    top = [math.pi * (1 - k / n) for k in range(n + 1)]
    arc = [(0.5 * CHORD * math.cos(p), HEIGHT * math.sin(p)) for p in top]
    return [(-0.5 * CHORD, -SKIRT), *arc, (0.5 * CHORD, -SKIRT)]


def centroid(corners):
    """Centroid of a polygon; m."""
    area = x = z = 0.0
    for (x0, z0), (x1, z1) in zip(corners, corners[1:] + corners[:1]):
        cross = x0 * z1 - x1 * z0
        area, x, z = area + cross / 2, x + (x0 + x1) * cross / 6, z + (z0 + z1) * cross / 6
    return x / area, z / area


def place(point, pose):
    """Position of a point of the block in the flume; m."""
    x, z, dip = pose
    return (x + point[0] * math.cos(dip) + point[1] * math.sin(dip),
            z - point[0] * math.sin(dip) + point[1] * math.cos(dip))


def way(time):
    """Displacement of the middle along the bed; m."""
    total = 0.0
    for (t0, v0), (t1, v1) in zip(KNOTS, KNOTS[1:]):
        t = min(max(time, t0), t1)
        v = v0 + (v1 - v0) * (t - t0) / (t1 - t0)
        total += 0.5 * (v0 + v) * (t - t0)
    return total


def poses():
    """Time and pose, every 20 ms; the rear end travels as far as the middle."""
    rear, run, step = START * math.cos(math.radians(15)) - 0.5 * CHORD * math.cos(math.radians(15)), 0.0, 1e-4
    for row in range(ROWS + 1):
        while run < way(0.02 * row):
            run += math.hypot(step, bed(rear + step) - bed(rear))
            rear += step
        yield 0.02 * row, chord(rear)


def shape():
    """Corners of the block at the start, in the format of a scene."""
    start = next(poses())[1]
    corners = [f"({x:.5f}, {z:.5f})" for x, z in (place(corner, start) for corner in outline())]
    return "\n".join(", ".join(corners[k:k + 5]) + "," for k in range(0, len(corners), 5))


def motion():
    """Prints the table of the motion."""
    middle = centroid(outline())
    first = None
    print("# run SG3_IS5: the speed along the bed is linear between")
    print("#", ", ".join(f"{v:g} m/s at {t:g} s" for t, v in KNOTS) + "; landslide_flume.py")
    print("time [s], x [m], y [m], z [m], rx [deg], ry [deg], rz [deg]")
    for time, pose in poses():
        x, z = place(middle, pose)
        first = first or (x, z, pose[2])
        print(f"{time:.2f}, {x - first[0]:.6f}, 0, {z - first[1]:.6f}, 0, {math.degrees(pose[2] - first[2]):.4f}, 0")


if __name__ == "__main__":
    if sys.argv[1:] == ["shape"]:
        print(shape())
    else:
        motion()
