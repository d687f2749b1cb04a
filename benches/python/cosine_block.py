#!/usr/bin/env python3
"""Motion and outline of the block of cosine_block.ron, from closed forms; standard library only.

    python3 cosine_block.py > cosine_block.csv
    python3 cosine_block.py outline

The speed down the incline is linear between KNOTS, fitted to the displacement measured by Zhou & Teng (2010), case A, read
from images at 29 Hz: 3 mm off. The record ends at 0.72 s; the block is at rest from then on.
"""

import math
import sys

# time, speed down the incline; s, m/s
KNOTS = [(0, 0), (0.08, 0.11), (0.51, 1.18), (0.72, 1.02), (0.735, 0), (2.5, 0)]
DIP = math.radians(10)
# a full cosine, by which the authors replace one of 0.457 m truncated at 0.394 m
HEIGHT, LENGTH = 0.019, 0.455
# the middle of the top, x from the shoreline; the block extends below its base, into the incline; m
MIDDLE, SKIRT = 0.618, 0.02


def way(time):
    """Displacement down the incline; m."""
    total = 0.0
    for (t0, v0), (t1, v1) in zip(KNOTS, KNOTS[1:]):
        t = min(max(time, t0), t1)
        total += (v0 + 0.5 * (v1 - v0) * (t - t0) / (t1 - t0)) * (t - t0)
    return total


def outline(n=8):
    """Corners of the block at its initial position, straight beyond the steepest points of the cosine, so that it is convex; m."""
    steepest = 0.25 * LENGTH
    tip = steepest + 0.5 * LENGTH / math.pi
    arc = [steepest * (k / n - 1) for k in range(2 * n + 1)]
    top = [(-tip, 0), *((q, 0.5 * HEIGHT * (1 + math.cos(2 * math.pi * q / LENGTH))) for q in arc), (tip, 0)]
    base = MIDDLE - HEIGHT * math.sin(DIP)
    return [(base + q * math.cos(DIP) + h * math.sin(DIP),
             -base * math.tan(DIP) - q * math.sin(DIP) + h * math.cos(DIP)) for q, h in [(-tip, -SKIRT), *top, (tip, -SKIRT)]]


if __name__ == "__main__":
    if sys.argv[1:] == ["outline"]:
        print(", ".join(f"({x:.6f}, {z:.6f})" for x, z in outline()))
    else:
        print("# the speed down the incline of 10 degrees is linear between")
        print("#", ", ".join(f"{v:g} m/s at {t:g} s" for t, v in KNOTS) + "; cosine_block.py")
        print("time [s], x [m], y [m], z [m]")
        for row in range(251):
            gone = way(0.01 * row)
            print(f"{0.01 * row:.2f}, {gone * math.cos(DIP):.6f}, 0, {-gone * math.sin(DIP):.6f}")
