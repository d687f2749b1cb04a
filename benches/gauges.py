"""Plots the gauges of runs of one scene together, each gauge in a panel of its own.

    python3 benches/gauges.py benches/plots/sliding_wedge.svg runs/standard=Standard runs/published=Mueller2003

Every run folder is followed by the name it gets in the legend. Surface elevations, pressures and run-up are drawn, with
the vertical axis in the gauge's own unit. Wants matplotlib.
"""

import csv
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402


def table(folder):
    """Columns of a run's gauges by name with unit."""
    with open(f"{folder}/gauges.csv", newline="") as file:
        rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    columns = zip(*rows[1:])
    return {
        name: [float(x) if x else float("nan") for x in column]
        for name, column in zip(rows[0], columns)
    }


def main():
    out, *runs = sys.argv[1:]
    tables = [(label, table(folder)) for folder, label in (run.rsplit("=", 1) for run in runs)]
    # forces on blocks have a dot in their name; they are not of one point
    gauges = [name for name in tables[0][1] if "." not in name][1:]
    figure, panels = plt.subplots(len(gauges), 1, sharex=True, figsize=(7, 1.4 * len(gauges)), squeeze=False)
    for name, panel in zip(gauges, panels[:, 0]):
        for label, columns in tables:
            time = next(iter(columns.values()))
            panel.plot(time, columns[name], lw=0.8, label=label)
        panel.set_ylabel(name, fontsize=8)
        panel.tick_params(labelsize=7)
        panel.grid(lw=0.3)
    panels[0, 0].legend(fontsize=8)
    panels[-1, 0].set_xlabel("time [s]", fontsize=8)
    figure.tight_layout()
    figure.savefig(out, metadata={"Date": None})


main()
