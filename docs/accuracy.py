"""Pages on accuracy, made from the results in the repository: `python3 docs/accuracy.py FOLDER`.

Numbers are those of `benches/trade/results/*/trade.csv` and of the tables in `benches/RESULTS.md`; words are in
`accuracy_cases.py`. Wants nothing but Python; the same results give the same pages.
"""

import csv
import re
import shutil
import sys
from pathlib import Path

from accuracy_cases import CASES, COUPLED, KNOBS, LABORATORY, VALUES
from accuracy_figure import figure

ROOT = Path(__file__).resolve().parent.parent
STUDIES = ROOT / "benches/trade"
PLOTS = ROOT / "benches/plots"

# names of the sources, and words for them
WALLS = {"W1": "springs", "W2": "particles", "W3": "integrals"}
INTERNAL = re.compile(r"\(?\b[CDGSTX]\d\d\b(?:, [CDGSTX]\d\d\b)*\)?:?")


class Run:
    """A row of a study: what differs from its first row, its error and its work."""

    def __init__(self, row, knobs, base):
        self.changed = {knob: row[knob] for knob in knobs if row[knob] != base[knob]}
        self.is_complete = row["stable"] == "1" and row["error [-]"] not in ("", "NaN")
        self.error = float(row["error [-]"]) if self.is_complete else float("nan")
        self.work = float(row["work [pairs]"])
        is_published = any(value.startswith("published") for value in self.changed.values())
        self.kind = "default" if not self.changed else "published" if is_published else "ours"


def read(name):
    """Knobs and runs of a study, the first with the first value of every knob."""
    with open(STUDIES / "results" / name / "trade.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    heads = list(rows[0])
    knobs = heads[: heads.index("value")]
    return knobs, rows[0], [Run(row, knobs, rows[0]) for row in rows]


def front_of(runs):
    """Runs that no other one beats in both error and work, in order of work."""
    best, found = float("inf"), []
    for run in sorted((run for run in runs if run.is_complete), key=lambda run: (run.work, run.error)):
        if run.error < best:
            best = run.error
            found.append(run)
    return found


def percent(run):
    """Error of a run in words."""
    if not run.is_complete:
        return "did not reach its end"
    return f"{100 * run.error:.2g} %" if run.error < 1 else f"{100 * run.error:.0f} %"


def table(head, rows):
    """A table in Markdown."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def knob_table(knobs, base_row, runs):
    """One setting changed at a time: error, and work relative to the first run."""
    base = runs[0]
    rows = [["**as it is**", "", f"**{percent(base)}**", "1"]]
    for knob in knobs:
        for run in runs:
            if list(run.changed) == [knob]:
                value = run.changed[knob]
                rows.append([
                    KNOBS.get(knob, knob), VALUES.get(value, value), percent(run), f"{run.work / base.work:.2f}",
                ])
    return table(["setting", "value", "error", "work"], rows)


def field(text, name):
    """A field of a study file."""
    return re.search(rf'^    {name}: "([^"]+)"', text, re.MULTILINE).group(1)


def case_page(name, folder):
    """Page of a study."""
    group, title, question, source = CASES[name]
    study = (STUDIES / f"{name}.ron").read_text()
    case = (STUDIES / field(study, "case")).resolve().relative_to(ROOT)
    knobs, base_row, runs = read(name)
    (folder / f"{name}.svg").write_text(figure(runs, front_of(runs)))
    at_first = ", ".join(f"{KNOBS.get(knob, knob)} {base_row[knob]}" for knob in knobs)
    settings = len(runs)
    text = f"""# {title}

**What is compared.** {question}

**Reference.** {source}

**Result.** {percent(runs[0])} off with the settings that the scene has by itself.

![Error against work in {settings} runs]({name}.svg)

Each dot is one run. The line joins the runs that no other run beats in both error and work. The star is the scene as it is; orange
dots are the published scheme.

## One setting at a time

Settings as they are: {at_first}. Work is relative to that run.

{knob_table(knobs, base_row, runs)}

## Make it again

The scene is `{case}`, the study `benches/trade/{name}.ron`. From the folder of the sources:

```sh
riprap study benches/trade/{name}.ron
```
"""
    (folder / f"{name}.md").write_text(text)
    presets = {run.changed["preset"]: percent(run) for run in runs if list(run.changed) == ["preset"]}
    return title, presets.get("Preview", ""), percent(runs[0]), presets.get("Reference", "")


def plain(text):
    """Text of the tables of results without names and marks that only the sources know."""
    text = re.sub(r" \((?:W[123]|r|i|r, i)\)", "", text).replace("see above", "see Water against closed forms")
    for name, word in WALLS.items():
        text = re.sub(rf"\b{name}\b", word, text)
    text = INTERNAL.sub("", text)
    text = re.sub(r"\| +", "| ", text).replace(" ;", ";").replace(" ,", ",")
    left = re.search(r"\b(W[123]|[CDGSTX]\d\d)\b", text)
    if left:
        raise SystemExit(f"accuracy.py: `{left.group()}` is left in {text[:80]!r}")
    return text


def section(heading):
    """First table below a heading of `benches/RESULTS.md`."""
    text = (ROOT / "benches/RESULTS.md").read_text()
    below = text.split(f"\n{heading}\n", 1)[1]
    lines = below[: below.index("\n\n", below.index("\n|"))].splitlines()
    return "\n".join(line for line in lines if line.startswith("|"))


def results_page(folder, name, title, words, parts):
    """Page of tables of `benches/RESULTS.md`: `parts` are (heading there, heading here or none)."""
    text = f"# {title}\n\n{words}\n"
    for heading, here in parts:
        text += f"\n## {here}\n" if here else ""
        text += f"\n{plain(section(heading))}\n"
    (folder / f"{name}.md").write_text(text)
    return name


def pictures_page(folder, name, title, words, pictures):
    """Page of plots."""
    text = f"# {title}\n\n{words}\n"
    for file, heading, caption in pictures:
        shutil.copy(PLOTS / file, folder / file)
        text += f"\n## {heading}\n\n![{heading}]({file})\n\n{caption}\n"
    (folder / f"{name}.md").write_text(text)
    return name


METHODS = (
    "The plots name the three [wall methods](../concepts/interface.md) by numbers: W1 is springs (`Penalty`), W2 particles inside the "
    "solids (`Particles`, the default), W3 integrals of the kernel (`Integral`)."
)
REQUIRED = (
    "*Required* is the bound set before the test was written, *measured* what came out. Rows marked *(missed)* are outside of their "
    "bound. The last column names the test or the scene that repeats the row."
)


def further_pages(folder):
    """Pages that are not studies; their names."""
    return [
        results_page(folder, "blocks", "Blocks against closed forms", REQUIRED, [
            ("## Blocks against closed forms", None), ("## Spheres", "Spheres"), ("## Terrain", "Terrain"),
        ]),
        results_page(folder, "water", "Water against closed forms", REQUIRED, [("## Against closed forms", None)]),
        results_page(folder, "laboratory", "Water against the laboratory", REQUIRED + " `Mueller2003` is the published scheme.", [
            ("## Against the laboratory", None), ("## The presets against theory and the laboratory", "Presets"),
        ]),
        results_page(folder, "coupled", "Rock in water", REQUIRED, [
            ("## Rock in water", None), ("### The three wall methods", "Three wall methods"),
        ]),
        pictures_page(folder, "coupled_plots", "Rock in water: plots",
                      METHODS + " `python3 benches/python/coupling.py` runs the scenes and draws the plots.", COUPLED),
        pictures_page(folder, "laboratory_plots", "Rock in water: laboratory",
                      METHODS + " `python3 benches/python/laboratory.py` runs the scenes and draws the plots.", LABORATORY),
    ]


def index_page(folder, results, further):
    """Page that leads to all others."""
    groups = {}
    for name, (title, *errors) in results.items():
        groups.setdefault(CASES[name][0], []).append([f"[{title}]({name}.md)", *errors])
    text = (Path(__file__).parent / "accuracy_intro.txt").read_text()
    for group, rows in groups.items():
        text += f"\n## {group}\n\n" + table(["comparison", "`Preview`", "as it is", "`Reference`"], rows) + "\n"
    text += "\n```{toctree}\n:hidden:\n\n" + "\n".join(results) + "\n```\n"
    text += "\n## All tests\n\nThese tables list every requirement, with those that are missed.\n"
    text += "\n```{toctree}\n:maxdepth: 1\n\n" + "\n".join(further) + "\n```\n"
    shutil.copy(PLOTS / "trade_schemes.png", folder)
    (folder / "index.md").write_text(text)


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    found = sorted(path.parent.name for path in STUDIES.glob("results/*/trade.csv"))
    if sorted(CASES) != found:
        raise SystemExit(f"accuracy.py: studies with results are {found}, words are there for {sorted(CASES)}")
    results = {name: case_page(name, folder) for name in CASES}
    index_page(folder, results, further_pages(folder))


main()
