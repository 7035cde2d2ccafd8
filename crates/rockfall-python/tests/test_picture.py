"""Pictures."""

from __future__ import annotations

import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np
import PIL.Image
import pytest

import rockfall as rf


@pytest.fixture(scope="module")
def sim() -> rf.Simulation:
    scene = rf.Scene()
    scene.add_box([-2, -1, -2], [2, 0, 2])
    scene.add_spheres([[0, 1, 0], [1, 2, 0]], 0.5, velocity=[[0, 0, 0], [1, 0, 0]])
    return rf.Simulation(scene, backend="cpu")


def test_a_picture_is_an_array_an_image_and_a_file(sim: rf.Simulation, tmp_path: pathlib.Path) -> None:
    picture = sim.render(size=(96, 54))
    pixels = picture.numpy()
    assert pixels.shape == (54, 96, 3) and pixels.dtype == np.uint8 and picture.size == (96, 54)
    assert pixels.std() > 5, "something is drawn"
    np.testing.assert_array_equal(np.asarray(picture), pixels)
    np.testing.assert_array_equal(np.asarray(picture.pil()), pixels)
    assert picture._repr_png_() == picture.png() and picture.png().startswith(b"\x89PNG")
    picture.save(tmp_path / "a.png")
    with PIL.Image.open(tmp_path / "a.png") as image:
        np.testing.assert_array_equal(np.asarray(image.convert("RGB")), pixels)
    picture.save(tmp_path / "a.jpg")
    with PIL.Image.open(tmp_path / "a.jpg") as image:
        assert image.size == (96, 54)
    assert "96x54" in repr(picture)
    with pytest.raises(ValueError, match=r"path: expected a name that ends in \.png"):
        picture.save(tmp_path / "a.tif")
    with pytest.raises(OSError):
        picture.save(tmp_path / "no" / "a.png")


def test_plots_beside_pictures_have_the_states_that_were_drawn() -> None:
    scene = rf.Scene()
    scene.settings.gravity = 10.0
    scene.add_sphere([0, 1, 0], 0.5, name="ball")
    sim = rf.Simulation(scene, backend="cpu")
    options: dict[str, Any] = {"size": (240, 96), "plain": True, "camera": [0, 1, 9], "look_at": [0, 1, 0]}
    alone = sim.render(**options).numpy()
    first = sim.render(**options, plot="height:ball").numpy()
    assert first.shape == alone.shape == (96, 240, 3)
    beside = slice(160, 240)
    assert first[:, beside].min() < 150, "letters and axes"
    sim.run(20)
    lines = sim.render(**options, plot="height:ball").numpy()
    assert not np.array_equal(lines[:, beside], first[:, beside])
    # Other plots begin anew: there is one state, as in a picture of a new simulation.
    sim.render(**options, plot=["energy"])
    again = sim.render(**options, plot="height:ball").numpy()
    assert not np.array_equal(again[:, beside], lines[:, beside])
    with pytest.raises(ValueError, match="plot: heigth is not known, expected one of: energy, kinetic"):
        sim.render(**options, plot="heigth:ball")
    with pytest.raises(KeyError, match="plot: bal: no object has the name 'bal': did you mean 'ball'"):
        sim.render(**options, plot="height:bal")


def test_camera_colours_and_state_change_the_picture(sim: rf.Simulation) -> None:
    plain = sim.render(size=(96, 54), plain=True).numpy()
    np.testing.assert_array_equal(plain, sim.render(size=(96, 54), plain=True).numpy())
    others = [
        sim.render(size=(96, 54)),
        sim.render(size=(96, 54), plain=True, camera=[0, 5, 10]),
        sim.render(size=(96, 54), plain=True, look_at=[0, 0, 0]),
        sim.render(size=(96, 54), plain=True, colour_by="speed", range=(0, 2)),
    ]
    for other in others:
        assert not np.array_equal(plain, other.numpy())
    sim.positions[0] += [0, 1, 0]
    assert not np.array_equal(plain, sim.render(size=(96, 54), plain=True).numpy())
    assert sim.render(size=(50, 60)).numpy().shape == (60, 50, 3)


def test_letters_that_the_font_lacks_are_named_in_a_warning(sim: rf.Simulation) -> None:
    scene = rf.Scene()
    scene.add_spheres([[0.0, 1.0, 0.0]], 0.5, label="球")
    text = "the built-in font lacks the letters 日本球, which are drawn as boxes"
    worlds = rf.Worlds([scene], dt=0.01, backend="cpu")
    options: dict[str, Any] = {"size": (96, 54), "plain": True, "title": "日本", "label": True}
    draw: list[Callable[[], object]] = [
        lambda: rf.Simulation(scene, backend="cpu").render(**options),
        lambda: worlds.render(0, **options),
        lambda: rf.film(rf.Simulation(scene, backend="cpu"), 2, **options),
        lambda: rf.film(worlds, 2, **options),
    ]
    for each in draw:
        with pytest.warns(UserWarning, match=text) as caught:
            each()
        assert [warning.filename for warning in caught] == [__file__]
    # Without labels, only the title counts, and a title that the font has gives no warning.
    sim.render(size=(96, 54), title="Größe λ")
