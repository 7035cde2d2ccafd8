"""Walls that move, conveyors and meshes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import rockfall as rf


def falling(**settings: float) -> rf.Scene:
    scene = rf.Scene()
    scene.settings.gravity = settings.get("gravity", 0.0)
    scene.settings.friction = 0.0
    return scene


def test_a_racket_returns_a_ball_and_goes_on() -> None:
    scene = falling()
    scene.settings.restitution = 1.0
    scene.add_motion("racket", velocity=(1, 0, 0))
    scene.add_box((-1, -2, -2), (0, 2, 2), motion="racket")
    scene.add_spheres((1, 0, 0), 0.1, velocity=(-2, 0, 0))
    sim = rf.Simulation(scene, dt=0.01, backend="cpu")
    sim.run(100)
    np.testing.assert_allclose(sim.velocities[0], (4, 0, 0), atol=1e-4)
    assert sim.motions["racket"][0].velocity == (1, 0, 0)
    sim.move("racket")
    sim.run(50)
    hit = sim.cast_rays((5, 1.5, 0), (-1, 0, 0))
    np.testing.assert_allclose(hit["point"][0, 0], 1.0, atol=1e-5)


def test_a_table_moves_a_wall_through_its_points() -> None:
    scene = falling()
    scene.add_motion_table("lift", [0.0, 0.5, 1.0], [(0, 0, 0), (0, 1, 0), (0, 1, 0)])
    floor = scene.add_box((-1, -1, -1), (1, 0, 1))
    scene.follow("box", floor, "lift")
    scene.add_spheres((0, 5, 0), 0.1)
    sim = rf.Simulation(scene, dt=0.01, backend="cpu")
    for steps, height in [(25, 0.5), (50, 1.0), (50, 1.0)]:
        sim.run(steps)
        hit = sim.cast_rays((0.5, 4, 0.5), (0, -1, 0))
        np.testing.assert_allclose(hit["point"][0, 1], height, atol=1e-5)
    with pytest.raises(ValueError, match="increase"):
        scene.add_motion_table("other", [0.0, 0.0], np.zeros((2, 3)))
    with pytest.raises(ValueError, match="already"):
        scene.add_motion_table("lift", [0.0, 1.0], np.zeros((2, 3)))


def test_a_conveyor_takes_a_ball_along() -> None:
    scene = rf.Scene()
    scene.settings.gravity = 9.81
    scene.settings.coulomb_friction = 0.3
    # At rest, the ball overlaps the belt by half a percent of its radius.
    scene.settings.contact_force = 2e4
    scene.settings.contact_damping = 100
    belt = scene.add_box((-2, -1, -1), (2, 0, 1), surface_velocity=(0.7, 0, 0))
    scene.add_spheres((-1, 0.1, 0), 0.1)
    sim = rf.Simulation(scene, dt=0.002, backend="cpu")
    sim.run(500)
    np.testing.assert_allclose(sim.velocities[0, 0], 0.2, atol=5e-3)
    sim.set_surface_velocity("box", belt, (0, 0, 0))
    sim.run(1000)
    assert abs(sim.velocities[0, 0]) < 0.1


def cube() -> tuple[np.ndarray, np.ndarray]:
    vertices = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, np.array([triangle for a, b, c, d in faces for triangle in ((a, b, c), (a, c, d))])


def test_a_mesh_of_arrays_and_of_a_file_are_the_same(tmp_path: Path) -> None:
    vertices, triangles = cube()
    path = tmp_path / "cube.obj"
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles]
    path.write_text("\n".join(lines))
    scenes = []
    for mesh in ((vertices, triangles), (path,)):
        scene = falling(gravity=9.81)
        numbers = scene.add_mesh(*mesh, scale=2, at=(-1, -2, -1), name="block", colour="grey")
        assert len(numbers) == 12 and scene.counts.polygons == 12
        scene.add_spheres((0.3, 0.5, 0.2), 0.1)
        sim = rf.Simulation(scene, dt=0.002, backend="cpu")
        sim.run(1000)
        assert abs(sim.positions[0, 1] - 0.1) < 0.02
        scenes.append(scene.to_text())
    assert scenes[0] == scenes[1]
    assert scenes[0].count("@triangle") == 12


def test_wrong_walls_name_what_was_expected(tmp_path: Path) -> None:
    scene = falling()
    vertices, triangles = cube()
    with pytest.raises(LookupError, match="drum.*no motions"):
        scene.add_box((0, 0, 0), (1, 1, 1), motion="drum")
    with pytest.raises(TypeError, match="triangles"):
        scene.add_mesh(vertices)
    with pytest.raises(ValueError, match="indices from 0 to 7"):
        scene.add_mesh(vertices, triangles + 1)
    with pytest.raises(OSError, match="gone.stl"):
        scene.add_mesh(tmp_path / "gone.stl")
    with pytest.raises(ValueError, match="scale"):
        scene.add_mesh(vertices, triangles, scale=0)
    with pytest.raises(ValueError, match="frequency"):
        scene.add_motion("a", amplitude=(1, 0, 0), frequency=-1)
    balls = scene.add_spheres((0, 5, 0), 0.1)
    scene.add_motion("a", velocity=(1, 0, 0))
    with pytest.raises(ValueError, match="box or a polygon"):
        scene.follow("sphere", balls, "a")  # type: ignore[arg-type]
    assert scene.counts.polygons == 0


def test_gauges() -> None:
    scene = rf.Scene()
    scene.settings.gravity = 10.0
    scene.add_box((-1, -1, -1), (1, 0, 1), name="floor")
    scene.add_spheres([(0.3, 0.1, 0), (-0.5, 0.1, 0), (5, 1.5, 0)], 0.1, mass=[1.0, 2.0, 4.0])
    scene.add_gauge("weight", wall="floor")
    scene.add_gauge("down", plane=((0, 1, 0), (0, -1, 0)))
    assert "@gauge name=weight wall=floor\n@gauge name=down plane=0,1,0,0,-1,0" in scene.to_text()
    sim = rf.Simulation(scene, dt=0.005, backend="cpu")
    assert sim.gauges["down"] == rf.PlaneFlow(0.0, 0)
    sim.run(2000)
    weight, down = sim.gauges["weight"], sim.gauges["down"]
    assert isinstance(weight, rf.WallLoad)
    np.testing.assert_allclose(weight.force, (0, -30, 0), atol=0.1)
    assert weight.contacts == 2
    assert down == rf.PlaneFlow(4.0, 1)
    sim.add_gauge("later", plane=((0, 1, 0), (0, -1, 0)))
    copy = sim.copy()
    assert list(copy.gauges) == ["weight", "down", "later"]
    assert (copy.gauges["down"], copy.gauges["later"]) == (down, rf.PlaneFlow(0.0, 0))
    for wrong in ({}, {"wall": "floor", "plane": ((0, 0, 0), (1, 0, 0))}):
        with pytest.raises(TypeError, match="one of them"):
            scene.add_gauge("a", **wrong)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="flor"):
        scene.add_gauge("a", wall="flor")
    with pytest.raises(ValueError, match="plane"):
        scene.add_gauge("a", plane=((0, 0, 0), (0, 0, 0)))
    with pytest.raises(ValueError, match="weight"):
        scene.add_gauge("weight", wall="floor")


def test_a_floor_bears_the_weight() -> None:
    scene = rf.Scene()
    scene.settings.gravity = 9.81
    scene.add_box((-1, -1, -1), (1, 0, 1), name="floor")
    scene.add_spheres([(0.3, 0.1, 0), (-0.5, 0.1, 0)], 0.1, mass=[1.0, 2.0])
    sim = rf.Simulation(scene, dt=0.005, backend="cpu")
    sim.run(2000)
    load = sim.wall_load("floor")
    np.testing.assert_allclose(load.force, (0, -3 * 9.81, 0), atol=0.1)
    np.testing.assert_allclose(load.torque, (0, 0, (0.3 * -1 + 0.5 * 2) * 9.81), atol=0.1)
    assert load.contacts == 2
    with pytest.raises(ValueError, match="ceiling"):
        sim.wall_load("ceiling")


def test_smooth_walls_are_those_of_the_scene_text() -> None:
    scene = falling(gravity=9.81)
    scene.add_motion("drum", spin=2.0)
    assert scene.add_cylinder((0, 0, -1), (0, 0, 1), 1, 2, inside=True, name="shell", motion="drum") == 0
    assert scene.add_cone((0, -3, 0), (0, 1, 0), (0.5, 1), 2, inside=True) == 1
    assert scene.add_plane((0, -4, 0), (0, 2, 0), colour="grey", group=1) == 2
    assert scene.add_ball((3, 0, 0), 0.5) == 3
    text = scene.to_text()
    expected = [
        "@cylinder at=0,0,-1 radius=1 axis=0,0,2 length=2 inside=yes",
        "@plane at=0,-4,0 normal=0,1,0",
        "@ball at=3,0,0 radius=0.5",
    ]
    assert all(line in text for line in expected), text
    assert rf.Scene.parse(text).to_text() == text
    assert scene.table("polygon")["surface"].tolist() == [4, 4, 2, 5]
    scene.add_spheres((0, -0.85, 0), 0.1)
    sim = rf.Simulation(scene, dt=0.002, backend="cpu")
    sim.run(1000)
    assert np.hypot(*sim.positions[0, :2]) < 0.95


@pytest.mark.parametrize(
    ("add", "message"),
    [
        (lambda s: s.add_plane((0, 0, 0), (0, 0, 0)), "normal"),
        (lambda s: s.add_plane((0, 0), (0, 0, 1)), "at: expected shape"),
        (lambda s: s.add_cylinder((0, 0, 0), (0, 0, 1), 0, 1), "radius"),
        (lambda s: s.add_cylinder((0, 0, 0), (0, 0, 1), 1, float("nan")), "length"),
        (lambda s: s.add_cone((0, 0, 0), (0, 0, 1), (0, 0), 1), "radii"),
        (lambda s: s.add_ball((0, 0, 0), -1), "radius"),
    ],
)
def test_wrong_smooth_walls_name_what_was_expected(add: Callable[[rf.Scene], int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        add(falling())


def press() -> rf.Scene:
    """A ball on a floor below a plate that seeks a force of 20."""
    scene = falling()
    scene.settings.contact_force, scene.settings.contact_damping = 1000.0, 20.0
    scene.settings.collisions = False
    scene.add_servo("plate", force=(0, -20, 0), speed=0.5)
    scene.add_box((-1, -1, -1), (1, 0, 1))
    scene.add_box((-1, 1.01, -1), (1, 2, 1), motion="plate")
    scene.add_spheres((0, 0.5, 0), 0.5)
    return scene


def test_a_plate_reaches_its_force() -> None:
    scene = press()
    assert scene.servos["plate"] == rf.Servo(20.0, 0.5, 0.0, 0.0, (0.0, -1.0, 0.0), turns=False)
    sim = rf.Simulation(scene, dt=0.002, backend="cpu")
    sim.run(2000)
    np.testing.assert_allclose(sim.wall_load("plate").force, (0, 20, 0), atol=0.01)
    np.testing.assert_allclose(sim.servos["plate"].displacement, 0.01 + 2 * 0.02, atol=1e-4)
    sim.set_servo("plate", target=10)
    sim.run(2000)
    np.testing.assert_allclose(sim.wall_load("plate").force, (0, 10, 0), atol=0.01)
    sim.move("plate")
    sim.run(10)
    assert not sim.servos
    np.testing.assert_allclose(sim.wall_load("plate").force, (0, 10, 0), atol=0.01)


def test_a_shaft_turns_at_its_speed() -> None:
    scene = falling()
    scene.add_servo("shaft", torque=-3, axis=(0, 2, 0), through=(1, 0, 0), speed=2)
    scene.add_box((0, 0, 0), (1, 1, 1), motion="shaft")
    scene.add_spheres((9, 0, 0), 0.1)
    sim = rf.Simulation(scene, dt=0.01, backend="cpu")
    sim.run(51)
    servo = sim.servos["shaft"]
    np.testing.assert_allclose((servo.displacement, servo.velocity), (-1.0, -2.0), atol=1e-5)
    assert servo.turns and servo.direction == (0, 1, 0)


def test_wrong_servos_name_the_argument() -> None:
    scene = press()
    with pytest.raises(TypeError, match="force, torque: expected one of them"):
        scene.add_servo("a", speed=1)
    with pytest.raises(ValueError, match="servo.force"):
        scene.add_servo("a", force=(0, 0, 0), speed=1)
    with pytest.raises(ValueError, match="servo.speed"):
        scene.add_servo("a", force=(0, 1, 0), speed=0)
    with pytest.raises(ValueError, match="name"):
        scene.add_servo("plate", force=(0, 1, 0), speed=1)
    with pytest.raises(ValueError, match="target: -1"):
        scene.set_servo("plate", target=-1)
    with pytest.raises(LookupError, match="unknown"):
        scene.set_servo("lid", target=1)
