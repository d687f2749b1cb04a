#!/usr/bin/env python3
"""Paddle records for compound_beach.ron, from a closed form; standard library only.

    python3 compound_beach.py C > compound_beach_paddle.csv     or A

The paddle of a solitary wave after Goring (1978), x(t) = S/2 (1 + tanh theta), theta = w (t - x/c - start), with stroke S,
rate w and celerity c fitted to the laboratory records (root mean square error 0.7 mm for C, 0.15 mm for A): the actual motion of
the machine, not the command signal. The fit is truncated where tanh is nearly one.
"""

import math
import sys

# stroke, rate, 1/celerity, time of the middle of the stroke on the laboratory's clock; m, 1/s, s/m, s
FITS = {"A": (0.10542, 1.4324, 1.651, 262.810), "C": (0.39254, 7.443, 0.7506, 260.809)}
FADE = 3.5
ROWS = 140


def record(stroke, rate, slowness):
    """Time and paddle position, truncated at both ends; s, m."""
    for row in range(ROWS + 1):
        theta = FADE * (2 * row / ROWS - 1)
        x = stroke / 2 * (math.tanh(theta) + math.tanh(FADE))
        yield (theta + FADE) / rate + x * slowness, x


if __name__ == "__main__":
    if sys.argv[1:] not in (["A"], ["C"]):
        sys.exit(__doc__)
    stroke, rate, slowness, middle = FITS[sys.argv[1]]
    start = middle - FADE / rate - stroke / 2 * math.tanh(FADE) * slowness
    print(f"# case {sys.argv[1]}: stroke {stroke:g} m; t = 0 is {start:.3f} s on the laboratory's clock; compound_beach.py")
    print("time [s], x [m], y [m], z [m]")
    for time, x in record(stroke, rate, slowness):
        print(f"{time:.5f}, {x:.6f}, 0, 0")
