#!/usr/bin/env python3
"""Dam breaks by fully nonlinear potential flow: the truth without friction beside the laboratory.

    python3 benches/python/dam_potential.py [ROW ...] [--finer 2] [--csv FOLDER] [--runs DIR --plot FILE]

Needs numpy and scipy, and shares no code with riprap. Rows are dam_break, dam_break_pressure and dam_break_wall, each the case of
that name in cases/, and check; all when left out. Prints for each what `hydraulics.py` measures, over the same laboratory values:
speed of the front between T = 2.0 and 3.35; arrival, plateau and its standard deviation at the sensor; and what area and energy have
lost. `--csv` writes the series into FOLDER/ROW.csv, with the columns of `gauges.csv` at its intervals: as `potential.csv` in the folder
of a run, `hydraulics.py` prints its measures there. `--plot` draws front and pressures beside the runs that `hydraulics.py` left in
DIR, and needs matplotlib, too. `check` compares the pressures at the release and the period of a standing wave
with theory, and the front of a wide dam and the depth where it stood with those of shallow water, 2 sqrt(g H) and 4/9 H (Ritter 1892).
At a wall nothing holds once the jet has fallen onto the water, at 6.1 sqrt(H/g) in these scenes. `--finer 0.5` gives the same answers
within 0.2 % in a tenth of the time.

Method: points that move with the free surface carry the potential (Longuet-Higgins & Cokelet 1976), Runge-Kutta of fourth order;
steps turn or stretch a chord between points by `--courant` at most. The stream function follows from Cauchy's integral over
straight chords along which potential and stream function are linear (Vinje & Brevig 1981), an equation of the second kind. Floor and
walls have no points: -cos(pi (x + iz) / L) lays floor, back wall and the wall at L onto the real axis, where the flow is mirrored.
Velocities are derivatives of cubic splines along the surface, even or odd at the back wall. Points are set anew after each step,
by `--share` of the distance from the wetted walls, from `--fine` to `--coarse`. The tip of a tongue or jet that is thinner than
`--thinnest` is cut off. Before the impact the wall is far away; the tongue is cut at the wall once it is `--strike` thick there, and
its end goes up the wall from then on (Greco 2001). Pressures at walls are Bernoulli's, with the rate of the potential from the same
equations.
Lengths inside are in depths H of the reservoir, times in sqrt(H/g), pressures in rho g H.
"""

import argparse
import csv
import math
import sys
import time
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).resolve().parent))
import numpy as np  # noqa: E402
from hydraulics import FRONT_SPEED, FRONT_TIMES, IMPACTS  # noqa: E402
from rows import columns  # noqa: E402
from scipy.interpolate import CubicSpline  # noqa: E402
from scipy.linalg import lu_factor, lu_solve  # noqa: E402

G = 9.81
RHO = 1000.0
# wall that no tongue reaches, H
FAR = 20.0
# width of the means of a run's pressures that are drawn, sqrt(H/g)
MEAN = 0.05
NAMES = {"Standard": "free slip", "Rough": "smooth walls by the law of the wall"}
# width, depth and tank in m; sensors by their heights in m; end in sqrt(H/g); interval of gauges in s
SCENES = {
    "dam_break": SimpleNamespace(width=0.05715, depth=0.1143, tank=None, sensors={}, until=1.75, interval=0.002),
    "dam_break_pressure": SimpleNamespace(
        width=0.6, depth=0.3, tank=1.61, sensors={"p1": 0.003, "p2": 0.015, "p3": 0.03, "p4": 0.08}, until=4.52, interval=0.0005,
        laboratory=IMPACTS["dam_break_pressure"],
    ),
    "dam_break_wall": SimpleNamespace(
        width=1.2, depth=0.6, tank=3.22, sensors={"p120": 0.12, "p130": 0.13, "p160": 0.16, "p190": 0.19}, until=5.22, interval=0.001,
        laboratory=IMPACTS["dam_break_wall"],
    ),
}


def chords(w, points):
    """Distances of nodes `w` from points, one row per point, and the integrals of 1 / (w - point) along the chords between nodes."""
    apart = w - points[:, None]
    at_node = apart == 0
    log = np.diff(np.log(np.abs(np.where(at_node, 1, apart)))) + 1j * np.angle(apart[:, 1:] * apart[:, :-1].conj())
    # principal value where a chord ends at the point; the size of the hole cancels between its two chords
    log.imag[at_node[:, 1:] | at_node[:, :-1]] = 0
    return apart, log


def weights(w, points):
    """Weights of the values at nodes `w` in the integral of value / (w - point), linear along the chords."""
    apart, log = chords(w, points)
    log /= np.diff(w)
    found = np.zeros(apart.shape, complex)
    found[:, 1:] += 1 - apart[:, :-1] * log
    found[:, :-1] += apart[:, 1:] * log - 1
    return found


def column(width, radius):
    """Surface of a column of depth 1 from its foot over its upper corner, rounded, to the back wall."""
    turn = np.linspace(0, math.pi / 2, 100)[1:-1]
    corner = width - radius + 1j * (1 - radius) + radius * np.exp(1j * turn)
    face = width + 1j * np.linspace(0, 1 - radius, 2000)
    return np.concatenate([face, corner, 1j + np.linspace(width - radius, 0, 500)])


class Water:
    """Free surface from its foot, which is node 0, to the back wall: places x + iz and the potential there."""

    def __init__(self, surface, args, tank=FAR, wetted=False):
        self.args, self.tank, self.wetted, self.time = args, tank, wetted, 0.0
        self.place, self.potential = surface, np.zeros(len(surface))
        self.regrid()
        self.first = np.array(self.balance())

    def splines(self, place, odd, even):
        """Arc length and, over it, splines of x and `odd` and of z and `even`, named for what they are about the back wall."""
        s = np.concatenate([[0], np.cumsum(np.abs(np.diff(place)))])
        odd = CubicSpline(s, np.stack([place.real, odd], 1), bc_type=("not-a-knot", (2, np.zeros(2))))
        even = CubicSpline(s, np.stack([place.imag, even], 1), bc_type=("not-a-knot", (1, np.zeros(2))))
        return s, odd, even

    def mapped(self, place):
        """Where floor and walls lie on the real axis."""
        return -np.cos(math.pi * place / self.tank)

    def equations(self, place):
        """Mapped nodes, factors of the matrix of the stream function inside, and the matrix of the potential."""
        w = self.mapped(place)
        inner = w[1:-1]
        matrix = weights(w, inner) - weights(w, inner.conj())
        angle = np.angle((w[:-2] - inner) / (w[2:] - inner)) % (2 * math.pi)
        return w, lu_factor(matrix.imag[:, 1:-1] - np.diag(angle), check_finite=False), matrix.real

    def conjugate(self, equations, potential):
        """Stream function at the nodes of a potential given there; it vanishes along floor and walls."""
        _, factors, known = equations
        return np.concatenate([[0], lu_solve(factors, known @ potential, check_finite=False), [0]])

    def velocities(self, place, potential, stream):
        """u + iw at the nodes, along the walls at both ends."""
        s, odd, even = self.splines(place, stream, potential)
        (x, flux), (z, along) = odd(s, 1).T, even(s, 1).T
        velocity = ((along + 1j * flux) / (x + 1j * z)).conj()
        velocity[0] = 1j * velocity[0].imag if self.wetted else velocity[0].real
        velocity[-1] = 1j * velocity[-1].imag
        return velocity

    def rates(self, place, potential, equations=None):
        """Velocities of the nodes and rates of their potential."""
        stream = self.conjugate(equations or self.equations(place), potential)
        velocity = self.velocities(place, potential, stream)
        return np.array([velocity, 0.5 * np.abs(velocity) ** 2 - place.imag])

    def advance(self):
        """One step, of a size of its own."""
        now = np.array([self.place, self.potential])
        first = self.rates(self.place, self.potential, self.now)
        turned = np.max(np.abs(np.diff(first[0])) / np.abs(np.diff(self.place)))
        step = min(self.args.longest, self.args.courant / max(turned, 1e-9))

        def later(share, rates):
            place, potential = now + share * step * rates
            return self.rates(place, potential.real)

        second = later(0.5, first)
        third = later(0.5, second)
        fourth = later(1, third)
        self.place, potential = now + step / 6 * (first + 2 * second + 2 * third + fourth)
        self.potential = potential.real
        self.time += step
        self.cut()
        self.regrid()

    def from_walls(self):
        """Distances of nodes from the nearer of the floor and a wetted wall in front."""
        return np.minimum(self.place.imag, self.tank - self.place.real) if self.wetted else self.place.imag

    def cut(self):
        """Takes off a tip that is too thin; the last of its nodes goes to the wall."""
        thin = self.from_walls() < self.args.thinnest
        thin[0] = True
        last = np.argmin(thin) - 1
        if last > 0:
            self.place, self.potential = self.place[last:].copy(), self.potential[last:].copy()
            self.place[0] = self.tank + 1j * self.place[0].imag if self.wetted else self.place[0].real

    def regrid(self):
        """Sets nodes anew along the surface: close near walls and in bends."""
        s, odd, even = self.splines(self.place, 0 * self.potential, self.potential)
        (dx, dz), (ddx, ddz) = [(odd(s, n)[:, 0], even(s, n)[:, 0]) for n in (1, 2)]
        spacing = np.minimum(self.args.share * self.from_walls(), self.args.bend / np.maximum(np.abs(dx * ddz - dz * ddx), 1e-9))
        spacing = np.clip(spacing, self.args.fine, self.args.coarse)
        spacing = np.min(spacing + self.args.growth * np.abs(s[:, None] - s), axis=1)
        count = np.concatenate([[0], np.cumsum(0.5 * (1 / spacing[1:] + 1 / spacing[:-1]) * np.diff(s))])
        new = np.interp(np.linspace(0, count[-1], math.ceil(count[-1]) + 1), count, s)
        ends = self.place[[0, -1]]
        z, self.potential = even(new).T
        self.place = odd(new)[:, 0] + 1j * z
        self.place[[0, -1]] = ends
        self.now = self.equations(self.place)

    def strike(self, tank):
        """Lets the tongue end at the wall, which is wetted from now on."""
        s, odd, even = self.splines(self.place, 0 * self.potential, self.potential)
        fine = np.linspace(0, s[-1], 200 * len(s))
        at = fine[np.argmax(odd(fine)[:, 0] < tank)]
        kept = s > at + 0.5 * self.args.fine
        z, potential = even(at)
        self.place = np.concatenate([[tank + 1j * z], self.place[kept]])
        self.potential = np.concatenate([[potential], self.potential[kept]])
        self.tank, self.wetted = tank, True
        self.regrid()

    def reach(self, thickness=0.0):
        """Farthest place x where the water over the floor is as thick."""
        k = np.argmax(self.place.imag >= thickness)
        return np.interp(thickness, self.place[k - 1 : k + 1].imag, self.place[k - 1 : k + 1].real) if k else self.place[0].real

    def depth(self, x):
        """Of the tongue."""
        return np.interp(-x, -self.place.real, self.place.imag, left=0)

    def balance(self):
        """Area and energy."""
        s, odd, even = self.splines(self.place, self.conjugate(self.now, self.potential), self.potential)
        step = np.diff(s)
        share = np.concatenate([np.append(step, 0) / 6 + np.insert(step, 0, 0) / 6, step * 2 / 3])
        at = np.concatenate([s, s[1:] - step / 2])
        (dx, flux), (z, potential) = odd(at, 1).T, even(at).T
        return -share @ (z * dx), 0.5 * share @ (potential * flux - z * z * dx)

    def pressures(self, places):
        """At places on floor and walls; zero above the water."""
        stream = self.conjugate(self.now, self.potential)
        rate = -self.place.imag - 0.5 * np.abs(self.velocities(self.place, self.potential, stream)) ** 2
        points = self.mapped(places).real + 0j
        growth = (weights(self.now[0], points) @ (rate + 1j * self.conjugate(self.now, rate))).imag / math.pi
        _, log = chords(self.now[0], points)
        slope = (log @ (np.diff(self.potential + 1j * stream) / np.diff(self.now[0]))).imag / math.pi
        speed = np.abs(slope * math.pi / self.tank * np.sin(math.pi * places / self.tank))
        dry = self.wetted & (places.real == self.tank) & (places.imag >= self.place[0].imag)
        return np.where(dry, 0, -growth - places.imag - 0.5 * speed**2)


def simulated(scene, args):
    """Water at the end and a row per step: time, front, place where the tongue is a given thickness, height at the wall, sensors."""
    tank = scene.tank / scene.depth if scene.tank else FAR
    water = Water(column(scene.width / scene.depth, args.round), args)
    sensors = tank + 1j * np.array(list(scene.sensors.values())) / scene.depth
    rows = []
    while water.time < (args.until or scene.until):
        water.advance()
        if not abs(water.balance()[1] / water.first[1] - 1) < 0.01:
            print(f"no surface at {water.time:.2f}, the energy is lost", file=sys.stderr)
            break
        if not water.wetted and water.depth(tank) > args.strike:
            water.strike(tank)
        up = water.place[0].imag if water.wetted else 0
        pressures = water.pressures(sensors) if water.wetted else 0 * sensors.real
        reach = (tank, tank) if water.wetted else (water.reach(), water.reach(args.thickness))
        rows.append([water.time, *reach, up, *pressures])
    return water, np.array(rows)


def resampled(scene, rows):
    """Times in s at the interval of the gauges, and the rows there, lengths in m and pressures in Pa."""
    times = np.arange(scene.interval, rows[-1, 0] * math.sqrt(scene.depth / G), scene.interval)
    units = scene.depth * np.array([1] * 3 + [RHO * G] * len(scene.sensors))
    return times, np.stack([np.interp(times / math.sqrt(scene.depth / G), rows[:, 0], one) for one in rows.T[1:]], 1) * units


def written(path, scene, times, values):
    """The series, with the columns of `gauges.csv`."""
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        names = ["front [m]", "thick_front [m]", "up_wall [m]", *(f"{name} [Pa]" for name in scene.sensors)]
        writer.writerow(["time [s]", *names])
        writer.writerows([f"{t:.4f}", *(f"{value:.6g}" for value in row)] for t, row in zip(times, values))


def drawn(path, runs, series):
    """Front over the floor, and pressures on the wall averaged over `MEAN`, beside runs with and without friction."""
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, len(series), figsize=(6 * len(series), 4.5), squeeze=False, layout="constrained")
    for axis, (row, (times, values)) in zip(axes[0], series.items()):
        scene = SCENES[row]
        unit = math.sqrt(scene.depth / G)
        beside = [(name, style, runs / f"{row}_{name}_W2") for name, style in (("Standard", "-"), ("Rough", ":"))]
        beside = [(name, style, columns(folder / "gauges.csv")) for name, style, folder in beside if folder.exists()]
        if not scene.sensors:
            axis.plot(times / unit, values[:, 0] / scene.width, "k", lw=2.5, alpha=0.5, label="potential flow")
            for name, style, run in beside:
                reach = np.array(run["front [m]"]) / scene.width
                axis.plot(np.array(run["time [s]"]) / unit, reach, f"C0{style}", label=f"riprap, {NAMES[name]}")
            axis.plot(np.array(FRONT_TIMES) / unit, [2.29, 4.13], "ks", label="Martin & Moyce (1952)")
            axis.set(title=row, xlabel="t sqrt(g/H)", ylabel="front / width of the column", xlim=(0, times[-1] / unit), ylim=(0.9, 5))
        for k, sensor in enumerate(scene.sensors):
            axis.plot(times / unit, values[:, 3 + k] / (RHO * G * scene.depth), f"C{k}", lw=2.5, alpha=0.5,
                      label=f"{sensor}, potential flow")
            for name, style, run in beside[:1]:
                n = max(1, round(MEAN * unit / scene.interval))
                means = np.convolve(run[f"{sensor} [Pa]"], np.ones(n) / n, "same") / (RHO * G * scene.depth)
                axis.plot(np.array(run["time [s]"]) / unit, means, f"C{k}{style}", lw=0.7)
        if scene.sensors:
            axis.set(title=row, xlabel="t sqrt(g/H)", ylabel="p / (rho g H)", xlim=(2.2, times[-1] / unit), ylim=(-0.5, 2.8))
        axis.legend(fontsize=8)
        axis.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


def front(scene, times, values, args):
    """Measures of `hydraulics.dam_break`: over T, and the speed over that of Martin & Moyce (1952)."""
    words = []
    for name, place in (("tip", values[:, 0]), (f"{args.thickness:g} H thick", values[:, 1])):
        first, last = np.interp(FRONT_TIMES, times, place)
        speed = (last - first) / (FRONT_TIMES[1] - FRONT_TIMES[0])
        words.append(f"{name}: Z {first / scene.width:.3f}, {last / scene.width:.3f}, speed {100 * (speed / FRONT_SPEED - 1):+.2f} %")
    return "; ".join(words)


def impact(scene, times, values, args):
    """Measures of `hydraulics.impact`, and means in the window at all sensors."""
    t, p = times * math.sqrt(G / scene.depth), values[:, 3:] / (RHO * G * scene.depth)
    _, sensor, (arrival, plateau), (flat, _) = scene.laboratory
    window = (flat[0] <= t) & (t <= flat[1])
    here = p[:, list(scene.sensors).index(sensor)]
    found = t[np.argmax(here > 0.1)]
    means = ", ".join(f"{name} {mean:.3f}" for name, mean in zip(scene.sensors, p[window].mean(axis=0)))
    return (
        f"{sensor} arrival {found:.3f}, {100 * (found / arrival - 1):+.2f} %, highest {here.max():.2f} at "
        f"{t[here.argmax()]:.2f}, plateau {here[window].mean():.3f} for {plateau}, ringing {here[window].std():.3f} up to "
        f"{t[window][-1]:.2f}; means {means}; {values[-1, 2] / scene.depth:.2f} H up the wall"
    )


def released(args):
    """Largest error of the pressures on floor and back wall as a column of width 2 is released, over rho g H."""
    n = np.arange(4000)
    k = (n + 0.5) * math.pi / 2
    share = 4 * (-1.0) ** n / (math.pi * (2 * n + 1)) / k
    floor, back = np.linspace(0.05, 1.9, 38), np.linspace(0, 0.95, 20)
    below = [np.sum(share * np.cos(k * x) * np.tanh(k)) for x in floor]
    behind = [np.sum(share * (np.exp(-k * z) - np.exp(k * (z - 2))) / (1 + np.exp(-2 * k))) for z in back]
    found = Water(column(2.0, args.round), args).pressures(np.concatenate([floor, 1j * back]))
    return np.max(np.abs(found - np.concatenate([below, behind])))


def sloshing(args):
    """Period of a wave of twice the length 2 of a tank, 0.001 high, over that of linear theory."""
    x = np.linspace(2, 0, 400)
    water = Water(x + 1j * (1 + 0.001 * np.cos(math.pi * x / 2)), args, tank=2.0, wetted=True)
    theory = 2 * math.pi / math.sqrt(math.pi / 2 * math.tanh(math.pi / 2))
    levels = [(0, 0.001)]
    while water.time < 0.8 * theory:
        water.advance()
        levels.append((water.time, water.place[-1].imag - 1))
    t, level = np.array(levels).T
    k = np.flatnonzero(level[1:] * level[:-1] < 0)
    first, second = t[k] - level[k] * (t[k + 1] - t[k]) / (level[k + 1] - level[k])
    return 2 * (second - first) / theory


def wide(args):
    """Speed over 2 sqrt(g H) of the front of a dam ten depths wide, and depth where it stood over 4/9 H, from 1 to 6 sqrt(H/g)."""
    water = Water(column(10.0, args.round), SimpleNamespace(**vars(args) | {"coarse": 3 * args.coarse}), tank=3 * FAR)
    speeds, depths = [], []
    for t in range(1, 7):
        while water.time < t:
            water.advance()
        speeds.append(f"{water.rates(water.place, water.potential, water.now)[0, 0].real / 2:.3f}")
        depths.append(f"{water.depth(10.0) / (4 / 9):.3f}")
    return f"front of a wide dam {', '.join(speeds)} of 2 sqrt(g H), depth where it stood {', '.join(depths)} of 4/9 H"


def main():
    """The table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", nargs="*", metavar="ROW", help=f"of {', '.join([*SCENES, 'check'])}; all when left out")
    parser.add_argument("--csv", type=Path, help="folder of the series")
    parser.add_argument("--runs", type=Path, default=Path("runs/benches"), help="folder of the runs to draw")
    parser.add_argument("--plot", type=Path, help="file of the plot")
    parser.add_argument("--until", type=float, help="end, sqrt(H/g); that of the measure when left out")
    parser.add_argument("--finer", type=float, default=1.0, help="divides sizes of chords and steps by this")
    parser.add_argument("--coarse", type=float, default=0.02, help="longest chord, H")
    parser.add_argument("--fine", type=float, default=0.001, help="shortest chord, H")
    parser.add_argument("--share", type=float, default=0.4, help="length of a chord over its distance from a wall")
    parser.add_argument("--bend", type=float, default=0.2, help="longest chord over the radius of curvature")
    parser.add_argument("--growth", type=float, default=0.15, help="growth of chords along the surface")
    parser.add_argument("--courant", type=float, default=0.1, help="largest share of a chord by which a step changes it")
    parser.add_argument("--longest", type=float, default=0.01, help="longest step, sqrt(H/g)")
    parser.add_argument("--round", type=float, default=0.02, help="radius of the upper corner of the column, H")
    parser.add_argument("--thinnest", type=float, default=5e-4, help="thickness below which a tip is cut off, H")
    parser.add_argument("--strike", type=float, default=3e-3, help="thickness of the tongue when the wall is wetted, H")
    parser.add_argument("--thickness", type=float, default=0.0125, help="of the tongue at the second front, H")
    args = parser.parse_args()
    for name in ("coarse", "fine", "share", "bend", "growth", "courant", "longest"):
        setattr(args, name, getattr(args, name) / args.finer)
    unknown = [row for row in args.rows if row not in [*SCENES, "check"]]
    if unknown:
        parser.error(f"no row {', '.join(unknown)}")
    series = {}
    for row in args.rows or [*SCENES, "check"]:
        started = time.process_time()
        if row == "check":
            print(f"{row}: pressures at the release {released(args):.1e} rho g H off; period {sloshing(args):.5f} of theory; {wide(args)}")
            continue
        scene = SCENES[row]
        water, rows = simulated(scene, args)
        series[row] = times, values = resampled(scene, rows)
        measured = (impact if scene.tank else front)(scene, times, values, args)
        area, energy = water.balance() / water.first - 1
        print(f"{row}: {measured}; area {area:+.1e}, energy {energy:+.1e}; {len(water.place)} nodes, {len(rows)} steps, "
              f"{time.process_time() - started:.0f} s", flush=True)
        if args.csv:
            args.csv.mkdir(parents=True, exist_ok=True)
            written(args.csv / f"{row}.csv", scene, times, values)
    if args.plot and series:
        drawn(args.plot, args.runs, series)


if __name__ == "__main__":
    main()
