#!/usr/bin/env python3
"""Paddle records for water waves, from closed forms; standard library only.

    python3 solitary.py 1.0 0.3 > solitary_paddle.csv     depth and height of the wave in meters

Goring (1978): the paddle moves with the depth-averaged water, xi(t) = (H/k) tanh(k (c t - xi)/d) + its start, with
Rayleigh's outskirts decay k = sqrt(3 H/(4 (d + H))) and c = sqrt(g (d + H)). The record starts at rest at x = 0.
"""

import math
import sys

GRAVITY = 9.81
# Truncation of the wave, where tanh(FADE) is nearly one: a thousandth of its height.
FADE = 4.0
ROWS = 400


def records(depth, height):
    """Time and paddle position; s, m."""
    k = math.sqrt(0.75 * height / (depth + height))
    celerity = math.sqrt(GRAVITY * (depth + height))
    half_stroke = height / k
    start = -half_stroke * math.tanh(FADE)
    for row in range(ROWS + 1):
        # by the phase theta = k (c t - xi)/d, which gives the time without iteration
        theta = FADE * (2 * row / ROWS - 1)
        xi = half_stroke * math.tanh(theta)
        time = (theta * depth / k + xi) / celerity
        zero = (-FADE * depth / k + start) / celerity
        yield time - zero, xi - start


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    depth, height = map(float, sys.argv[1:])
    print(f"# solitary wave of {height:g} m on {depth:g} m, Goring (1978) with Rayleigh's outskirts; solitary.py")
    print("time [s], x [m], y [m], z [m]")
    for time, x in records(depth, height):
        print(f"{time:.6f}, {x:.7f}, 0, 0")
