"""Periodic boundaries."""

import numpy as np
import pytest

import rockfall as rf


def test_bodies_pass_the_faces_of_the_box() -> None:
    scene = rf.Scene()
    scene.settings.gravity = 0
    scene.set_periodic("x", -1, 1)
    scene.add_spheres([[0.75, 0, 0], [-0.75, 0, 0]], radius=0.1, velocity=[[1, 0, 0], [-1, 0, 0]])
    assert scene.periodic == {"x": (-1.0, 1.0)}
    again = rf.Scene.parse(scene.to_text())
    assert again.periodic == scene.periodic
    sim = rf.Simulation(scene, dt=0.01, backend="cpu")
    sim.run(100)
    # They meet at the face and fly back.
    assert sim.velocities[0, 0] < 0 < sim.velocities[1, 0]
    assert sim.periodic == scene.periodic
    far = [[2.5, 7, 0], [-1, 0, 0], [1, 0, 0], [-1e-20 - 1, 0, 0]]
    assert np.array_equal(scene.in_box(far), [[0.5, 7, 0], [-1, 0, 0], [-1, 0, 0], [-1, 0, 0]])
    scene.set_periodic("x")
    assert scene.periodic == {}


def test_wrong_boxes_are_refused() -> None:
    scene = rf.Scene()
    with pytest.raises(ValueError, match="axis: expected 'x', 'y' or 'z'"):
        scene.set_periodic("w", 0, 1)
    with pytest.raises(ValueError, match="expected both bounds"):
        scene.set_periodic("x", 0)
    with pytest.raises(ValueError, match="ascending order"):
        scene.set_periodic("x", 1, 0)
    scene.set_periodic("y", 0, 1)
    scene.add_spheres([[0, 0, 0]], radius=0.3)
    with pytest.raises(ValueError, match="sphere 0 is 0.6 units long along y"):
        rf.Simulation(scene, backend="cpu")
