"""Runs in a folder: what the command writes, results, signals."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import riprap

from conftest import command


def test_a_run_is_that_of_the_command(case: Path, scene: riprap.Scene, tmp_path: Path) -> None:
    times = []
    run = scene.run(tmp_path / "mine", every=0.1, call=lambda world: times.append(world.time))
    assert len(times) == 4
    done = command("run", case, "-o", "theirs", "--quiet", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    theirs = riprap.open(tmp_path / "theirs")
    assert run.summary["state_hash"] == theirs.summary["state_hash"]
    assert run.summary["completed"] is True
    names = {path.name for path in run.folder.iterdir()}
    assert names == {path.name for path in theirs.folder.iterdir()} and "report.html" in names
    for name in ("case.ron", "gauges.csv", "energy.csv", "blocks.csv", "water_00001.vtp"):
        assert (run.folder / name).read_bytes() == (theirs.folder / name).read_bytes(), name
    with pytest.raises(OSError, match="already contains a run"):
        scene.run(tmp_path / "mine")


def test_results_are_what_the_files_say(scene: riprap.Scene, tmp_path: Path) -> None:
    run = scene.run(tmp_path / "run", report=False)
    header, *rows = (run.folder / "gauges.csv").read_text().splitlines()
    assert header.startswith("time [s],level [m],deep [Pa],on_cube.fluid_fx [N]")
    first = [float(cell) for cell in rows[0].split(",")]
    gauges = run.gauges
    assert [gauges[name][0] for name in gauges] == first and gauges.n_rows == len(rows)
    assert gauges.units["deep"] == "Pa" and gauges["time"].dtype == np.float64
    with pytest.raises(KeyError, match="there are time, level"):
        gauges["lvl"]
    cube = run.blocks["cube"]
    assert list(run.blocks) == ["cube"] and cube["z"][0] == pytest.approx(0.5)
    assert np.all(np.diff(cube["z"][:5]) < 0)
    assert list(run.bodies["name"]) == ["floor", "left", "right", "cube"]
    assert run.bodies["mass"][3] == pytest.approx(2.4) and run.bodies.units["mass"] == "kg"
    assert run.energy["residual"][0] == 0.0
    assert set(run.frames) == {"water", "blocks"}
    water = run.frames["water"]
    assert len(water) == 4 and water.times[0] == 0.0 and all(path.is_file() for path in water.files)
    # the scene as run is the same scene again
    again = run.scene.world()
    again.run()
    assert again.state_hash == run.summary["state_hash"]
    with pytest.raises(FileNotFoundError, match="forces.csv"):
        run.forces
    with pytest.raises(FileNotFoundError, match="not a run folder"):
        riprap.open(tmp_path)


def test_a_run_compared_with_itself_has_no_error(scene: riprap.Scene, tmp_path: Path) -> None:
    run = scene.run(tmp_path / "run", report=False)
    table = run.folder / "gauges.csv"
    found = riprap.compare(table, table, column="level")
    assert found["level"]["normalized_rms_error"] == 0.0 and found["level"]["unit"] == "m"
    assert "deep" in riprap.compare(table, table, start=0.1)
    with pytest.raises(ValueError, match="lvl"):
        riprap.compare(table, table, column="lvl")


def listen() -> None:
    """Lets SIGINT interrupt a process, also where these tests run in the background of a shell, which ignores it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


SCRIPT = """
import sys, riprap
scene = riprap.Scene.read(sys.argv[1]).set("time.duration", 60.0)
def call(world):
    print(world.time, flush=True)
scene.run(sys.argv[2], every=0.1, call=call, report=False)
"""


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_leaves_a_checkpoint_that_resumes_to_the_same_bits(case: Path, tmp_path: Path) -> None:
    line = [sys.executable, "-c", SCRIPT, str(case), "stopped"]
    process = subprocess.Popen(
        line, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=listen
    )
    assert process.stdout is not None and process.stderr is not None
    for _ in range(4):
        process.stdout.readline()
    process.send_signal(signal.SIGINT)
    process.wait(timeout=60)
    assert "KeyboardInterrupt" in process.stderr.read()
    folder = tmp_path / "stopped"
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["stop_reason"] == "interrupted" and 0.3 <= summary["simulated_time"] < 60
    assert (folder / "checkpoint.bin").is_file()

    # shorter than it was: another scene
    scene = riprap.Scene.read(case)
    with pytest.raises(OSError, match="the run had"):
        scene.run(folder, until=0.1, resume=True)
    until = summary["simulated_time"] + 0.1
    # a scene that is stopped, and one that is not, both end here
    state = scene.set("time.duration", 60.0).world(resume=folder / "checkpoint.bin")
    state.run(until=until)
    whole = scene.set("time.duration", 60.0).world()
    whole.run(until=until)
    assert state.state_hash == whole.state_hash


def test_a_run_ended_by_its_call_resumes(scene: riprap.Scene, tmp_path: Path) -> None:
    whole = scene.run(tmp_path / "whole", report=False)

    def stop(world: riprap.World) -> None:
        if 0.2 <= world.time:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        scene.run(tmp_path / "part", every=0.1, call=stop, report=False)
    part = riprap.open(tmp_path / "part")
    assert part.summary["completed"] is False
    resumed = scene.run(tmp_path / "part", resume=True, report=False)
    assert resumed.summary["state_hash"] == whole.summary["state_hash"]
    assert (resumed.folder / "gauges.csv").read_bytes() == (whole.folder / "gauges.csv").read_bytes()


def test_the_world_of_a_run_that_is_over_says_so(scene: riprap.Scene, tmp_path: Path) -> None:
    worlds: "list[riprap.World]" = []
    scene.run(tmp_path / "run", until=0.02, call=worlds.append, report=False)
    with pytest.raises(riprap.RunError, match="has ended"):
        worlds[0].time


def test_a_run_that_fails_is_an_error(scene: riprap.Scene, tmp_path: Path) -> None:
    # a cube that leaves the domain
    falling = scene.set("domain.leaving", "Fail").set("blocks.cube.velocity", (0.0, 0.0, 30.0))
    with pytest.raises(riprap.RunError, match="domain"):
        falling.run(tmp_path / "run", report=False)
    assert riprap.open(tmp_path / "run").summary["completed"] is False


STUDY = """(
    title: "Spacing of a box",
    case: "box.ron",
    output: (name: "level", column: "level", take: At(0.2)),
    truth: Finest(knob: "spacing"),
    knobs: [(name: "spacing", values: [
        (name: "0.05", at: 0.05, set: ["fluid.resolution=Spacing(0.05)"]),
        (name: "0.1", at: 0.1, set: ["fluid.resolution=Spacing(0.1)"]),
    ])],
)"""


def test_a_study_runs_in_processes_of_this_python(case: Path, tmp_path: Path) -> None:
    path = tmp_path / "study.ron"
    path.write_text(STUDY)
    result = riprap.study(path, tmp_path / "study", jobs=2)
    assert result.runs.n_rows == 2 and (tmp_path / "study" / "trade.svg").is_file()
    path.write_text(STUDY.replace("knobs", "nobs"))
    with pytest.raises(riprap.SceneError) as caught:
        riprap.trade(path, tmp_path / "study")
    assert caught.value.problems[0].line == 6
