"""Hard contacts (the contact law ``rigid``) through the Python package."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rockfall as rf

FRAME = 1 / 60


def stage() -> tuple[rf.Scene, int]:
    scene = rf.Scene()
    scene.settings.contact_law = "rigid"
    scene.settings.gravity = 9.81
    cube = scene.add_shape(rf.Shape(mass=2).box([-0.5] * 3, [0.5] * 3))
    return scene, cube


def test_a_belt_and_a_table_carry_bodies() -> None:
    scene, cube = stage()
    scene.add_motion("table", velocity=[1, 0, 0])
    scene.add_box([-9, -1, -9], [9, 0, -1], motion="table", name="scale")
    scene.add_box([-9, -1, 1], [9, 0, 9], surface_velocity=[-1, 0, 0])
    scene.add_bodies(cube, [[0, 0.5, -4], [0, 0.5, 4]])
    sim = rf.Simulation(scene, dt=FRAME, backend="cpu")
    sim.run(120)
    np.testing.assert_allclose(sim.bodies.velocities, [[1, 0, 0], [-1, 0, 0]], atol=1e-3)
    # Friction 0.5 accelerates to 1 unit/s within 0.1 units.
    np.testing.assert_allclose(sim.bodies.positions[:, 0], [1.9, -1.9], atol=0.03)
    load = sim.wall_load("scale")
    np.testing.assert_allclose(load.force, [0, -2 * 9.81, 0], atol=0.05)


def test_bodies_are_set_and_a_run_is_resumed(tmp_path: Path) -> None:
    scene, cube = stage()
    scene.add_box([-9, -1, -9], [9, 0, 9])
    scene.add_bodies(cube, [[0, 0.5, 0], [0, 1.5, 0], [4, 0.5, 0]])
    sim = rf.Simulation(scene, dt=FRAME, backend="cpu")
    sim.run(30)
    sim.set_bodies(2, velocities=[-6, 0, 0])
    np.testing.assert_array_equal(sim.bodies.velocities[2], [-6, 0, 0])
    sim.run(10)
    sim.save_checkpoint(tmp_path / "a.ckpt")
    sim.run(50)
    other = rf.Simulation.resume(tmp_path / "a.ckpt")
    other.run(50)
    np.testing.assert_array_equal(sim.bodies.positions, other.bodies.positions)
    assert sim.bodies.positions[0, 0] < -0.05


def test_states_of_bodies_are_set_or_refused_as_a_whole() -> None:
    scene, cube = stage()
    scene.add_bodies(cube, [[0, 0, 0], [3, 0, 0]])
    for target in (scene, rf.Simulation(scene, dt=FRAME, backend="cpu")):
        half = np.sqrt(0.5)
        target.set_bodies([1, 0], positions=[[5, 1, 0], [0, 2, 0]], orientations=[half, 0, half, 0], angular_momenta=[0, 1, 0])
        np.testing.assert_array_equal(target.bodies.positions, [[0, 2, 0], [5, 1, 0]])
        np.testing.assert_allclose(target.bodies.orientations, [[half, 0, half, 0]] * 2, rtol=1e-6)
        np.testing.assert_array_equal(target.bodies.angular_momenta, [[0, 1, 0]] * 2)
        with pytest.raises(ValueError, match="row 1"):
            target.set_bodies([0, 1], positions=[7, 7, 7], orientations=[[1, 0, 0, 0], [1, 1, 0, 0]])
        with pytest.raises(LookupError):
            target.set_bodies(2, positions=[7, 7, 7])
        with pytest.raises(ValueError, match="velocities: expected shape"):
            target.set_bodies([0, 1], velocities=[[1, 2, 3]])
        np.testing.assert_array_equal(target.bodies.positions, [[0, 2, 0], [5, 1, 0]])


def test_what_hard_contacts_do_not_know_is_named() -> None:
    scene, cube = stage()
    scene.add_body(cube, [0, 1, 0])
    scene.add_servo("lid", force=[0, -1, 0], speed=1)
    scene.add_box([-1, 2, -1], [1, 3, 1], motion="lid")
    with pytest.raises(ValueError, match="rigid with a servo"):
        rf.Simulation(scene, dt=FRAME, backend="cpu")
