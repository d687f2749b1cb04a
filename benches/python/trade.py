"""Summary of the shipped studies: presets, knobs, and the published scheme against ours.

    python3 benches/python/trade.py --results benches/trade/results --plots benches/plots

Reads the tables that `riprap study` left in `benches/trade/results/NAME/trade.csv`, prints tables in Markdown, and draws
`trade_schemes.png`: error against cost in water, ours and published. Wants numpy and matplotlib.
"""

import argparse
import csv
from pathlib import Path

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.ticker import LogFormatter, NullFormatter  # noqa: E402

PRESETS = ("artificial, half step", "Preview", "Standard", "Reference", "published")
# marks in the plot
DEFAULTS = (("Standard", "*", "Standard"), ("artificial, half step", "D", "the default before it"))
TITLES = {
    "still_tank": "still tank, pressure",
    "standing_wave": "standing wave, height after 5 periods",
    "standing_wave_period": "standing wave, period",
    "standing_wave_high": "standing wave of five spacings",
    "piston": "piston, wave height",
    "solitary": "solitary wave, run-up",
    "dam_break_front": "dam break, front speed",
    "dam_break_pressure": "dam break, pressure on a wall",
    "held_box": "held box, force",
    "floating_box": "floating box, height",
    "sliding_wedge": "sliding wedge, first crest",
    "landslide_flume": "landslide, surface (laboratory)",
}


class Run:
    """A row of a table: knob, value, error, cost."""

    def __init__(self, row, knobs, base):
        self.turned = {knob: row[knob] for knob in knobs if row[knob] != base[knob]}
        self.error = float(row["error [-]"]) if row["stable"] == "1" else float("nan")
        self.time = float(row["wall_time [s]"])
        self.work = float(row["work [pairs]"])
        self.memory = float(row["peak_memory [B]"])
        scheme = next((knob for knob in ("preset", "scheme") if knob in row), None)
        self.preset = row[scheme] if scheme else "Standard"
        self.has_only_another_scheme = set(self.turned) <= {"preset", "scheme"}

    @property
    def is_published(self):
        return self.preset.startswith("published")


def read(path):
    """Runs of a study, starting with the one at the first value of every knob."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    heads = list(rows[0])
    knobs = heads[: heads.index("value")]
    return [Run(row, knobs, rows[0]) for row in rows]


def front(runs):
    """Pareto front by work and error, in order of work."""
    best, found = float("inf"), []
    for run in sorted((r for r in runs if np.isfinite(r.error)), key=lambda r: r.work):
        if run.error < best:
            best = run.error
            found.append(run)
    return found


def percent(x):
    return "none" if not np.isfinite(x) else f"{100 * x:.2g} %" if x < 1 else f"{100 * x:.0f} %"


def presets(studies):
    print("| study | " + " | ".join(PRESETS) + " |")
    print("|---|" + "---|" * len(PRESETS))
    for name, runs in studies.items():
        cells = []
        for preset in PRESETS:
            found = [r for r in runs if r.preset == preset and r.has_only_another_scheme]
            cells.append(f"{percent(found[0].error)}, {found[0].work / runs[0].work:.2f}" if found else "")
        if cells[0]:
            print(f"| `{name}` | " + " | ".join(cells) + " |")


def knobs(studies):
    """A line per knob and study: errors, work and time over those of the first values."""
    print("\n| knob | study | turned | error | work | time |\n|---|---|---|---|---|---|")
    rows = []
    for name, runs in studies.items():
        base = runs[0]
        for run in runs:
            if len(run.turned) == 1 and np.isfinite(run.error):
                (knob, value), = run.turned.items()
                rows.append((knob, name, value, base.error, run.error, run.work / base.work, run.time / base.time))
    for knob, name, value, before, after, work, time in sorted(rows, key=lambda r: (r[0], r[1])):
        print(f"| {knob} | {name} | {value} | {percent(before)} to {percent(after)} | {work:.2f} | {time:.2f} |")


def draw(studies, path):
    """Error against work: our scheme with its front, the published scheme at three spacings."""
    shown = [name for name in TITLES if name in studies]
    columns = 4
    rows = -(-len(shown) // columns)
    figure, panels = plt.subplots(rows, columns, figsize=(13, 2.9 * rows), squeeze=False)
    for panel, name in zip(panels.flat, shown):
        runs = studies[name]
        ours = [r for r in runs if not r.is_published]
        theirs = sorted((r for r in runs if r.is_published and r.has_only_another_scheme), key=lambda r: r.work)
        dots = [(r.work, 100 * r.error) for r in ours if np.isfinite(r.error) and r.error > 0]
        panel.plot(*zip(*dots), ".", color="0.7", ms=5, label="all settings")
        best = [(r.work, 100 * r.error) for r in front(ours) if r.error > 0]
        panel.plot(*zip(*best), "o-", color="#0072b2", ms=4, lw=1.2, label="riprap, front")
        line = [(r.work, 100 * r.error) for r in theirs if np.isfinite(r.error)]
        if line:
            panel.plot(*zip(*line), "s--", color="#d55e00", ms=5, lw=1, label="published scheme, three spacings")
        for preset, mark, label in DEFAULTS:
            of_preset = [r for r in runs if r.preset == preset and r.has_only_another_scheme]
            point = [(r.work, 100 * r.error) for r in of_preset if np.isfinite(r.error) and r.error > 0]
            if point:
                panel.plot(*zip(*point), mark, color="k", ms=9, mfc="none", mew=1.5, label=label)
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_title(TITLES[name], fontsize=9)
        panel.tick_params(labelsize=7, which="both")
        panel.xaxis.set_minor_formatter(NullFormatter())
        panel.yaxis.set_major_formatter(LogFormatter())
        panel.yaxis.set_minor_formatter(LogFormatter(minor_thresholds=(1.2, 0.4)))
        panel.grid(lw=0.3)
    for panel in panels[-1]:
        panel.set_xlabel("work [pair interactions]", fontsize=8)
    for panel in panels[:, 0]:
        panel.set_ylabel("error [%]", fontsize=8)
    for panel in list(panels.flat)[len(shown):]:
        panel.axis("off")
    handles, labels = panels.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", fontsize=9, ncols=len(labels))
    figure.tight_layout(rect=(0, 0.04, 1, 1))
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110, metadata={"Software": None})


def main():
    parser = argparse.ArgumentParser(description="Tables and the plot of the shipped studies")
    parser.add_argument("--results", default="benches/trade/results", type=Path, help="folder of the tables")
    parser.add_argument("--plots", default="benches/plots", type=Path, help="folder of the plot")
    args = parser.parse_args()
    studies = {path.parent.name: read(path) for path in sorted(args.results.glob("*/trade.csv"))}
    presets(studies)
    knobs(studies)
    draw(studies, args.plots / "trade_schemes.png")


if __name__ == "__main__":
    main()
