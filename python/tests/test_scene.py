"""Scenes: text, fields, errors with their place."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import riprap

from conftest import BOX


def test_a_typo_is_reported_with_line_and_column(tmp_path: Path) -> None:
    path = tmp_path / "typo.ron"
    path.write_text(BOX.replace("density: 2400", "densty: 2400"))
    with pytest.raises(riprap.SceneError) as caught:
        riprap.Scene.read(path)
    (problem,) = caught.value.problems
    line = next(k for k, text in enumerate(BOX.splitlines(), 1) if "density: 2400" in text)
    column = BOX.splitlines()[line - 1].index("density") + 1
    assert (problem.line, problem.column, problem.severity) == (line, column, "error")
    assert "did you mean `density`" in problem.message and problem.code == "unknown-field"
    assert f"typo.ron:{line}:{column}: error: " in str(caught.value)
    assert isinstance(caught.value, ValueError)


def test_every_bad_value_is_reported_by_check(tmp_path: Path) -> None:
    text = BOX.replace("density: 2400", "density: -2400").replace("friction_angle_deg: 30", "friction_angle_deg: 130")
    scene = riprap.Scene.parse(text, folder=tmp_path)
    with pytest.raises(riprap.SceneError) as caught:
        scene.check()
    assert len(caught.value.problems) == 2
    copy = pickle.loads(pickle.dumps(caught.value))
    assert copy.problems == caught.value.problems and str(copy) == str(caught.value)


def test_warnings_have_places(scene: riprap.Scene) -> None:
    for warning in scene.check():
        assert warning.severity == "warning" and 0 < warning.line


@pytest.mark.parametrize(
    "path, value, written",
    [
        ("time.duration", 2, "duration: 2,"),
        ("time.duration", np.float64(0.1), "duration: 0.1,"),
        ("time.duration", np.int64(3), "duration: 3,"),
        ("fluid.resolution", "Spacing(0.04)", "resolution: Spacing(0.04)"),
        ("domain.max", (0.9, 0.1, 1.5), "max: (0.9, 0.1, 1.5)"),
        ("blocks.cube.sealed", True, "sealed: true"),
        ("materials.rock", {"name": '"rock"', "density": 2500, "friction_angle_deg": 1e-5}, "friction_angle_deg: 1e-5)"),
        ("blocks.cube.shape", "Box(min: (0.2, 0, 0.5), max: (0.3, 0.1, 0.6))", "max: (0.3, 0.1, 0.6)"),
    ],
)
def test_fields_take_values_of_python(scene: riprap.Scene, path: str, value: object, written: str) -> None:
    before = scene.text
    changed = scene.set(path, value)  # type: ignore[arg-type]
    assert written in changed.text
    assert scene.text == before


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_number_that_is_not_finite_is_refused(scene: riprap.Scene, value: float) -> None:
    with pytest.raises(ValueError, match="finite"):
        scene.set("time.duration", value)


def test_a_field_that_does_not_exist_is_refused_at_once(scene: riprap.Scene) -> None:
    with pytest.raises(riprap.SceneError, match="did you mean `duration`"):
        scene.set("time.duraton", 2)
    with pytest.raises(TypeError, match="a field of a scene is"):
        scene.set("time.duration", object())  # type: ignore[arg-type]


def test_a_missing_file_is_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        riprap.Scene.read(tmp_path / "none.ron")
