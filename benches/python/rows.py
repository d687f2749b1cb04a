"""Common parts of the benches: runs of one scene with several wall methods, runs that are resumed, tables and plots.

Existing runs are reused, so that an interrupted bench continues. Only plots need more than the standard library.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
from pathlib import Path

from walls import print_walls

# for matplotlib, which is imported only where a plot is drawn: other benches need the standard library alone
os.environ["MPLBACKEND"] = "svg"
CASES = Path(__file__).resolve().parents[2] / "cases"
WALLS = {"Penalty": "W1", "Particles": "W2", "Integral": "W3"}
COLORS = {"Penalty": "tab:orange", "Particles": "tab:blue", "Integral": "tab:green"}


def arguments(description, rows, records=False, schemes=()):
    """Command line of a bench; `rows` are the available rows, `records` whether it uses measured records, `schemes` those to
    run in place of wall methods."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("rows", nargs="*", metavar="ROW", help=f"of {', '.join(rows)}; all when left out")
    parser.add_argument("--riprap", default="target/release/riprap", help="the program")
    parser.add_argument("--runs", default="runs/benches", type=Path, help="folder of the runs")
    parser.add_argument("--plots", default="benches/plots", type=Path, help="folder of the plots")
    if schemes:
        parser.add_argument("--schemes", default=",".join(schemes), help="schemes to run, by comma")
    parser.add_argument("--walls", default="Particles" if schemes else ",".join(WALLS), help="methods to run, by comma")
    if records:
        parser.add_argument("--records", type=Path, help="folder of measured records, your own")
    parser.add_argument("--draw-only", action="store_true", help="no runs: table and plots of those that are there")
    found = parser.parse_args()
    found.walls = found.walls.split(",")
    if schemes:
        found.schemes = found.schemes.split(",")
    unknown = [row for row in found.rows if row not in rows]
    if unknown:
        parser.error(f"no row {', '.join(unknown)}; there are {', '.join(rows)}")
    found.rows = found.rows or list(rows)
    return found


class Run:
    """A run folder, the exit status and the CPU seconds."""

    def __init__(self, folder):
        self.folder = folder
        code, cpu = (folder / "ended").read_text().split()
        self.code, self.cpu = int(code), float(cpu)

    def columns(self, name):
        """Columns of one of its tables, by name with unit; empty cells are NaN."""
        return columns(self.folder / name)

    def column(self, name, start):
        """The column of a table with a name prefix."""
        found = [column for column in self.columns(name) if column.startswith(start)]
        if len(found) != 1:
            raise KeyError(f"{self.folder / name}: {len(found)} columns start with {start!r}")
        return self.columns(name)[found[0]]


def columns(path):
    """Columns of a CSV file with one line of names; lines that start with # are skipped."""
    with open(path, newline="") as file:
        rows = [row for row in csv.reader(line for line in file if not line.startswith("#")) if row]
    return {
        name: [float(x) if x else float("nan") for x in column]
        for name, column in zip(rows[0], zip(*rows[1:]))
    }


def read_rows(path):
    """Rows of a CSV file one by one, each by the names of its columns with unit: for tables with words, or too long for memory."""
    with open(path, newline="") as file:
        yield from csv.DictReader(file)


def run(args, case, walls, name, settings=()):
    """The run of a case with one wall method, executed unless it exists or is not requested; None if unavailable."""
    folder = args.runs / f"{name}_{WALLS[walls]}"
    done = folder / "ended"
    if not done.exists() and walls in args.walls and not args.draw_only:
        command = [args.riprap, "run", str(case), "-o", str(folder), "--force", "--quiet", "--threads", "1"]
        for one in [f"interface.walls={walls}", *settings]:
            command += ["--set", one]
        args.runs.mkdir(parents=True, exist_ok=True)
        with open(f"{folder}.log", "w") as log:
            to_log = [(os.POSIX_SPAWN_DUP2, log.fileno(), 1), (os.POSIX_SPAWN_DUP2, log.fileno(), 2)]
            child = os.posix_spawn(args.riprap, command, os.environ, file_actions=to_log)
            _, status, used = os.wait4(child, 0)
        if not folder.is_dir():
            print(f"{name} {WALLS[walls]}: refused, see {folder}.log", file=sys.stderr)
            return None
        done.write_text(f"{os.waitstatus_to_exitcode(status)} {used.ru_utime + used.ru_stime:.2f}\n")
    if not done.exists():
        return None
    print_walls(f"{name} {WALLS[walls]}", folder)
    return Run(folder)


def run_to_end(args, name, prepare):
    """Folder and summary of a run: executed unless it reached its end, resumed if it was stopped before.

    `prepare` writes the files that the scene names into the folder of the runs; it returns the text of the scene, and settings
    that come before those of the command line.
    """
    name = name.replace(" ", "").replace("/", "_")
    folder = args.runs / name
    summary = folder / "summary.json"
    if not (summary.exists() and json.loads(summary.read_text())["completed"]):
        args.runs.mkdir(parents=True, exist_ok=True)
        text, settings = prepare()
        path = args.runs / f"{name}.ron"
        path.write_text(text)
        begin = "--resume" if (folder / "checkpoint.bin").exists() else "--force"
        command = [args.riprap, "run", str(path), "-o", str(folder), begin, "--quiet", "--no-report", "--threads", str(args.threads)]
        for one in [*settings, *args.set]:
            command += ["--set", one]
        subprocess.run(command, check=True)
    return folder, json.loads(summary.read_text())


def unexplained(summary):
    """Share of the energy released that the ledger lacks."""
    energy = summary["energy"]
    return energy["residual"] / sum(energy[key] for key in ("friction", "damping", "kinetic"))


def figure(n_panels, height=1.6):
    """A figure of stacked panels with a common time axis."""
    import matplotlib.pyplot as plt

    made, panels = plt.subplots(n_panels, 1, sharex=True, figsize=(7, max(2.4, height * n_panels)), squeeze=False)
    for panel in panels[:, 0]:
        panel.tick_params(labelsize=7)
        panel.grid(lw=0.3)
    panels[-1, 0].set_xlabel("time [s]", fontsize=8)
    return made, panels[:, 0]


def save(args, made, name):
    """Writes a figure into the folder of plots."""
    import matplotlib.pyplot as plt

    args.plots.mkdir(parents=True, exist_ok=True)
    made.tight_layout()
    made.savefig(args.plots / f"{name}.svg", metadata={"Date": None})
    plt.close(made)


def table(rows):
    """Prints a table as in RESULTS.md, with the headings first."""
    head, *body = rows
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for row in body:
        print("| " + " | ".join(row) + " |")
