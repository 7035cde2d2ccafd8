"""Joints and rigid bodies of many worlds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rockfall as rf

FRAME = 1 / 60


def arm(*, mass: float = 2.0, gravity: float = 0.0, **options: Any) -> rf.Scene:
    """A bar of the length 1 on a hinge about z at the origin, and a second one on its end, with a hinge called elbow."""
    scene = rf.Scene()
    scene.settings.update(contact_law="rigid", gravity=gravity)
    bar = scene.add_shape(rf.Shape(mass=mass).box([0, -0.05, -0.05], [1, 0.05, 0.05]))
    upper, lower = scene.add_bodies(bar, [[0, 0, 0], [1, 0, 0]]).bodies
    scene.add_joint("hinge", None, int(upper), at=[0, 0, 0], axis=[0, 0, 1], name="shoulder", **options)
    scene.add_joint("hinge", int(upper), int(lower), at=[1, 0, 0], axis=[0, 0, 1], name="elbow")
    return scene


def sled() -> rf.Scene:
    """A box of the mass 2 on a slider along x, without gravity."""
    scene = rf.Scene()
    scene.settings.update(contact_law="rigid", gravity=0.0)
    box = scene.add_shape(rf.Shape(mass=2.0).box([-0.1, -0.1, -0.1], [0.1, 0.1, 0.1]))
    scene.add_joint("slider", None, scene.add_body(box, [0, 0, 0]), at=[0, 0, 0], axis=[1, 0, 0], name="way")
    return scene


def worlds_of(scene: rf.Scene, count: int = 3) -> rf.Worlds:
    return rf.Worlds(scene, FRAME, count=count, backend="cpu")


def test_joints_and_bodies_are_those_of_simulations() -> None:
    scenes = [arm(gravity=9.81), sled(), arm(gravity=3.0)]
    worlds = rf.Worlds(scenes, FRAME, backend="cpu")
    worlds.run(20)
    joints, bodies = worlds.joints, worlds.bodies
    assert joints.mask.tolist() == bodies.mask.tolist() == [[True, True], [True, False], [True, True]]
    assert joints.names == [["shoulder", "elbow"], ["way"], ["shoulder", "elbow"]]
    assert len(joints) == len(bodies) == 2
    for number, scene in enumerate(scenes):
        sim = rf.Simulation(scene, FRAME, backend="cpu")
        sim.run(20)
        count = len(sim.joints)
        for name in ("positions", "speeds", "errors", "forces", "torques", "broken"):
            found = getattr(joints, name)
            np.testing.assert_array_equal(found[number, :count], getattr(sim.joints, name))
            assert not found[number, count:].any()
        for name in ("positions", "orientations", "velocities", "angular_momenta"):
            found = getattr(bodies, name)
            np.testing.assert_array_equal(found[number, :count], getattr(sim.bodies, name))
            assert not found.flags.writeable
    assert joints.positions[0, 0] < -0.1 and joints.forces.shape == (3, 2, 3)
    # About the axis of the shoulder, the angular velocity of the bar is the rate of the angle.
    np.testing.assert_allclose(bodies.spins[:, 0, 2], np.where([True, False, True], joints.speeds[:, 0], 0), atol=1e-5)


def test_motors_of_some_worlds_are_set() -> None:
    worlds = worlds_of(arm())
    worlds.set_joints(speed=[0.0, 0.0], max_force=1e4)
    worlds.set_joints([0, 2], joints=0, speed=[[1.0], [-2.0]])
    worlds.set_joints(np.array([False, True, False]), joints=[1], speed=0.5)
    worlds.run(30)
    np.testing.assert_allclose(worlds.joints.speeds, [[1, 0], [0, 0.5], [-2, 0]], rtol=0.06, atol=0.01)
    worlds.set_joints(speed=np.nan, target=[[0.3, 0.1], [0.2, 0.0], [-0.4, 0.3]], stiffness=2000.0, damping=200.0)
    worlds.run(300)
    np.testing.assert_allclose(worlds.joints.positions, [[0.3, 0.1], [0.2, 0.0], [-0.4, 0.3]], atol=2e-3)


def test_a_force_and_a_torque_act_as_newton_says() -> None:
    seconds = 0.5
    worlds = worlds_of(sled())
    worlds.set_joint_forces([[3.0], [0.0], [-1.5]])
    worlds.run(30)
    np.testing.assert_allclose(worlds.joints.speeds[:, 0], np.array([3.0, 0.0, -1.5]) / 2 * seconds, rtol=2e-3, atol=1e-6)
    np.testing.assert_allclose(worlds.joints.positions[:, 0], np.array([3.0, 0.0, -1.5]) / 4 * seconds**2, rtol=0.02, atol=1e-6)
    # The force ends with the next one, and a motor with a speed stops at it.
    worlds.set_joint_forces(0.0)
    before = worlds.joints.speeds
    worlds.run(30)
    np.testing.assert_allclose(worlds.joints.speeds, before, rtol=1e-4, atol=1e-6)
    worlds.set_joint_forces(6.0, 1, fastest=0.7)
    worlds.run(60)
    assert worlds.joints.speeds[1, 0] == pytest.approx(0.7, abs=1e-4)

    # A torque turns both bars of a stretched arm whose elbow is held as one.
    turning = worlds_of(arm(), 2)
    turning.set_joint_forces([[4.0], [-2.0]], joints=[0])
    turning.set_joints(joints=1, speed=0.0, max_force=np.inf)
    turning.run(15)
    inertia = 4.0 * 2.0**2 / 3 + 2 * 2.0 * 0.1**2 / 12
    np.testing.assert_allclose(turning.joints.speeds[:, 0], np.array([4.0, -2.0]) / inertia * 0.25, rtol=5e-3)


def test_forces_on_bodies_act_until_they_are_changed() -> None:
    worlds = worlds_of(sled(), 4)
    worlds.set_bodies([1, 3], forces=[[[1.0, 0, 0]], [[2.0, 0, 0]]], torques=[[0.0, 0, 0]])
    np.testing.assert_array_equal(worlds.bodies.forces[:, 0, 0], [0, 1, 0, 2])
    worlds.run(12)
    speeds = worlds.joints.speeds[:, 0]
    assert speeds[1] > 0 and not speeds[[0, 2]].any()
    np.testing.assert_allclose(speeds[3], 2 * speeds[1], rtol=1e-4)
    worlds.set_bodies(forces=[[0.0, 0, 0]])
    assert not worlds.bodies.forces.any()
    worlds.run(12)
    np.testing.assert_allclose(worlds.joints.speeds[:, 0], speeds, rtol=1e-3)


def test_places_of_joints_are_those_that_are_read() -> None:
    worlds = worlds_of(arm())
    random = np.random.default_rng(1)
    positions, speeds = random.uniform(-1, 1, (3, 2)), random.uniform(-2, 2, (3, 2))
    worlds.place_joints(positions, speeds)
    np.testing.assert_allclose(worlds.joints.positions, positions, atol=1e-6)
    np.testing.assert_allclose(worlds.joints.speeds, speeds, atol=1e-5)
    assert worlds.joints.errors.max() < 1e-6
    angle, rate = positions[:, 0], speeds[:, 0]
    middle = 0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    np.testing.assert_allclose(worlds.bodies.positions[:, 0, :2], middle, atol=1e-6)
    across = 0.5 * rate[:, None] * np.stack([-np.sin(angle), np.cos(angle)], axis=1)
    np.testing.assert_allclose(worlds.bodies.velocities[:, 0, :2], across, atol=1e-6)
    np.testing.assert_allclose(worlds.bodies.spins[:, 1, 2], speeds.sum(axis=1), atol=1e-5)
    # Only one world, and all joints at one place.
    before = worlds.joints.positions
    worlds.place_joints(0.25, worlds=2)
    np.testing.assert_array_equal(worlds.joints.positions[:2], before[:2])
    np.testing.assert_allclose(worlds.joints.positions[2], [0.25, 0.25], atol=1e-6)
    np.testing.assert_allclose(worlds.joints.speeds[2], [0.0, 0.0], atol=1e-6)


def test_what_is_free_follows_its_first_body() -> None:
    worlds = worlds_of(rf.gym.ant(), 2)
    half = np.sqrt(0.5)
    worlds.set_bodies(1, 0, positions=[[3.0, 2.0, 1.0]], orientations=[[half, 0, half, 0]])
    worlds.set_bodies(1, 0, velocities=[[1, 0, 0]], spins=[[0, 2, 0]])
    worlds.place_joints(np.full(8, 0.1), 0.0, 1)
    joints, bodies = worlds.joints, worlds.bodies
    np.testing.assert_allclose(joints.positions[1], 0.1, atol=1e-6)
    assert joints.errors.max() < 1e-6 and not joints.positions[0].any()
    np.testing.assert_allclose(bodies.spins[1], np.broadcast_to([0, 2, 0], (9, 3)), atol=1e-5)
    apart = bodies.positions[1] - bodies.positions[1, 0]
    np.testing.assert_allclose(bodies.velocities[1], [1, 0, 0] + np.cross([0, 2, 0], apart), atol=1e-5)


def test_states_of_bodies_are_set() -> None:
    worlds = worlds_of(sled(), 4)
    worlds.set_bodies([1, 3], velocities=[[[1.0, 0, 0]], [[2.0, 0, 0]]], angular_momenta=[[0.0, 0, 0]])
    np.testing.assert_allclose(worlds.joints.speeds[:, 0], [0, 1, 0, 2], atol=1e-6)
    worlds.set_bodies(positions=np.arange(4)[:, None, None] * [[[1.0, 0, 0]]], orientations=[[1.0, 0, 0, 0]])
    np.testing.assert_allclose(worlds.joints.positions[:, 0], np.arange(4), atol=1e-6)
    with pytest.raises(TypeError, match="angular_momenta, spins: expected at most one of them"):
        worlds.set_bodies(spins=[[0.0, 0, 0]], angular_momenta=[[0.0, 0, 0]])


def test_the_reset_of_some_leaves_the_others_bit_for_bit() -> None:
    def drive(worlds: rf.Worlds, chosen: Any) -> None:
        worlds.set_joint_forces(np.outer(np.arange(4), [1.0, -0.5]))
        worlds.run(25)
        if chosen is not None:
            worlds.reset(chosen)
            assert not worlds.joints.positions[chosen].any() and not worlds.joints.speeds[chosen].any()
        worlds.run(25)

    one, other = worlds_of(arm(gravity=2.0), 4), worlds_of(arm(gravity=2.0), 4)
    drive(one, [1, 3])
    drive(other, None)
    for name in ("positions", "speeds", "forces", "torques"):
        np.testing.assert_array_equal(getattr(one.joints, name)[[0, 2]], getattr(other.joints, name)[[0, 2]])
    np.testing.assert_array_equal(one.bodies.orientations[[0, 2]], other.bodies.orientations[[0, 2]])
    # The motors of those that begin again are as in the scene: there are none.
    fresh = worlds_of(arm(gravity=2.0), 1)
    fresh.run(25)
    np.testing.assert_array_equal(one.joints.positions[[1, 3]], np.repeat(fresh.joints.positions, 2, axis=0))


def test_copies_and_checkpoints_keep_motors_and_places() -> None:
    worlds = worlds_of(arm())
    worlds.place_joints([0.2, -0.1])
    worlds.set_joint_forces([2.0, 1.0])
    worlds.run(10)
    twin = worlds.copy()
    worlds.run(10)
    twin.run(10)
    np.testing.assert_array_equal(worlds.joints.positions, twin.joints.positions)


WRONG: list[tuple[str, dict[str, Any], type[Exception], str]] = [
    ("set_joints", {"speed": [1.0, 2.0, 3.0]}, ValueError, r"speed: expected shape \(3, 2\), \(2,\) or \(\), got \(3,\)"),
    ("set_joints", {"pace": 1.0}, TypeError, "pace: not a number of a joint"),
    ("set_joints", {"joints": 2, "speed": 1.0}, ValueError, "joint: 2 of 2 is not allowed, expected a number below"),
    ("set_joints", {"worlds": 3, "speed": 1.0}, LookupError, "worlds: there is no world 3"),
    ("set_joints", {"max_force": -1.0}, ValueError, "joint.max_force: -1.0 is not allowed"),
    ("set_joint_forces", {"forces": [1.0]}, ValueError, r"effort: expected shape \(3, 2\)"),
    ("place_joints", {"positions": [1.0]}, ValueError, r"positions: expected shape \(3, 2\) or \(2,\), got \(1,\)"),
    ("place_joints", {"positions": np.nan}, ValueError, "positions: expected finite numbers"),
    ("set_bodies", {"bodies": 2, "positions": [[0.0, 0, 0]]}, ValueError, "body: 2 of 2 is not allowed"),
    ("set_bodies", {"positions": [0.0, 0, 0]}, ValueError, r"positions: expected shape \(3, 2, 3\) or \(2, 3\)"),
    ("set_bodies", {"orientations": np.ones((2, 4))}, ValueError, "orientations: expected unit quaternions"),
]


@pytest.mark.parametrize("number", range(len(WRONG)))
def test_errors_name_what_was_expected(number: int) -> None:
    method, arguments, kind, message = WRONG[number]
    with pytest.raises(kind, match=message):
        getattr(worlds_of(arm()), method)(**arguments)


def test_worlds_without_joints_have_empty_arrays() -> None:
    scene = rf.Scene()
    scene.add_sphere([0, 1, 0], 0.1)
    worlds = rf.Worlds(scene, 0.01, count=2, backend="cpu")
    assert worlds.joints.positions.shape == (2, 0) and worlds.bodies.orientations.shape == (2, 0, 4)
    assert isinstance(worlds.joints, rf.WorldJoints) and isinstance(worlds.bodies, rf.WorldBodies)
