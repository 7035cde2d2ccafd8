"""Shapes and rigid bodies."""

from __future__ import annotations

import numpy as np
import pytest

import rockfall as rf

TURNED = [0.6, 0.0, 0.8, 0.0]


def dumbbell(scene: rf.Scene) -> int:
    return scene.add_shape(rf.Shape(mass=9).sphere([0, 0, 0], 1).sphere([4, 0, 0], 0.5).rod(0, 1, 0.25))


def test_bodies_have_the_poses_and_motions_that_were_given() -> None:
    scene = rf.Scene()
    scene.add_sphere([0, 50, 0], 1.0)
    shape = dumbbell(scene)
    added = scene.add_bodies(shape, [[0, 10 * k, 0] for k in range(3)], [TURNED, TURNED, [1, 0, 0, 0]], velocities=[1, 2, 3], name="bone")
    assert (added.bodies.tolist(), added.spheres.tolist(), added.rods.tolist()) == ([0, 1, 2], [[1, 2], [3, 4], [5, 6]], [[0], [1], [2]])
    assert scene.counts.bodies == 3
    sim = rf.Simulation(scene, dt=0.01, backend="cpu")
    mass, (x, y, z), inertia = scene.shape_mass(shape)
    assert (mass, y, z) == (pytest.approx(9), 0, 0) and inertia[1] == pytest.approx(inertia[2])
    np.testing.assert_allclose(sim.bodies.positions[2], [x, 20, 0], rtol=1e-6)
    np.testing.assert_array_equal(sim.bodies.orientations, np.float32([TURNED, TURNED, [1, 0, 0, 0]]))
    np.testing.assert_array_equal(sim.bodies.velocities, np.tile(np.float32([1, 2, 3]), (3, 1)))
    assert sim.bodies.angular_momenta.shape == (3, 3) and not sim.bodies.angular_momenta.any()
    assert len(sim.bodies) == 3


def test_a_spin_becomes_an_angular_momentum() -> None:
    scene = rf.Scene()
    shape = scene.add_shape(rf.Shape(density=2).capsule([0, 0, -1], [0, 0, 1], 0.5))
    body = scene.add_body(shape, [0, 0, 0], spin=[0, 0, 3])
    assert body == 0
    inertia = scene.shape_mass(shape).inertia
    np.testing.assert_allclose(scene.bodies.angular_momenta, [[0, 0, 3 * inertia[2]]], rtol=1e-6)


def test_bodies_are_removed_as_a_whole() -> None:
    scene = rf.Scene()
    added = scene.add_bodies(dumbbell(scene), [[0, 0, 0], [0, 10, 0]])
    with pytest.raises(ValueError, match="remove the body"):
        scene.remove("sphere", added.spheres[0])
    scene.remove_bodies(added.bodies[0])
    assert (scene.counts.spheres, scene.counts.bodies) == (2, 1)
    with pytest.raises(LookupError):
        scene.remove_bodies(added.bodies[0])


def test_wrong_shapes_and_bodies_are_errors() -> None:
    scene = rf.Scene()
    with pytest.raises(ValueError, match="at least one sphere"):
        scene.add_shape(rf.Shape())
    with pytest.raises(ValueError, match="density: expected without mass"):
        rf.Shape(mass=1, density=1)
    with pytest.raises(ValueError, match="expected both or none"):
        rf.Shape(centre=[0, 0, 0])
    with pytest.raises(LookupError, match="there is no shape 3"):
        scene.add_bodies(3, [0, 0, 0])
    with pytest.raises(ValueError, match="row 1: body.angular_momentum"):
        scene.add_bodies(dumbbell(scene), [[0, 0, 0], [9, 0, 0]], spins=[[0, 0, 0], [0, 3e38, 0]])
    assert scene.counts.spheres == 0


def test_states_of_bodies_are_read_only_copies() -> None:
    scene = rf.Scene()
    scene.add_bodies(dumbbell(scene), [[0, 0, 0]])
    sim = rf.Simulation(scene, dt=0.01, backend="cpu")
    for bodies in (scene.bodies, sim.bodies):
        for field in ("positions", "orientations", "velocities", "angular_momenta"):
            with pytest.raises(ValueError, match="read-only"):
                getattr(bodies, field)[0] = 1


def test_groups_meet_those_of_their_list() -> None:
    scene = rf.Scene()
    scene.settings.contact_law = "rigid"
    ball = scene.add_shape(rf.Shape(mass=1.0).sphere([0, 0, 0], 0.5, group=2))
    # Without a list, the balls of group 2 fall through the floor of group 0.
    scene.add_boxes([[-5, -1, -5]], [[[10, 0, 0], [0, 1, 0], [0, 0, 10]]])
    scene.add_bodies(ball, positions=[[0, 2, 0], [0.3, 3.2, 0]])
    assert scene.group_meets(2) is None
    scene.set_group_meets(2, [0])
    assert scene.group_meets(2) == [0]
    sim = rf.Simulation(scene, backend="cpu")
    sim.run(300)
    # They lie on the floor, one inside the other.
    np.testing.assert_allclose(sim.bodies.positions[:, 1], 0.5, atol=0.01)
    with pytest.raises(ValueError, match="group: expected integers from 0 to 65535"):
        scene.set_group_meets(-1, [0])
    with pytest.raises(ValueError, match="group.meets: 40 groups is not allowed"):
        scene.set_group_meets(2, range(40))


def floating(count: int = 3) -> rf.Simulation:
    """Boxes of the mass 2 without gravity."""
    scene = rf.Scene()
    scene.settings.update(gravity=0.0, contact_law="rigid")
    shape = scene.add_shape(rf.Shape(mass=2).box([-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]))
    scene.add_bodies(shape, [[0, 5 * k, 0] for k in range(count)])
    scene.set_bodies(0, forces=[0, 0, 1])
    return rf.Simulation(scene, backend="cpu")


def test_forces_and_torques_act_until_they_are_changed() -> None:
    sim = floating()
    np.testing.assert_array_equal(sim.bodies.forces, [[0, 0, 1], [0, 0, 0], [0, 0, 0]])
    numbers, forces = np.arange(3), np.float32([[2, 0, 0], [0, 4, 0], [0, 0, 0]])
    sim.set_bodies(numbers, forces=forces, torques=[0, 0.5, 0])
    sim.run(60)
    np.testing.assert_allclose(sim.bodies.velocities, forces / 2, rtol=1e-5)
    np.testing.assert_allclose(sim.bodies.positions[0], [0.5, 0, 0], atol=1e-5)
    np.testing.assert_allclose(sim.bodies.angular_momenta, np.tile([0, 0.5, 0], (3, 1)), rtol=1e-5)
    sim.set_bodies(numbers, forces=0 * forces, torques=[0, 0, 0])
    sim.run(60)
    np.testing.assert_allclose(sim.bodies.velocities, forces / 2, rtol=1e-5)
    assert not sim.bodies.torques.any()
    with pytest.raises(ValueError, match="forces"):
        sim.set_bodies(numbers, forces=[[1, 0, np.nan]] * 3)


def test_impulses_and_forces_act_at_points() -> None:
    sim = floating()
    sim.apply_body_impulses([0, 1], [[0, 0, 4], [0, 0, 2]], [[0.5, 0, 0], [0, 5, 0]])
    np.testing.assert_allclose(sim.bodies.velocities, [[0, 0, 2], [0, 0, 1], [0, 0, 0]])
    np.testing.assert_allclose(sim.bodies.angular_momenta, [[0, -2, 0], [0, 0, 0], [0, 0, 0]])
    sim.apply_body_impulses(2, [2, 0, 0])
    np.testing.assert_allclose(sim.bodies.velocities[2], [1, 0, 0])
    sim.add_body_forces([0, 0], [[0, 0, 3], [0, 1, 0]], [[0.5, 0, 0], [0, 0, 1]])
    np.testing.assert_allclose(sim.bodies.forces[0], [0, 1, 4])
    np.testing.assert_allclose(sim.bodies.torques[0], [-1, -1.5, 0])
    with pytest.raises(LookupError):
        sim.apply_body_impulses(3, [1, 0, 0])
    with pytest.raises(ValueError, match="points"):
        sim.apply_body_impulses([0, 1], [1, 0, 0], [[0, 0, 0], [0, np.inf, 0]])
    np.testing.assert_allclose(sim.bodies.velocities[0], [0, 0, 2])


def test_impulses_on_bodies_need_another_law() -> None:
    scene = rf.Scene()
    scene.settings.contact_law = "linear"
    scene.add_material("stuff", density=1)
    scene.set_pair("stuff", "stuff", stiffness=1000)
    scene.add_body(scene.add_shape(rf.Shape().sphere([0, 0, 0], 0.5, material="stuff")), [0, 0, 0])
    sim = rf.Simulation(scene, backend="cpu")
    with pytest.raises(ValueError, match="collisions: on under linear with a rigid body is not allowed, expected off"):
        sim.settings.update(collisions=True)
    sim.run(1)
    scene.settings.collision_friction = 0.5
    with pytest.raises(ValueError, match="collision_friction: 0.5 under linear .*contact_law = .rigid"):
        rf.Simulation(scene, backend="cpu")
