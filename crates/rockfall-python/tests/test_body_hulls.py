"""Convex hulls of shapes under the contact law ``rigid`` (docs/physics section 11)."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import rockfall as rf

CORNERS = np.array(list(itertools.product([-0.5, 0.5], repeat=3)))
TETRAHEDRON = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]


def stage() -> rf.Scene:
    scene = rf.Scene()
    scene.settings.contact_law = "rigid"
    scene.settings.gravity = 9.81
    scene.add_box([-5, -1, -5], [5, 0, 5])
    return scene


def test_a_hull_has_mass_centre_and_inertia_of_the_closed_form() -> None:
    scene = stage()
    found = scene.shape_mass(scene.add_shape(rf.Shape(density=1000).add_hull(TETRAHEDRON)))
    assert found.mass == pytest.approx(1000 / 6, rel=1e-6)
    np.testing.assert_allclose(found.centre, [0.25] * 3, rtol=1e-6)
    np.testing.assert_allclose(found.inertia, [3 / 40 * found.mass] * 3 + [found.mass / 80] * 3, rtol=1e-5)
    inside = np.vstack([CORNERS, 0.3 * CORNERS])
    cube = scene.shape_mass(scene.add_shape(rf.Shape(mass=6).add_hull(inside)))
    np.testing.assert_allclose(cube.inertia, [1, 1, 1, 0, 0, 0], atol=1e-6)


def test_hulls_rest_on_the_ground() -> None:
    scene = stage()
    scene.add_material("stone", density=1000)
    tetrahedron = scene.add_shape(rf.Shape(density=1000, name="t").add_hull(TETRAHEDRON, group=0, material="stone"))
    cube = scene.add_shape(rf.Shape(mass=1).add_hull(CORNERS))
    first = scene.add_bodies(tetrahedron, [[0, 0.1, 0], [2, 0.1, 0]])
    assert first.spheres.shape == (2, 1)
    scene.add_body(cube, [-2, 0.6, 0])
    assert (scene.counts.hulls, scene.counts.bodies, scene.counts.spheres) == (3, 3, 3)
    sim = rf.Simulation(scene, dt=1 / 60, backend="cpu")
    sim.run(240)
    np.testing.assert_allclose(sim.bodies.positions[:, 1], [0.25, 0.25, 0.5], atol=1e-4)
    assert np.abs(sim.bodies.velocities).max() < 1e-4
    assert "@hull" in scene.to_text()


def test_wrong_hulls_are_errors() -> None:
    with pytest.raises(ValueError, match="points: expected finite numbers"):
        rf.Shape().add_hull([[np.nan, 0, 0]] * 4)
    with pytest.raises(ValueError, match=r"points: expected shape \(N, 3\)"):
        rf.Shape().add_hull(np.zeros((4, 2)))
    with pytest.raises(ValueError, match="group: expected integers from 0 to 65535"):
        rf.Shape().add_hull(TETRAHEDRON, group=70000)
    scene = stage()
    for points, message in (
        (TETRAHEDRON[:3], "shape.hull.points: 3 points is not allowed, expected 4 to 100000"),
        (CORNERS * [1, 0, 1], "one plane"),
        (np.random.default_rng(1).normal(size=(200, 3)), "at most 32 faces"),
    ):
        with pytest.raises(ValueError, match=message):
            scene.add_shape(rf.Shape().add_hull(points))
    scene.settings.contact_law = "thesis"
    scene.add_body(scene.add_shape(rf.Shape().add_hull(TETRAHEDRON)), [0, 1, 0])
    with pytest.raises(ValueError, match=r"hulls need `scene\.settings\.contact_law = \"rigid\"`"):
        rf.Simulation(scene)
