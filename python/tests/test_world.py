"""Worlds: the bits of the command line, columns, callbacks, threads."""

import json
import threading
from pathlib import Path

import numpy as np
import pytest

import riprap

from conftest import command


def summary_of(case: Path, *arguments: object) -> "dict[str, object]":
    done = command("run", case, "-o", "reference", "--quiet", "--no-report", *arguments, cwd=case.parent)
    assert done.returncode == 0, done.stderr
    summary: "dict[str, object]" = json.loads((case.parent / "reference" / "summary.json").read_text())
    return summary


def test_a_world_has_the_bits_of_the_command_line(case: Path, scene: riprap.Scene) -> None:
    summary = summary_of(case)
    world = scene.world(threads=1)
    assert world.is_settling and world.time == 0.0
    world.run()
    assert world.state_hash == summary["state_hash"]
    assert (world.steps, world.time) == (summary["steps"], summary["simulated_time"])
    ledger = world.ledger
    assert ledger.pop("momentum_residual") == summary["momentum_residual"]
    assert ledger == summary["energy"]


def test_looking_changes_nothing(scene: riprap.Scene) -> None:
    plain, watched = scene.world(threads=2), scene.world(threads=1)
    plain.run(until=0.1)
    times = []

    def look(world: riprap.World) -> None:
        assert world.water is not None
        times.append(world.time)
        world.gauges["level"], world.gauges["on_cube"], world.water.position, world.blocks["cube"].force

    watched.run(until=0.1, every=0.02, call=look)
    assert watched.state_hash == plain.state_hash
    assert times[0] == 0.0 and len(times) == 6
    # at the first step at or after the due time; steps are 7 ms
    for k, time in enumerate(times):
        assert 0.02 * k - 1e-9 <= time < 0.02 * k + 0.01


def test_columns_are_copies_in_shapes_of_their_own(scene: riprap.Scene) -> None:
    world = scene.world()
    water = world.water
    assert water is not None
    n = len(water)
    assert n == 96
    for vector in (water.position, water.velocity):
        assert vector.shape == (n, 3) and vector.dtype == np.float64
    for column in (water.density, water.pressure, water.mass):
        assert column.shape == (n,) and column.dtype == np.float64
    assert water.id.dtype == np.uint32 and sorted(water.id) == list(range(n))
    before = water.position
    world.step(20)
    assert not np.array_equal(before, water.position)
    position, ids = water.position, water.id
    assert np.array_equal(water.by_id("position")[ids], position)
    assert np.array_equal(water.by_id("pressure")[ids], water.pressure)
    with pytest.raises(KeyError, match="there are position"):
        water.by_id("colour")  # type: ignore[arg-type]


def test_blocks_and_gauges_have_names(scene: riprap.Scene) -> None:
    world = scene.world()
    assert list(world.blocks) == ["floor", "left", "right", "cube"] == world.blocks.keys()
    assert "cube" in world.blocks and "cub" not in world.blocks and len(world.blocks) == 4
    cube = world.blocks["cube"]
    assert (cube.name, cube.number, cube.kind, world.blocks[3].name) == ("cube", 3, "free", "cube")
    assert world.blocks["floor"].kind == "fixed"
    np.testing.assert_allclose(cube.centroid, [0.25, 0.05, 0.5])
    np.testing.assert_allclose(cube.attitude, [0, 0, 0, 1])
    np.testing.assert_allclose(cube.force["gravity"], [0, 0, -9.81 * cube.mass], rtol=1e-3)
    assert set(cube.force) == set(cube.moment) == {"water", "contact", "gravity"}
    with pytest.raises(KeyError, match="did you mean `cube`"):
        world.blocks["cub"]
    with pytest.raises(IndexError):
        world.blocks[4]
    world.run(until=0.1)
    # 5 cm above the water: it has begun to fall
    assert cube.velocity[2] < -0.5
    assert abs(world.gauges["level"] - 0.4) < 0.05
    # rho g 0.3 m
    assert abs(world.gauges["deep"] - 2943) < 600
    assert world.gauges["on_cube"]["fluid_fz"] == cube.force["water"][2]
    with pytest.raises(KeyError, match="did you mean `level`"):
        world.gauges["leve"]


def test_a_checkpoint_continues_to_the_same_bits(scene: riprap.Scene, tmp_path: Path) -> None:
    world = scene.world()
    world.run(until=0.08)
    world.checkpoint(tmp_path / "a.bin")
    world.run(until=0.15)
    again = scene.world(resume=tmp_path / "a.bin")
    assert not again.is_settling and 0.08 <= again.time < 0.09
    again.run(until=0.15)
    assert again.state_hash == world.state_hash
    with pytest.raises(riprap.RunError, match="another scene") as caught:
        scene.set("time.duration", 1).world(resume=tmp_path / "a.bin")
    assert caught.value.code == "checkpoint-mismatch"


def test_an_exception_of_a_call_comes_out(scene: riprap.Scene, tmp_path: Path) -> None:
    class Enough(Exception):
        pass

    def stop(world: riprap.World) -> None:
        if 0.05 <= world.time:
            raise Enough

    world = scene.world()
    with pytest.raises(Enough):
        world.run(every=0.01, call=stop, checkpoint=tmp_path / "stopped.bin")
    assert 0.05 <= world.time < 0.06
    rest = scene.world(resume=tmp_path / "stopped.bin")
    assert rest.time == world.time
    rest.run()
    whole = scene.world()
    whole.run()
    assert rest.state_hash == whole.state_hash


def test_two_worlds_in_two_threads(scene: riprap.Scene) -> None:
    hashes = []

    def run() -> None:
        world = scene.world(threads=1)
        world.run(until=0.1)
        hashes.append(world.state_hash)

    threads = [threading.Thread(target=run) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(hashes) == 2 and hashes[0] == hashes[1]


def test_nonsense_is_refused(scene: riprap.Scene) -> None:
    with pytest.raises(ValueError, match="threads"):
        scene.world(threads=0)
    with pytest.raises(ValueError, match="every"):
        scene.world().run(every=0.0, call=print)
    with pytest.raises(ValueError, match="until"):
        scene.world().run(until=float("nan"))
