"""Wrong arguments give errors that name the argument and what was expected."""

from __future__ import annotations

import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import rockfall as rf

NAN = float("nan")


class OnDevice:
    """An array on a GPU, as far as DLPack tells."""

    shape = (3,)

    def __dlpack_device__(self) -> tuple[int, int]:
        return (2, 0)

    def __dlpack__(self, **options: Any) -> Any:
        raise AssertionError("not asked for")


SCENE: list[tuple[Callable[[rf.Scene], Any], type[Exception], str]] = [
    (lambda s: s.add_spheres([[0, 0]], 1), ValueError, r"position: expected shape \(1, 3\) or \(3,\), got \(1, 2\)"),
    (lambda s: s.add_spheres(np.zeros((2, 3, 1)), 1), ValueError, r"position: expected shape \(2, 3\)"),
    (lambda s: s.add_spheres(5.0, 1), ValueError, "position: expected shape"),
    (lambda s: s.add_spheres(np.zeros((2, 3)), [1, 2, 3]), ValueError, "radius: expected 2 rows as in position, got 3"),
    (lambda s: s.add_spheres([0, 0, 0], np.ones((1, 1))), ValueError, r"radius: expected shape \(1,\)"),
    (lambda s: s.add_spheres([[0, 0, 0], [0, NAN, 0]], 1), ValueError, r"position: expected finite .* got nan at index \[1, 1\]"),
    (lambda s: s.add_spheres([1e300, 0, 0], 1), ValueError, r"position: .*\(in the range of float32"),
    (lambda s: s.add_spheres([0, 0, 0], np.inf), ValueError, "radius: expected finite"),
    (lambda s: s.add_spheres([0, 0, 0], 0), ValueError, "radius: expected numbers greater than 0"),
    (lambda s: s.add_spheres([0, 0, 0], 1e-60), ValueError, "radius: expected numbers greater than 0"),
    (lambda s: s.add_spheres([0, 0, 0], 1, -1), ValueError, "mass: expected numbers greater than 0"),
    (lambda s: s.add_spheres([0, 0, 0], 1e-30, 1e-30), ValueError, "row 0: sphere.mass and sphere.radius"),
    (lambda s: s.add_spheres([0, 0, 0], 1, velocity=[1, 2]), ValueError, "velocity: expected shape"),
    (lambda s: s.add_spheres([0, 0, 0], 1, orientation=[1, 1, 0, 0]), ValueError, "orientation: expected unit quaternions"),
    (lambda s: s.add_spheres([0, 0, 0], 1, fixed=1), TypeError, "fixed: expected booleans, got dtype int"),
    (lambda s: s.add_spheres(np.zeros((3, 3)), 1, fixed=[True, False]), ValueError, "fixed: expected 3 rows as in position"),
    (lambda s: s.add_spheres([0, 0, 0], 1, group=1.5), TypeError, "group: expected integers"),
    (lambda s: s.add_spheres([0, 0, 0], 1, group=65536), ValueError, "group: expected integers from 0 to 65535"),
    (lambda s: s.add_spheres("abc", 1), TypeError, "position: expected real numbers, got dtype <U3"),
    (lambda s: s.add_spheres([[0, 0, 0], [0, 0]], 1), ValueError, "position: expected"),
    (lambda s: s.add_spheres(None, 1), TypeError, "position: expected real numbers, got dtype object"),
    (lambda s: s.add_spheres(np.zeros(3, complex), 1), TypeError, "position: expected real numbers, got dtype complex128"),
    (lambda s: s.add_spheres(np.zeros(3, bool), 1), TypeError, "position: expected real numbers, got dtype bool"),
    (lambda s: s.add_spheres(OnDevice(), 1), TypeError, r"position: expected an array in host memory.*type 2"),
    (lambda s: s.add_sphere(np.zeros((2, 3)), 1), ValueError, "position: .* add_spheres takes several"),
    (lambda s: s.add_rods(0, 5, 0.1), LookupError, "there is no sphere 5"),
    (lambda s: s.add_rods(0, 0, 0.1), ValueError, "row 0: both ends are sphere 0"),
    (lambda s: s.add_rods(0.5, 1, 0.1), TypeError, "end1: expected integers"),
    (lambda s: s.add_rods(-1, 1, 0.1), ValueError, "end1: expected integers from 0"),
    (lambda s: s.add_rods(0, 1, 0.0), ValueError, "radius: expected numbers greater than 0"),
    (lambda s: s.add_rods(0, 1, 0.1, -1), ValueError, "length: expected numbers that are not negative"),
    (lambda s: s.add_rod([0, 1], [1, 0], 0.1), ValueError, "end1: .* add_rods"),
    (lambda s: s.add_springs(0, 1, -1), ValueError, "stiffness: expected numbers that are not negative"),
    (lambda s: s.add_springs(0, 1, 1, damping=NAN), ValueError, "damping: expected finite"),
    (lambda s: s.add_spring(0, [1, 1], 1), ValueError, "b: .* add_springs"),
    (lambda s: s.add_tethers(0, [0, 0], 1), ValueError, "point: expected shape"),
    (lambda s: s.add_tethers(9, [0, 0, 0], 1), LookupError, "there is no sphere 9"),
    (lambda s: s.add_capsules([0, 0, 0], [0, 0, 0], 1), ValueError, "row 0: capsule.end1 and capsule.end2"),
    (lambda s: s.add_capsules([0, 0, 0], [0, 0], 1), ValueError, "end2: expected shape"),
    (lambda s: s.add_boxes([0, 0, 0], np.ones((3, 3))), ValueError, "row 0: box.edges"),
    (lambda s: s.add_boxes([0, 0, 0], np.eye(2)), ValueError, r"edges: expected shape \(1, 3, 3\) or \(3, 3\), got \(2, 2\)"),
    (lambda s: s.add_box([0, 0, 0], [0, 1, 1]), ValueError, "min, max: expected a greater number in every coordinate of max"),
    (lambda s: s.add_box([1, 0, 1], [0, 1, 2]), ValueError, r"got min \[1.0, 0.0, 1.0\] and max \[0.0, 1.0, 2.0\]"),
    (lambda s: s.add_box([0, 0], [1, 1, 1]), ValueError, "min: expected shape"),
    (lambda s: s.add_box(np.zeros((2, 3)), [1, 1, 1]), ValueError, "min, max: expected shape"),
    (lambda s: s.add_polygons([0, 0, 0], [1, 0, 0], [2, 0, 0]), ValueError, "row 0: polygon.right"),
    (lambda s: s.remove("ball", 0), ValueError, "kind: expected one of sphere, rod"),
    (lambda s: s.remove("sphere", 99), LookupError, "there is no sphere 99"),
    (lambda s: s.table("ball"), ValueError, "kind: expected one of"),
    (lambda s: s.update_springs(0, stiffness=-1), ValueError, "stiffness"),
    (lambda s: s.update_springs(7, stiffness=1), LookupError, "there is no spring 7"),
    (lambda s: s.update_tethers([0, 0], point=np.zeros((3, 3))), ValueError, "point: expected shape"),
    (lambda s: setattr(s.settings, "gravity", NAN), ValueError, "gravity: expected finite"),
    (lambda s: setattr(s.settings, "gravity", "1"), TypeError, "gravity: expected a number"),
    (lambda s: setattr(s.settings, "gravity", [1, 2]), ValueError, "gravity"),
    (lambda s: setattr(s.settings, "gravity", [0, -9.8, 0]), ValueError, "gravity_direction the direction"),
    (lambda s: setattr(s.settings, "restitution", -1), ValueError, "restitution: .* is not allowed, expected"),
    (lambda s: setattr(s.settings, "collisions", 1), TypeError, "collisions: expected True or False"),
    (lambda s: setattr(s.settings, "gravity_direction", [0, 0, 0]), ValueError, "gravity_direction"),
    (lambda s: setattr(s.settings, "gravitation", 1), AttributeError, "gravitation"),
    (lambda s: s.settings.update(gravitation=1), AttributeError, "gravitation: did you mean .*gravity"),
    (lambda s: s.settings["gravitation"], KeyError, "gravitation"),
    (lambda s: s.check(dt=0), ValueError, "dt: expected"),
    (lambda s: s.check(integrator="euler"), ValueError, "integrator"),
    (lambda s: rf.Scene.parse("S 1 2"), ValueError, "scene:1: S"),
    (lambda s: rf.Scene.parse(b"S"), TypeError, "text: expected a str"),  # type: ignore[arg-type]
    (lambda s: rf.Scene.load("/no/such/file.txt"), FileNotFoundError, "/no/such/file.txt"),
    (lambda s: s.save("/no/such/folder/file.txt"), OSError, "/no/such/folder"),
    (lambda s: rf.Simulation("scene"), TypeError, "scene: expected a rockfall.Scene"),  # type: ignore[arg-type]
    (lambda s: rf.Simulation(s, dt=0), ValueError, "dt: expected a finite number of seconds greater than 0"),
    (lambda s: rf.Simulation(s, dt=NAN), ValueError, "dt: expected"),
    (lambda s: rf.Simulation(s, dt=1e-60), ValueError, "dt: expected"),
    (lambda s: rf.Simulation(s, dt="1"), TypeError, "dt: expected a number"),  # type: ignore[arg-type]
    (lambda s: rf.Simulation(s, backend="cuda"), ValueError, "backend: .*cuda.* expected one of: auto gpu cpu"),
    (lambda s: rf.Simulation(s, backend=1), TypeError, "backend: expected a str"),  # type: ignore[arg-type]
    (lambda s: rf.Simulation(s, integrator="euler"), ValueError, "integrator: .*euler.* expected auto, rk4"),
    (lambda s: rf.Simulation(s, broad_phase="tree"), ValueError, "broad-phase"),
]


@pytest.mark.parametrize("case", range(len(SCENE)))
def test_wrong_arguments_of_scenes_are_named(case: int) -> None:
    call, kind, message = SCENE[case]
    scene = rf.Scene()
    scene.add_spheres(np.eye(3), 0.1)
    scene.add_springs(0, 1, 1)
    scene.add_tethers(0, [0, 0, 0], 1)
    before = scene.to_text()
    with pytest.raises(kind, match=message) as caught:
        call(scene)
    assert "panic" not in str(caught.value).lower()
    assert scene.to_text() == before, "nothing was changed"


SIMULATION: list[tuple[Callable[[rf.Simulation], Any], type[Exception], str]] = [
    (lambda s: s.run(-1), ValueError, "steps: expected a whole number of at least 0, got -1"),
    (lambda s: s.run(1.5), TypeError, "steps: expected a whole number, got float"),  # type: ignore[arg-type]
    (lambda s: s.run(2**70), ValueError, "steps: expected"),
    (lambda s: setattr(s, "dt", -1), ValueError, "dt: expected"),
    (lambda s: s.profile(0), ValueError, "steps: expected a whole number of at least 1"),
    (lambda s: setattr(s, "velocities", np.zeros((2, 3))), ValueError, r"velocity: expected shape \(3, 3\) or \(3,\), got \(2, 3\)"),
    (lambda s: setattr(s, "velocities", "fast"), TypeError, "velocity: expected real numbers"),
    (lambda s: setattr(s, "orientations", np.zeros((3, 4))), ValueError, "orientation: expected unit quaternions"),
    (lambda s: setattr(s, "radii", [1, 1, 1]), AttributeError, "radii"),
    (lambda s: s.velocities.__setitem__((1, 2), NAN) or s.step(), ValueError, r"velocity: expected finite .* \[1, 2\]"),
    (lambda s: s.orientations.__setitem__(1, 0) or s.step(), ValueError, "orientation: .* at row 1"),
    (lambda s: s.velocities.__setitem__(slice(None), np.zeros((2, 3))), ValueError, "broadcast"),
    (lambda s: s.set(0, velocity=[1, 2]), ValueError, "velocity: expected shape"),
    (lambda s: s.set([0, 1], velocity=np.zeros((3, 3))), ValueError, "velocity: expected shape"),
    (lambda s: s.set(0, velocity=[NAN, 0, 0]), ValueError, "velocity: expected finite"),
    (lambda s: s.set(9, velocity=[0, 0, 0]), LookupError, "there is no sphere 9"),
    (lambda s: s.set(0.5, velocity=[0, 0, 0]), TypeError, "ids: expected integers"),
    (lambda s: s.apply_impulse(0, [1, 2]), ValueError, "impulse: expected shape"),
    (lambda s: s.apply_impulse(9, [0, 0, 0]), LookupError, "there is no sphere 9"),
    (lambda s: s.cast_rays([0, 0, 0], [0, 0, 0]), ValueError, "direction: expected vectors that are not zero"),
    (lambda s: s.cast_rays([0, NAN, 0], [0, 0, 1]), ValueError, "origin: expected finite"),
    (lambda s: s.cast_rays(np.zeros((2, 3)), np.ones((3, 3))), ValueError, "origin: expected shape"),
    (lambda s: s.render(size=(0, 10)), ValueError, "size: expected a whole number of at least 1"),
    (lambda s: s.render(size=(10.5, 10)), TypeError, "size: expected a whole number"),  # type: ignore[arg-type]
    (lambda s: s.render(size=5), ValueError, "size: expected width and height"),  # type: ignore[arg-type]
    (lambda s: s.render(size=(65000, 10)), ValueError, "65000x10"),
    (lambda s: s.render(size=(9, 9), colour_by="taste"), ValueError, "colour_by: .*taste.* expected one of: kind"),
    (lambda s: s.render(size=(9, 9), range=(2, 1)), ValueError, "range: expected two numbers"),
    (lambda s: s.render(size=(9, 9), camera=[1, 2]), ValueError, "camera: expected shape"),
    (lambda s: s.render(size=(9, 9), view="below"), ValueError, "view: .*below.* expected one of: front"),
    (lambda s: s.render(size=(9, 9), up="x"), ValueError, "up: .*x.* expected one of: y, z, auto"),
    (lambda s: s.render(size=(9, 9), view="top", camera=[1, 2, 3]), ValueError, "view, camera: expected only one"),
    (lambda s: s.render(size=(9, 9), arrows="spin"), ValueError, "arrows: .*spin.* expected one of: velocity"),
    (lambda s: s.render(size=(9, 9), camera=[1, 2, 3], look_at=[1, 2, 3]), ValueError, "camera and look_at are the same"),
    (lambda s: s.record("film.mp4"), ValueError, "path: film.mp4 is not a trajectory, expected"),
    (lambda s: s.record("/no/such/folder/film.npz"), OSError, "/no/such/folder"),
    (lambda s: s.record("film.npz", every=0), ValueError, "every: expected a whole number of at least 1"),
    (lambda s: s.save_checkpoint("/no/such/folder/a.ckpt"), OSError, "/no/such/folder"),
    (lambda s: s.restore("/no/such/file.ckpt"), FileNotFoundError, "/no/such/file.ckpt"),
    (lambda s: rf.Simulation.resume("/no/such/file.ckpt"), FileNotFoundError, "/no/such/file.ckpt"),
    (lambda s: rf.Simulation.resume(__file__), ValueError, "not a usable checkpoint"),
    (lambda s: rf.Trajectory(__file__), OSError, "not a usable trajectory"),
    (lambda s: setattr(s.settings, "gravity", NAN), ValueError, "gravity: expected finite"),
]


@pytest.mark.parametrize("case", range(len(SIMULATION)))
def test_wrong_arguments_of_simulations_are_named(case: int, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    call, kind, message = SIMULATION[case]
    monkeypatch.chdir(tmp_path)
    scene = rf.Scene()
    scene.add_spheres(np.eye(3), 0.1)
    sim = rf.Simulation(scene, backend="cpu")
    before = sim.scene.to_text()
    with pytest.raises(kind, match=message) as caught:
        call(sim)
    assert "panic" not in str(caught.value).lower()
    assert sim.scene.to_text() == before, "nothing was changed"
    sim.step()


def test_a_wrong_row_adds_nothing() -> None:
    scene = rf.Scene()
    position = np.zeros((10, 3))
    radius = np.full(10, 1e-30)
    radius[:9] = 1
    with pytest.raises(ValueError, match="row 9"):
        scene.add_spheres(position, radius, 1e-30 * np.where(np.arange(10) == 9, 1, 1e30))
    assert scene.counts.spheres == 0


def test_comm_needs_mpi(scene: rf.Scene) -> None:
    # check_mpi.py tests the rest.
    class Communicator:
        def py2f(self) -> int:
            return 0

    with pytest.raises(rf.SimulationError, match="MPI"):
        rf.Simulation(scene, comm=Communicator())
    with pytest.raises(TypeError, match="comm: expected a communicator of mpi4py"):
        rf.Simulation(scene, comm=0)  # type: ignore[arg-type]
