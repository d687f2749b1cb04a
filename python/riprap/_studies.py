"""Comparisons and studies."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple, Optional

from ._errors import RunError
from ._results import PathLike, Table, _mixed_table
from ._riprap import check_study, compare_files

class StudyResult(NamedTuple):
    """Results of a study."""

    folder: Path
    """Folder of its runs."""
    runs: Table
    """Every run with its settings, value, error and cost."""
    front: Table
    """Runs that no other one beats in both error and cost."""


def compare(
    computed: PathLike,
    reference: PathLike,
    *,
    column: Optional[str] = None,
    shift: float = 0.0,
    start: Optional[float] = None,
    end: Optional[float] = None,
    cell: Optional[float] = None,
) -> Any:
    """Compares a table of a run with a reference, or two surfaces.

    Tables are compared over time, one column or all common ones: returns a dict of the results of each column, with
    `normalized_rms_error`, `peak_error`, `trough_error`, `arrival_time_error`, `correlation`, `reference_range`, `n` and
    `window`; what is not defined is None. `shift` (s) is added to the computed times, `start` and `end` (s) are times of
    the reference.

    Two surfaces (run folders, rasters, meshes, point clouds) are compared at points every `cell` (m): returns a dict.
    """
    files = (Path(computed), Path(reference))
    is_of_surfaces, text = compare_files(files, column, shift, (start, end), cell)
    found = json.loads(text)
    return found if is_of_surfaces else {one.pop("column"): one for one in found}


def study(path: PathLike, folder: Optional[PathLike] = None, *, jobs: Optional[int] = None) -> StudyResult:
    """Measures error against cost for settings of a scene; runs that are complete in the folder are not repeated."""
    check_study(Path(path))
    folder = Path("runs") / "trade" / Path(path).stem if folder is None else Path(folder)
    command = [sys.executable, "-m", "riprap", "study", os.fspath(path), "-o", os.fspath(folder)]
    if jobs is not None:
        command += ["--jobs", str(jobs)]
    # in a session of its own, which gets the signal from here, once
    process = subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    try:
        _, said = process.communicate()
    except KeyboardInterrupt:
        _interrupt(process)
        process.communicate()
        raise
    if process.returncode != 0:
        lines = [line for line in said.splitlines() if line.startswith("error")]
        raise RunError("\n".join(lines) or said.strip())
    return StudyResult(folder, _mixed_table(folder / "trade.csv"), _mixed_table(folder / "front.csv"))


trade = study


def _interrupt(process: subprocess.Popen[str]) -> None:
    """Ends a study with its runs, in good order where the system knows how."""
    if hasattr(os, "killpg"):
        os.killpg(process.pid, signal.SIGINT)
    else:
        process.terminate()
