"""Rock and water against theory, with the three wall methods.

    python3 benches/python/coupling.py [ROW ...] --riprap target/release/riprap --runs runs/benches --walls Penalty,Particles,Integral

Prints a table of errors and the CPU seconds of each run, and plots each row in `coupling_ROW.svg`. Scenes are
`benches/scenes/coupling/*.ron` and four of `cases/`; their headers have the solution and its source. Needs numpy and matplotlib.
"""

import json
import math
import struct
import zlib
from pathlib import Path

import numpy as np

from rows import COLORS, WALLS, arguments, figure, run, save, table

BENCHES = Path(__file__).resolve().parents[1]
SCENES = BENCHES / "scenes/coupling"
CASES = BENCHES.parent / "cases"
RHO, G = 1000.0, 9.81


# --- runs


def runs(args, case, name, settings=()):
    """Runs of a case by wall method, if possible, each with its CPU seconds."""
    made = {walls: run(args, case, walls, name, settings) for walls in WALLS}
    return {walls: one for walls, one in made.items() if one is not None}


def columns(made, name):
    """Columns of a table as arrays, by their names without units."""
    return {key.rsplit(" [", 1)[0]: np.array(column) for key, column in made.columns(name).items()}


def of_block(made, name, block):
    """Rows of a table that belong to a block."""
    all_rows = columns(made, name)
    mine = all_rows["block"] == block
    return {key: column[mine] for key, column in all_rows.items()}


def load(rows):
    """Force and moment of the water by forces.csv: by pressure, shear, and stopped particles."""
    return {c: sum(rows[f"{source}_{c}"] for source in ("pressure", "shear", "pushed_back")) for c in
            ("fx", "fy", "fz", "mx", "my", "mz")}


def summary(made):
    return json.loads((made.folder / "summary.json").read_text())


def row(name, asked, found, say):
    """A row of the table: the text of `say` for each run, and its seconds."""
    def cell(walls):
        if walls not in found:
            return "-"
        made = found[walls]
        early = f"; ended early at {summary(made)['simulated_time']:.3g} s" if made.code else ""
        return f"{say(made)}{early}; {made.cpu:.0f} s"
    return [name, asked] + [cell(walls) for walls in WALLS]


def draw(panel, made, walls, x, y, **more):
    panel.plot(x, y, color=COLORS[walls], lw=0.9, label=WALLS[walls], **more)


# --- numbers


def percent(ratio):
    return f"{100 * (ratio - 1):+.2f} %"


def smooth_mean(values):
    """Mean weighted by a Hann window, which suppresses oscillations at any phase."""
    weights = np.hanning(len(values) + 2)[1:-1]
    return float(np.sum(weights * values) / np.sum(weights))


def risings(t, x):
    """Times at which a record rises through its mean."""
    x = x - np.mean(x)
    k = np.flatnonzero((x[:-1] < 0) & (0 <= x[1:]))
    return t[k] - x[k] * (t[k + 1] - t[k]) / (x[k + 1] - x[k])


def turned(first, second):
    """Axis and angle (degrees) of a rotation followed by another, each axis and angle."""
    def quaternion(axis, angle):
        half = math.radians(angle) / 2
        return math.cos(half), math.sin(half) * np.array(axis, float)
    (s1, v1), (s2, v2) = quaternion(*first), quaternion(*second)
    s, v = s2 * s1 - v2 @ v1, s2 * v1 + s1 * v2 + np.cross(v2, v1)
    return v / np.linalg.norm(v), math.degrees(2 * math.acos(s))


# --- rows: each returns lines of the table and makes its plot


def submerged_bodies():
    """Shape, placement and volume of bodies 12 spacings (0.24 m) across about (0.26, 0.26, 0.26)."""
    middle, size = np.full(3, 0.26), 0.24
    golden = (1 + math.sqrt(5)) / 2
    scale = size / 2 / math.hypot(1, golden)
    corners = [np.roll((0, s, t * golden), k) for s in (1, -1) for t in (1, -1) for k in range(3)]
    hull = ", ".join("({:.9f}, {:.9f}, {:.9f})".format(*(middle + scale * c)) for c in corners)
    leg = size / math.sqrt(3)
    # angles of 90 and 60 degrees below, of 30 above; and upside down
    up = [(-leg / 3, -size / 3), (2 * leg / 3, -size / 3), (-leg / 3, 2 * size / 3)]
    blunt = [(-size / 2, -size / math.sqrt(12)), (size / 2, -size / math.sqrt(12)), (0, size / math.sqrt(3))]

    def wedge(corners):
        polygon = ", ".join(f"({0.26 + x:.9f}, {0.26 + z:.9f})" for x, z in corners)
        return f"Extrusion(polygon: [{polygon}], axis: Y, from: 0.14, to: 0.38)"
    axis, angle = turned(((1, 0, 0), 20), ((0, 1, 0), 20))
    tilt = "(rotate: (axis: ({:.9f}, {:.9f}, {:.9f}), angle_deg: {:.9f}, about: (0.26, 0.26, 0.26)))".format(*axis, angle)
    as_drawn = "(translate: (0, 0, 0))"
    prism = size * leg / 2 * size
    return {
        "cube": ("Box(min: (0.14, 0.14, 0.14), max: (0.38, 0.38, 0.38))", as_drawn, size**3),
        "icosahedron": (f"Hull(points: [{hull}])", as_drawn, 5 / 12 * (3 + math.sqrt(5)) * (2 * scale) ** 3),
        # blunt: not a thin solid for walls of particles
        "prism of 60 degrees": (wedge(blunt), as_drawn, size**3 * math.sqrt(3) / 4),
        "wedge, edge up": (wedge(up), as_drawn, prism),
        "wedge, edge down": (wedge([(x, -z) for x, z in up]), as_drawn, prism),
        "wedge, tilted": (wedge(up), tilt, prism),
    }


def submerged(args):
    lines = []
    bodies = submerged_bodies()
    made_figure, panels = figure(len(bodies))
    for panel, (name, (shape, placement, volume)) in zip(panels, bodies.items()):
        weight = RHO * G * volume
        settings = [f"blocks.body.shape={shape}", f"blocks.body.placement={placement}"]
        found = runs(args, SCENES / "submerged.ron", "submerged_" + name.replace(",", "").replace(" ", "_"), settings)

        def say(made):
            rows = of_block(made, "forces.csv", 0)
            late = rows["time"] > 0.5 * rows["time"][-1]
            felt = {c: x[late] for c, x in load(rows).items()}
            mean = {c: smooth_mean(x) for c, x in felt.items()}
            turning = math.hypot(mean["mx"], mean["my"]) / (weight * 0.24)
            aside = math.hypot(mean["fx"], mean["fy"]) / weight
            return (f"{percent(mean['fz'] / weight)} ± {100 * np.std(felt['fz']) / weight:.1f}; moment {100 * turning:.2f} %, "
                    f"aside {100 * aside:.2f} %")

        lines.append(row(f"submerged {name}", "1.5 % of ρgV; 1 % of ρgVL", found, say))
        for walls, made in found.items():
            rows = of_block(made, "forces.csv", 0)
            draw(panel, made, walls, rows["time"], load(rows)["fz"] / weight)
        panel.axhline(1, color="black", lw=0.8, ls="--")
        panel.set_ylabel(f"{name}\nforce up / ρgV", fontsize=7)
        panel.set_ylim(0.65, 1.2)
    panels[0].legend(fontsize=7, ncol=3)
    save(args, made_figure, "coupling_submerged")
    return lines


def submerged_plane(args):
    """Polygons in two dimensions: squares rotated by some angles, triangles of 60 degrees and of 30, 60 and 90."""
    size = 0.24
    square = [(-size / 2, -size / 2), (size / 2, -size / 2), (size / 2, size / 2), (-size / 2, size / 2)]
    blunt = [(-size / 2, -size / math.sqrt(12)), (size / 2, -size / math.sqrt(12)), (0, size / math.sqrt(3))]
    leg = size / math.sqrt(3)
    sharp = [(-leg / 3, -size / 3), (2 * leg / 3, -size / 3), (-leg / 3, 2 * size / 3)]
    lines = []
    made_figure, panels = figure(3)
    for panel, (name, corners, angles) in zip(panels, (("square", square, (5, 20, 45)), ("triangle of 60 degrees", blunt, (0, 20)),
                                                       ("triangle of 30, 60, 90", sharp, (0, 20)))):
        corners = np.array(corners)
        x, z = corners.T
        area = 0.5 * abs(np.sum(x * np.roll(z, -1) - z * np.roll(x, -1)))
        weight = RHO * G * area * 0.1
        for spacing in (0.02, 0.01):
            for angle in angles:
                c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
                polygon = ", ".join(f"({0.39 + c * x - s * z:.9f}, {0.27 + s * x + c * z:.9f})" for x, z in corners)
                settings = [f"blocks.body.shape=Extrusion(polygon: [{polygon}], axis: Y, from: 0, to: 0.1)",
                            f"fluid.resolution=Spacing({spacing})"]
                label = f"{name} at {angle} degrees, {round(size / spacing)} spacings"
                found = runs(args, SCENES / "submerged_plane.ron", "plane_" + label.replace(",", "").replace(" ", "_"), settings)

                def say(made):
                    rows = of_block(made, "forces.csv", 0)
                    up = load(rows)["fz"][rows["time"] > 0.5 * rows["time"][-1]] / weight
                    return f"{percent(smooth_mean(up))} ± {100 * np.std(up):.1f}"

                lines.append(row(f"in a plane, {label}", "1.5 % of ρgA", found, say))
                if angle == 20:
                    for walls, made in found.items():
                        rows = of_block(made, "forces.csv", 0)
                        panel.plot(rows["time"], load(rows)["fz"] / weight, color=COLORS[walls], lw=0.9,
                                   ls="-" if spacing == 0.01 else ":", label=f"{WALLS[walls]}, {round(size / spacing)} spacings")
        panel.axhline(1, color="black", lw=0.8, ls="--")
        panel.set_ylabel(f"{name}\nforce up / ρgA", fontsize=7)
    panels[0].legend(fontsize=7, ncol=3)
    save(args, made_figure, "coupling_submerged_plane")
    return lines


def floating_boxes(args):
    found = runs(args, CASES / "floating_boxes.ron", "floating_boxes")
    names = ["fifth", "half", "nine tenths", "square"]
    exact = [0.436, 0.4, 0.352, 0.4]

    def angle(made):
        rows = of_block(made, "blocks.csv", 3)
        t, w = rows["time"], np.degrees(rows["wy"])
        return t, 10 + np.concatenate([[0], np.cumsum(np.diff(t) * (w[1:] + w[:-1]) / 2)])

    def say(made):
        said = []
        for block, right in enumerate(exact):
            rows = of_block(made, "blocks.csv", block)
            late = rows["z"][rows["time"] > 4]
            said.append(f"{(np.mean(late) - right) / 0.01:+.2f}")
        t, turned_by = angle(made)
        return f"{', '.join(said)} spacings; at {np.mean(turned_by[t > 4]):.1f} ± {np.std(turned_by[t > 4]):.1f} degrees"

    made_figure, panels = figure(5)
    for walls, made in found.items():
        for block in range(4):
            rows = of_block(made, "blocks.csv", block)
            draw(panels[block], made, walls, rows["time"], 1000 * (rows["z"] - exact[block]))
        draw(panels[4], made, walls, *angle(made))
    for panel, name in zip(panels, names):
        panel.axhline(0, color="black", lw=0.8, ls="--")
        panel.axhspan(-2.5, 2.5, color="black", alpha=0.08)
        panel.set_ylabel(f"{name}\nabove draft [mm]", fontsize=7)
    panels[4].axhline(45, color="black", lw=0.8, ls="--")
    panels[4].set_ylabel("square turned [deg]", fontsize=7)
    panels[0].legend(fontsize=7, ncol=3)
    save(args, made_figure, "coupling_floating_boxes")
    return [row("floating_boxes 0.2, 0.5, 0.9; square: centroid over that of Archimedes", "0.25 spacing; 45 degrees", found, say)]


def radiation(omega, half, gap, depth, n=60):
    """Added mass and damping per width of a rectangle of width 2 `half`, `gap` over the bed, heaving in two dimensions.

    Matched eigenfunctions. Under the box, z from the bed:
        φ = (z² − x²)/(2 gap) + Σ A_n cosh(μ_n x)/cosh(μ_n half) cos(μ_n z),   μ_n = n π/gap
    and outside φ = Σ B_m exp(−κ_m (x − half)) cos(κ_m z)/√N_m with κ_0 = −i k, ω² = g k tanh(k depth) = −g κ_m tan(κ_m depth).
    Potential and normal velocity agree at x = half. Added mass + i damping/ω = ρ ∫ φ dx under the box, for exp(−iωt).
    """
    nu = omega**2 / G
    k = max(nu, math.sqrt(nu / depth))
    for _ in range(50):
        t = math.tanh(k * depth)
        k -= (k * t - nu) / (t + k * depth * (1 - t * t))
    low = (np.arange(1, n) - 0.5) * np.pi / depth * (1 + 1e-14)
    high = np.arange(1, n) * np.pi / depth
    for _ in range(60):
        middle = (low + high) / 2
        below = middle * np.tan(middle * depth) + nu < 0
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    kappa = np.concatenate([[-1j * k], low])
    norm_out = depth / 2 * (1 + np.sin(2 * kappa * depth) / (2 * kappa * depth))
    order = np.arange(n)
    mu = order * np.pi / gap
    total, difference = mu[:, None] + kappa, mu[:, None] - kappa
    c = (np.sin(difference * gap) / (2 * difference) + np.sin(total * gap) / (2 * total)) / np.sqrt(norm_out)
    sign = (-1.0) ** order
    norm = np.where(order == 0, gap, gap / 2)
    # of (z² − half²)/(2 gap)
    particular = np.where(order == 0, gap**2 / 6 - half**2 / 2, sign / np.where(order == 0, 1, mu) ** 2)
    slope = mu * np.tanh(mu * half)
    joined = (c / -kappa) @ c.T
    a = np.linalg.solve(np.diag(norm) - joined * slope, -particular - half / gap * joined[:, 0])
    modes = 2 * np.tanh(mu[1:] * half) / mu[1:]
    integral = gap * half - half**3 / (3 * gap) + 2 * half * a[0] + np.sum(a[1:] * sign[1:] * modes)
    return RHO * integral.real, RHO * omega * integral.imag


def decay(ratio, times, start):
    """Heave (m) of a box 0.4 m wide, 0.2 m high of a density ratio in water 0.5 m deep, released `start` above its draft.

        z(t) = start + 2/π ∫ Re V(ω) sin(ωt)/ω dω,   V = −c start/(c − ω² (m + a) − i ω b)
    """
    draft = 0.2 * ratio
    mass, spring = RHO * 0.4 * draft, RHO * G * 0.4
    omega = np.linspace(0.02, 60, 1500)
    speed = []
    for w in omega:
        added, damping = radiation(w, 0.2, 0.5 - draft, 0.5, 40)
        speed.append((-spring * start / (spring - w**2 * (mass + added) - 1j * w * damping)).real)
    # toward ω = 0 the integrand is extrapolated
    weights = np.full(len(omega), omega[1] - omega[0])
    weights[0], weights[-1] = 0.5 * weights[0] + omega[0], 0.5 * weights[-1]
    return start + 2 / np.pi * np.sin(np.outer(times, omega)) @ (weights * np.array(speed) / omega)


def turns(t, x, about):
    """Times and values of the lowest point before three quarters of a time and of the highest point after it before 1.4 of it, by
    parabolas; a Hann window of 60 ms removes sound."""
    width = int(round(0.06 / (t[1] - t[0])))
    window = np.hanning(width + 2)[1:-1]
    x = np.convolve(np.pad(x, width, mode="edge"), window / window.sum(), mode="same")[width:-width]
    low = np.argmin(np.where(t < 0.75 * about, x, np.inf))
    high = np.argmax(np.where((t[low] < t) & (t < 1.4 * about) & (t < t[-1] - 0.06), x, -np.inf))
    found = []
    for k in (low, high):
        a, b, c = x[k - 1], x[k], x[k + 1]
        found.append((t[k] + 0.5 * (t[k + 1] - t[k]) * (a - c) / (a - 2 * b + c), b))
    return found


def heave_boxes(args):
    lines = []
    made_figure, panels = figure(3, 1.8)
    fine = np.arange(0, 1.6, 0.004)
    for panel, (ratio, period) in zip(panels, ((0.2, 0.830), (0.5, 0.984), (0.9, 1.171))):
        z0 = 0.5 - 0.2 * ratio + 0.02
        settings = [f"materials.box.density={1000 * ratio:g}", f"blocks.box.placement.translate=(0, 0, {z0:g})"]
        found = runs(args, SCENES / "heave_boxes.ron", f"heave_{ratio}", settings)
        exact = decay(ratio, fine, 0.02)
        (t1, z1), (t2, z2) = turns(fine, exact, period)

        def say(made):
            rows = of_block(made, "blocks.csv", 0)
            (m1, y1), (m2, y2) = turns(rows["time"], rows["z"] - z0 - 0.1 + 0.02, period)
            return (f"first return {percent(m2 / t2)}, first trough {percent(m1 / t1)}, swing trough to crest "
                    f"{percent((y2 - y1) / (z2 - z1))}")

        what = f"heave_boxes {ratio} (first return at {t2:.3f} s, period by added mass {period:.3f} s)"
        lines.append(row(what, "4 %", found, say))
        for walls, made in found.items():
            rows = of_block(made, "blocks.csv", 0)
            draw(panel, made, walls, rows["time"], 1000 * (rows["z"] - z0 - 0.1 + 0.02))
        panel.plot(fine, 1000 * exact, "k--", lw=0.8, label="linear theory")
        panel.set_ylabel(f"{ratio}\nheave [mm]", fontsize=7)
    panels[0].legend(fontsize=7, ncol=4)
    save(args, made_figure, "coupling_heave_boxes")
    return lines


def wedge_entry(args):
    found = runs(args, CASES / "wedge_entry.ron", "wedge_entry")
    speed, width, coefficient = 4.0, 0.1, 14.14
    unit = RHO * speed**3 * width

    def say(made):
        g = columns(made, "gauges.csv")
        t, f = g["time"], g["slam.fluid_fz"] / unit
        k = (0.015 <= t) & (t <= 0.042)
        fit = np.sum(f[k] * t[k]) / np.sum(t[k] ** 2)
        means = [np.mean(f[(a <= t) & (t < a + 0.004)] / t[(a <= t) & (t < a + 0.004)]) for a in np.arange(0.015, 0.0385, 0.004)]
        low, high = min(means) / coefficient, max(means) / coefficient
        return f"{percent(fit / coefficient)} ({percent(low)} to {percent(high)} over 4 ms)"

    made_figure, panels = figure(1, 3.5)
    for walls, made in found.items():
        g = columns(made, "gauges.csv")
        draw(panels[0], made, walls, g["time"], g["slam.fluid_fz"] / width / 1000)
    t = np.array([0, 0.045])
    panels[0].plot(t, coefficient * RHO * speed**3 * t / 1000, "k--", lw=0.8, label="Zhao & Faltinsen (1993)")
    panels[0].set_ylabel("force per width [kN/m]", fontsize=8)
    panels[0].set_ylim(-20, 80)
    panels[0].legend(fontsize=7)
    save(args, made_figure, "coupling_wedge_entry")
    return [row("wedge_entry, line through zero from 15 to 42 ms", "10 %", found, say)]


def paddle_work(args):
    return paddle(args, 0) + paddle(args, 1)


def paddle(args, settle):
    """The row without and with a number of seconds of settling; the plot is that with settling."""
    found = runs(args, SCENES / "paddle_work.ron", f"paddle_work_{settle}", [f"time.settle={settle}"])

    def by_gauge(made):
        """Work of the recorded force."""
        g = columns(made, "gauges.csv")
        t, f = g["time"], -g["paddle.fluid_fx"]
        x = of_block(made, "blocks.csv", 0)
        at = np.interp(t, x["time"], x["x"])
        return np.sum((f[1:] + f[:-1]) / 2 * np.diff(at))

    def say(made):
        e = columns(made, "energy.csv")
        work = e["external_work"][-1]
        start, end = (sum(e[name][i] for name in ("kinetic", "potential", "elastic", "internal")) for i in (0, -1))
        share = {name: 100 * e[name][-1] / work for name in ("viscous", "diffusive", "damping", "at_walls", "residual")}
        most = {name: 100 * np.max(np.abs(e[name])) / np.max(e["external_work"]) for name in ("at_walls", "residual")}
        return (f"unexplained {share['residual']:+.3f} % of {work:.2f} J, at any time at most {most['residual']:.3f} % of the "
                f"most work, {np.max(e['external_work']):.2f} J; brought in at walls {share['at_walls']:+.2f} %, {most['at_walls']:.2f} % "
                f"at most; gained {100 * (end - start) / work:.1f}, viscous {share['viscous']:.1f}, "
                f"diffusive {share['diffusive']:.1f}, dashpots {share['damping']:.1f} %; "
                f"work by the force recorded {percent(by_gauge(made) / work)}")

    made_figure, panels = figure(2, 2)
    for walls, made in found.items():
        e = columns(made, "energy.csv")
        draw(panels[0], made, walls, e["time"], e["external_work"])
        for name, dashes in (("at_walls", {"ls": "--"}), ("residual", {})):
            draw(panels[1], made, walls, e["time"], 100 * e[name] / np.max(e["external_work"]), **dashes)
    panels[0].set_ylabel("work [J]", fontsize=8)
    panels[1].set_ylabel("unexplained; dashed\nbrought in at walls\n[% of the most work]", fontsize=8)
    panels[1].axhspan(-2, 2, color="black", alpha=0.08)
    panels[0].legend(fontsize=7)
    save(args, made_figure, "coupling_paddle_work")
    return [row(f"paddle_work, {settle} s of settling", "2 %", found, say)]


def column(args):
    lines = []
    made_figure, panels = figure(3, 1.8)
    for panel, (ratio, theta) in zip(panels, ((0.2, 0.4328407), (1, 0.8603336), (5, 1.3138377))):
        period = 2 * math.pi / (theta * 60)
        density = 1000 / (ratio * 0.4)
        settings = [f"materials.rock.density={density:g}", f"time.duration={6.2 * period:.6f}"]
        found = runs(args, SCENES / "column.ron", f"column_{ratio}", settings)
        # at rest; earlier, the block is at its initial position
        down = G * density * 0.4 / (RHO * 60**2) if density else 0

        def say(made):
            rows = of_block(made, "blocks.csv", 0)
            rising = risings(rows["time"], rows["z"])
            if len(rising) < 2:
                return "sinks, does not come back twice"
            felt = of_block(made, "forces.csv", 0)
            k = (rising[0] <= felt["time"]) & (felt["time"] < rising[-1])
            weight = density * 0.4 * 0.2 * 0.1 * G
            return (f"period {percent((rising[-1] - rising[0]) / (len(rising) - 1) / period)}, "
                    f"mean force {percent(np.mean(load(felt)['fz'][k]) / weight)}")

        lines.append(row(f"column, mass ratio {ratio}", "1 %", found, say))
        for walls, made in found.items():
            rows = of_block(made, "blocks.csv", 0)
            draw(panel, made, walls, rows["time"], 1000 * (rows["z"] - 1.2))
        t = np.linspace(0, 6.2 * period, 800)
        panel.plot(t, -1000 * down * (1 - np.cos(2 * math.pi * t / period)), "k--", lw=0.8, label="first mode, from rest")
        panel.set_ylabel(f"ratio {ratio}\nblock [mm]", fontsize=7)
        panel.set_xlim(0, 1.5)
    panels[0].legend(fontsize=7, ncol=4)
    save(args, made_figure, "coupling_column")
    return lines


def released(args):
    return let_go(args, 0) + let_go(args, 0.3)


def let_go(args, settle):
    """The row without and with a number of seconds of settling; the plot is that with settling."""
    lines = []
    made_figure, panels = figure(3, 1.8)
    start = 5 * 0.5 / 88.6
    for panel, s in zip(panels, (0.1, 0.5, 0.9)):
        found = runs(args, SCENES / "released.ron", f"released_{s}_{settle}",
                     [f"materials.cylinder.density={1000 * s:g}", f"time.settle={settle}"])
        exact = G * (1 - s) / (s + 1)

        def say(made):
            rows = of_block(made, "blocks.csv", 0)
            t, v = rows["time"], rows["vz"]
            k = np.flatnonzero(t >= start)[0]
            return percent((v[-1] - v[k]) / (t[-1] - t[k]) / exact)

        lines.append(row(f"released cylinder, density {s}, {settle:g} s of settling", "10 %", found, say))
        for walls, made in found.items():
            rows = of_block(made, "blocks.csv", 0)
            draw(panel, made, walls, rows["time"], rows["vz"])
        t = np.array([0, 0.085])
        panel.plot(t, exact * t, "k--", lw=0.8, label="g (1 - s)/(s + 1) t")
        panel.axvline(start, color="black", lw=0.4)
        panel.set_ylabel(f"{s}\nspeed up [m/s]", fontsize=7)
    panels[0].legend(fontsize=7, ncol=4)
    save(args, made_figure, "coupling_released")
    return lines


def through(made):
    """Number of particles on the other side of the plate at the end, from left and from right."""
    frames = [vtk_arrays(path) for path in sorted(made.folder.glob("water_*.vtp"))]
    left = {i: x < 0.41 for i, x in zip(frames[0]["Id"], frames[0]["Points"][:, 0])}
    now = [(left[i], x < 0.41) for i, x in zip(frames[-1]["Id"], frames[-1]["Points"][:, 0])]
    return f"{sum(a and not b for a, b in now)} and {sum(b and not a for a, b in now)} particles"


def thin_plate(args):
    found = runs(args, SCENES / "thin_plate.ron", "thin_plate")
    exact = RHO * G * (0.4**2 - 0.2**2) / 2 * 0.1

    def say(made):
        rows = of_block(made, "forces.csv", 0)
        f, t = load(rows)["fx"] / exact, rows["time"]
        early, late = f[(0.1 < t) & (t < 0.3)], f[t > 0.5 * t[-1]]
        return (f"{percent(smooth_mean(late))} ± {100 * np.std(late):.1f}; from 0.1 to 0.3 s {percent(np.mean(early))} ± "
                f"{100 * np.std(early):.1f}; across {through(made)}")

    made_figure, panels = figure(1, 3)
    for walls, made in found.items():
        rows = of_block(made, "forces.csv", 0)
        draw(panels[0], made, walls, rows["time"], load(rows)["fx"] / exact)
    panels[0].axhline(1, color="black", lw=0.8, ls="--")
    panels[0].axhspan(0.95, 1.05, color="black", alpha=0.08)
    panels[0].set_ylabel("force / (ρ g (H1² - H2²)/2)", fontsize=8)
    panels[0].legend(fontsize=7)
    save(args, made_figure, "coupling_thin_plate")
    return [row("thin_plate, one spacing, in a plane, last half of 2 s", "5 %", found, say)]


def vtk_arrays(path):
    """Arrays of a frame by name: appended, raw, compressed."""
    data = path.read_bytes()
    head, body = data.split(b'<AppendedData encoding="raw">', 1)
    body = body[body.index(b"_") + 1:]
    found = {}
    for tag in head.split(b"<DataArray ")[1:]:
        fields = dict(f.split("=", 1) for f in tag.split(b">")[0].decode().rstrip("/").split())
        if fields["format"] != '"appended"':
            continue
        at = int(fields["offset"].strip('"'))
        n = struct.unpack_from("<Q", body, at)[0]
        sizes = struct.unpack_from(f"<{n}Q", body, at + 24)
        at += 24 + 8 * n
        raw = b""
        for size in sizes:
            raw += zlib.decompress(body[at:at + size])
            at += size
        kind = {"Float32": "<f4", "Float64": "<f8", "Int32": "<i4", "UInt8": "u1"}[fields["type"].strip('"')]
        values = np.frombuffer(raw, kind)
        width = int(fields.get("NumberOfComponents", '"1"').strip('"'))
        found[fields["Name"].strip('"')] = values.astype(float).reshape(-1, width) if width > 1 else values
    return found


def momentum(args):
    found = runs(args, SCENES / "momentum.ron", "momentum")
    start, mass = 128.0, 300 * 0.25 * 0.45 * 0.4

    def history(made):
        """Times; change of momentum and of its moment about the origin since the first frame over 128 kg m/s (an arm of
        1 m); share of the block, and its rotation."""
        n = summary(made)["fluid_particles"]
        particle = summary(made)["fluid_mass"][0] / n
        times, sums, given = [], [], []
        for path in sorted(made.folder.glob("water_*.vtp")):
            water = vtk_arrays(path)
            block = vtk_arrays(made.folder / path.name.replace("water", "blocks"))
            linear = particle * water["Velocity"].sum(axis=0)
            angular = particle * np.cross(water["Points"], water["Velocity"]).sum(axis=0)
            corners = block["Points"]
            middle = corners.mean(axis=0)
            # of a box: mass/12 (sum of squared edges across the axis), from the spread of its corners
            spread = 4 * np.cov(corners.T, bias=True)
            inertia = mass / 12 * (np.trace(spread) * np.eye(3) - spread)
            v, w = block["Velocity"][0], block["AngularVelocity"][0]
            linear = linear + mass * v
            angular = angular + np.cross(middle, mass * v) + inertia @ w
            text = path.read_bytes()[:2000].split(b'Name="TimeValue"')[1]
            times.append(float(text[text.index(b">") + 1:text.index(b"<")]))
            sums.append((linear, angular))
            given.append((mass * v[0] / start, np.linalg.norm(w)))
        change = np.array([[np.linalg.norm(s[i] - sums[0][i]) / start for i in (0, 1)] for s in sums])
        return np.array(times), change, np.array(given)

    def say(made):
        t, change, given = history(made)
        return (f"linear {summary(made)['momentum_residual']:.1e} by the run; from frames linear {np.max(change[:, 0]):.1e}, "
                f"angular {np.max(change[:, 1]):.1e} (single precision); block has {100 * given[-1, 0]:.0f} %, turns at "
                f"{given[-1, 1]:.2f} rad/s")

    made_figure, panels = figure(2, 2)
    for walls, made in found.items():
        t, change, given = history(made)
        draw(panels[0], made, walls, t, 100 * given[:, 0])
        panels[1].plot(t[1:], 1e9 * change[1:, 0], color=COLORS[walls], lw=0.9, label=f"{WALLS[walls]} linear")
        panels[1].plot(t[1:], 1e9 * change[1:, 1], color=COLORS[walls], lw=0.9, ls=":", label=f"{WALLS[walls]} angular")
    panels[0].set_ylabel("share of the block [%]", fontsize=8)
    panels[1].set_ylabel("change since the start [1e-9]", fontsize=8)
    panels[0].legend(fontsize=7)
    panels[1].legend(fontsize=6, ncol=3)
    save(args, made_figure, "coupling_momentum")
    return [row("momentum", "1e-10", found, say)]


def crest_wedge(args):
    return crests(args, "sliding_wedge", 0.6)


def crest_block(args):
    return crests(args, "impacting_block", 0.5)


def crests(args, name, depth):
    """First crests of a scene of the paper, without exact solution: comparison of the three wall methods."""
    found = runs(args, CASES / f"{name}.ron", f"crest_{name}", ["numerics.preset=Standard"])
    gauges = ("g1", "g2", "g3")

    def say(made):
        g = columns(made, "gauges.csv")
        said = []
        for gauge in gauges:
            t, eta = g["time"], g[gauge] - depth
            k = first_crest(eta)
            said.append("none" if k is None else f"{1000 * eta[k]:.0f} mm at {t[k]:.2f} s")
        return ", ".join(said)

    made_figure, panels = figure(3, 1.6)
    for walls, made in found.items():
        g = columns(made, "gauges.csv")
        for panel, gauge in zip(panels, gauges):
            draw(panel, made, walls, g["time"], 1000 * (g[gauge] - depth))
            panel.set_ylabel(f"{gauge} [mm]", fontsize=7)
    panels[0].legend(fontsize=7, ncol=3)
    save(args, made_figure, f"coupling_crest_{name}")
    return [row(f"crests of {name} at g1, g2, g3, Standard", "-", found, say)]


def convergence_wedge(args):
    def settings(rows):
        # the slab stays four spacings wide
        spacing = 0.6 / rows
        width = f"{4 * spacing:.7f}"
        return [f"fluid.resolution=Spacing({spacing:.7f})", f"domain.max=(5.3, {width}, 1.8)", f"blocks.wedge.shape.to={width}"]
    return convergence(args, "sliding_wedge", 0.6, (13, 18, 26, 37), 26, settings)


def convergence_block(args):
    def settings(rows):
        return [f"fluid.resolution=Spacing({0.5 / rows:.7f})"]
    return convergence(args, "impacting_block", 0.5, (10, 14, 19), 14, settings)


def convergence(args, name, depth, all_rows, own_rows, settings):
    """First crests of a scene of the paper by rows of water over its depth, where the scene itself has `own_rows`."""
    def one(rows):
        if rows == own_rows:
            return runs(args, CASES / f"{name}.ron", f"crest_{name}", ["numerics.preset=Standard"])
        return runs(args, CASES / f"{name}.ron", f"crest_{name}_{rows}", ["numerics.preset=Standard", *settings(rows)])

    found = {rows: one(rows) for rows in all_rows}
    spacings = [depth / rows for rows in all_rows]
    made_figure, panels = figure(3, 1.8)
    lines = []
    for panel, gauge in zip(panels, ("g1", "g2", "g3")):
        line = [f"first crest of {name} at {gauge}; {', '.join(f'{1000 * s:.1f}' for s in spacings)} mm", "converges"]
        for walls in WALLS:
            crests = []
            for rows in all_rows:
                if walls not in found[rows]:
                    continue
                made = found[rows][walls]
                g = columns(made, "gauges.csv")
                eta = g[gauge] - depth
                k = first_crest(eta)
                crests.append(math.nan if k is None else eta[k])
                shade = 0.25 + 0.75 * rows / all_rows[-1]
                panel.plot(g["time"], 1000 * eta, color=COLORS[walls], alpha=shade, lw=0.4 + 0.8 * shade,
                           label=f"{WALLS[walls]}, {1000 * depth / rows:.1f} mm")
            line.append(limit(spacings, crests) if len(crests) == len(all_rows) else "-")
        panel.set_ylabel(f"{gauge} [mm]", fontsize=7)
        lines.append(line)
    panels[0].legend(fontsize=6, ncol=4)
    save(args, made_figure, f"coupling_convergence_{name}")
    return lines


def limit(spacings, values):
    """Values, and of the three finest the observed order, Richardson's limit and the grid convergence index.

    Celik et al. (2008), J. Fluids Eng. 130, 078001, for ratios that differ; safety factor 1.25; limit and index with an order of two
    at most.
    """
    said = f"{', '.join(f'{1000 * v:.0f}' for v in values)} mm"
    (h3, h2, h1), (f3, f2, f1) = spacings[-3:], values[-3:]
    coarse, fine = f3 - f2, f2 - f1
    if not coarse * fine > 0:
        return f"{said}; not monotone, the three finest within {100 * np.ptp(values[-3:]) / abs(f1):.0f} %"
    r21, r32 = h2 / h1, h3 / h2
    order = 1.0
    for _ in range(200):
        order = abs(math.log(coarse / fine) + math.log((r21**order - 1) / (r32**order - 1))) / math.log(r21)
        if not 0 < order < 50:
            return f"{said}; no order"
    # an order above the scheme's shows that the spacings are too large: it must not narrow the limit
    gain = r21 ** min(order, 2) - 1
    end = f1 - fine / gain
    return f"{said}; order {order:.1f}, limit {1000 * end:.0f} mm, uncertainty {125 * abs(fine / f1) / gain:.0f} %"


def first_crest(eta):
    """Index of the first crest: the highest point before the level falls to half of it again."""
    best = None
    for k in np.flatnonzero(np.isfinite(eta)):
        if eta[k] > 0.01 and (best is None or eta[k] > eta[best]):
            best = k
        if best is not None and eta[k] < 0.5 * eta[best]:
            return best
    return best


ROWS = {f.__name__: f for f in (submerged, submerged_plane, floating_boxes, heave_boxes, wedge_entry, paddle_work, column, released,
                                thin_plate, momentum, crest_wedge, crest_block, convergence_wedge, convergence_block)}


def main():
    args = arguments(__doc__.splitlines()[0], ROWS)
    lines = [["row", "asked", *WALLS.values()]]
    for name in args.rows:
        lines += ROWS[name](args)
    table(lines)


if __name__ == "__main__":
    main()
