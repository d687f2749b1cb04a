#!/usr/bin/env python3
"""Motion and outline of the body of submarine_body.ron, from closed forms; standard library only.

    python3 submarine_body.py > submarine_body.csv
    python3 submarine_body.py outline

Enet & Grilli (2007): height T/(1 - e) (sech(2 C q/b) sech(2 C y/w) - e), C = acosh(1/e), over the slope; way down the slope
s0 ln cosh(t/t0), s0 = u^2/a, t0 = u/a, with u and a fitted to the published table of d = 61 mm.
"""

import math
import sys

SPEED, ACCELERATION = 1.696, 1.194
DIP = math.radians(15)
LENGTH, WIDTH, HEIGHT, E = 0.395, 0.680, 0.082, 0.717
# position of the middle of the base, x from the shoreline; the body extends below it, into the slope; m
MIDDLE, SKIRT = 0.551, 0.06


def way(time):
    """Displacement down the slope; m."""
    return SPEED**2 / ACCELERATION * math.log(math.cosh(time * ACCELERATION / SPEED))


def contour(share, n=20):
    """Points at a fraction of the height of the body: along, across, up; m."""
    level, c = E + (1 - E) * share, math.acosh(1 / E)
    if share == 1:
        yield 0, 0, HEIGHT
        return
    for k in range(n):
        angle = 2 * math.pi * k / n
        low, high = 0.0, 2.0
        for _ in range(60):
            r = 0.5 * (low + high)
            inside = level < 1 / (math.cosh(c * r * math.cos(angle)) * math.cosh(c * r * math.sin(angle)))
            low, high = (r, high) if inside else (low, r)
        yield 0.5 * LENGTH * low * math.cos(angle), 0.5 * WIDTH * low * math.sin(angle), share * HEIGHT


def points():
    """Position of the body at the start; m."""
    foot = [(q, y, -SKIRT) for q, y, _ in contour(0)]
    for q, y, h in [*foot, *(p for share in (0, 0.3, 0.6, 0.85) for p in contour(share)), (0, 0, HEIGHT)]:
        yield (MIDDLE + q * math.cos(DIP) + h * math.sin(DIP), y,
               -MIDDLE * math.tan(DIP) - q * math.sin(DIP) + h * math.cos(DIP))


if __name__ == "__main__":
    if sys.argv[1:] == ["outline"]:
        print(", ".join(f"({x:.5f}, {y:.5f}, {z:.5f})" for x, y, z in points()))
    else:
        print("# way down the slope of 15 degrees: s0 ln cosh(t/t0); submarine_body.py")
        print("time [s], x [m], y [m], z [m]")
        for row in range(141):
            gone = way(0.02 * row)
            print(f"{0.02 * row:.2f}, {gone * math.cos(DIP):.6f}, 0, {-gone * math.sin(DIP):.6f}")
