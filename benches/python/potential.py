#!/usr/bin/env python3
"""Surface of a flume by fully nonlinear potential flow, driven by the paddle of a run: the truth beside waves that do not break.

    python3 benches/python/potential.py RUN --depth 1 --length 38 --layer 31.8 [--until 40.4] [--from 20]

Needs numpy and scipy, and shares no code with riprap. RUN is the folder of a run whose piston starts at x = 0 and is written at
least twenty times in a period (`output.ledger_interval`); as its motion does not depend on the water (unless it absorbs), a run at a
coarse spacing will do. Gauges are those of the run's case. Writes `potential.csv`, with the columns of `gauges.csv`, into the folder.
Prints per gauge the mean level above still water and four standard deviations from `--from` on.

Method: surface elevation and potential at the surface (Zakharov 1968), vertical velocities by an expansion about the still level to
`--order` (West et al. 1987), cosines along the flume up to waves of `--shortest` depths, Runge-Kutta of fourth order. The piston
enters by an added potential that has its velocity at x = 0, linear in the piston's way (Bonnefoy, Le Touze & Ferrant 2006). Waves are
absorbed between `--layer` and the end of the flume by a pressure against the vertical velocity, growing with the square of the
distance.
"""

import argparse
import csv
import math
import re
import sys
from pathlib import Path

import numpy as np
from scipy.fft import dct, idct, idst
from scipy.interpolate import CubicSpline

G = 9.81


def paddle_of(folder, name):
    """Way of a block along x from where it started, as a spline over time; m."""
    with open(folder / "blocks.csv", newline="") as file:
        found = [(float(row["time [s]"]), float(row["x [m]"])) for row in csv.DictReader(file) if row["name"] == name]
    if len(found) < 3:
        sys.exit(f"{folder}: no motion of a block named {name}")
    times, places = np.array(found).T
    return CubicSpline(times, places - places[0])


def gauges_of(folder):
    """Places along x of the surface gauges by name; m."""
    text = (folder / "case.ron").read_text()
    return {name: float(x) for name, x in re.findall(r'SurfaceElevation\(\s*name: "([^"]+)",\s*x: ([-+.\de]+)', text)}


class Flume:
    """Water of constant depth between the piston at x = 0 and a wall."""

    def __init__(self, paddle, args):
        self.paddle, self.depth, self.length, self.order = paddle, args.depth, args.length, args.order
        highest = 2 * math.pi / (args.shortest * args.depth)
        # products of `order` factors are taken at four points in the shortest wave
        count = 2 ** math.ceil(math.log2(2 * highest * args.length / math.pi))
        self.x = (np.arange(count) + 0.5) * args.length / count
        self.k = np.arange(count) * math.pi / args.length
        self.kept = self.k < highest
        self.tanh = np.tanh(self.k * args.depth)
        reach = np.clip((self.x - args.layer) / (args.length - args.layer), 0, None)
        # pressure over density and vertical velocity, m/s: strong against the speed of long waves at the end, none at the start
        self.absorption = 2 * math.sqrt(G * args.depth) * reach**2
        self.surface = np.zeros((2, count))

    def modes(self, values):
        """Amplitudes of the cosines that are kept."""
        return dct(values, type=2, norm="forward") * self.kept

    def values(self, modes):
        """Sum of cosines at the points."""
        return idct(modes, type=2, norm="forward")

    def slope(self, values):
        """Derivative along x."""
        sines = np.append(-(self.modes(values) * self.k)[1:], 0.0)
        return idst(sines, type=2, norm="forward")

    def vertical_velocity(self, elevation, potential):
        """Vertical velocity at the surface from the potential there (West et al. 1987)."""
        powers = [np.ones_like(elevation)]
        for n in range(1, self.order):
            powers.append(powers[-1] * elevation / n)

        def derivative(modes, n):
            """Of the n-th order along z at the still level."""
            return self.values(modes * self.k**n * (self.tanh if n % 2 else 1.0))

        terms = [self.modes(potential)]
        for m in range(1, self.order):
            terms.append(self.modes(-sum(powers[n] * derivative(terms[m - n], n) for n in range(1, m + 1))))
        velocity = sum(powers[n] * derivative(terms[m], n + 1) for m in range(self.order) for n in range(self.order - m))
        return self.values(self.modes(velocity))

    def rates(self, time, surface):
        """Rates of the elevation and of the potential at the surface, that of the piston apart."""
        elevation, potential = surface
        speed, acceleration = self.paddle(time, 1), self.paddle(time, 2)
        vertical = self.vertical_velocity(elevation, potential)
        rise, along = self.slope(elevation), self.slope(potential)
        # the piston's potential is -speed/(2 length) ((length - x)^2 - (z + depth)^2)
        far, high = self.length - self.x, elevation + self.depth
        by_piston = speed * far / self.length, speed * high / self.length
        grown = -acceleration / (2 * self.length) * (far**2 - high**2)
        return np.array([
            self.values(self.modes((1 + rise**2) * vertical - (along + by_piston[0]) * rise + by_piston[1])),
            self.values(self.modes(
                -G * elevation - 0.5 * along**2 + 0.5 * (1 + rise**2) * vertical**2 - along * by_piston[0]
                - 0.5 * (by_piston[0] ** 2 + by_piston[1] ** 2) - grown - self.absorption * vertical
            )),
        ])

    def advance(self, time, step):
        """One step of the Runge-Kutta scheme."""
        now = self.surface
        first = self.rates(time, now)
        second = self.rates(time + 0.5 * step, now + 0.5 * step * first)
        third = self.rates(time + 0.5 * step, now + 0.5 * step * second)
        fourth = self.rates(time + step, now + step * third)
        self.surface = now + step / 6 * (first + 2 * second + 2 * third + fourth)

    def elevations(self, places):
        """Elevation at some places; m."""
        modes = self.modes(self.surface[0])
        modes[1:] *= 2
        return np.cos(np.outer(places, self.k)) @ modes


def main():
    """The records and the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("--paddle", default="paddle", help="name of the piston")
    parser.add_argument("--depth", type=float, required=True, help="m")
    parser.add_argument("--length", type=float, required=True, help="of the flume, m; with room for the layer")
    parser.add_argument("--layer", type=float, required=True, help="start of the absorbing layer, m")
    parser.add_argument("--until", type=float, help="s; the end of the run when left out")
    parser.add_argument("--from", dest="start", type=float, default=0.0, help="s")
    parser.add_argument("--order", type=int, default=4)
    parser.add_argument("--shortest", type=float, default=0.3, help="shortest wave, in depths")
    parser.add_argument("--step", type=float, default=0.01, help="s")
    args = parser.parse_args()
    flume, gauges = Flume(paddle_of(args.run, args.paddle), args), gauges_of(args.run)
    until = args.until or flume.paddle.x[-1]
    places = np.array(list(gauges.values()))
    times = np.arange(int(until / args.step) + 1) * args.step
    levels = np.empty((len(times), len(places)))
    for n, time in enumerate(times):
        levels[n] = flume.elevations(places)
        if not np.isfinite(levels[n]).all():
            sys.exit(f"a wave broke or --shortest is too short: no surface after {time:.2f} s")
        flume.advance(time, args.step)
    with open(args.run / "potential.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["time [s]", *(f"{name} [m]" for name in gauges)])
        writer.writerows([f"{time:.4f}", *(f"{args.depth + level:.6f}" for level in row)] for time, row in zip(times, levels))
    chosen = times >= args.start
    for name, record in zip(gauges, levels.T):
        print(f"{name}: mean {1e3 * record[chosen].mean():+.2f} mm, four standard deviations {4 * record[chosen].std():.4f} m")


if __name__ == "__main__":
    main()
