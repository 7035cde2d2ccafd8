"""Worlds: many scenes side by side."""

from __future__ import annotations

import pathlib
import threading
from typing import Any

import numpy as np
import pytest

import rockfall as rf


def creature(seed: int, spheres: int) -> rf.Scene:
    """A tangle of springs above a floor, with a muscle."""
    random = np.random.default_rng(seed)
    scene = rf.Scene()
    scene.settings.update(gravity=9.81, collisions=False, contact_force=8000.0, contact_damping=60.0, friction=16000.0)
    scene.add_box([-50, -1, -50], [50, 0, 50])
    corners = np.stack(np.meshgrid(range(2), range(2), range(3), indexing="ij"), -1).reshape(-1, 3)[:spheres]
    balls = scene.add_spheres(corners * 0.5 + [0, 0.15, 0], radius=0.12, velocity=random.normal(0, 0.5, (spheres, 3)))
    a, b = np.triu_indices(spheres, 1)
    scene.add_springs(balls[a], balls[b], stiffness=1500, damping=8, muscle=[0.1, 2.0, 0.25 * seed])
    return scene


def states(sim: rf.Simulation) -> list[Any]:
    return [sim.positions.tolist(), sim.velocities.tolist(), sim.orientations.tolist(), sim.angular_momenta.tolist()]


def rows_of(worlds: rf.Worlds, world: int) -> list[Any]:
    exists = worlds.mask[world]
    fields = [worlds.positions, worlds.velocities, worlds.orientations, worlds.angular_momenta]
    return [field[world][exists].tolist() for field in fields]


@pytest.mark.parametrize("backend", ["cpu", "gpu"])
def test_a_world_is_bitwise_identical_to_a_simulation(backend: str) -> None:
    scenes = [creature(seed, spheres) for seed, spheres in enumerate([4, 8, 6])]
    worlds = rf.Worlds(scenes, dt=0.005, backend=backend)
    worlds.run(60)
    assert len(worlds) == 3 and worlds.backend.kind == backend and worlds.integrator == "rk4"
    assert worlds.positions.shape == (3, 8, 3) and worlds.orientations.shape == (3, 8, 4)
    assert worlds.sphere_counts.tolist() == [4, 8, 6] and worlds.spring_counts.tolist() == [6, 28, 15]
    assert worlds.mask.sum(axis=1).tolist() == [4, 8, 6] and worlds.spring_mask.sum(axis=1).tolist() == [6, 28, 15]
    assert not worlds.positions[~worlds.mask].any() and not worlds.rest_lengths[~worlds.spring_mask].any()
    for world, scene in enumerate(scenes):
        alone = rf.Simulation(scene, dt=0.005, backend=backend)
        alone.run(60)
        assert rows_of(worlds, world) == states(alone), world
    report = worlds.report()
    assert report["steps"].tolist() == [60, 60, 60] and report["workgroup"].all() == (backend == "gpu")
    np.testing.assert_allclose(report["time"], 0.3)


@pytest.mark.parametrize("backend", ["cpu", "gpu"])
def test_a_record_is_that_of_a_loop(backend: str) -> None:
    scenes = [creature(seed, spheres) for seed, spheres in enumerate([4, 8, 6])]
    recorded = rf.Worlds(scenes, dt=0.005, backend=backend)
    for field, columns in [("positions", 3), ("velocities", 3), ("orientations", 4), ("angular_momenta", 3)]:
        looped = rf.Worlds(scenes, dt=0.005, backend=backend)
        recorded.reset()
        samples = recorded.record(11, every=4, field=field)
        assert samples.shape == (3, 3, 8, columns) and samples.dtype == np.float32 and not samples.flags.writeable
        for steps, sample in zip([4, 4, 3], samples, strict=True):
            looped.run(steps)
            assert sample.tolist() == getattr(looped, field).tolist(), (field, steps)
    assert recorded.record(0).shape == (0, 3, 8, 3)


def test_wrong_records_are_errors() -> None:
    worlds = rf.Worlds(creature(1, 4), count=2, dt=0.005, backend="cpu")
    for wrong in ({"steps": -1}, {"steps": 2, "every": 0}, {"steps": 2, "field": "colours"}):
        with pytest.raises(ValueError, match="expected"):
            worlds.record(**wrong)
    with pytest.raises(TypeError):
        worlds.record(2.5)
    assert worlds.report()["steps"].tolist() == [0, 0]


def test_neighbours_and_order_do_not_matter() -> None:
    scenes = [creature(seed, 5 + seed) for seed in range(3)]
    together, alone = rf.Worlds(scenes, backend="cpu", dt=0.005), rf.Worlds(scenes[2], count=1, backend="cpu", dt=0.005)
    turned = rf.Worlds(scenes[::-1], backend="cpu", dt=0.005)
    for worlds in (together, alone, turned):
        worlds.run(40)
    assert rows_of(together, 2) == rows_of(alone, 0) == rows_of(turned, 0)


@pytest.mark.parametrize("backend", ["cpu", "gpu"])
def test_controls_are_those_of_a_simulation_that_is_changed_between_steps(backend: str) -> None:
    scenes = [creature(3, 4), creature(4, 6)]
    worlds = rf.Worlds(scenes, dt=0.005, backend=backend)
    random = np.random.default_rng(0)
    lengths = np.maximum(worlds.rest_lengths * random.uniform(0.8, 1.2, (4, 2, 15)), 0).astype(np.float32)
    forces = random.normal(0, 5, (4, 2, 6, 3)).astype(np.float32)
    worlds.run(35, rest_lengths=lengths, external_forces=forces, every=10)
    np.testing.assert_array_equal(worlds.rest_lengths[1], lengths[3, 1])
    np.testing.assert_array_equal(worlds.external_forces[1], forces[3, 1])
    for world, scene in enumerate(scenes):
        alone = rf.Simulation(scene, dt=0.005, backend=backend)
        spheres, springs = alone.counts.spheres, alone.counts.springs
        for row, steps in enumerate([10, 10, 10, 5]):
            alone.update_springs(np.arange(springs), length=lengths[row, world, :springs])
            alone.external_forces = forces[row, world, :spheres]
            alone.run(steps)
        assert rows_of(worlds, world) == states(alone), world
    with pytest.raises(ValueError, match=r"rest_lengths: expected shape \(4, 2, 15\), got \(3, 2, 15\)"):
        worlds.run(35, rest_lengths=lengths[:3], every=10)
    with pytest.raises(ValueError, match=r"external_forces: expected shape"):
        worlds.run(1, external_forces=np.zeros((1, 2, 5, 3)))
    assert worlds.report()["steps"].tolist() == [35, 35]


def test_states_are_set_for_all_and_for_some_worlds() -> None:
    worlds = rf.Worlds([creature(1, 4), creature(2, 6)], backend="cpu", dt=0.005)
    before = worlds.positions
    with pytest.raises(ValueError, match="read-only"):
        before[0, 0, 0] = 1.0
    moved = before.copy()
    moved[:, :, 0] += 1.5
    moved[~worlds.mask] = np.nan
    worlds.positions = moved
    np.testing.assert_array_equal(worlds.positions[worlds.mask], moved[worlds.mask])
    worlds.velocities = np.zeros((6, 3))
    assert not worlds.velocities.any()
    worlds.set([False, True], velocities=[np.full((6, 3), 2.0)], angular_momenta=np.ones((6, 3)))
    assert not worlds.velocities[0].any() and (worlds.velocities[1] == 2.0).all() and (worlds.angular_momenta[1] == 1.0).all()
    turned = np.tile([0.6, 0.0, 0.8, 0.0], (6, 1))
    worlds.orientations = turned
    np.testing.assert_array_equal(worlds.orientations[1], turned.astype(np.float32))
    worlds.external_forces = np.ones((2, 6, 3))
    worlds.angular_momenta = np.zeros((6, 3))
    worlds.rest_lengths = np.full(15, 0.4)
    assert worlds.external_forces[0, :4].min() == 1.0 and not worlds.external_forces[0, 4:].any()
    assert not worlds.angular_momenta.any() and (worlds.rest_lengths[worlds.spring_mask] == np.float32(0.4)).all()
    assert (worlds.masses[worlds.mask] == 1.0).all() and (worlds.radii[worlds.mask] == np.float32(0.12)).all()
    np.testing.assert_allclose(worlds.centres[0], worlds.positions[0, :4].mean(axis=0), rtol=1e-6)


@pytest.mark.parametrize("backend", ["cpu", "gpu"])
def test_worlds_are_reset_and_replaced(backend: str) -> None:
    worlds = rf.Worlds(creature(5, 6), dt=0.005, count=3, backend=backend)
    first = worlds.positions
    worlds.run(20)
    later = worlds.positions
    worlds.rest_lengths = worlds.rest_lengths * 0.9
    worlds.reset(1)
    np.testing.assert_array_equal(worlds.positions, np.stack([later[0], first[1], later[2]]))
    assert worlds.report()["steps"].tolist() == [20, 0, 20]
    worlds.reset()
    worlds.run(20)
    np.testing.assert_array_equal(worlds.positions, later)
    worlds.replace([2], creature(6, 8))
    assert worlds.positions.shape == (3, 8, 3) and worlds.report()["steps"].tolist() == [20, 20, 0]
    worlds.run(10)
    alone = rf.Simulation(creature(6, 8), dt=0.005, backend=backend)
    alone.run(10)
    assert rows_of(worlds, 2) == states(alone)


@pytest.mark.parametrize("backend", ["cpu", "gpu"])
def test_all_worlds_are_replaced_as_by_new_worlds(backend: str) -> None:
    worlds = rf.Worlds(creature(5, 6), dt=0.005, count=3, backend=backend)
    worlds.run(7)
    for scenes, count in [([creature(1, 4), creature(2, 8)], None), (creature(3, 5), 4)]:
        worlds.replace_all(scenes, count=count)
        fresh = rf.Worlds(scenes, dt=0.005, count=count, backend=backend)
        for some in (worlds, fresh):
            some.run(15)
        assert len(worlds) == len(fresh)
        for field in ("positions", "velocities", "orientations", "angular_momenta", "rest_lengths"):
            assert getattr(worlds, field).tobytes() == getattr(fresh, field).tobytes(), field
        assert (worlds.report() == fresh.report()).all()
    worlds.replace_all(creature(3, 5), count=2)
    with pytest.raises(TypeError, match="count: expected the number of worlds"):
        worlds.replace_all(rf.Scene())
    assert len(worlds) == 2


@pytest.mark.parametrize("backend", ["cpu", "gpu"])
def test_worlds_at_rest_sleep(backend: str, tmp_path: pathlib.Path) -> None:
    scene = rf.Scene()
    scene.settings.update(gravity=9.81, collisions=False, contact_force=8000.0, contact_damping=60.0)
    scene.add_box([-50, -1, -50], [50, 0, 50])
    scene.add_sphere([0, 0.1, 0], radius=0.1)
    worlds = rf.Worlds([scene, scene, creature(1, 4)], dt=0.005, backend=backend)
    assert worlds.sleep == {"speed": pytest.approx(0.01), "steps": 100, "skip": False}
    worlds.run(300)
    assert worlds.report()["sleeping"].tolist() == [True, True, False]
    assert worlds.report()["steps"].tolist() == [300, 300, 300]
    worlds.set_sleep(0.05, 20, skip=True)
    assert not worlds.report()["sleeping"].any()
    worlds.run(30)
    assert worlds.report()["steps"].tolist() == [320, 320, 330]
    worlds.set(0, external_forces=[[1.0, 0.0, 0.0]] * 4)
    worlds.save_checkpoint(tmp_path / "worlds.ckpt")
    for some in (worlds, rf.Worlds.resume(tmp_path / "worlds.ckpt", dt=0.005)):
        assert some.report()["sleeping"].tolist() == [False, True, False]
        some.run(10)
        assert some.report()["steps"].tolist() == [330, 320, 340] and some.sleep["steps"] == 20


@pytest.mark.parametrize("backend", ["cpu", "gpu"])
def test_a_world_that_is_not_finite_is_stopped_alone(backend: str) -> None:
    bad = creature(7, 4)
    bad.add_spheres([[0, 3, 0], [0.1, 3, 0]], radius=0.1, mass=1e-30, force=[1e30, 0, 0])
    worlds = rf.Worlds([creature(8, 4), bad, creature(8, 4)], dt=0.005, backend=backend)
    worlds.run(30)
    assert list(worlds.stopped) == [1] and "finite" in worlds.stopped[1]
    assert worlds.report()["stopped"].tolist() == [False, True, False]
    assert rows_of(worlds, 0) == rows_of(worlds, 2) and np.isfinite(worlds.positions).all()
    assert worlds.report()["steps"][0] == 30
    worlds.reset([1])
    assert worlds.stopped == {}


def test_worlds_go_on_from_a_checkpoint(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "worlds.ckpt"
    worlds = rf.Worlds([creature(1, 4), creature(2, 6)], dt=0.005, backend="cpu")
    worlds.run(30)
    worlds.save_checkpoint(path)
    resumed = rf.Worlds.resume(path, dt=0.005)
    assert resumed.backend.kind == "cpu" and resumed.report()["steps"].tolist() == [30, 30]
    for both in (worlds, resumed):
        both.run(20)
        both.reset(1)
        both.run(5)
    assert rows_of(resumed, 0) == rows_of(worlds, 0) and rows_of(resumed, 1) == rows_of(worlds, 1)
    assert resumed.report()["steps"].tolist() == [55, 5]
    rf.Simulation(rf.Scene(), backend="cpu").save_checkpoint(path)
    with pytest.raises(ValueError, match="does not begin as"):
        rf.Worlds.resume(path)
    with pytest.raises(FileNotFoundError):
        rf.Worlds.resume(tmp_path / "none")


def test_reports_name_the_sphere_that_has_escaped() -> None:
    worlds = rf.Worlds(creature(1, 4), count=2, backend="cpu")
    worlds.set(1, positions=[[0, 1, 0], [9, 1, 0], [1, 1, 0], [0, 2, 0]])
    assert worlds.report(bounds=([-5, -5, -5], [5, 5, 5]))["escaped"].tolist() == [-1, 1]
    assert worlds.report()["escaped"].tolist() == [-1, -1]


def test_a_world_becomes_a_scene_and_a_picture() -> None:
    worlds = rf.Worlds([creature(1, 4), creature(2, 6)], dt=0.005, backend="cpu")
    worlds.run(10)
    goes_on = rf.Simulation(worlds.scene(1), dt=0.005, backend="cpu")
    assert goes_on.positions.tolist() == rows_of(worlds, 1)[0]
    assert worlds.render(1, (64, 48)).numpy().shape[:2] == (48, 64)
    worlds.dt = 0.01
    assert worlds.dt == 0.01 and "2 worlds, 10 spheres, cpu" in repr(worlds)


def test_threads_and_progress(capsys: pytest.CaptureFixture[str]) -> None:
    worlds = rf.Worlds(creature(1, 6), count=8, dt=0.005, backend="cpu")
    threads = [threading.Thread(target=worlds.run, args=(50,)) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    worlds.run(50, progress=True)
    assert (worlds.report()["steps"] == 200).all()
    shown = capsys.readouterr().err
    assert "50/50" in shown or "50 of 50" in shown


def test_worlds_without_spheres() -> None:
    empty = rf.Worlds(rf.Scene(), count=2, backend="cpu")
    empty.run(5)
    assert empty.positions.shape == (2, 0, 3) and empty.report()["steps"].tolist() == [5, 5]


WRONG: list[tuple[Any, type[Exception], str]] = [
    (lambda w: rf.Worlds([rf.Scene(), 5]), TypeError, "scenes: expected a Scene at place 1, got int"),
    (lambda w: rf.Worlds(5), TypeError, "scenes: expected a Scene or a sequence"),
    (lambda w: rf.Worlds(rf.Scene()), TypeError, "count: expected the number of worlds"),
    (lambda w: rf.Worlds([rf.Scene()], count=2), TypeError, "count: expected None for several scenes"),
    (lambda w: rf.Worlds(rf.Scene(), count=-1), ValueError, "count: expected a whole number of at least 0"),
    (lambda w: rf.Worlds([]), ValueError, "scenes: expected at least one Scene"),
    (lambda w: rf.Worlds([rf.Scene()], dt=0), ValueError, "dt: expected a finite number"),
    (lambda w: rf.Worlds([rf.Scene()], backend="tpu"), ValueError, "tpu"),
    (lambda w: rf.Worlds([rf.Scene()], integrator=5), TypeError, "integrator: expected a str"),
    (lambda w: w.run(-1), ValueError, "steps: expected a whole number"),
    (lambda w: w.run(5, every=0), ValueError, "every: expected a whole number of at least 1"),
    (lambda w: w.reset(2), LookupError, "worlds: there is no world 2, expected numbers below 2"),
    (lambda w: w.reset([True]), ValueError, r"worlds: expected a mask of shape \(2,\)"),
    (lambda w: w.reset(0.5), TypeError, "worlds: expected integers"),
    (lambda w: w.set_sleep(-1.0), ValueError, "speed: expected"),
    (lambda w: w.set_sleep(steps=0), ValueError, "steps: expected a whole number of at least 1"),
    (lambda w: w.replace_all([]), ValueError, "scenes: expected at least one Scene"),
    (lambda w: w.replace_all([5]), TypeError, "scenes: expected a Scene at place 0"),
    (lambda w: w.scene(2), LookupError, "there is no world 2"),
    (lambda w: w.replace(0, 5), TypeError, "scenes: expected a Scene"),
    (lambda w: w.replace([0, 1], [rf.Scene()]), ValueError, "scenes: expected 2 scenes, one per world, got 1"),
    (lambda w: setattr(w, "positions", np.zeros((2, 4, 3))), ValueError, r"positions: expected shape \(2, 6, 3\)"),
    (lambda w: setattr(w, "velocities", np.full((6, 3), np.nan)), ValueError, "velocities: expected finite"),
    (lambda w: setattr(w, "orientations", np.ones((2, 6, 4))), ValueError, "orientations: expected unit quaternions"),
    (lambda w: setattr(w, "rest_lengths", np.full((2, 15), -1.0)), ValueError, "rest_lengths: expected numbers that are not neg"),
    (lambda w: setattr(w, "external_forces", "abc"), TypeError, "external_forces: expected real numbers"),
    (lambda w: w.set(1, positions=np.zeros((2, 6, 3))), ValueError, r"positions: expected shape \(1, 6, 3\)"),
    (lambda w: w.report(bounds=([0, 0], [1, 1, 1])), ValueError, r"bounds\[0\]: expected shape"),
]


@pytest.mark.parametrize("number", range(len(WRONG)))
def test_errors_name_the_argument(number: int) -> None:
    call, kind, message = WRONG[number]
    worlds = rf.Worlds([creature(1, 4), creature(2, 6)], backend="cpu")
    before = worlds.positions
    with pytest.raises(kind, match=message):
        call(worlds)
    np.testing.assert_array_equal(worlds.positions, before)


def plate(frequency: float) -> rf.Scene:
    """Balls on a plate that oscillates."""
    scene = rf.Scene()
    scene.settings.update(gravity=9.81, collisions=False)
    scene.add_motion("plate", amplitude=(0, 0.05, 0), frequency=frequency)
    scene.add_box([-2, -0.2, -2], [2, 0, 2], motion="plate")
    scene.add_spheres([[0.3, 0.5, 0], [-0.9, 0.3, 0.2]], [0.5, 0.25], velocity=[0.1, 0, 0])
    return scene


def test_worlds_have_moving_walls() -> None:
    scenes = [plate(frequency) for frequency in (2.0, 3.0, 7.0)]

    def alone(number: int, steps: int) -> list[Any]:
        sim = rf.Simulation(scenes[number], dt=0.005, backend="cpu")
        sim.run(steps)
        return states(sim)

    worlds = rf.Worlds(scenes, dt=0.005, backend="cpu")
    worlds.run(20)
    twin = worlds.copy()
    for both in (worlds, twin):
        both.run(10)
        both.reset([1])
        both.run(15)
        for number, steps in enumerate((45, 15, 45)):
            assert states(both.simulation(number)) == alone(number, steps)
    still = plate(0.0)
    still.settings.gravity = 0.0
    resting = rf.Worlds([still], dt=0.005, backend="cpu")
    resting.set_sleep(1.0, steps=5, skip=True)
    resting.run(20)
    assert resting.report()["steps"].tolist() == [20], "a wall may come"


def test_too_many_worlds_are_an_error() -> None:
    scene = rf.Scene()
    scene.add_sphere([0, 1, 0], radius=0.1)
    with pytest.raises(ValueError, match="100000000 worlds is not allowed, expected at most 1048576 worlds"):
        rf.Worlds(scene, dt=0.01, count=100_000_000, backend="cpu")
