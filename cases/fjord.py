#!/usr/bin/env python3
"""The fjord of fjord_rockslide.ron and slide_section.ron, from a closed form; standard library only.

    python3 fjord.py grid > fjord.asc      land and sea bed, an ESRI ASCII grid in coordinates of the map
    python3 fjord.py section               the polygons of slide_section.ron: ground and slide along y = 0

Edit a parameter and run it again for another fjord; a test holds the committed files to this script.
Lengths in meters, in the scene's coordinates: x runs east across the fjord, y north along it, z up from the still water.
"""

import math
import sys

ORIGIN = (412000.0, 6904000.0)  # of the scene, on the map
CELL = 20.0
WEST, EAST = -1100.0, 1100.0
SOUTH, NORTH = -1000.0, 1000.0

DEPTH = 120.0  # of the middle
WEST_SHORE, EAST_SHORE = -450.0, 550.0  # where the slopes meet the water, without rounding
WEST_SLOPE, EAST_SLOPE = 42.0, 28.0  # degrees
PLATEAU = 460.0  # height of the land above the slopes
ROUNDING = 14.0  # length of the transitions between slopes, floor and plateau

# The slide: within this outline, above a plane that daylights in the slope at its toe.
OUTLINE = [(-900.0, -115.0), (-620.0, -115.0), (-620.0, 115.0), (-900.0, 115.0)]
TOE = (-620.0, 0.0)
FAILURE_DIP = 34.0

# The section: from and to, lower edge of its pieces, and their tolerance to the raster.
SECTION = (-960.0, 960.0)
BASE = -150.0
TOLERANCE = 0.3


def smooth_max(*heights):
    """The largest of some heights, rounded where two are close."""
    top = max(heights)
    return top + ROUNDING * math.log(sum(math.exp((z - top) / ROUNDING) for z in heights))


def height(x, y):
    """Elevation of land and sea bed; m."""
    # headlands and bays: both shores meander, except at the slide
    far = 1.0 - math.exp(-((y / 400.0) ** 4))
    wander = 35.0 * math.sin(2 * math.pi * y / 900.0) * far
    west = math.tan(math.radians(WEST_SLOPE)) * (WEST_SHORE + wander - x)
    east = math.tan(math.radians(EAST_SLOPE)) * (x - EAST_SHORE - 0.6 * wander)
    # a vertical fjord end would reflect waves: the floor continues to the edge
    land = smooth_max(west, east, -DEPTH)
    return -smooth_max(-land, -PLATEAU)


def toe():
    """The lowest point of the failure plane within the outline; m."""
    return (*TOE, height(*TOE))


def grid():
    columns = round((EAST - WEST) / CELL) + 1
    rows = round((NORTH - SOUTH) / CELL) + 1
    print(f"ncols {columns}\nnrows {rows}")
    print(f"xllcenter {ORIGIN[0] + WEST:.1f}\nyllcenter {ORIGIN[1] + SOUTH:.1f}")
    print(f"cellsize {CELL:g}\nNODATA_value -9999")
    for row in range(rows - 1, -1, -1):
        y = SOUTH + row * CELL
        print(" ".join(f"{height(WEST + column * CELL, y):.2f}" for column in range(columns)))


def failure_plane(x):
    """Elevation of the failure plane; m."""
    x_toe, _, z_toe = toe()
    return z_toe + math.tan(math.radians(FAILURE_DIP)) * (x_toe - x)


def simplified(points, tolerance):
    """A line reduced to the points needed to stay within a tolerance (Douglas and Peucker 1973)."""
    (x0, z0), (x1, z1) = points[0], points[-1]
    off = [abs(z - z0 - (z1 - z0) * (x - x0) / (x1 - x0)) for x, z in points]
    worst = max(range(len(points)), key=off.__getitem__)
    if off[worst] <= tolerance:
        return [points[0], points[-1]]
    return simplified(points[: worst + 1], tolerance)[:-1] + simplified(points[worst:], tolerance)


def terrain(west, east):
    """The raster along y = 0; m."""
    first, last = round((west - WEST) / CELL), round((east - WEST) / CELL)
    return [(WEST + i * CELL, height(WEST + i * CELL, 0.0)) for i in range(first, last + 1)]


def polygon(points):
    return "[" + ", ".join(f"({x:g}, {z:.2f})" for x, z in points) + "]"


def section():
    back, front = OUTLINE[0][0], TOE[0]
    # terrain, the failure plane under the slide, terrain
    stretches = [
        simplified(terrain(SECTION[0], back), TOLERANCE),
        [(back, failure_plane(back)), (front, failure_plane(front))],
        simplified(terrain(front, SECTION[1]), TOLERANCE),
    ]
    pieces = [pair for stretch in stretches for pair in zip(stretch, stretch[1:])]
    for number, ((x0, z0), (x1, z1)) in enumerate(pieces, 1):
        piece = polygon([(x0, BASE), (x1, BASE), (x1, z1), (x0, z0)])
        print(
            f'        (name: "ground_{number:02}", material: "ground", motion: Fixed,'
            f" shape: Extrusion(axis: Y, from: -20, to: 30, polygon: {piece})),"
        )
    # the slide: terrain from the toe up, and the failure plane back down
    top = simplified(terrain(back, front), TOLERANCE)[::-1]
    rock = polygon([*top, (back, failure_plane(back))])
    print(f"        boundary: Extrusion(axis: Y, from: 0, to: 10, polygon: {rock}),")


if __name__ == "__main__":
    if sys.argv[1:] == ["grid"]:
        grid()
    elif sys.argv[1:] == ["section"]:
        section()
    else:
        sys.exit(__doc__)
