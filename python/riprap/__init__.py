"""Rock blocks and water in one explicit engine.

>>> import riprap
>>> scene = riprap.Scene.read("cases/sliding_wedge.ron").set("time.duration", 2.0)
>>> run = scene.run("runs/wedge")
>>> run.gauges["g1"].max()
"""

from __future__ import annotations

from ._errors import Problem, RunError, SceneError
from ._riprap import Block, Blocks, Gauges, Scene, Water, World, __version__
from ._results import BlockTables, Frames, Run, Table, open
from ._studies import StudyResult, compare, study, trade

__all__ = [
    "Block",
    "BlockTables",
    "Blocks",
    "Frames",
    "Gauges",
    "Problem",
    "Run",
    "RunError",
    "Scene",
    "SceneError",
    "StudyResult",
    "Table",
    "Water",
    "World",
    "__version__",
    "compare",
    "open",
    "study",
    "trade",
]
