#!/usr/bin/env python3
"""Irregular waves in a flume between two pistons that absorb: significant height, peak period and reflection.

    python3 benches/python/irregular.py --riprap PATH --runs DIR [--spacings 5] [--rows 50] [--waves 200] [--seed 1] [--set FIELD=VALUE ...]

Standard library only. A flume of eight peak wave lengths, kh = 1 at the peak, in a plane, JONSWAP's spectrum with a peak enhancement of 3.3; the
significant height is so many spacings. The first wave maker absorbs what comes back while it makes waves, the second one only absorbs. Records
start once the slowest components of interest have crossed the flume, and last for so many peak periods. Significant height: four times the root
of the variance, at two, four and six wave lengths. Peak period: that of the mean frequency weighted by the fourth power of the spectral density,
against the same mean of the spectrum asked for. Reflection: root of the ratio of the energies of both directions between 0.7 and 1.8 peak
frequencies, by least squares over five gauges around the middle (Zelt & Skjelbreia 1992), with the wave numbers of linear theory. A record
of n waves scatters about its spectrum, by some 100/sqrt(2 n) percent in height. The heights of a potential flow driven by the same
paddle do not: where `potential.py` left its record in the folder of the run, they stand beside. Finished runs are reused, others
resumed.
"""

import argparse
import cmath
import math
from pathlib import Path

from rows import columns, run_to_end, table

G = 9.81
DEPTH = 1.0  # m
LENGTHS = 8.0  # of the flume, × that of the peak
ENHANCEMENT = 3.3
# Waves of this frequency, × that of the peak, have crossed the flume before records start.
SLOWEST = 1.5
# Frequencies looked at, × that of the peak.
BAND = (0.7, 1.8)
# Gauges for the reflection: places around the middle, × the peak's wave length.
ARRAY = (-0.21, -0.09, 0.0, 0.13, 0.3)
# Gauges for heights, × the peak's wave length.
PLACES = (2.0, 4.0, 6.0)
# Peak of a record is sought in means over so many frequencies of its transform.
SMOOTHING = 9


def wave_number(frequency):
    """Of linear theory; 1/m."""
    square = (2 * math.pi * frequency) ** 2 / G
    k = max(square, math.sqrt(square / DEPTH))
    for _ in range(50):
        tanh = math.tanh(k * DEPTH)
        k -= (k * tanh - square) / (tanh + k * DEPTH * (1 - tanh * tanh))
    return k


def group_speed(frequency):
    """Of linear theory; m/s."""
    kh = wave_number(frequency) * DEPTH
    return math.pi * frequency / wave_number(frequency) * (1 + 2 * kh / math.sinh(2 * kh))


def shape(x):
    """JONSWAP's spectrum over the frequency in those of the peak."""
    width = 0.07 if x <= 1 else 0.09
    return x**-5 * math.exp(-1.25 * x**-4) * ENHANCEMENT ** math.exp(-((x - 1) ** 2) / (2 * width * width))


def weighted(frequencies, densities):
    """Mean frequency by the fourth power of the density."""
    weights = [density**4 for density in densities]
    return math.fsum(f * w for f, w in zip(frequencies, weights)) / math.fsum(weights)


class Sea:
    """Peak of kh = 1 and the flume for it."""

    def __init__(self, args):
        self.period = 2 * math.pi / math.sqrt(G * math.tanh(1.0) / DEPTH)
        self.wave_length = 2 * math.pi * DEPTH
        self.spacing = DEPTH / args.rows
        self.height = args.spacings * self.spacing
        self.length = round(LENGTHS * self.wave_length / self.spacing) * self.spacing
        self.start = self.length / group_speed(SLOWEST / self.period)
        self.end = self.start + args.waves * self.period


def scene(sea, args):
    """Text of the scene."""
    middle, high = 0.5 * sea.length, DEPTH + 3 * sea.height
    gauges = [("h", n, place * sea.wave_length) for n, place in enumerate(PLACES)]
    gauges += [("a", n, middle + place * sea.wave_length) for n, place in enumerate(ARRAY)]
    lines = ", ".join(f'SurfaceElevation(name: "{kind}{n}", x: {x:.6g}, y: 0.5)' for kind, n, x in gauges)
    waves = f"Irregular(spectrum: Jonswap({ENHANCEMENT}), height: {sea.height:g}, period: {sea.period:.6g}, seed: {args.seed})"
    return f"""(
    title: "Irregular waves between pistons that absorb",
    domain: (min: (-1.5, 0, -0.5), max: ({sea.length + 1.5:.6g}, 1, {high + 0.5:.6g}), dimensions: Two),
    materials: [(name: "rock", density: 2600, friction_angle_deg: 35)],
    blocks: [
        (name: "paddle", material: "rock", shape: Box(min: (-0.5, -0.5, 0), max: (0, 1.5, {high:.6g})),
         motion: Waves(direction: (1, 0, 0), absorb: true, waves: {waves})),
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-1.5, -0.5, -0.4), max: ({sea.length + 1.5:.6g}, 1.5, 0))),
        (name: "end", material: "rock", shape: Box(min: ({sea.length:.6g}, -0.5, 0), max: ({sea.length + 0.5:.6g}, 1.5, {high:.6g})),
         motion: Waves(direction: (-1, 0, 0), absorb: true, waves: Still(period: {sea.period:.6g}))),
    ],
    fluid: (resolution: Spacing({sea.spacing:.6g}), regions: [
        (name: "flume", shape: Box(min: (0, 0, 0), max: ({sea.length:.6g}, 1, {DEPTH:g})))]),
    time: (duration: {sea.end:.6g}),
    gauges: [{lines}],
    output: (frame_interval: {sea.end:.6g}, gauge_interval: 0.1, ledger_interval: 0.1),
)
"""


def records(path, sea):
    """Interval of the samples of a table, s, and its records by gauge from the start of the sea on, without their means; m."""
    found = columns(path)
    times = found["time [s]"]
    kept = [k for k, time in enumerate(times) if sea.start <= time]

    def record(gauge):
        values = [found[f"{gauge} [m]"][k] for k in kept]
        mean = math.fsum(values) / len(values)
        return [value - mean for value in values]

    return (times[kept[-1]] - times[kept[0]]) / (len(kept) - 1), record


def significant(record):
    """Four times the root of the variance; m."""
    return 4 * math.sqrt(math.fsum(value * value for value in record) / len(record))


def transform(record, step, frequencies):
    """Fourier coefficients of a record at some frequencies: amplitudes and phases."""
    found = []
    for frequency in frequencies:
        turn = cmath.exp(-2j * math.pi * frequency * step)
        phase, total = 1.0, 0.0
        for value in record:
            total += value * phase
            phase *= turn
        found.append(2 * total / len(record))
    return found


def smoothed(values):
    """Means over `SMOOTHING` neighbors, where there are so many."""
    half = SMOOTHING // 2
    return [math.fsum(values[k - half : k + half + 1]) / SMOOTHING for k in range(half, len(values) - half)]


def directions(coefficients, places, k):
    """Amplitudes of the waves along x and against it that fit best at some places (m)."""
    away = [cmath.exp(-1j * k * x) for x in places]
    cross = sum(a * a for a in away)
    n = len(places)
    right = [sum(c * a.conjugate() for c, a in zip(coefficients, away)), sum(c * a for c, a in zip(coefficients, away))]
    det = n * n - abs(cross) ** 2
    return (n * right[0] - cross.conjugate() * right[1]) / det, (n * right[1] - cross * right[0]) / det


def main():
    """The table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--riprap", default="target/release/riprap")
    parser.add_argument("--runs", default="runs/benches/irregular", type=Path)
    parser.add_argument("--spacings", default=5.0, type=float, help="significant height over the spacing")
    parser.add_argument("--rows", default=50, type=int, help="of water")
    parser.add_argument("--waves", default=200, type=int, help="length of the records, in peak periods")
    parser.add_argument("--seed", default=1, type=int)
    parser.add_argument("--threads", default=2, type=int)
    parser.add_argument("--set", nargs="*", action="extend", default=[])
    args = parser.parse_args()
    sea = Sea(args)
    name = f"jonswap_{args.spacings:g}_of_{args.rows}_{args.waves}_seed_{args.seed}" + "".join(f"_{one}" for one in args.set)
    folder, summary = run_to_end(args, name, lambda: (scene(sea, args), []))
    step, record = records(folder / "gauges.csv", sea)
    truth = folder / "potential.csv"
    _, of_theory = records(truth, sea) if truth.exists() else (None, None)
    resolution = 1 / (step * len(record("h0")))
    first, last = (round(x / sea.period / resolution) for x in BAND)
    frequencies = [n * resolution for n in range(first, last + 1)]
    inner = frequencies[SMOOTHING // 2 : len(frequencies) - SMOOTHING // 2]
    asked = weighted(inner, smoothed([shape(f * sea.period) for f in frequencies]))
    theory = ["the same of the potential flow"] if of_theory else []
    table([["gauge", "significant height over that asked for", *theory, "peak period over that asked for"]])
    for n, place in enumerate(PLACES):
        values = record(f"h{n}")
        heights = [significant(one(f"h{n}")) / sea.height for one in (record, of_theory) if one]
        squares = [abs(c) ** 2 for c in transform(values, step, frequencies)]
        peak = weighted(inner, smoothed(squares))
        print(f"| {place:g} wave lengths | {' | '.join(f'{height:.3f}' for height in heights)} | {asked / peak:.3f} |")
    places = [place * sea.wave_length for place in ARRAY]
    coefficients = [transform(record(f"a{n}"), step, frequencies) for n in range(len(ARRAY))]
    energies = [0.0, 0.0]
    for n, frequency in enumerate(frequencies):
        pair = directions([of[n] for of in coefficients], places, wave_number(frequency))
        energies = [energy + abs(amplitude) ** 2 for energy, amplitude in zip(energies, pair)]
    print(
        f"\nReflection {100 * math.sqrt(energies[1] / energies[0]):.1f} %; incident height over that asked for, of this band "
        f"{4 * math.sqrt(energies[0] / 2) / sea.height:.3f}; {args.waves} waves, {summary['steps']} steps, {summary['wall_time']:.0f} s"
    )


if __name__ == "__main__":
    main()
