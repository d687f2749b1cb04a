"""Results of a run, read from its folder."""

from __future__ import annotations

import builtins
import csv
import json
import os
import xml.etree.ElementTree as xml
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterator, Mapping, Sequence, Union

from ._riprap import Scene, read_table

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

PathLike = Union[str, "os.PathLike[str]"]


class Table(Mapping[str, "NDArray[Any]"]):
    """Columns by name, as arrays; `units` has their units."""

    def __init__(self, columns: Mapping[str, NDArray[Any]], units: Mapping[str, str]) -> None:
        self._columns = dict(columns)
        self.units = dict(units)

    def __getitem__(self, name: str) -> NDArray[Any]:
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(f"no column `{name}`; there are {', '.join(self._columns)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def n_rows(self) -> int:
        """Number of rows."""
        return len(next(iter(self._columns.values()), ()))

    def where(self, rows: NDArray[np.bool_]) -> Table:
        """The rows for which an array of truth values is true."""
        return Table({name: values[rows] for name, values in self.items()}, self.units)

    def to_pandas(self) -> Any:
        """The table as a `pandas.DataFrame`; its index is the time, where there is one."""
        import pandas

        frame = pandas.DataFrame(self._columns)
        return frame.set_index("time") if "time" in frame else frame

    def __repr__(self) -> str:
        return f"<riprap.Table of {self.n_rows} rows: {', '.join(self)}>"


def _structured(path: Path) -> Table:
    """A structured array of NumPy as a table, without units."""
    import numpy as np

    # a run under way adds rows behind those that its heading counts
    rows = np.load(path)
    names = rows.dtype.names or ()
    return Table({name: rows[name] for name in names}, {name: "" for name in names})


class BlockTables(Mapping[str, Table]):
    """Tables of blocks by name; `all` has the rows of all of them."""

    def __init__(self, every: Table, names: Mapping[int, str]) -> None:
        self.all = every
        recorded = dict.fromkeys(int(number) for number in every["block"])
        self._numbers = {names.get(number) or str(number): number for number in recorded}

    def __getitem__(self, name: str) -> Table:
        try:
            number = self._numbers[name]
        except KeyError:
            raise KeyError(f"no rows of a block `{name}`; there are those of {', '.join(self._numbers)}") from None
        return self.all.where(self.all["block"] == number)

    def __iter__(self) -> Iterator[str]:
        return iter(self._numbers)

    def __len__(self) -> int:
        return len(self._numbers)


class Frames(Sequence[Any]):
    """VTK frames of a run in order of time; each is read by PyVista when it is asked for."""

    def __init__(self, files: list[Path], times: NDArray[np.float64]) -> None:
        self.files = files
        self.times = times

    def __len__(self) -> int:
        return len(self.files)

    def __getitem__(self, number: Any) -> Any:
        import pyvista

        if isinstance(number, slice):
            return Frames(self.files[number], self.times[number])
        return pyvista.read(self.files[number])

    def at(self, time: float) -> Any:
        """The frame nearest to a time (s)."""
        import numpy as np

        return self[int(np.argmin(np.abs(self.times - time)))]


class Run:
    """A run folder, of a run that is over or under way. Nothing is read before it is asked for."""

    def __init__(self, folder: PathLike) -> None:
        self.folder = Path(folder)
        if not (self.folder / "case.ron").is_file():
            raise FileNotFoundError(f"{self.folder} is not a run folder: it has no case.ron")

    @property
    def scene(self) -> Scene:
        """The scene as run, every default written out."""
        return Scene.read(self.folder / "case.ron")

    @property
    def summary(self) -> dict[str, Any]:
        """Statistics, residuals and verdict: `summary.json`, which is written at the end of a run."""
        found: dict[str, Any] = json.loads(self._file("summary.json").read_text(encoding="utf-8"))
        return found

    @property
    def gauges(self) -> Table:
        """Gauges over time."""
        return self.table("gauges.csv")

    @property
    def energy(self) -> Table:
        """Energy over time, every sink named; J."""
        return self.table("energy.csv")

    @property
    def masses(self) -> Table:
        """Groups of blocks tracked as one body over time."""
        return self.table("masses.csv")

    @property
    def counters(self) -> Table:
        """Blocks that have passed planes or been in boxes, and those inside, over time."""
        return self.table("counters.csv")

    @property
    def reactions(self) -> Table:
        """Contact forces between two blocks or groups of blocks over time."""
        return self.table("reactions.csv")

    @property
    def blocks(self) -> BlockTables:
        """Place, motion and forces of the blocks that can move, by name; of blocks.csv or blocks.npy."""
        binary = self.folder / "blocks.npy"
        table = _structured(binary) if binary.is_file() else self.table("blocks.csv")
        return BlockTables(table, self._names())

    @property
    def forces(self) -> BlockTables:
        """Forces and moments on chosen blocks by source, by name."""
        return BlockTables(self.table("forces.csv"), self._names())

    @property
    def contacts(self) -> BlockTables:
        """Contact forces on chosen blocks by partner, by name."""
        return BlockTables(self.table("contacts.csv"), self._names())

    @property
    def trajectories(self) -> BlockTables:
        """Paths of chosen blocks, by name."""
        return BlockTables(self.table("trajectories.csv"), self._names())

    @property
    def bodies(self) -> Table:
        """Who is who among the blocks: number, name, kind, mass, volume, centroid at the start."""
        return _mixed_table(self._file("bodies.csv"))

    @property
    def frames(self) -> dict[str, Frames]:
        """VTK frames by what is in them: `water`, `blocks`, and `contacts` and `faces` where they are asked for."""
        stems = ("water", "blocks", "contacts", "faces")
        return {stem: self._frames(stem) for stem in stems if (self.folder / f"{stem}.pvd").is_file()}

    def table(self, name: str) -> Table:
        """A table of the folder."""
        columns = read_table(self._file(name))
        return Table({name: values for name, _, values in columns}, {name: unit for name, unit, _ in columns})

    def _file(self, name: str) -> Path:
        path = self.folder / name
        if not path.is_file():
            raise FileNotFoundError(f"{self.folder} has no {name}: the scene does not ask for it, or the run has not got there")
        return path

    def _names(self) -> dict[int, str]:
        bodies = self.bodies
        return {int(number): str(name) for number, name in zip(bodies["block"], bodies["name"])}

    def _frames(self, stem: str) -> Frames:
        import numpy as np

        sets = xml.parse(self.folder / f"{stem}.pvd").iter("DataSet")
        found = [(float(one.attrib["timestep"]), self.folder / one.attrib["file"]) for one in sets]
        return Frames([path for _, path in found], np.array([time for time, _ in found]))

    def __repr__(self) -> str:
        return f"<riprap.Run {self.folder}>"


def open(folder: PathLike) -> Run:
    """Opens a run folder."""
    return Run(folder)


def _mixed_table(path: Path) -> Table:
    """A table with text in some columns; the others are numbers."""
    import numpy as np

    with builtins.open(path, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    columns: dict[str, Any] = {}
    units: dict[str, str] = {}
    for k, title in enumerate(header):
        name, _, unit = title.partition(" [")
        units[name] = unit.rstrip("]")
        cells = [row[k] for row in rows]
        try:
            columns[name] = np.array([float(cell or "nan") for cell in cells])
        except ValueError:
            columns[name] = np.array(cells)
    return Table(columns, units)
