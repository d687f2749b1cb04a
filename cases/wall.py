#!/usr/bin/env python3
"""Stones of wall.ron; standard library only.

    python3 wall.py     the lines of wall.ron between its two marks

A test holds the committed scene to this script. Lengths in meters; x runs along the wall, y across it, z up.
"""

LENGTH, THICKNESS, HEIGHT = 0.6, 0.4, 0.3  # of a stone
STONES, COURSES = 10, 10


def courses():
    """Ends of the stones of each course along the wall: half a stone at both ends of every second one."""
    for course in range(COURSES):
        ends = [LENGTH * k for k in range(STONES + 1)]
        if course % 2 == 1:
            ends = [0.0] + [LENGTH * (k + 0.5) for k in range(STONES)] + [LENGTH * STONES]
        yield course, ends


def stones():
    for course, ends in courses():
        low, high = HEIGHT * course, HEIGHT * (course + 1)
        for number, (start, end) in enumerate(zip(ends, ends[1:]), 1):
            yield (
                f'        (name: "stone_{course + 1:02}_{number:02}", material: "stone", '
                f"shape: Box(min: ({start:.9g}, 0, {low:.9g}), max: ({end:.9g}, {THICKNESS}, {high:.9g}))),"
            )


if __name__ == "__main__":
    print("\n".join(stones()))
