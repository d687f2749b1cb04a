#!/usr/bin/env python3
"""Water against theory and published laboratory values: runs and a table.

    python3 benches/python/hydraulics.py [ROW ...] --riprap PATH --runs DIR --schemes Standard,Artificial,Preview,Reference

Rows are still_tank, piston_05, piston_1, piston_2, solitary, dam_break, dam_break_pressure and dam_break_wall, each the case of
that name in cases/ (kd of the piston after its name) with its source; standing_3, standing_5, standing_10 and wave_train are cases
of benches/trade/cases, the former 3, 5 and 10 spacings high, the latter 5 and, as wave_train_10, 10. Prints
`row | required | Standard | ...` with errors and CPU seconds. `Artificial` is the default of old: artificial viscosity, half the
step, ten times the fastest flow. `Rough` and `NoSlip` are the default with smooth walls by the law of the wall and with walls where
the water sticks.

Definitions. Pressure and speed in the still tank: root mean square over the gauges and of all particles after 8 s, over rho g H
and sqrt(g H). Height of the piston's waves: mean of sines fitted from x = 2.5 to 8 m, over linear theory; length: from the slope of
their phases. Standing wave: share of the height left in the eighth period, and phase after it against linear theory, where a wave
that keeps its height lags by 0.62 rad in deep water. Wave train: decay per wave length from sines fitted to four periods, 2 to 10
lengths away from the piston, once four periods of full height have passed. Solitary wave: celerity from the times of crests at
x = 8 to 24 m, loss between crests there, run-up at the wall over twice the last crest and its second-order term. Pressures: arrival
is the first sample above 0.1 rho g H, plateau and ringing are mean and standard deviation in a window, the second peak is a mean
over 50 ms. Where a record of `potential.py` or `dam_potential.py` lies in the folder of a run as `potential.csv`, the same measure of it
stands beside.
"""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import numpy as np  # noqa: E402
import rows as shared  # noqa: E402

CASES = Path(__file__).resolve().parents[2] / "cases"
OF_STUDIES = "../benches/trade/cases/"
G = 9.81
RHO = 1000.0
SCHEMES = {
    "Standard": [],
    "Artificial": ["numerics=(viscosity: Artificial(0.02), time_step_factor: 0.5, sound_speed: {c10})"],
    "Preview": ["numerics=(preset: Preview)"],
    "Reference": ["numerics=(preset: Reference)"],
    "Rough": ["interface.slip=Rough(0)"],
    "NoSlip": ["interface.slip=None"],
}
PISTON = "Sinusoid(direction: (1, 0, 0), amplitude: {0}, period: {1}, ramp: {2})"
FRONT = '[Front(name: "front", from: (0, 0.005), to: (0.44, 0.005))]'
# speed in m/s of the front between two times in s: Z = 2.29 at T = 2.0, 4.13 at T = 3.35 (Martin & Moyce 1952)
FRONT_TIMES, FRONT_SPEED = (0.1079, 0.1808), 1.443
# depth in m, sensor, arrival over sqrt(H/g) and plateau over rho g H, windows of plateau and second peak over sqrt(H/g)
IMPACTS = {
    "dam_break_pressure": (0.3, "p2", (2.4, 0.60), ((3.5, 4.5), None)),
    "dam_break_wall": (0.6, "p120", (2.5, 0.545), ((3.2, 5.2), (5.3, 7.4))),
}


def gauge(run, name):
    """Times and readings, without empty ones."""
    time, value = np.array(run.column(run.record, "time")), np.array(run.column(run.record, f"{name} ["))
    return time[~np.isnan(value)], value[~np.isnan(value)]


def percent(value, truth, digits=1):
    """Relative error in words."""
    return f"{100 * (value / truth - 1):+.{digits}f} %"


def still_tank(run):
    """Departure from rest."""
    rest = {"deep": 0.1, "on_step": 0.5, "over_slope": 0.5}
    errors = []
    for name, z in rest.items():
        time, pressure = gauge(run, name)
        errors.extend(pressure[time > 8] / (RHO * G) - (1 - z))
    kinetic = np.array(run.column("energy.csv", "kinetic"))
    time = np.array(run.column("energy.csv", "time"))
    mass = run.summary()["fluid_mass"][0]
    speed = np.sqrt(2 * kinetic[time > 8].mean() / mass / G)
    return f"p {100 * np.sqrt(np.mean(np.square(errors))):.2f} %, speed {100 * speed:.3f} %"


def piston(kd, stroke, window):
    """Height and length of waves from a piston, against linear theory."""
    omega = np.sqrt(G * kd * np.tanh(kd))
    ratio = 2 * (np.cosh(2 * kd) - 1) / (np.sinh(2 * kd) + 2 * kd)

    def measured(run):
        heights, phases, places = [], [], []
        for k in range(23):
            x = 2.5 + 0.25 * k
            time, level = gauge(run, f"x{x:.2f}")
            chosen = (window[0] <= time) & (time <= window[1])
            t = omega * time[chosen]
            shape = np.stack([np.cos(t), np.sin(t), np.ones_like(t)], 1)
            a, b, _ = np.linalg.lstsq(shape, level[chosen], rcond=None)[0]
            heights.append(2 * np.hypot(a, b))
            phases.append(np.arctan2(b, a))
            places.append(x)
        number = np.polyfit(places, np.unwrap(phases), 1)[0]
        return f"height {percent(np.mean(heights), ratio * stroke)}, length {percent(kd / number, 1)}"

    return measured


def standing(run):
    """Height and phase of a standing wave in its eighth period; it starts with a level surface."""
    period = 1.1339
    time, level = gauge(run, "left")
    chosen = (7 * period <= time) & (time <= 8 * period)
    t = 2 * np.pi / period * time[chosen]
    (a, b, _), *_ = np.linalg.lstsq(np.stack([np.cos(t), np.sin(t), np.ones_like(t)], 1), level[chosen], rcond=None)
    phase = np.angle(np.exp(1j * (np.pi / 2 - np.arctan2(b, a))))
    return f"{2 * np.hypot(a, b) / 0.19961:.2f} left, {phase:+.2f} rad"


def wave_train(run):
    """Decay of regular waves on their way."""
    period, speed, ramp = 1.4447, 1.247, 2.9
    heights = []
    for k in range(2, 11):
        time, level = gauge(run, f"{k} lengths")
        end = min(time[-1], k * np.pi / speed + ramp + 8 * period)
        chosen = (end - 4 * period < time) & (time <= end)
        t = 2 * np.pi / period * time[chosen]
        (a, b, _), *_ = np.linalg.lstsq(np.stack([np.cos(t), np.sin(t), np.ones_like(t)], 1), level[chosen], rcond=None)
        heights.append(2 * np.hypot(a, b))
    rate = -np.polyfit(range(2, 11), np.log(heights), 1)[0]
    return f"{100 * (1 - np.exp(-rate)):.1f} % a length, {heights[0] / 0.2:.2f} of the height at 2 lengths"


def solitary(run):
    """Celerity, loss and run-up of a solitary wave of 0.3 m on 1 m."""
    crests = []
    for x in range(8, 25, 4):
        time, level = gauge(run, f"x{x}")
        late = time < 2 + (x + 6) / 3.2
        k = np.argmax(level[late])
        near = slice(max(k - 5, 0), k + 6)
        a, b, c = np.polyfit(time[near] - time[k], level[near], 2)
        crests.append((x, time[k] - b / (2 * a), c - b * b / (4 * a) - 1))
    x, t, height = np.array(crests).T
    celerity = np.polyfit(t, x, 1)[0]
    e = height[-1]
    up = np.max(gauge(run, "wall")[1]) - 1
    return (
        f"celerity {percent(celerity, np.sqrt(G * (1 + height.mean())))}, loss {100 * (1 - height[-1] / height[0]):.1f} %, "
        f"run-up {percent(up, 2 * e + e * e / 2)}"
    )


def dam_break(run):
    """Speed of the front."""
    first, last = np.interp(FRONT_TIMES, *gauge(run, "front"))
    return f"speed {percent((last - first) / (FRONT_TIMES[1] - FRONT_TIMES[0]), FRONT_SPEED)}"


def impact(depth, name, truth, windows):
    """Pressures at a sensor over rho g H."""
    (arrival, plateau), (window, second) = truth, windows

    def measured(run):
        time, pressure = gauge(run, name)
        t, p = time * np.sqrt(G / depth), pressure / (RHO * G * depth)
        found = t[np.argmax(p > 0.1)]
        flat = p[(window[0] <= t) & (t <= window[1])]
        words = f"arrival {percent(found, arrival)}, plateau {flat.mean():.2f} for {plateau}, ringing {flat.std():.2f}"
        if second and second[1] <= t[-1]:
            n = max(1, round(0.05 / np.median(np.diff(time))))
            means = np.convolve(p, np.ones(n) / n, "same")
            late = (second[0] <= t) & (t <= second[1])
            k = np.argmax(np.where(late, means, -np.inf))
            words += f", second {means[k]:.2f} at {t[k]:.2f}"
        return words

    return measured


def pistoned(amplitude, period, ramp):
    """Settings of the piston's case."""
    return [f"blocks.paddle.motion={PISTON.format(amplitude, period, ramp)}"]


# case, settings, ten times the fastest flow (m/s), measure, required
ROWS = {
    "still_tank": ("still_tank", [], 31.3, still_tank, "p 1.5 %, speed 0.5 %"),
    "piston_05": ("piston", pistoned(0.04, 4.17341, 4.2), 31.3, piston(0.5, 0.08, (7.6, 11.8)), "4 %, 2 %"),
    "piston_1": ("piston", [], 31.3, piston(1.0, 0.06, (11.4, 16.0)), "4 %, 2 %"),
    "piston_2": ("piston", pistoned(0.03, 1.4447, 2.9), 31.3, piston(2.0, 0.06, (11.6, 15.95)), "5 %, 2 %"),
    "standing_3": (OF_STUDIES + "standing_wave_high", ["fluid.resolution=Spacing(0.0666666667)"], 31.3, standing, "keeps"),
    "standing_5": (OF_STUDIES + "standing_wave_high", [], 31.3, standing, "0.92"),
    "standing_10": (OF_STUDIES + "standing_wave_high", ["fluid.resolution=Spacing(0.02)"], 31.3, standing, "0.97"),
    "wave_train": (OF_STUDIES + "wave_train", [], 31.3, wave_train, "1 %"),
    "wave_train_10": (OF_STUDIES + "wave_train", ["fluid.resolution=Spacing(0.02)"], 31.3, wave_train, "-"),
    "solitary": ("solitary", [], 35.7, solitary, "1, 5, 5 %"),
    "dam_break": ("dam_break", [f"gauges={FRONT}"], 10.6, dam_break, "3 %"),
    "dam_break_pressure": (
        "dam_break_pressure", [], 17.2, impact(*IMPACTS["dam_break_pressure"]), "3 %, in the band of 0.5 to 0.7",
    ),
    "dam_break_wall": (
        "dam_break_wall", [], 24.3, impact(*IMPACTS["dam_break_wall"]), "3 %, 10 %, 0.89 at 5.84",
    ),
}


class Run(shared.Run):
    """A run folder with its summary and the table that gauges are read from."""

    record = "gauges.csv"

    def summary(self):
        """Contents of `summary.json`."""
        return json.loads((self.folder / "summary.json").read_text())


def words(measure, run):
    """A measure of a run, and of the potential flow whose record lies beside it."""
    found = measure(run)
    if (run.folder / "potential.csv").exists():
        run.record = "potential.csv"
        found += f" (potential flow: {measure(run)})"
    return found


def main():
    """The table."""
    args = shared.arguments(__doc__, ROWS, schemes=SCHEMES)
    table = [["row", "required", *args.schemes]]
    for row in args.rows:
        case, settings, c10, measure, required = ROWS[row]
        cells = [row, required]
        for scheme in args.schemes:
            chosen = [one.format(c10=c10) for one in SCHEMES[scheme]]
            run = shared.run(args, CASES / f"{case}.ron", "Particles", f"{row}_{scheme}", [*settings, *chosen])
            cells.append(f"{words(measure, Run(run.folder))}; {run.cpu:.0f} s" if run else "")
        table.append(cells)
    shared.table(table)


if __name__ == "__main__":
    main()
