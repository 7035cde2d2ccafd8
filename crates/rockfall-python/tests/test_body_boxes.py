"""Boxes of shapes, and rigid bodies of them (docs/physics section 1.5)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import rockfall as rf
from rockfall.typing import ContactLawName

#: Edges of a box, in units.
EDGES = (0.4, 0.2, 0.3)


def stage() -> rf.Scene:
    """A floor, with a material. Bodies give the scene the contact law ``rigid``."""
    scene = rf.Scene()
    scene.settings.gravity = 9.81
    scene.add_material("stone", density=1000, young=1e9, poisson=0.3)
    scene.set_pair("stone", "stone", restitution=0.2, friction=0.5, characteristic_velocity=1)
    scene.add_box([-5, -1, -5], [5, 0, 5], material="stone")
    return scene


def block(**options: Any) -> rf.Shape:
    half = 0.5 * np.array(EDGES)
    return rf.Shape(**options).box(-half, half, material="stone")


def test_a_box_has_mass_centre_and_inertia_of_the_closed_form() -> None:
    scene = rf.Scene()
    a, b, c = EDGES
    mass = 1000 * a * b * c
    expected = np.array([b * b + c * c, a * a + c * c, a * a + b * b]) * mass / 12
    found = scene.shape_mass(scene.add_shape(rf.Shape(density=1000).box([1, 2, 3], [1 + a, 2 + b, 3 + c])))
    assert found.mass == pytest.approx(mass, rel=1e-5)
    np.testing.assert_allclose(found.centre, [1 + a / 2, 2 + b / 2, 3 + c / 2], rtol=1e-6)
    np.testing.assert_allclose(found.inertia[:3], expected, rtol=1e-4)

    # A turned box has J = R diag(J1, J2, J3) R^T. The rounding has no part in it.
    turn = np.array([[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]])
    shape = rf.Shape(mass=mass, rounding=0.05).cuboid([0, 0, 0], turn * np.array(EDGES)[:, None])
    turned = scene.shape_mass(scene.add_shape(shape))
    tensor = turn.T @ np.diag(expected) @ turn
    np.testing.assert_allclose(turned.inertia, [*np.diag(tensor), tensor[0, 1], 0, 0], rtol=1e-4, atol=1e-6)


def test_a_body_has_one_sphere_for_each_box() -> None:
    scene = rf.Scene()
    shape = rf.Shape(mass=3).sphere([2, 0, 0], 0.1).box([0, 0, 0], EDGES, group=4).sphere([3, 0, 0], 0.1).rod(0, 1, 0.05)
    number = scene.add_shape(shape.box([0, 1, 0], [0.5, 2, 0.5]))
    scene.add_sphere([0, 50, 0], 1.0)
    none = scene.add_bodies(number, np.zeros((0, 3)))
    assert [part.shape for part in none] == [(0,), (0, 4), (0, 1)]
    added = scene.add_bodies(number, [[0, 0, 0], [0, 10, 0]])
    np.testing.assert_array_equal(added.spheres, 1 + np.arange(8).reshape(2, 4))
    np.testing.assert_array_equal(added.rods, np.arange(2).reshape(2, 1))
    assert scene.add_sphere([0, 60, 0], 1.0) == 9
    assert (scene.counts.spheres, scene.counts.rods, scene.counts.bodies) == (10, 2, 2)

    # Spheres of the shape, then the spheres around the boxes.
    radius = scene.table("sphere")["radius"][added.spheres]
    around = [0.5 * np.linalg.norm(EDGES), 0.5 * np.linalg.norm([0.5, 1, 0.5])]
    np.testing.assert_allclose(radius, np.tile(np.array([0.1, 0.1, *around], np.float32), (2, 1)), rtol=1e-6)
    assert scene.table("sphere")["group"][added.spheres[1]].tolist() == [0, 0, 4, 0]
    assert scene.table("rod")[["end1", "end2"]][added.rods[1]].tolist() == [(5, 6)]

    # The same for a simulation, and after a body has gone.
    sim = rf.Simulation(scene, dt=0.001, backend="cpu")
    sim.remove_bodies(added.bodies[0])
    more = sim.add_bodies(number, [0, 20, 0])
    np.testing.assert_array_equal(more.spheres, [10 + np.arange(4)])
    np.testing.assert_array_equal(more.rods, [[2]])
    assert len(sim.bodies) == 2 and (sim.counts.spheres, sim.counts.rods) == (10, 2)
    rows = [[int(np.flatnonzero(sim.sphere_ids == sphere)[0]) for sphere in spheres] for spheres in (added.spheres[1], more.spheres[0])]
    np.testing.assert_allclose(sim.positions[rows[1]] - sim.positions[rows[0]], np.tile([0, 10, 0], (4, 1)), atol=1e-5)


def test_a_box_falls_on_a_floor_and_rests_at_half_its_height() -> None:
    scene = stage()
    shape = scene.add_shape(block(density=1000))
    scene.add_body(shape, [0, 0.105, 0])
    sim = rf.Simulation(scene, backend="cpu")
    assert sim.settings.contact_law == "rigid"
    sim.run(1)
    assert sim.bodies.velocities[0, 1] == pytest.approx(-9.81 / 60, rel=1e-3)
    sim.run(240)
    np.testing.assert_allclose(sim.bodies.positions, [[0, 0.1, 0]], atol=3e-4)
    assert np.abs(sim.bodies.velocities).max() < 1e-3
    assert abs(sim.bodies.orientations[0, 0]) > 0.99999


@pytest.mark.parametrize("law", ["linear", "hertz-mindlin", "thesis"])
def test_other_laws_have_no_boxes_that_move(law: ContactLawName) -> None:
    scene = stage()
    scene.settings.contact_law = law
    scene.add_body(scene.add_shape(block(density=1000)), [0, 0.105, 0])
    with pytest.raises(ValueError, match=f"{law} with a body with a box is not allowed, expected rigid"):
        rf.Simulation(scene, backend="cpu", integrator="velocity-verlet")


# Numbers of Python are float32. The position 0.375 is exact in it, because a text gives a position more digits.
TEXT = """set gravity 9.81
@material stone density=1000 young=1e9 poisson=0.3
@pair stone stone restitution=0.2 friction=0.5 characteristic_velocity=1
@use stone
B -5 -1 -5  10 0 0  0 1 0  0 0 10
@body block density=1000 rounding=0.01
S 1  0 0.2 0  0 0 0  0 0 0  - 0.1
B -0.2 -0.1 -0.15  0.24 0.32 0  -0.16 0.12 0  0 0 0.3
@end
@place block at=0,0.375,0 spin=1,2,3
"""


def test_a_scene_text_and_python_give_the_same_bits() -> None:
    scene = stage()
    shape = rf.Shape(density=1000, rounding=0.01, name="block").sphere([0, 0.2, 0], 0.1, material="stone")
    edges = [[0.24, 0.32, 0], [-0.16, 0.12, 0], [0, 0, 0.3]]
    scene.add_body(scene.add_shape(shape.cuboid([-0.2, -0.1, -0.15], edges, material="stone")), [0, 0.375, 0], spin=[1, 2, 3])
    sims = [rf.Simulation(one, backend="cpu") for one in (rf.Scene.parse(TEXT), scene)]
    for sim in sims:
        sim.run(18)
    one, other = sims
    for field in ("positions", "orientations", "velocities", "angular_momenta"):
        assert getattr(one.bodies, field).tobytes() == getattr(other.bodies, field).tobytes(), field
    assert one.positions.tobytes() == other.positions.tobytes()
    # In free fall, the centre would be below the floor.
    assert 0.05 < one.bodies.positions[0, 1] < 0.35


def test_wrong_boxes_are_errors() -> None:
    wrong: list[tuple[Callable[[], rf.Shape], str]] = [
        (lambda: rf.Shape(rounding=-0.1), "rounding: expected numbers that are not negative"),
        (lambda: rf.Shape(rounding=np.nan), "rounding: expected finite numbers"),
        (lambda: rf.Shape(rounding=[0.1, 0.2]), "rounding: expected one number"),  # type: ignore[arg-type]
        (lambda: rf.Shape().box([0, 0], EDGES), r"min: expected shape \(N, 3\) or \(3,\), got \(2,\)"),
        (lambda: rf.Shape().box(np.zeros((2, 3)), EDGES), r"min, max: expected shape \(3,\) each"),
        (lambda: rf.Shape().box([0, 0, 0], [1, 0, 1]), "min, max: expected a greater number in every coordinate"),
        (lambda: rf.Shape().cuboid(np.zeros((2, 3)), np.eye(3)), r"corner: expected shape \(3,\), got shape \(2, 3\)"),
        (lambda: rf.Shape().cuboid([0, 0, 0], [1, 1, 1]), r"edges: expected shape \(N, 3, 3\) or \(3, 3\)"),
        (lambda: rf.Shape().cuboid([0, 0, np.inf], np.eye(3)), "corner: expected finite numbers"),
        (lambda: rf.Shape().box([0, 0, 0], EDGES, group=70000), "group: expected integers from 0 to 65535"),
        (lambda: rf.Shape().sphere([0, 0, 0], [1, 2]), "radius: expected one number"),  # type: ignore[arg-type]
        (lambda: rf.Shape().sphere([0, 0, 0], 1, group=[1, 2]), "group: expected one number"),  # type: ignore[arg-type]
    ]
    for make, message in wrong:
        with pytest.raises(ValueError, match=message):
            make()
    with pytest.raises(TypeError, match="edges: expected real numbers"):
        rf.Shape().cuboid([0, 0, 0], "edges")
    scene = rf.Scene()
    for shape, message in (
        (rf.Shape().cuboid([0, 0, 0], [[1, 0, 0], [1, 1, 0], [0, 0, 1]]), "box.edges: .*three edges at right angles"),
        (rf.Shape().cuboid([0, 0, 0], np.diag([1, 0, 1])), "box.edge: .*expected"),
        (rf.Shape(rounding=0.1).box([0, 0, 0], EDGES), "shape.rounding: .*less than half the shortest edge"),
    ):
        with pytest.raises(ValueError, match=message):
            scene.add_shape(shape)
    with pytest.raises(LookupError, match="material: there is no material 'wood'"):
        scene.add_shape(rf.Shape().box([0, 0, 0], EDGES, material="wood"))
    with pytest.raises(LookupError, match="there is no material 7"):
        scene.add_shape(rf.Shape().box([0, 0, 0], EDGES, material=7))
    assert scene.add_shape(rf.Shape().box([0, 0, 0], EDGES)) == 0


def test_a_static_body_stays_or_follows_a_motion() -> None:
    scene = rf.Scene()
    shape = scene.add_shape(rf.Shape().capsule([0, 0, 0], [1, 0, 0], 0.2).box([1, -0.5, -0.5], [2, 0.5, 0.5]))
    scene.add_motion("rotor", spin=2, axis=[0, 1, 0])
    fixed = scene.add_static_body(shape, [0, 1, 0], name="post")
    rotor = scene.add_static_body(shape, [5, 1, 0], [0, 0, 1, 0], motion="rotor")
    assert [len(part) for part in fixed] == [2, 1, 1, 0]
    assert [len(part) for part in rotor] == [0, 0, 1, 3]
    assert len(scene.bodies) == 0
    assert "post" in scene.names
    ball = scene.add_sphere([0.5, 2, 0], 0.3)
    sim = rf.Simulation(scene, dt=0.01, backend="cpu")
    sim.run(200)
    assert sim.positions[int(ball), 1] > 1
    assert sim.add_static_body(shape, [0, -5, 0]).boxes.tolist() == [2]


def test_a_static_body_needs_a_shape_and_a_known_motion() -> None:
    scene = rf.Scene()
    shape = scene.add_shape(rf.Shape().sphere([0, 0, 0], 1))
    with pytest.raises(LookupError, match="there is no shape 7"):
        scene.add_static_body(7, [0, 0, 0])
    with pytest.raises(LookupError, match="motion: 'up' is unknown"):
        scene.add_static_body(shape, [0, 0, 0], motion="up")
    with pytest.raises(ValueError, match="got 2 rows"):
        scene.add_static_body(shape, [[0, 0, 0], [1, 0, 0]])
