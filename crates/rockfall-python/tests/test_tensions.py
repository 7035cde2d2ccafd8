"""Tensions of springs, muscles and tethers."""

from __future__ import annotations

import numpy as np

import rockfall as rf


def test_tensions_are_those_of_hookes_law() -> None:
    scene = rf.Scene()
    low, high = scene.add_spheres([[0, 1, 0], [0, 3, 0]], 0.1, fixed=True, name="ball")
    scene.add_spring(low, high, 10.0, length=1.5)
    scene.add_spring(low, high, 10.0, length=4.0, muscle=[0.5, 1.0, 0.0])
    scene.add_tethers(high, [0, 4, 0], 10.0, length=0.25)
    sim = rf.Simulation(scene, dt=0.25, backend="cpu")
    found = sim.tensions
    assert found["kind"].tolist() == ["spring", "muscle", "tether"]
    assert found["index"].tolist() == [0, 1, 0]
    assert (found["a"].tolist(), found["b"].tolist()) == ([0, 0, 1], [1, 1, -1])
    np.testing.assert_array_equal(found["length"], np.float32([2, 2, 1]))
    np.testing.assert_array_equal(found["tension"], np.float32([5, -20, 7.5]))
    sim.run(1)
    # At a quarter of its period the rest length of the muscle is 4 (1 + 0.5).
    np.testing.assert_allclose(sim.tensions["tension"], [5, -40, 7.5], rtol=1e-5)
    picture = sim.render((96, 54), colour_by="tension").numpy()
    assert (picture != sim.render((96, 54), colour_by="kind").numpy()).any()


def test_a_scene_without_springs_has_no_tensions() -> None:
    scene = rf.Scene()
    scene.add_rod(*scene.add_spheres([[0, 0, 0], [1, 0, 0]], 0.1), 0.05, length=1.0)
    found = rf.Simulation(scene, backend="cpu").tensions
    assert found.shape == (0,) and found.dtype.names == ("kind", "index", "a", "b", "length", "tension")
