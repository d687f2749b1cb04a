#!/usr/bin/env python3
"""Rock and water against laboratory experiments with every wall method: runs, a table and plots.

    python3 benches/python/laboratory.py [ROW ...] --riprap PATH --runs DIR --records DIR --walls Penalty,Particles,Integral

Rows are ellipse, ellipse_potential, ellipse_free, falling_block, floating_block, cosine_block, cube, heave_sphere and submarine_body; their
scenes are in cases/ and benches/scenes/laboratory/, each with its source. Prints `row | required | W1 | W2 | W3` with errors and CPU
seconds, and plots `plots/laboratory_ROW.png`: raster images, from which records of others cannot be recovered as data.

Records are not part of this repository. `--records` is a folder of your own with any of these CSV files, in it or in its
subfolders; a row without record is compared with the values quoted in its scene, or given as measured.

    SG3_IS5_motion.csv        t_s, com_x_m, com_y_m: displacement of the block; also for the other runs of the ellipse
    SG3_IS5_eta_t.csv         t_s, eta_x0.5_m to eta_x4.5_m: free surface at the gauges
    falling_block_exp.csv     t_s, y_m: height of the center
    floating_block_exp.csv    t_s, y_m: height of the center
    Case_A_gauges.csv         t_s, g1_mm, g2_mm: free surface
    one_cube_exp_x.csv        t_s, x_m: position of the cube's center
    heave_codes.csv           t_s, NREL_CFD and other codes: heave, m
    d61_gauges.csv            t_s, g1ave_mm to g4ave_mm: free surface

Levels: the mean before the wave is subtracted, for a run that of the first 0.1 s, for a record that of the first 0.1 s or, if
it starts before the release, that before. Extremes, of runs and records alike: least-squares parabola through the samples
within 0.07 s of the highest or lowest value in a time window. Arrival is the time of an extreme. Errors of heights are
relative to the record's height, those of times to the record's time. Windows: the leading trough of the ellipse is the lowest value
until PASSED, its crest the highest before that; those of other rows are given with their gauges.
"""

import importlib.util
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import numpy as np  # noqa: E402
import rows as shared  # noqa: E402
from matplotlib import pyplot as plt  # noqa: E402

HERE = Path(__file__).resolve().parent
CASES = HERE.parents[1] / "cases"
SCENES = HERE.parent / "scenes/laboratory"


def module(name):
    """A generator of scenes."""
    spec = importlib.util.spec_from_file_location(name, HERE / f"{name}.py")
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


# runs ---------------------------------------------------------------------------------------------------------------------


class Run(shared.Run):
    """A run folder and the CPU seconds it took."""

    def series(self, name, start):
        """Time and a column of a table, as arrays without empty cells; for blocks, that of the first."""
        time = np.array(self.column(name, "time"))
        values = np.array(self.column(name, start))
        there = np.isfinite(values)
        if name == "blocks.csv":
            blocks = np.array(self.column(name, "block"))
            there &= blocks == blocks[0]
        return time[there], values[there]

    def note(self):
        """Cost of the run, and time of an early end."""
        early = "" if self.code == 0 else f"; ended early at {self.column('energy.csv', 'time')[-1]:.2f} s"
        return f"{self.cpu:.0f} s{early}"


def run(args, scene, walls, name, settings=()):
    """The run of a scene with one wall method, if available."""
    made = shared.run(args, scene, walls, name, settings)
    return made and Run(made.folder)


def record(args, name):
    """Columns of a record as arrays, or None."""
    found = sorted(args.records.rglob(name)) if args.records else []
    if not found:
        return None
    return {key: np.array(values) for key, values in shared.columns(found[0]).items() if key}


def settled(walls, time):
    """Settings of runs in two dimensions: with penalty walls the water sinks by a spacing in the first 0.05 s, so it settles first."""
    return [f"time.settle={time}"] if walls == "Penalty" else []


# evaluation -------------------------------------------------------------------------------------------------------------


def levelled(time, values, until=0.1):
    """Values minus their mean up to a time."""
    before = time <= max(until, time[0])
    return values - values[before].mean()


def extreme(time, values, window, sense, reach=0.07):
    """Time and height of the highest (sense 1) or lowest (-1) value in a window."""
    inside = (window[0] <= time) & (time <= window[1])
    if not inside.any():
        return math.nan, math.nan
    at = np.flatnonzero(inside)[np.argmax(sense * values[inside])]
    near = np.abs(time - time[at]) <= reach
    if near.sum() < 3:
        return time[at], values[at]
    a, b, c = np.polyfit(time[near] - time[at], values[near], 2)
    top = -b / (2 * a) if a * sense < 0 else 0.0
    if abs(top) > reach:
        return time[at], values[at]
    return time[at] + top, (a * top + b) * top + c


def leading(time, values, until, reach=0.07):
    """Leading crest and trough: the lowest value up to a time, the highest one before that."""
    trough = extreme(time, values, (0, until), -1, reach)
    return extreme(time, values, (0, trough[0]), 1, reach), trough


def percent(found, asked):
    """Error of a number."""
    return f"{100 * (found / asked - 1):+.0f}" if math.isfinite(found) else "-"


def apart(time, values, times, asked, shift=0.0):
    """Root mean square difference of a series from points, with a time shift."""
    return float(np.sqrt(np.mean((np.interp(times, time + shift, values) - asked) ** 2)))


def best_shift(time, values, times, asked, most=0.1):
    """The time shift, up to a limit, with the least root mean square difference."""
    return min(np.arange(-most, most + 1e-9, 0.005), key=lambda shift: apart(time, values, times, asked, shift))


def grid(n_rows, n_columns, width=2.4, height=1.5):
    """A figure of panels with a common time axis."""
    made, panels = plt.subplots(n_rows, n_columns, sharex=True, squeeze=False,
                                figsize=(max(6.5, width * n_columns), max(2.6, height * n_rows)))
    for panel in panels.flat:
        panel.tick_params(labelsize=6)
        panel.grid(lw=0.3)
    for panel in panels[-1]:
        panel.set_xlabel("time [s]", fontsize=7)
    return made, panels


def save(args, made, row):
    """Writes a figure as an image."""
    args.plots.mkdir(parents=True, exist_ok=True)
    made.tight_layout()
    made.savefig(args.plots / f"laboratory_{row}.png", dpi=110, metadata={"Software": None})
    plt.close(made)


def legend(panel):
    """Legend of the curves, if any."""
    if not panel.get_legend_handles_labels()[1]:
        return
    panel.legend(fontsize=6, loc="best", frameon=False)


# rows ---------------------------------------------------------------------------------------------------------------------

GAUGES = (0.5, 1.5, 2.5, 3.5, 4.5)
# time until which the leading trough has passed each of them
PASSED = (1.6, 2.5, 3.3, 3.7, 4.2)
# SG3_IS5 as its scene quotes it: time and height of crests and troughs; s, m
QUOTED = {"SG3_IS5": [((0.42, 0.0041), (0.95, -0.0226)), ((1.23, 0.0130), (1.75, -0.0314)),
                      ((1.87, 0.0141), (2.58, -0.0300)), ((2.37, 0.0118), (3.21, -0.0188)), ((2.89, 0.0105), (3.80, -0.0142))]}


def ellipse(args):
    """Eight runs of the half ellipse, each with its measured motion."""
    return slides(args, "ellipse", "10 %, arrival 3 %")


def ellipse_potential(args):
    """The same with the full height of the block, for records of a potential flow, by spacing."""
    rows = []
    for spacing in (10, 5):
        settings = [f"fluid.resolution=Spacing({spacing / 1000})", "output.frame_interval=5"]
        rows += slides(args, f"ellipse_potential_{spacing}mm", "3 %, at 4.5 m 5 %", 0.026, settings)
    return rows


def slides(args, row, required, height=None, settings=()):
    """Eight runs of the half ellipse of a height (m; the published volume's when left out)."""
    scenes = module("ellipse")
    folder = args.runs / "scenes"
    folder.mkdir(parents=True, exist_ok=True)
    made, panels = grid(len(GAUGES), len(scenes.MOTIONS))
    table = []
    for column, name in enumerate(scenes.MOTIONS):
        measured = record(args, f"{name}_eta_t.csv")
        asked = QUOTED.get(name)
        if measured:
            time = measured["t_s"]
            waves = [levelled(time, measured[f"eta_x{x}_m"]) for x in GAUGES]
            asked = [leading(time, wave, until) for wave, until in zip(waves, PASSED)]
            for panel, wave in zip(panels[:, column], waves):
                panel.plot(time, 1e3 * wave, "k.-", lw=0.6, ms=2, label="measured")
        panels[0, column].set_title(name, fontsize=8)
        cells = {}
        for walls in args.walls:
            scene = scenes.prescribed(name, folder, height)
            ran = run(args, scene, walls, f"{row}_{name}", [*settings, *settled(walls, 1)])
            if ran is None:
                continue
            found = []
            for panel, x, until in zip(panels[:, column], GAUGES, PASSED):
                time, wave = ran.series("gauges.csv", f"x{10 * x:02.0f}")
                wave = levelled(time, wave)
                found.append(leading(time, wave, until))
                panel.plot(time, 1e3 * wave, color=shared.COLORS[walls], lw=0.8, label=shared.WALLS[walls])
            cells[walls] = f"{heights(found, asked, 0)}; {heights(found, asked, 1)}; {ran.note()}"
        table.append((f"{row}, {name}: crests; troughs at x = 0.5 to 4.5 m", required, cells))
    for panel, x in zip(panels[:, 0], GAUGES):
        panel.set_ylabel(f"x = {x} m [mm]", fontsize=7)
        panel.set_xlim(0, 4.2)
    legend(panels[0, list(scenes.MOTIONS).index("SG3_IS5")])
    save(args, made, row)
    return table


def heights(found, asked, which):
    """Errors of crests (0) or troughs (1) and the largest error of their times; millimeters where no record is known."""
    if asked is None:
        return ", ".join(f"{1e3 * pair[which][1]:.1f}" for pair in found) + " mm"
    errors, late = [], []
    for one, other in zip(found, asked):
        (time, height), (time_asked, height_asked) = one[which], other[which]
        if abs(height_asked) < 1e-3:
            errors.append("n/a")
            continue
        errors.append(percent(height, height_asked))
        late.append(time - time_asked if math.isfinite(time) else 0.0)
    times = [time_asked for other in asked for time_asked in [other[which][0]] if abs(other[which][1]) >= 1e-3]
    worst = max(range(len(late)), key=lambda k: abs(late[k]) / times[k])
    return f"{', '.join(errors)} %, times within {100 * abs(late[worst]) / times[worst]:.0f} % ({max(map(abs, late)):.2f} s)"


# run, friction, sealed: the first two fitted to the displacement of SG3_IS5, the last blind
FREE = [("SG3_IS5", 0.02, False), ("SG3_IS5", 0.008, True), ("SG2_IS5", 0.02, False)]


def ellipse_free(args):
    """The released half ellipse, with a friction fitted to the displacement of one run."""
    scenes = module("ellipse")
    folder = args.runs / "scenes"
    folder.mkdir(parents=True, exist_ok=True)
    made, panels = grid(4, len(FREE), width=3.2)
    table = []
    for column, (name, friction, sealed) in enumerate(FREE):
        kind = "sealed" if sealed else "open"
        motion, surface = record(args, f"{name}_motion.csv"), record(args, f"{name}_eta_t.csv")
        panels[0, column].set_title(f"{name}, {kind}, friction {friction:g}", fontsize=8)
        asked = None
        if motion:
            steps = np.hypot(np.diff(motion["com_x_m"]), np.diff(motion["com_y_m"]))
            way_asked = np.concatenate([[0], np.cumsum(steps)])
            panels[0, column].plot(motion["t_s"], way_asked, "k", lw=0.8, label="measured")
        if surface:
            asked = []
            for panel, x, until in zip(panels[2:, column], GAUGES, PASSED):
                wave = levelled(surface["t_s"], surface[f"eta_x{x}_m"])
                asked.append(leading(surface["t_s"], wave, until))
                panel.plot(surface["t_s"], 1e3 * wave, "k.-", lw=0.6, ms=2)
        cells = {}
        for walls in args.walls:
            scene = scenes.free(name, folder, friction, sealed)
            ran = run(args, scene, walls, scene.stem, ["time.duration=2.6"])
            if ran is None:
                continue
            color = shared.COLORS[walls]
            time, x = ran.series("blocks.csv", "x [")
            _, z = ran.series("blocks.csv", "z [")
            way = np.concatenate([[0], np.cumsum(np.hypot(np.diff(x), np.diff(z)))])
            off = 1e3 * lift(scenes.flume(name), x, z)
            panels[0, column].plot(time, way, color=color, lw=0.8, label=shared.WALLS[walls])
            panels[1, column].plot(time, off, color=color, lw=0.8)
            found = []
            for panel, at, until in zip(panels[2:, column], GAUGES, PASSED):
                wave_time, wave = ran.series("gauges.csv", f"x{10 * at:02.0f}")
                wave = levelled(wave_time, wave)
                found.append(leading(wave_time, wave, until))
                panel.plot(wave_time, 1e3 * wave, color=color, lw=0.8)
            text = ""
            if motion:
                looks = [t for t in (0.4, 0.8, 1.2, 1.6, 2.0, 2.4) if t <= time[-1]]
                ratio = [np.interp(t, time, way) / np.interp(t, motion["t_s"], way_asked) - 1 for t in looks]
                text = ", ".join(f"{100 * r:+.1f}" for r in ratio) + f" % at {', '.join(f'{t:g}' for t in looks)} s; "
            waves = [f"{heights(found, asked[:2] if asked else None, which)}" for which in (0, 1)]
            high = ", ".join(f"{off[time <= t].max():.1f}" for t in (0.8, 1.2, 2.4))
            text += f"off the bed by {high} mm at most until 0.8, 1.2, 2.4 s; {'; '.join(waves)}; {ran.note()}"
            cells[walls] = text
        table.append((f"ellipse_free, {name}, {kind}, friction {friction:g}: way; crests; troughs at 0.5, 1.5 m",
                      "way; 10 %, arrival 3 %", cells))
    for panel, name in zip(panels[:, 0], ("way [m]", "off the bed [mm]", "x = 0.5 m [mm]", "x = 1.5 m [mm]")):
        panel.set_ylabel(name, fontsize=7)
    for panel in panels[1]:
        panel.set_ylim(-2, 20)
    panels[0, 0].set_xlim(0, 2.6)
    legend(panels[0, 0])
    save(args, made, "ellipse_free")
    return table


def lift(flume, x, z):
    """Elevation of a free block's centroid above its position with both ends of its base on the bed; m."""
    middle = flume.centroid(flume.outline()[1:-1])
    lying = np.array([flume.place(middle, flume.chord(rear)) for rear in np.arange(-0.3, 5, 0.005)])
    slope = np.gradient(lying[:, 1], lying[:, 0])
    return (z - np.interp(x, *lying.T)) * np.cos(np.arctan(np.interp(x, lying[:, 0], slope)))


def falling_block(args):
    """The falling block; the record's origin is shifted so that it ends on the floor."""
    return tank(args, "falling_block", 0.010, 0.4)


def floating_block(args):
    """The block released on the floor."""
    return tank(args, "floating_block", None, 1.5)


def tank(args, row, rest, until):
    """Height of a block in the small tank."""
    measured = record(args, f"{row}_exp.csv")
    made, panels = grid(1, 1)
    panel = panels[0, 0]
    points = None
    if measured:
        times, asked = measured["t_s"], measured["y_m"]
        asked = asked - (asked[-1] - rest if rest else 0)
        points = times[times <= until], asked[times <= until]
        panel.plot(points[0], 1e3 * points[1], "k.", ms=3, label="measured")
    table = []
    for spacing, style in ((2, "-"), (1, "--")):
        settings = [f"fluid.resolution=Spacing({spacing / 1000})"]
        name = row if spacing == 2 else f"{row}_{spacing}mm"
        wanted = args.walls if spacing == 2 else [walls for walls in args.walls if walls == "Particles"]
        cells = {}
        for walls in wanted:
            ran = run(args, SCENES / f"{row}.ron", walls, name, settings)
            if ran is not None:
                cells[walls] = height_of_block(ran, panel, (walls, style, spacing), points, rest)
        table.append((f"{row}, {spacing} mm: root mean square of the height", "3 mm, times 0.03 s", cells))
    panel.set_ylabel("height of the center [mm]", fontsize=7)
    panel.set_xlim(0, until)
    legend(panel)
    save(args, made, row)
    return table


def height_of_block(ran, panel, kind, measured, rest):
    """Plots the height of a block and returns its error; `rest` is that of a block that ends on the floor."""
    walls, style, spacing = kind
    time, height = ran.series("blocks.csv", "z [")
    panel.plot(time, 1e3 * height, color=shared.COLORS[walls], ls=style, lw=0.8,
               label=f"{shared.WALLS[walls]}, {spacing} mm")
    text = ""
    if measured:
        shift = best_shift(time, height, *measured)
        text = (f"{1e3 * apart(time, height, *measured):.1f} mm; moved by {shift:+.3f} s "
                f"{1e3 * apart(time, height, *measured, shift):.1f} mm; ")
    if rest:
        near = height < rest + 0.003
        text += f"3 mm over the floor at {time[np.argmax(near)]:.3f} s" if near.any() else "not down"
        text += f", at the end {1e3 * (height[-1] - rest):.1f} mm over it"
    else:
        first = int(np.argmax(np.where(time < 0.8, height, 0)))
        low = first + int(np.argmin(np.where((time >= time[first]) & (time < time[first] + 0.3), height, 1)[first:]))
        high = low + int(np.argmax(np.where(time < time[low] + 0.3, height, 0)[low:]))
        text += ", ".join(f"{1e3 * height[k]:.1f} mm at {time[k]:.2f} s" for k in (first, low, high))
    return f"{text}; {ran.note()}"


# of the gauges: name, window, sense, as quoted; s, mm
COSINE = [("g1", (0.1, 0.6), -1, (0.33, -3.9)), ("g1", (0.6, 1.2), 1, (1.03, 1.9)), ("g2", (0.2, 0.7), 1, (0.52, 6.8)),
          ("g2", (0.65, 1.05), -1, (0.88, -11.2)), ("g2", (1.0, 1.28), 1, (1.20, 7.1))]


def cosine_block(args):
    """The block of Zhou & Teng, case A."""
    measured = record(args, "Case_A_gauges.csv")
    made, panels = grid(2, 1)
    asked = [quoted for _, _, _, quoted in COSINE]
    if measured:
        waves = {g: levelled(measured["t_s"], measured[f"{g}_mm"], 0) for g in ("g1", "g2")}
        asked = [extreme(measured["t_s"], waves[g], window, sense) for g, window, sense, _ in COSINE]
        for panel, g in zip(panels[:, 0], waves):
            panel.plot(measured["t_s"], waves[g], "k.-", lw=0.6, ms=2, label="measured")
    cells = {}
    for walls in args.walls:
        ran = run(args, SCENES / "cosine_block.ron", walls, "cosine_block", settled(walls, 0.5))
        if ran is None:
            continue
        for panel, g in zip(panels[:, 0], ("g1", "g2")):
            time, wave = ran.series("gauges.csv", g)
            panel.plot(time, 1e3 * levelled(time, wave), color=shared.COLORS[walls], lw=0.8, label=shared.WALLS[walls])
        found = []
        for g, (start, end), sense, _ in COSINE:
            time, wave = ran.series("gauges.csv", g)
            if end + 0.1 < time[-1]:
                found.append(extreme(time, 1e3 * levelled(time, wave), (start, end + 0.1), sense))
        errors = [f"{percent(h, other)} % ({t - at:+.2f} s)" for (t, h), (at, other) in zip(found, asked)]
        cells[walls] = f"{', '.join(errors)}; {ran.note()}"
    for panel, x in zip(panels[:, 0], (0.618, 1.128)):
        panel.set_ylabel(f"x = {x} m [mm]", fontsize=7)
    panels[0, 0].set_xlim(0, 1.4)
    legend(panels[0, 0])
    save(args, made, "cosine_block")
    return [("cosine_block: trough, crest at 0.618 m; crest, trough, crest at 1.128 m", "10 %, arrival 3 %", cells)]


def cube(args):
    """One cube in a dam break."""
    measured = record(args, "one_cube_exp_x.csv")
    times, asked = (np.array([0.6, 1.0, 1.2, 1.4]), np.array([1.82, 2.13, 2.51, 2.90]))
    made, panels = grid(2, 1, height=1.9)
    if measured:
        times, asked = measured["t_s"], measured["x_m"]
    panels[0, 0].plot(times, asked, "k.", ms=3, label="measured")
    table = []
    for spacing, style in ((0.025, "-"), (0.03, "--")):
        name = "cube" if spacing == 0.025 else f"cube_{1e3 * spacing:.0f}"
        cells = {}
        for walls in args.walls:
            ran = run(args, CASES / "dam_break_cube.ron", walls, name, [f"fluid.resolution=Spacing({spacing})"])
            if ran is None:
                continue
            time, x = ran.series("blocks.csv", "x [")
            _, z = ran.series("blocks.csv", "z [")
            kind = f"{shared.WALLS[walls]}, {1e3 * spacing:.0f} mm"
            panels[0, 0].plot(time, x, color=shared.COLORS[walls], ls=style, lw=0.8, label=kind)
            panels[1, 0].plot(time, 1e3 * z, color=shared.COLORS[walls], ls=style, lw=0.8, label=kind)
            there = times <= time[-1]
            shift = best_shift(time, x, times[there], asked[there])
            places = ", ".join(f"{np.interp(t, time, x):.2f}" for t in (0.6, 1.0, 1.2, 1.4))
            cells[walls] = (f"{100 * apart(time, x, times[there], asked[there]) / 1.39:.1f} %, moved by {shift:+.3f} s "
                            f"{100 * apart(time, x, times[there], asked[there], shift) / 1.39:.1f} %; {places} m; "
                            f"center {1e3 * z.max():.0f} mm high at most; {ran.note()}")
        table.append((f"cube, {1e3 * spacing:.0f} mm: root mean square of the place; at 0.6, 1.0, 1.2, 1.4 s",
                      "5 % of 1.39 m; 1.82, 2.13, 2.51, 2.90 m", cells))
    panels[0, 0].set_ylabel("place [m]", fontsize=7)
    panels[1, 0].set_ylabel("height of the center [mm]", fontsize=7)
    legend(panels[0, 0])
    save(args, made, "cube")
    return table


# extrema of the most complete computation: time, heave; s, m
HEAVE = [(2.23, -0.869), (4.45, 0.637), (6.63, -0.469), (8.81, 0.349)]


def heave_sphere(args):
    """Heave decay of a sphere."""
    measured = record(args, "heave_codes.csv")
    made, panels = grid(1, 1, height=2.6)
    panel = panels[0, 0]
    if measured:
        for name in measured:
            if name != "t_s":
                best = name == "NREL_CFD"
                panel.plot(measured["t_s"], measured[name], "k" if best else "0.7", lw=0.8 if best else 0.4,
                           label=name if best else None)
    cells = {}
    for walls in args.walls:
        ran = run(args, SCENES / "heave_sphere.ron", walls, "heave_sphere")
        if ran is None:
            continue
        time, z = ran.series("blocks.csv", "z [")
        panel.plot(time, z, color=shared.COLORS[walls], lw=0.8, label=shared.WALLS[walls])
        seen = [(t, h) for t, h in HEAVE if t + 0.8 < time[-1]]
        found = [extreme(time, z, (t - 0.8, t + 0.8), math.copysign(1, h), 0.3) for t, h in seen]
        errors = ", ".join(f"{percent(h, other)} % ({t - at:+.2f} s)" for (t, h), (at, other) in zip(found, seen))
        change = np.flatnonzero(np.diff(np.sign(z)))
        crossings = [time[k] - z[k] * (time[k + 1] - time[k]) / (z[k + 1] - z[k]) for k in change]
        period = 100 * ((found[-1][0] - found[0][0]) / (seen[-1][0] - seen[0][0]) - 1) if 1 < len(seen) else math.nan
        cells[walls] = (f"by extrema {period:+.1f} %, crossings at {', '.join(f'{t:.2f}' for t in crossings[:4])} s; {errors}; "
                        f"{ran.note()}")
    panel.set_ylabel("heave [m]", fontsize=7)
    panel.set_xlim(0, 10)
    legend(panel)
    save(args, made, "heave_sphere")
    return [("heave_sphere: period; first extrema", "2 %, first crossing 1.15 s; 5 %", cells)]


# gauge, windows of crest or trough and sense, as quoted; s, mm
BODY = [("g1", (0.2, 0.7), -1, (0.45, -12.3)), ("g2", (1.3, 1.8), -1, (1.58, -13.9)), ("g2", (1.8, 2.2), 1, (1.98, 15.4)),
        ("g3", (1.6, 2.1), -1, (1.89, -16.9)), ("g3", (2.1, 2.5), 1, (2.30, 22.0)), ("g4", (1.7, 2.15), -1, (1.94, -9.3)),
        ("g4", (2.1, 2.55), 1, (2.37, 11.0))]


def submarine_body(args):
    """The body of Enet & Grilli, d = 61 mm."""
    measured = record(args, "d61_gauges.csv")
    made, panels = grid(4, 1)
    asked = [quoted for _, _, _, quoted in BODY]
    names = ("g1", "g2", "g3", "g4")
    if measured:
        waves = {g: levelled(measured["t_s"], measured[f"{g}ave_mm"]) for g in names}
        asked = [extreme(measured["t_s"], waves[g], window, sense) for g, window, sense, _ in BODY]
        for panel, g in zip(panels[:, 0], names):
            panel.plot(measured["t_s"], waves[g], "k", lw=0.8, label="measured")
    cells = {}
    for walls in args.walls:
        ran = run(args, SCENES / "submarine_body.ron", walls, "submarine_body")
        if ran is None:
            continue
        for panel, g in zip(panels[:, 0], names):
            time, wave = ran.series("gauges.csv", g)
            panel.plot(time, 1e3 * levelled(time, wave), color=shared.COLORS[walls], lw=0.8, label=shared.WALLS[walls])
        errors = []
        for (g, window, sense, _), (at, height) in zip(BODY, asked):
            time, wave = ran.series("gauges.csv", g)
            found = extreme(time, 1e3 * levelled(time, wave), (window[0], window[1] + 0.1), sense)
            errors.append(f"{g} {found[1]:+.1f} mm ({percent(found[1], height)} %, {found[0] - at:+.2f} s)")
        cells[walls] = f"{', '.join(errors)}; {ran.note()}"
    for panel, g in zip(panels[:, 0], names):
        panel.set_ylabel(f"{g} [mm]", fontsize=7)
    panels[0, 0].set_xlim(0, 3)
    legend(panels[0, 0])
    save(args, made, "submarine_body")
    return [("submarine_body: troughs and crests at four gauges", "10 %, arrival 0.1 s", cells)]


ROWS = {one.__name__: one for one in (ellipse, ellipse_potential, ellipse_free, falling_block, floating_block, cosine_block, cube,
                                      heave_sphere, submarine_body)}


def main():
    """Runs the requested rows and prints the table."""
    args = shared.arguments(__doc__.splitlines()[0], ROWS, records=True)
    table = [["row", "asked", *shared.WALLS.values()]]
    for row in args.rows:
        for label, asked, cells in ROWS[row](args):
            table.append([label, asked, *(cells.get(walls, "not run") for walls in shared.WALLS)])
    shared.table(table)


if __name__ == "__main__":
    main()
