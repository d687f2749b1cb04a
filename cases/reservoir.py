#!/usr/bin/env python3
"""The valley and dam of reservoir_overtopping.ron, from a closed form; standard library only.

    python3 reservoir.py > reservoir.asc      an ESRI ASCII grid in coordinates of the map

Edit a parameter and run it again for another reservoir; a test holds the committed file to this script.
Lengths in meters, in the scene's coordinates: x runs down the valley, y north across it, z up from the full reservoir.
"""

import math

ORIGIN = (618000.0, 5142000.0, 500.0)  # of the scene, on the map; heights of the file are above sea level
CELL = 10.0
WEST, EAST = -940.0, 440.0
SOUTH, NORTH = -300.0, 460.0

DEPTH = 70.0  # of the valley floor below the full reservoir, under the dam
FLOOR = 60.0  # half width of the floor, there
SLOPE = 38.0  # of both sides; degrees
FALL = 0.05  # of the floor along the valley
HEAD, HEAD_SLOPE = -700.0, 16.0  # from here on the floor rises at this angle upstream; degrees
PLATEAU = 230.0  # height of the land above the slopes
ROUNDING = 8.0  # length of the transitions between slopes, floor and plateau

CREST = (0.0, 10.0)  # from and to, along the valley
FREEBOARD = 10.0
FACES = (1.5, 1.5)  # run over rise, upstream and downstream


def smooth_max(*heights):
    """The largest of some heights, rounded where two are close."""
    top = max(heights)
    return top + ROUNDING * math.log(sum(math.exp((z - top) / ROUNDING) for z in heights))


def valley(x, y):
    """Elevation of the land without the dam; m."""
    slope = math.tan(math.radians(SLOPE))
    # the valley bends upstream
    middle = 0.1 * max(0.0, -450.0 - x) ** 2 / 250.0
    floor = smooth_max(-DEPTH - FALL * x, -DEPTH - FALL * HEAD + math.tan(math.radians(HEAD_SLOPE)) * (HEAD - x))
    side = -DEPTH + slope * (abs(y - middle) - FLOOR)
    return -smooth_max(-smooth_max(side, floor), -PLATEAU)


def dam(x):
    """Elevation of the dam, extended below the ground; m."""
    upstream, downstream = CREST
    return FREEBOARD - max(0.0, (upstream - x) / FACES[0], (x - downstream) / FACES[1])


def height(x, y):
    """Elevation of land, bed and dam; m."""
    return max(valley(x, y), dam(x))


def main():
    columns = round((EAST - WEST) / CELL) + 1
    rows = round((NORTH - SOUTH) / CELL) + 1
    print(f"ncols {columns}\nnrows {rows}")
    print(f"xllcenter {ORIGIN[0] + WEST:.1f}\nyllcenter {ORIGIN[1] + SOUTH:.1f}")
    print(f"cellsize {CELL:g}\nNODATA_value -9999")
    for row in range(rows - 1, -1, -1):
        y = SOUTH + row * CELL
        print(" ".join(f"{ORIGIN[2] + height(WEST + column * CELL, y):.2f}" for column in range(columns)))


if __name__ == "__main__":
    main()
