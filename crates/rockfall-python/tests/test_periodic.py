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
        rf.Simulation(scene, dt=0.01, backend="cpu")


def sheared() -> rf.Scene:
    scene = rf.Scene()
    for axis, high in {"x": 4, "y": 2, "z": 2}.items():
        scene.set_periodic(axis, 0, high)
    scene.settings.gravity = 0
    scene.settings.collisions = False
    return scene


def test_a_shear_moves_the_images() -> None:
    scene = sheared()
    assert scene.shear is None
    scene.set_shear(0.5)
    assert scene.shear == {"gradient": "y", "flow": "x", "rate": 0.5, "displacement": 0.0}
    assert rf.Scene.parse(scene.to_text()).shear == scene.shear
    scene.add_spheres([[0.5, 0.25, 1]], radius=0.1, velocity=[[0.125, 0, 0]])
    sim = rf.Simulation(scene, dt=0.01, backend="cpu")
    sim.run(100)
    # The box above moves by 0.5 * 2 units in 1 s: a quarter of the period.
    assert sim.shear is not None and abs(sim.shear["displacement"] - 0.25) < 1e-6
    # One box down: back by 1 along x.
    assert np.allclose(sim.in_box([[0.5, 2.5, 1]]), [[3.5, 0.5, 1]], atol=1e-5)
    scene.set_shear(None)
    assert scene.shear is None


def test_wrong_shears_are_errors() -> None:
    scene = sheared()
    with pytest.raises(ValueError, match="gradient: expected 'x', 'y' or 'z', got 'w'"):
        scene.set_shear(1, gradient="w")
    with pytest.raises(ValueError, match="shear.axes"):
        scene.set_shear(1, gradient="x")
    scene.set_shear(1)
    scene.settings.linear_damping = 0.1
    with pytest.raises(ValueError, match="linear_damping"):
        rf.Simulation(scene, dt=0.01, backend="cpu")
