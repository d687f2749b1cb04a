"""Plots the gauges of runs of one scene together, each gauge in a panel of its own.

    python3 benches/python/gauges.py benches/plots/sliding_wedge.svg runs/standard=Standard runs/published=Mueller2003

Every run folder is followed by the name it gets in the legend. Surface elevations, pressures and run-up are drawn, with
the vertical axis in the gauge's own unit. A CSV file in place of a folder is a record of the laboratory, drawn as dots: its
first column is the time, the others are headed as those of `gauges.csv`; gauges it lacks stay without. `until=3` ends the
time axis there. Wants matplotlib.
"""

import csv
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402


def table(source):
    """Columns of a run's gauges, or of a record, by name with unit."""
    path = source if source.endswith(".csv") else f"{source}/gauges.csv"
    with open(path, newline="") as file:
        rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    columns = zip(*rows[1:])
    return {
        name: [float(x) if x else float("nan") for x in column]
        for name, column in zip(rows[0], columns)
    }


def main():
    out, *runs = sys.argv[1:]
    sources = [run.rsplit("=", 1) for run in runs]
    until = next((float(label) for source, label in sources if source == "until"), None)
    tables = [(label, table(source), source.endswith(".csv")) for source, label in sources if source != "until"]
    # forces on blocks have a dot in their name; they do not belong to a point
    gauges = [name for name in tables[0][1] if "." not in name][1:]
    figure, panels = plt.subplots(len(gauges), 1, sharex=True, figsize=(7, 1.4 * len(gauges)), squeeze=False)
    for name, panel in zip(gauges, panels[:, 0]):
        for label, columns, is_record in tables:
            time = next(iter(columns.values()))
            style = {"ls": "", "marker": ".", "ms": 3, "color": "black"} if is_record else {"lw": 0.8}
            if name in columns:
                panel.plot(time, columns[name], label=label, **style)
        panel.set_ylabel(name, fontsize=8)
        panel.tick_params(labelsize=7)
        panel.grid(lw=0.3)
    panels[0, 0].legend(fontsize=8)
    panels[0, 0].set_xlim(right=until)
    panels[-1, 0].set_xlabel("time [s]", fontsize=8)
    figure.tight_layout()
    figure.savefig(out, metadata={"Date": None})


main()
