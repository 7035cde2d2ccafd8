"""The window and the widget."""

from __future__ import annotations

import io
import json
import os
import pathlib
import subprocess
import sys
import time
from collections.abc import Iterator

import numpy as np
import PIL.Image
import pytest

import rockfall as rf
from rockfall import _view
from rockfall._widget import Viewer

TESTS = pathlib.Path(__file__).parent


@pytest.fixture
def display(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A display without a screen."""
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "1024x768x24"], pass_fds=[write], stderr=subprocess.DEVNULL
    )
    os.close(write)
    with os.fdopen(read) as numbers:
        name = f":{numbers.readline().strip()}"
    monkeypatch.setenv("DISPLAY", name)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    yield name
    server.terminate()
    server.wait()


def titles() -> str:
    """Titles of all windows of the display."""
    found = subprocess.run(["xdotool", "search", "--name", "."], capture_output=True, text=True, check=False).stdout.split()
    names = [subprocess.run(["xdotool", "getwindowname", number], capture_output=True, text=True, check=False) for number in found]
    return " ".join(name.stdout for name in names)


def test_a_window_opens_in_a_process_of_its_own(
    sim: rf.Simulation, display: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROCKFALL", os.environ["ROCKFALL_BIN"])
    sim.run(3)
    with rf.view(sim) as window:
        assert isinstance(window, rf.Window) and window.is_open and "open" in repr(window)
        sim.run(5)
        assert not window.wait(0.01)
        end = time.monotonic() + 120
        while "simulation.ckpt" not in titles() and time.monotonic() < end:
            time.sleep(0.2)
        assert "simulation.ckpt" in titles() and window.is_open
        files = pathlib.Path(window._folder)
        assert (files / "simulation.ckpt").exists()
    assert not window.is_open and "closed" in repr(window) and window.wait()
    assert not files.exists()
    window.close()
    assert sim.steps == 8


def test_a_window_that_cannot_open_is_an_error(sim: rf.Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("ROCKFALL", raising=False)
    with pytest.raises(FileNotFoundError, match="cargo install --path crates/rockfall-cli"):
        rf.view(sim)
    monkeypatch.setenv("ROCKFALL", os.environ["ROCKFALL_BIN"])
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    if sys.platform.startswith("linux"):
        with pytest.raises(OSError, match="neither DISPLAY nor WAYLAND_DISPLAY is set"):
            rf.view(sim)
    monkeypatch.setenv("DISPLAY", ":987654")
    with pytest.raises(OSError, match="the window did not open: .*"):
        rf.view(sim)
    with pytest.raises(TypeError, match=r"sim: expected a rockfall\.Simulation"):
        rf.view(sim.scene)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="kind: expected auto, widget or window, got 'film'"):
        rf.view(sim, "film")
    with pytest.raises(ValueError, match="size: expected no options for a window"):
        rf.view(sim, "window", size=(3, 3))


def test_a_notebook_gets_a_widget(sim: rf.Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    assert not _view.in_notebook()
    monkeypatch.setattr(_view, "in_notebook", lambda: True)
    assert isinstance(rf.view(sim, size=(96, 60)), Viewer)
    monkeypatch.setattr(_view.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ImportError, match="pip install anywidget"):
        rf.view(sim, "widget")


def pixels(viewer: Viewer) -> np.ndarray:
    with PIL.Image.open(io.BytesIO(viewer.frame)) as image:
        return np.asarray(image).astype(int)


def tell(viewer: Viewer, **message: object) -> None:
    """Passes a message from the browser."""
    viewer._receive(viewer, message, [])


def test_the_widget_plays_pauses_and_goes_back(sim: rf.Simulation) -> None:
    viewer = rf.view(sim, "widget", size=(160, 100), steps=10, plain=True)
    answers: list[object] = []
    viewer.send = answers.append
    start = pixels(viewer)
    assert start.shape == (100, 160, 3) and start.std() > 5
    assert (viewer.shown, viewer.last, viewer.caption, viewer.width) == (0, 0, "step 0, 0.00 s", 160)
    tell(viewer, kind="next")
    assert sim.steps == 0, "it does not step while it is paused"
    viewer.playing = True
    for _ in range(3):
        tell(viewer, kind="next")
    assert (sim.steps, viewer.shown, viewer.last, viewer.caption) == (30, 3, 3, "step 30, 0.30 s")
    end = pixels(viewer)
    assert np.abs(end - start).max() > 30
    tell(viewer, kind="show", state=0)
    assert not viewer.playing and (viewer.shown, sim.steps) == (0, 30)
    np.testing.assert_allclose(pixels(viewer), start, atol=3)
    # From the past, playing shows the states up to the present, and then goes on.
    viewer.playing = True
    for _ in range(3):
        tell(viewer, kind="next")
    assert (sim.steps, viewer.shown) == (30, 3)
    np.testing.assert_allclose(pixels(viewer), end, atol=3)
    tell(viewer, kind="next")
    assert sim.steps == 40
    # Steps outside of the widget are seen by it.
    sim.run(7)
    tell(viewer, kind="orbit", across=0.0, up=0.0)
    assert viewer.caption == "step 47, 0.47 s" and viewer.last == 5
    assert answers == [{"kind": "done"}] * 10


def test_the_mouse_moves_the_camera(sim: rf.Simulation) -> None:
    viewer = rf.view(sim, "widget", size=(160, 100), plain=True)
    first = pixels(viewer)
    eye, target = viewer._eye.copy(), viewer._target.copy()
    tell(viewer, kind="orbit", across=0.5, up=9.0)
    assert np.isclose(np.linalg.norm(viewer._eye - target), np.linalg.norm(eye - target))
    assert viewer._eye[1] > eye[1] and not np.array_equal(pixels(viewer), first)
    tell(viewer, kind="zoom", factor=0.5)
    assert np.isclose(np.linalg.norm(viewer._eye - target), 0.5 * np.linalg.norm(eye - target))
    tell(viewer, kind="pan", across=0.1, up=0.2)
    assert not np.allclose(viewer._target, target)
    tell(viewer, kind="frame all")
    np.testing.assert_allclose(viewer._eye, eye)
    np.testing.assert_array_equal(pixels(viewer), first)
    given = rf.view(sim, "widget", size=(160, 100), camera=[0, 3, 20], look_at=[0, 1, 0])
    assert given._eye.tolist() == [0, 3, 20]


def test_errors_of_a_simulation_pause_the_widget() -> None:
    scene = rf.Scene()
    a, b = scene.add_spheres([[0, 0, 0], [5, 0, 0]], 0.1)
    scene.add_spring(a, b, 1e9, 1.0)
    viewer = rf.view(rf.Simulation(scene, dt=1.0, backend="cpu"), "widget", steps=100, size=(96, 60))
    viewer.playing = True
    tell(viewer, kind="next")
    assert not viewer.playing and "stopped being finite" in viewer.caption


def test_the_browser_sends_one_message_at_a_time() -> None:
    script = pathlib.Path(rf.__file__).with_name("_widget.js")
    done = subprocess.run(["node", str(TESTS / "widget.mjs"), str(script)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["before"] == {"src": "blob:picture", "max": 5, "value": 2, "caption": "step 2", "play": "Play"}
    kinds = [message["kind"] for message in found["sent"]]
    assert kinds == ["orbit", "orbit", "pan", "zoom", "show", "frame all", "next", "next"]
    assert found["sent"][1] == {"kind": "orbit", "across": pytest.approx(-0.16), "up": pytest.approx(0.08)}
    assert found["sent"][2] == {"kind": "pan", "across": pytest.approx(-0.1), "up": pytest.approx(0.05)}
    assert found["sent"][4]["state"] == 3
    assert found["left"] == 0, "a closed widget leaves no listeners"
