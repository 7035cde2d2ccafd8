"""Joints between bodies."""

from __future__ import annotations

import numpy as np
import pytest
import rockfall as rf


def door(**options: object) -> tuple[rf.Scene, int]:
    """A bar of the length 1 and mass 2 that begins at the origin, with a hinge about z there."""
    scene = rf.Scene()
    scene.settings.contact_law = "rigid"
    scene.settings.gravity = 9.81
    bar = scene.add_shape(rf.Shape(mass=2.0).box([0, -0.05, -0.05], [1, 0.05, 0.05]))
    body = scene.add_body(bar, [0, 0, 0])
    scene.add_joint("hinge", None, body, at=[0, 0, 0], axis=[0, 0, 1], name="hinge", **options)  # type: ignore[arg-type]
    return scene, body


def test_a_hinge_stops_at_its_limit_and_bears_the_weight() -> None:
    scene, _ = door(limits=(-0.5, 0.5))
    sim = rf.Simulation(scene, backend="cpu")
    sim.run(300)
    joints = sim.joints
    assert len(joints) == 1 and joints.names == ["hinge"]
    assert joints.positions == pytest.approx([-0.5], abs=2e-3)
    assert joints.speeds == pytest.approx([0.0], abs=1e-3)
    assert joints.forces[0] == pytest.approx([0, 2 * 9.81, 0], abs=0.05)
    assert joints.torques[0, 2] == pytest.approx(2 * 9.81 * 0.5 * np.cos(0.5), rel=0.01)
    assert joints.errors[0] < 1e-3 and not joints.broken.any()


def test_a_controller_holds_an_arm() -> None:
    scene, _ = door(speed=0.0, max_force=100.0)
    sim = rf.Simulation(scene, backend="cpu")
    for _ in range(300):
        sim.set_joints(0, speed=4.0 * (0.7 - sim.joints.positions))
        sim.step()
    assert sim.joints.positions == pytest.approx([0.7], abs=0.02)
    sim.set_joints([0], speed=np.nan, target=-0.4, stiffness=500.0, damping=50.0)
    sim.run(300)
    # The spring gives way by the torque of the weight.
    gives = 2 * 9.81 * 0.5 * np.cos(0.42) / 500
    assert sim.joints.positions == pytest.approx([-0.4 - gives], abs=2e-3)


def test_a_joint_breaks_and_is_reported() -> None:
    scene, body = door(break_force=15.0)
    sim = rf.Simulation(scene, backend="cpu")
    sim.run(120)
    assert sim.joints.broken.tolist() == [True]
    assert sim.bodies.positions[body, 1] < -2


def test_joints_are_added_and_removed_while_it_runs() -> None:
    scene, body = door()
    sim = rf.Simulation(scene, backend="cpu")
    sim.run(30)
    sim.remove_joints(0)
    sim.run(60)
    assert len(sim.joints) == 0 and sim.bodies.positions[body, 1] < -1
    x, y, z = sim.bodies.positions[body]
    number = sim.add_joint("ball", None, body, at=[x, y, z])
    assert number == 1 and sim.joints.ids.tolist() == [1]
    sim.run(60)
    assert sim.bodies.positions[body] == pytest.approx([x, y, z], abs=0.05)


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({"limits": (0.5, 1.0)}, ValueError, "limits"),
        ({"cone": 0.5}, ValueError, "cone"),
        ({"stiffness": -1.0}, ValueError, "stiffness"),
        ({"friction": "much"}, TypeError, "friction"),
        ({"speed": np.nan}, ValueError, "speed"),
    ],
)
def test_wrong_values_are_named(options: dict[str, object], error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        door(**options)


def test_wrong_ends_are_named() -> None:
    scene, body = door()
    with pytest.raises(LookupError, match="body 7"):
        scene.add_joint("ball", body, 7, at=[0, 0, 0])
    with pytest.raises(TypeError, match="to:"):
        scene.add_joint("distance", None, body, at=[0, 0, 0])
    with pytest.raises(ValueError, match="another body"):
        scene.add_joint("ball", body, body, at=[0, 0, 0])
    with pytest.raises(LookupError, match="joint 3"):
        rf.Simulation(scene, backend="cpu").set_joints(3, speed=1.0)
