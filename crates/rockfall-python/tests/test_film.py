"""Films."""

from __future__ import annotations

import base64
import pathlib
import re
import subprocess
from typing import Any

import numpy as np
import PIL.Image
import pytest

import rockfall as rf
from rockfall import _film

SIZE = (96, 54)


@pytest.fixture
def sim() -> rf.Simulation:
    scene = rf.Scene()
    scene.add_box([-3, -1, -2], [3, 0, 2])
    scene.add_spheres([[-2, 0.5, 0], [1, 2, 0]], 0.5, velocity=[[2, 0, 0], [0, 0, 0]])
    return rf.Simulation(scene, dt=0.01, backend="cpu")


def probe(path: pathlib.Path) -> str:
    """Codec, width, height and number of pictures of a video, read by another program."""
    options = ["-v", "error", "-select_streams", "v", "-count_frames", "-of", "csv=p=0"]
    entries = ["-show_entries", "stream=codec_name,width,height,nb_read_frames"]
    done = subprocess.run(["ffprobe", *options, *entries, str(path)], capture_output=True, text=True, check=True)
    return done.stdout.strip()


def test_a_film_runs_the_steps_and_keeps_its_pictures(sim: rf.Simulation) -> None:
    twin = rf.Simulation(sim.scene, dt=0.01, backend="cpu")
    # 0.53 s at 10 pictures per second: the last picture is before the last step, and all pictures lie on steps.
    film = rf.film(sim, 53, fps=10, size=SIZE, plain=True)
    assert (len(film), film.fps, film.size, film.duration) == (6, 10, SIZE, 0.6)
    assert "96x54, 6 pictures" in repr(film)
    twin.run(53)
    assert sim.steps == 53 and sim.positions.tobytes() == twin.positions.tobytes()
    pictures = [picture.numpy() for picture in film]
    assert len(pictures) == 6 and all(not np.array_equal(a, b) for a, b in zip(pictures, pictures[1:], strict=False))
    np.testing.assert_array_equal(film[-1].numpy(), pictures[5])
    with pytest.raises(IndexError, match="from -6 to 5, got 6"):
        film[6]
    # The next film starts where this one ended.
    assert not np.array_equal(rf.film(sim, 1, size=SIZE, plain=True)[0].numpy(), pictures[0])


def test_pictures_are_those_of_render(sim: rf.Simulation) -> None:
    options = {"size": SIZE, "camera": [0, 4, 9], "look_at": [0, 0.5, 0], "colour_by": "speed", "range": (0, 5)}
    film = rf.film(sim, 40, fps=10, **options)  # type: ignore[arg-type]
    np.testing.assert_allclose(film[4].numpy().astype(int), sim.render(**options).numpy().astype(int), atol=2)  # type: ignore[arg-type]


def test_camera_follow_orbit_speed_and_colours_change_the_film(sim: rf.Simulation) -> None:
    scene = sim.scene

    def last(steps: int = 40, **options: object) -> np.ndarray:
        own = rf.Simulation(scene, dt=0.01, backend="cpu")
        return rf.film(own, steps, fps=10, size=SIZE, plain=True, **options)[-1].numpy()  # type: ignore[arg-type]

    plain = last()
    moved: list[dict[str, object]] = [{"camera": [0, 5, 10]}, {"look_at": [1, 0, 0]}, {"follow": 0}, {"orbit": 90.0}]
    written: list[dict[str, object]] = [{"title": "A"}, {"clock": True}, {"scale_bar": True}, {"label": True}, {"trails": 1.0}]
    for options in (*moved, {"view": "top"}, {"up": "z"}, {"colour_by": "speed"}, *written, {"arrows": "velocity"}):
        assert not np.array_equal(plain, last(**options)), options
    assert len(rf.film(rf.Simulation(scene, dt=0.01, backend="cpu"), 40, fps=10, speed=0.5, size=SIZE, plain=True)) == 9
    # The followed ball stays in the middle while it rolls.
    own = rf.Simulation(scene, dt=0.01, backend="cpu")
    film = rf.film(own, 50, fps=15, size=SIZE, plain=True, follow=0, colour_by="kind")
    middle = [picture.numpy()[20:34, 40:56].astype(int) for picture in film]
    assert max(np.abs(patch - middle[0]).mean() for patch in middle) < 25


def test_plots_are_beside_the_pictures_and_grow() -> None:
    scene = rf.Scene()
    scene.add_spheres([[0.0, 3.0, 0.0], [2.0, 0.0, 0.0]], 0.5, fixed=[False, True], name="ball")

    def blue(picture: np.ndarray) -> int:
        return int((np.abs(picture[:, 256:].astype(int) - [0x00, 0x72, 0xB2]).max(axis=2) < 30).sum())

    def film(**options: object) -> list[np.ndarray]:
        sim = rf.Simulation(scene, dt=0.01, backend="cpu")
        taken = rf.film(sim, 40, fps=10, plain=True, camera=[0, 4, 9], look_at=[0, 1, 0], **options)  # type: ignore[arg-type]
        return [picture.numpy() for picture in taken]

    alone = film(size=(256, 200))
    for plot in ("height:ball", ["height:0"]):
        for more in ({}, {"on_step": lambda sim: None}):
            pictures = film(size=(400, 200), plot=plot, **more)
            assert pictures[0].shape == (200, 400, 3)
            np.testing.assert_array_equal(pictures[-1][:, :256], alone[-1])
            lines = [blue(picture) for picture in pictures]
            assert lines[0] < lines[2] < lines[4], lines
    for plot, error, text in [
        ("hight:0", ValueError, "plot: hight is not known, expected one of: energy, kinetic, potential, momentum, contacts, x"),
        ("height:7", LookupError, "there is no sphere 7"),
        ("height:bal", KeyError, "did you mean 'ball'"),
        (3, TypeError, "plot: expected a text or a list of texts"),
    ]:
        with pytest.raises(error, match=text):
            film(size=(400, 200), plot=plot)


def test_a_film_becomes_files_of_every_format(sim: rf.Simulation, tmp_path: pathlib.Path) -> None:
    film = rf.film(sim, 40, fps=20, size=SIZE)
    assert len(film) == 9
    film.save(tmp_path / "a.mp4")
    assert probe(tmp_path / "a.mp4") == "h264,96,54,9"
    film.save(tmp_path / "a.webm")
    assert probe(tmp_path / "a.webm") == "vp9,96,54,9"
    film.save(f"{tmp_path}/pictures/")
    with PIL.Image.open(tmp_path / "pictures" / "0008.png") as image:
        np.testing.assert_array_equal(np.asarray(image), film[8].numpy())
    for name in ("a.gif", "a.apng"):
        film.save(tmp_path / name)
        with PIL.Image.open(tmp_path / name) as image:
            assert getattr(image, "n_frames", 1) == 9 and image.size == SIZE
    with pytest.raises(ValueError, match=r"path: expected a name that ends in \.mp4"):
        film.save(tmp_path / "a.avi")
    with pytest.raises(OSError):
        film.save(tmp_path / "no" / "a.gif")
    with pytest.raises(ValueError, match="fps: a GIF has at most 50 pictures per second, got 60"):
        rf.film(sim, 2, fps=60, size=SIZE).save(tmp_path / "a.gif")


def test_a_film_shows_itself_in_a_notebook(sim: rf.Simulation, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    film = rf.film(sim, 20, fps=20, size=SIZE)
    bundle = film._repr_mimebundle_()
    assert bundle["text/html"] == film._repr_html_() and bundle["text/plain"] == repr(film)
    found = re.search(r'<video width="96" .* src="data:video/mp4;base64,([^"]*)">', bundle["text/html"])
    assert found is not None
    (tmp_path / "shown.mp4").write_bytes(base64.b64decode(found[1]))
    assert probe(tmp_path / "shown.mp4") == "h264,96,54,5"
    # Without ffmpeg, an animated picture is shown.
    monkeypatch.setattr(_film.shutil, "which", lambda name: None)
    assert "data:image/gif;base64,R0lGOD" in film._repr_html_()
    assert "data:image/apng;base64,iVBOR" in rf.film(sim, 20, fps=60, size=SIZE)._repr_html_()


def test_numbers_of_objects_stay_valid_and_progress_is_shown(sim: rf.Simulation, capfd: pytest.CaptureFixture[str]) -> None:
    first = sim.add_sphere([0, 5, 0], 0.2)
    second = sim.add_sphere([0, 6, 0], 0.2)
    sim.remove("sphere", [first])
    rf.film(sim, 20, fps=10, size=SIZE, progress=True, follow=second)
    assert "picture" in capfd.readouterr().err
    sim.set(second, position=[0, 9, 0])
    np.testing.assert_allclose(sim.positions[-1], [0, 9, 0])
    with pytest.raises(LookupError, match="sphere 99"):
        rf.film(sim, 20, size=SIZE, follow=99)
    with pytest.raises(LookupError):
        rf.film(sim, 20, size=SIZE, follow=first)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"steps": 0}, "steps: expected a whole number of at least 1, got 0"),
        ({"fps": 0}, "fps: expected a whole number of at least 1"),
        ({"fps": 2000}, "fps: expected up to 1000"),
        ({"speed": 0}, "speed: expected numbers greater than 0"),
        ({"orbit": float("nan")}, "orbit: expected finite numbers"),
        ({"size": (0, 3)}, "size: expected a whole number of at least 1"),
        ({"colour_by": "taste"}, "colour_by: .* expected one of: kind, speed"),
        ({"camera": [1, 1, 1], "look_at": [1, 1, 1]}, "camera and look_at are the same point"),
        ({"follow": 0, "look_at": [1, 1, 1]}, "look_at, follow: expected only one of them"),
        ({"range": (2, 1)}, "range: expected two numbers"),
    ],
)
def test_wrong_arguments_are_named(sim: rf.Simulation, options: dict[str, object], message: str) -> None:
    before = sim.positions.copy()
    with pytest.raises(ValueError, match=message):
        rf.film(sim, **{"steps": 5, "size": SIZE} | options)  # type: ignore[arg-type]
    assert sim.steps == 0 and sim.positions.tobytes() == before.tobytes()


def test_a_function_is_called_after_every_step_of_a_film() -> None:
    scene = rf.Scene()
    scene.add_sphere([0, 0, 0], 0.5)

    def push(sim: rf.Simulation) -> None:
        seen.append(sim.steps)
        sim.velocities = [[0.1 * sim.steps, 0, 0]]

    seen: list[int] = []
    sim, twin = (rf.Simulation(scene, dt=0.01, backend="cpu") for _ in range(2))
    options: dict[str, Any] = {"size": SIZE, "camera": [0, 0, 9], "look_at": [0, 0, 0], "plain": True}
    film = rf.film(sim, 40, fps=10, on_step=push, **options)
    assert seen == list(range(1, 41)) and len(film) == 5
    for _ in range(40):
        twin.step()
        push(twin)
    assert sim.positions.tobytes() == twin.positions.tobytes() and sim.positions[0, 0] > 0.5
    np.testing.assert_allclose(film[4].numpy().astype(int), sim.render(**options).numpy().astype(int), atol=2)
    # Pictures between two steps, a camera that follows, trails and progress.
    more = rf.film(sim, 10, fps=25, speed=0.1, on_step=push, size=SIZE, follow=0, trails=0.1, progress=True)
    assert len(more) == 26 and not np.array_equal(more[1].numpy(), more[2].numpy())
    with pytest.raises(ZeroDivisionError):
        rf.film(sim, 10, on_step=lambda sim: 1 / 0, size=SIZE)
    with pytest.raises(TypeError, match="on_step: expected a function, got int"):
        rf.film(sim, 10, on_step=5, size=SIZE)  # type: ignore[arg-type]


def test_a_film_of_steps_that_are_run_once_has_the_pictures_of_one_of_steps_that_are_run_twice(sim: rf.Simulation) -> None:
    options: dict[str, Any] = {"fps": 30, "size": SIZE, "camera": [0, 4, 9], "look_at": [0, 0.5, 0], "colour_by": "speed"}
    twice, once = (
        rf.film(own, 30, range=(0, 5), **options, **more)
        for own, more in ((sim.copy(), {}), (sim, {"on_step": lambda sim: None}))
    )
    assert len(twice) == len(once) == 10
    for one, other in zip(twice, once, strict=True):
        assert np.abs(one.numpy().astype(int) - other.numpy().astype(int)).max() <= 2


def test_worlds_are_filmed(sim: rf.Simulation) -> None:
    other = rf.Scene()
    other.add_sphere([0, 5, 0], 0.5)
    scenes = [other, sim.scene]

    def worlds() -> rf.Worlds:
        return rf.Worlds(scenes, dt=0.01, backend="cpu")

    options: dict[str, Any] = {"size": SIZE, "fps": 10, "plain": True}
    expected = rf.film(sim, 40, **options)
    own, twin = worlds(), worlds()
    film = rf.film(own, 40, world=1, **options)
    assert len(film) == len(expected) == 5
    assert all(np.array_equal(one.numpy(), other.numpy()) for one, other in zip(film, expected, strict=True))
    twin.run(40)
    assert own.positions.tobytes() == twin.positions.tobytes() and own.report()["steps"].tolist() == [40, 40]
    # With a function, which sees all worlds.
    seen = []
    assert len(rf.film(own, 20, on_step=lambda worlds: seen.append(worlds.report()["steps"][0]), **options)) == 3
    assert seen == list(range(41, 61))
    # A world that sleeps after a step stands still.
    own.set_sleep(speed=100.0, steps=1, skip=True)
    asleep = rf.film(own, 20, world=1, **options)
    assert np.array_equal(asleep[1].numpy(), asleep[2].numpy())
    with pytest.raises(LookupError, match="there is no world 2"):
        rf.film(own, 5, world=2)
    with pytest.raises(TypeError, match="world: expected None for a Simulation"):
        rf.film(sim, 5, world=0)


def test_a_film_needs_a_simulation_and_leaves_a_recording_alone(sim: rf.Simulation, tmp_path: pathlib.Path) -> None:
    with pytest.raises(TypeError, match=r"sim: expected a rockfall\.Simulation, rockfall\.Worlds or rockfall\.Trajectory, got Scene"):
        rf.film(sim.scene, 5)  # type: ignore[arg-type]
    with sim.record(tmp_path / "a.npz"), pytest.raises(ValueError, match="finish the recording first"):
        rf.film(sim, 5, size=SIZE)


def test_a_body_that_fails_leaves_the_state_before_the_film() -> None:
    scene = rf.Scene()
    a, b = scene.add_spheres([[0, 0, 0], [5, 0, 0]], 0.1)
    scene.add_spring(a, b, 1e9, 1.0)
    sim = rf.Simulation(scene, dt=1.0, backend="cpu")
    with pytest.raises(rf.SimulationError, match="stopped being finite"):
        rf.film(sim, 100, size=SIZE)
    assert sim.steps == 0 and np.isfinite(sim.positions).all()


def test_a_simulation_on_the_gpu_is_filmed_on_its_device(sim: rf.Simulation) -> None:
    gpu = rf.Simulation(sim.scene, dt=0.01, backend="gpu")
    films = [rf.film(own, 20, fps=10, size=SIZE, plain=True) for own in (sim, gpu)]
    assert gpu.steps == 20 and len(films[1]) == 3
    np.testing.assert_allclose(gpu.positions, sim.positions, atol=1e-4)
    difference = np.abs(films[0][2].numpy().astype(int) - films[1][2].numpy().astype(int))
    assert difference.mean() < 1


@pytest.fixture
def twin(sim: rf.Simulation) -> rf.Simulation:
    return rf.Simulation(sim.scene, dt=0.01, backend="cpu")


@pytest.fixture
def recorded(twin: rf.Simulation, sim: rf.Simulation, tmp_path: pathlib.Path) -> rf.Trajectory:
    # The twin stays at the start.
    path = tmp_path / "run.npz"
    with sim.record(path, every=5):
        sim.run(40)
    return rf.Trajectory(path)


def test_a_trajectory_is_filmed_like_the_simulation(
    sim: rf.Simulation, twin: rf.Simulation, recorded: rf.Trajectory
) -> None:
    options: dict[str, Any] = {"size": SIZE, "colour_by": "speed", "clock": True}
    films = [rf.film(twin, 40, fps=20, **options), rf.film(recorded, fps=20, **options)]
    assert [len(film) for film in films] == [9, 9]
    for live, again in zip(*films, strict=True):
        np.testing.assert_allclose(live.numpy().astype(int), again.numpy().astype(int), atol=4)
    # Pictures between two frames, and a part of the trajectory.
    assert len(rf.film(recorded, fps=40, size=SIZE)) == 17
    part = rf.film(recorded[4:], fps=20, plot="height:1", trails=0.1, follow=1, size=SIZE)
    assert len(part) == 5 and not np.array_equal(part[0].numpy(), part[4].numpy())
    for wrong in ({"steps": 3}, {"on_step": print}, {"world": 0}):
        with pytest.raises(TypeError, match=f"{next(iter(wrong))}: expected None for a Trajectory"):
            rf.film(recorded, **wrong)
    with pytest.raises(ValueError, match="trajectory: expected frames at several times"):
        rf.film(recorded[3:4])
    with pytest.raises(TypeError, match="steps: expected the number of steps"):
        rf.film(sim)


def test_a_frame_of_a_trajectory_is_drawn(sim: rf.Simulation, recorded: rf.Trajectory) -> None:
    camera: dict[str, Any] = {"size": SIZE, "camera": [0, 4, 9], "look_at": [0, 0.5, 0], "clock": True}
    np.testing.assert_allclose(recorded.render(**camera).numpy().astype(int), sim.render(**camera).numpy().astype(int), atol=2)
    first = recorded.render(frame=0, **camera)
    assert not np.array_equal(first.numpy(), recorded.render(**camera).numpy())
    np.testing.assert_array_equal(first.numpy(), recorded.render(frame=-9, **camera).numpy())
    with pytest.raises(IndexError, match="frame 9 does not exist: the trajectory has 9 frames"):
        recorded.render(frame=9)


def test_columns_of_a_trajectory_have_the_names_of_tables(recorded: rf.Trajectory) -> None:
    np.testing.assert_array_equal(recorded["y"], recorded.positions[:, :, 1])
    np.testing.assert_array_equal(recorded["vz"], recorded.velocities[:, :, 2])
    np.testing.assert_array_equal(recorded["qw"], recorded.orientations[:, :, 0])
    with pytest.raises(KeyError, match="expected one of x, y, z, vx"):
        recorded["height"]


def test_a_body_is_followed_by_its_name() -> None:
    scene = rf.Scene.parse("set gravity 0\n@name left\nS 1 0 0 0 5 0 0 0 0 0 1 0.5\n@name -\nS 2 0 3 0 0 0 0 0 0 0 1 0.5\n")
    films = [rf.film(rf.Simulation(scene, backend="cpu"), 10, follow=body, size=SIZE) for body in ("left", 0, 1)]
    pictures = [film[-1].numpy() for film in films]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert not np.array_equal(pictures[0], pictures[2])
    with pytest.raises(KeyError, match="follow: lefd: .*did you mean"):
        rf.film(rf.Simulation(scene, backend="cpu"), 10, follow="lefd", size=SIZE)


def test_a_film_has_the_speed_of_the_scene(sim: rf.Simulation) -> None:
    scene = sim.scene
    scene.run = rf.RunDefaults(speed=0.5)
    assert rf.Scene.parse(scene.to_text()).run.speed == 0.5
    slow = rf.Simulation(scene, sim.dt, backend="cpu")
    frames = [len(rf.film(each, 40, fps=10, size=SIZE, plain=True, **options)) for each, options in ((sim, {}), (slow, {}), (slow, {"speed": 1.0}))]  # type: ignore[arg-type]
    assert frames[0] == frames[2] < frames[1]


def test_trails_may_be_those_of_one_body(sim: rf.Simulation) -> None:
    def pixels(trails: float | str) -> bytes:
        return rf.film(sim.copy(), 20, fps=10, size=SIZE, plain=True, trails=trails)[-1].png()

    assert len({pixels(0.0), pixels(1.0), pixels("1:0")}) == 3
    for wrong, error in (("1:nobody", KeyError), ("x:0", ValueError), ("1:", ValueError), ("1:99999", LookupError)):
        with pytest.raises(error, match="trails|sphere"):
            pixels(wrong)
