"""Names, colours and labels of objects."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rockfall as rf

TEXT = """@name left
@colour red
S 1 0 1 0 0 0 0 0 0 0 1 0.5
S 2 2 1 0 0 0 0 0 0 0 1 0.5
@colour -
K 1 2 1 1 0
@name floor
@label the floor
B -5 -1 -5 10 0 0 0 1 0 0 0 10
"""


def test_names_find_objects() -> None:
    scene = rf.Scene.parse(TEXT)
    left = scene["left"]
    assert (left.spheres.tolist(), left.springs.tolist(), left.boxes.tolist()) == ([0, 1], [0], [])
    assert left.spheres.dtype == np.int64
    assert scene["floor"].boxes.tolist() == [0]
    assert scene.names == ["floor", "left"]
    assert "left" in scene and "right" not in scene
    sim = rf.Simulation(scene, backend="cpu")
    sim.run(2)
    assert sim["left"].spheres.tolist() == [0, 1]
    # The numbers of objects stay when others are removed.
    sim.remove("sphere", 0)
    assert sim["left"].spheres.tolist() == [1]
    assert sim["left"].springs.tolist() == []


def test_an_unknown_name_is_a_key_error_with_near_names() -> None:
    scene = rf.Scene.parse(TEXT)
    for objects in (scene, rf.Simulation(scene, backend="cpu")):
        with pytest.raises(KeyError, match="no object has the name 'lefft': did you mean 'left'"):
            objects["lefft"]
        with pytest.raises(KeyError, match="expected one of 'floor', 'left'"):
            objects["x"]
        with pytest.raises(TypeError, match="expected the name of objects, got int"):
            objects[0]  # type: ignore[index]
        with pytest.raises(TypeError, match="not iterable"):
            list(objects)  # type: ignore[call-overload]
    with pytest.raises(KeyError, match="the scene has no names"):
        rf.Scene()["left"]


def test_objects_are_named_when_they_are_added() -> None:
    scene = rf.Scene()
    one = scene.add_sphere([0, 1, 0], 0.5, name="left", colour="red", look="wood")
    two = scene.add_spheres([[2, 1, 0], [4, 1, 0]], 0.5, name="left", label="a ball")
    rod = scene.add_rod(one, int(two[0]), 0.1, name="bar")
    spring = scene.add_spring(int(two[0]), int(two[1]), 1.0, name="coil", colour="#0a0b0c")
    capsules = scene.add_capsules([0, 5, 0], [1, 5, 0], 0.2, name="pill")
    scene.add_tethers(one, [0, 9, 0], 1.0)
    scene.add_box([-5, -1, -5], [5, 0, 5], name="floor")
    scene.add_polygons([0, 0, 0], [0, 0, 1], [1, 0, 0], name="wall")
    assert scene["left"].spheres.tolist() == [one, *two]
    assert scene["bar"].rods.tolist() == [rod]
    assert scene["coil"].springs.tolist() == [spring]
    pill = scene["pill"]
    assert pill.capsules.tolist() == capsules.capsules.tolist()
    assert (pill.spheres.tolist(), pill.rods.tolist()) == (capsules.spheres.ravel().tolist(), capsules.rods.tolist())
    assert scene.names == ["bar", "coil", "floor", "left", "pill", "wall"]
    assert scene.tag("sphere", one) == rf.Tag("left", "red", None, "wood")
    assert scene.tag("spring", spring) == ("coil", "#0a0b0c", None, None)
    assert rf.Scene.parse(scene.to_text()).to_text() == scene.to_text()
    assert "@name left\n@colour red\n@look wood\nS 0 0 1 0 " in scene.to_text()


def test_wrong_tags_add_nothing() -> None:
    scene = rf.Scene()
    for error, options in [(ValueError, {"name": "a b"}), (ValueError, {"colour": "rde"}), (TypeError, {"name": 3})]:
        with pytest.raises(error):
            scene.add_sphere([0, 0, 0], 0.5, **options)  # type: ignore[arg-type]
    assert scene.counts.spheres == 0
    with pytest.raises(ValueError, match="'wod' \\(did you mean wood\\?\\) is not allowed, expected one of plain, striped"):
        scene.set_tag("sphere", [], look="wod")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="did you mean red"):
        scene.add_box([0, 0, 0], [1, 1, 1], colour="rde")
    with pytest.raises(ValueError, match="kind: expected one of sphere"):
        scene.set_tag("tether", 0, name="a")  # type: ignore[arg-type]


def test_tags_can_be_changed_and_are_in_checkpoints(tmp_path: Path) -> None:
    sim = rf.Simulation(rf.Scene.parse(TEXT), backend="cpu")
    sim.step()
    sim.set_tag("sphere", [0, 1], name="right", colour="blue")
    before = sim.render((48, 32)).numpy()
    sim.set_tag("sphere", 0, name="right", colour="yellow")
    after = sim.render((48, 32)).numpy()
    assert (before != after).any()
    sim.save_checkpoint(tmp_path / "a.ckpt")
    again = rf.Simulation.resume(tmp_path / "a.ckpt")
    assert again["right"].spheres.tolist() == [0, 1]
    with pytest.raises(LookupError):
        sim.set_tag("sphere", 9, name="x")
