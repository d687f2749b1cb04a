"""Scenes of the tests: small enough for a second."""

import subprocess
import sys
from pathlib import Path

import pytest

import riprap

BOX = """(
    title: "Box",
    domain: (min: (-0.3, 0, -0.3), max: (0.9, 0.1, 0.9), dimensions: Two),
    materials: [(name: "rock", density: 2400, friction_angle_deg: 30)],
    blocks: [
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, -0.3), max: (0.9, 0.1, 0))),
        (name: "left", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, 0), max: (0, 0.1, 0.9))),
        (name: "right", material: "rock", motion: Fixed, shape: Box(min: (0.6, 0, 0), max: (0.9, 0.1, 0.9))),
        (name: "cube", material: "rock", shape: Box(min: (0.2, 0, 0.45), max: (0.3, 0.1, 0.55))),
    ],
    fluid: (dynamic_viscosity: 0.001, resolution: Spacing(0.05), regions: [
        (name: "water", shape: Box(min: (0, 0, 0), max: (0.6, 0.1, 0.4))),
    ]),
    gauges: [
        SurfaceElevation(name: "level", x: 0.45, y: 0.05),
        Pressure(name: "deep", position: (0.45, 0.05, 0.1)),
        BlockForce(name: "on_cube", block: "cube"),
    ],
    time: (duration: 0.3, settle: 0.05),
    output: (frame_interval: 0.1, gauge_interval: 0.01),
)"""


@pytest.fixture
def case(tmp_path: Path) -> Path:
    """A cube that falls into a box of water, in a file."""
    path = tmp_path / "box.ron"
    path.write_text(BOX)
    return path


@pytest.fixture
def scene(case: Path) -> riprap.Scene:
    """The same scene, read."""
    return riprap.Scene.read(case)


def command(*arguments: object, cwd: Path) -> "subprocess.CompletedProcess[str]":
    """The command line."""
    line = [sys.executable, "-m", "riprap", *map(str, arguments)]
    return subprocess.run(line, cwd=cwd, capture_output=True, text=True)
