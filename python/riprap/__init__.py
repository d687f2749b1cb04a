"""Rock blocks and water in one explicit engine.

>>> import riprap
>>> scene = riprap.Scene.read("cases/sliding_wedge.ron").set("time.duration", 2.0)
>>> run = scene.run("runs/wedge")
>>> run.gauges["g1"].max()
"""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from ._errors import Problem, RunError, SceneError
    from ._results import BlockTables, Frames, Run, Table, open
    from ._riprap import Block, Blocks, Gauges, Scene, Water, World, __version__
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

# module of each name; loaded when it is first asked for, so that the command starts as fast as it can
_MODULES = {
    "_errors": ("Problem", "RunError", "SceneError"),
    "_results": ("BlockTables", "Frames", "Run", "Table", "open"),
    "_riprap": ("Block", "Blocks", "Gauges", "Scene", "Water", "World", "__version__"),
    "_studies": ("StudyResult", "compare", "study", "trade"),
}


def __getattr__(name: str) -> object:
    for module, names in _MODULES.items():
        if name in names:
            from importlib import import_module

            value: object = getattr(import_module(f".{module}", __name__), name)
            globals()[name] = value
            return value
    raise AttributeError(f"module `riprap` has no attribute `{name}`")


def __dir__() -> "list[str]":
    return sorted({*globals(), *__all__})
