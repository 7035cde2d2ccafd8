"""The package and the command line give the same bits on the CPU."""

from __future__ import annotations

import pathlib
from collections.abc import Callable

import numpy as np
import pytest
from conftest import ROOT

import rockfall as rf


def scenes() -> list[pathlib.Path]:
    """The scenes of the repository that are small enough to run in a test."""
    found = [path for path in sorted((ROOT / "scenes").glob("*.txt")) if path.stat().st_size < 100_000]
    # Where spheres come and go, arrays have other shapes.
    found = [path for path in found if "@inlet" not in path.read_text()]
    assert len(found) >= 3
    return found


def same(sim: rf.Simulation, archive: pathlib.Path) -> None:
    with np.load(archive) as states:
        for name, array in {
            "position": sim.positions,
            "velocity": sim.velocities,
            "orientation": sim.orientations,
            "angular_momentum": sim.angular_momenta,
        }.items():
            key = next(key for key in states if key.startswith(name) or key.startswith(name.replace("momentum", "momenta")))
            expected = states[key].reshape(-1, *array.shape)[-1]
            assert expected.tobytes() == array.tobytes(), f"{name} differs"


@pytest.mark.parametrize("path", scenes(), ids=lambda path: path.stem)
def test_a_run_gives_the_bits_of_the_command_line(
    path: pathlib.Path, command_line: Callable[..., str], tmp_path: pathlib.Path
) -> None:
    out = tmp_path / "out.npz"
    command_line("run", path, "--steps", 100, "--every", 100, "--dt", 0.01, "--backend", "cpu", "--out", out)
    sim = rf.Simulation(rf.Scene.load(path), dt=0.01, backend="cpu")
    sim.run(100)
    same(sim, out)


def test_a_scene_from_arrays_gives_the_bits_of_its_text(
    scene: rf.Scene, command_line: Callable[..., str], tmp_path: pathlib.Path
) -> None:
    scene.settings.update(gravity=9.81, contact_force=3000.0, restitution=0.3)
    scene.save(tmp_path / "scene.txt")
    out = tmp_path / "out.npz"
    command_line("run", tmp_path / "scene.txt", "--steps", 200, "--dt", 0.005, "--integrator", "symplectic-euler",
                 "--backend", "cpu", "--out", out)  # fmt: skip
    sim = rf.Simulation(scene, dt=0.005, backend="cpu", integrator="symplectic-euler")
    sim.run(200)
    same(sim, out)


def test_a_checkpoint_of_the_command_line_goes_on_in_python(
    scene: rf.Scene, command_line: Callable[..., str], tmp_path: pathlib.Path
) -> None:
    scene.save(tmp_path / "scene.txt")
    command_line("run", tmp_path / "scene.txt", "--steps", 60, "--dt", 0.01, "--backend", "cpu",
                 "--checkpoint", tmp_path / "half.ckpt")  # fmt: skip
    whole = rf.Simulation(scene, dt=0.01, backend="cpu")
    whole.run(150)
    resumed = rf.Simulation.resume(tmp_path / "half.ckpt")
    assert (resumed.steps, resumed.dt) == (60, 0.01)
    resumed.run(90)
    assert resumed.positions.tobytes() == whole.positions.tobytes()
    command_line("run", "--resume", tmp_path / "half.ckpt", "--steps", 150, "--out", tmp_path / "end.npz")
    same(resumed, tmp_path / "end.npz")


def test_a_checkpoint_of_python_goes_on_in_the_command_line(
    scene: rf.Scene, command_line: Callable[..., str], tmp_path: pathlib.Path
) -> None:
    sim = rf.Simulation(scene, dt=0.01, backend="cpu")
    sim.run(60)
    sim.save_checkpoint(tmp_path / "python.ckpt")
    command_line("run", "--resume", tmp_path / "python.ckpt", "--steps", 150, "--out", tmp_path / "end.npz")
    sim.run(90)
    same(sim, tmp_path / "end.npz")


def test_trajectories_are_those_of_the_command_line(
    scene: rf.Scene, command_line: Callable[..., str], tmp_path: pathlib.Path
) -> None:
    scene.save(tmp_path / "scene.txt")
    command_line("run", tmp_path / "scene.txt", "--steps", 50, "--dt", 0.01, "--backend", "cpu", "--every", 10,
                 "--out", tmp_path / "cli.npz")  # fmt: skip
    sim = rf.Simulation(rf.Scene.load(tmp_path / "scene.txt"), dt=0.01, backend="cpu")
    with sim.record(tmp_path / "python.npz", every=10):
        sim.run(50)
    with np.load(tmp_path / "cli.npz") as expected, np.load(tmp_path / "python.npz") as found:
        assert set(expected) == set(found)
        for name in expected:
            np.testing.assert_array_equal(expected[name], found[name], err_msg=name)
