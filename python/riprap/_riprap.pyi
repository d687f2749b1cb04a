"""Compiled part of riprap."""

from os import PathLike
from typing import Any, Callable, Iterator, Literal, Mapping, Optional, Union, final

import numpy as np
from numpy.typing import NDArray

from ._errors import Problem
from ._results import Run

__all__ = [
    "Block",
    "Blocks",
    "Gauges",
    "Scene",
    "Water",
    "World",
    "__version__",
    "check_study",
    "command",
    "compare_files",
    "read_table",
]

__version__: str

_Path = Union[str, PathLike[str]]
_Value = Union[str, float, bool, PathLike[str], tuple[Any, ...], list[Any], Mapping[str, Any], np.generic, None]
_Vector = NDArray[np.float64]

@final
class Scene:
    """A scene: text that was read, and fields set since."""

    @staticmethod
    def read(path: _Path, *, allow_outside: bool = False) -> Scene:
        """Reads a scene; files that it names are in its folder, or anywhere with `allow_outside`.

        Fields and variants are checked here, values and files by `check`, `world` and `run`.
        """

    @staticmethod
    def parse(text: str, *, folder: _Path = ..., name: str = "scene.ron") -> Scene:
        """Reads a scene from a text; files that it names are in `folder`."""

    def set(self, path: str, value: _Value) -> Scene:
        """The scene with a field set, by its path: `scene.set("numerics.smoothing_length_ratio", 1.5)`.

        Text stands as in a scene file, `"Spacing(0.05)"`; numbers, truth values, tuples, lists, dicts and paths are
        written so. This scene stays as it is.
        """

    @property
    def path(self) -> PathLike[str]:
        """File of the scene."""

    @property
    def text(self) -> str:
        """Text of the scene with all fields set."""

    def check(self) -> list[Problem]:
        """Checks everything that can be checked before a run; returns the warnings."""

    def world(self, *, threads: Optional[int] = None, resume: Optional[_Path] = None) -> World:
        """The world of the scene, in memory: water or blocks that are to settle first have not settled yet.

        `threads` are its own, all cores without; results do not depend on them. `resume` is a checkpoint of this scene,
        written by `World.checkpoint` or by a run.
        """

    def run(
        self,
        folder: _Path,
        *,
        until: Optional[float] = None,
        every: Optional[float] = None,
        call: Optional[Callable[[World], object]] = None,
        threads: Optional[int] = None,
        resume: bool = False,
        force: bool = False,
        report: bool = True,
        checkpoint_interval: float = 600.0,
    ) -> Run:
        """Runs the scene into a folder, as `riprap run` does, and opens the folder.

        `call` is called with the world every so many seconds (`every`), after each step without. Ctrl-C and exceptions
        of `call` end the run in good order, with a checkpoint from which `resume=True` continues to the same bits.
        """

@final
class World:
    """Blocks and water at one time."""

    @property
    def title(self) -> str:
        """Title of the scene."""
    @property
    def duration(self) -> float:
        """Duration of the scene; s."""
    @property
    def time(self) -> float:
        """Simulated time, 0 until water or blocks have settled; s."""
    @property
    def steps(self) -> int:
        """Steps since t = 0."""
    @property
    def time_step(self) -> Optional[float]:
        """Size of the last step, None before the first one; s."""
    @property
    def is_settling(self) -> bool:
        """Whether the water is still settling before t = 0."""
    @property
    def state_hash(self) -> str:
        """Hash of every number of the state: equal hashes, equal worlds. It is that of `summary.json`."""
    @property
    def water(self) -> Optional[Water]:
        """The water; None for a scene without."""
    @property
    def blocks(self) -> Blocks:
        """The blocks by name or number."""
    @property
    def gauges(self) -> Gauges:
        """Readings of the gauges by name, at the present state."""
    @property
    def ledger(self) -> dict[str, float]:
        """Energy by term (J), and `momentum_residual` (-)."""

    def step(self, n: int = 1) -> float:
        """Takes `n` steps, those of settling included; returns the time (s)."""

    def run(
        self,
        *,
        until: Optional[float] = None,
        every: Optional[float] = None,
        call: Optional[Callable[[World], object]] = None,
        checkpoint: Optional[_Path] = None,
    ) -> None:
        """Settles the water if need be, and takes steps until a time (s), the duration of the scene without.

        `call` is called with this world at t = 0 and every so many seconds (`every`), after each step without: at the
        first step at or after the due time. When Ctrl-C or an exception ends it, the state is written to the file
        `checkpoint`, if there is one.
        """

    def checkpoint(self, path: _Path) -> None:
        """Writes the state to a file, for `Scene.world(resume=...)`."""

@final
class Water:
    """The water of a world; every column is a copy."""

    @property
    def position(self) -> _Vector:
        """Position of each particle, (n, 3); m."""
    @property
    def velocity(self) -> _Vector:
        """Velocity of each particle, (n, 3); m/s."""
    @property
    def density(self) -> _Vector:
        """Density of each particle; kg/m³."""
    @property
    def pressure(self) -> _Vector:
        """Pressure of each particle; Pa."""
    @property
    def mass(self) -> _Vector:
        """Mass of each particle; kg."""
    @property
    def id(self) -> NDArray[np.uint32]:
        """Number of each particle, which it keeps while rows are sorted by place."""
    def by_id(self, name: Literal["position", "velocity", "density", "pressure", "mass"]) -> _Vector:
        """A column with a row for each number ever given; NaN for particles that have left."""
    def surface_elevation(self, x: float, y: float) -> float:
        """Elevation of the free surface at a point in plan view, NaN where it is dry; m."""
    def __len__(self) -> int: ...

@final
class Blocks:
    """The blocks of a world, by name or number."""

    def __getitem__(self, key: Union[str, int], /) -> Block: ...
    def __contains__(self, key: object, /) -> bool: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def keys(self) -> list[str]:
        """Names of the blocks."""

@final
class Block:
    """A block."""

    @property
    def name(self) -> str:
        """Name in the scene."""
    @property
    def number(self) -> int:
        """Number, as in the tables of a run."""
    @property
    def kind(self) -> str:
        """`free`, `fixed` or `prescribed`."""
    @property
    def is_removed(self) -> bool:
        """Whether it has left the domain."""
    @property
    def mass(self) -> float:
        """kg."""
    @property
    def volume(self) -> float:
        """m³."""
    @property
    def centroid(self) -> _Vector:
        """Centroid; m."""
    @property
    def velocity(self) -> _Vector:
        """Velocity of the centroid; m/s."""
    @property
    def angular_velocity(self) -> _Vector:
        """Angular velocity; rad/s."""
    @property
    def attitude(self) -> _Vector:
        """Turn since the start, a quaternion (x, y, z, w)."""
    @property
    def force(self) -> dict[str, _Vector]:
        """Forces by source: `water`, `contact`, `gravity`; N."""
    @property
    def moment(self) -> dict[str, _Vector]:
        """Moments about the centroid by source; N m."""

@final
class Gauges:
    """Readings of the gauges at the present state: a number, or a dict of those of a gauge with several columns.

    Pressures and forces are those of the moment, not means over an interval as in `gauges.csv`.
    """

    def __getitem__(self, name: str, /) -> Any: ...
    def __contains__(self, name: object, /) -> bool: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def keys(self) -> list[str]:
        """Names of the gauges."""

def command(arguments: list[str], program: list[str]) -> int:
    """Runs the command line; returns its exit code."""

def read_table(path: _Path) -> list[tuple[str, str, _Vector]]:
    """Name, unit and values of each column of a table of numbers."""

def compare_files(
    files: tuple[_Path, _Path],
    column: Optional[str],
    shift: float,
    window: tuple[Optional[float], Optional[float]],
    cell: Optional[float],
) -> tuple[bool, str]:
    """Comparison of two tables or surfaces as JSON, and whether it is one of surfaces."""

def check_study(path: _Path) -> None:
    """Reads and checks the file of a study."""
