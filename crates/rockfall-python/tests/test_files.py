"""Checkpoints and trajectories."""

from __future__ import annotations

import gc
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import rockfall as rf


def test_a_checkpoint_restores_the_state(sim: rf.Simulation, tmp_path: pathlib.Path) -> None:
    sim.run(20)
    sim.save_checkpoint(tmp_path / "a.ckpt")
    positions = sim.positions
    view = sim.state.positions
    seen = view.copy()
    sim.run(30)
    end = sim.positions
    sim.restore(tmp_path / "a.ckpt")
    assert sim.steps == 20
    np.testing.assert_array_equal(sim.positions, positions)
    np.testing.assert_array_equal(view, seen)
    sim.run(30)
    np.testing.assert_array_equal(sim.positions, end)
    other = rf.Simulation.resume(tmp_path / "a.ckpt", backend="cpu")
    other.run(30)
    np.testing.assert_array_equal(other.positions, end)


@pytest.mark.parametrize("name", ["film.npz", "film.pvd"])
def test_a_trajectory_is_written_and_read(sim: rf.Simulation, tmp_path: pathlib.Path, name: str) -> None:
    path = tmp_path / name
    recording = sim.record(path, every=5)
    expected = [sim.positions.copy()]
    for _ in range(2):
        sim.run(5)
        expected.append(sim.positions.copy())
    for _ in range(5):
        sim.step()
    expected.append(sim.positions.copy())
    sim.run(3)
    recording.frame()
    expected.append(sim.positions.copy())
    assert not path.exists(), "the file appears when it is complete"
    recording.finish()
    recording.finish()
    with pytest.raises(ValueError, match="finished"):
        recording.frame()
    sim.run(10)
    trajectory = rf.Trajectory(path)
    assert trajectory.steps == [0, 5, 10, 15, 18] and trajectory.times == [0, 0.05, 0.1, 0.15, 0.18]
    assert len(trajectory) == 5 and trajectory.scene.counts == sim.counts
    for frame, positions in zip(trajectory, expected, strict=True):
        np.testing.assert_array_equal(frame.positions, positions)
        assert frame.orientations.shape == (45, 4) and frame.velocities.shape == frame.angular_momenta.shape == (45, 3)
    assert trajectory[-1].step == 18 and trajectory[0].time == 0
    with pytest.raises(IndexError, match="has 5 frames"):
        trajectory[5]


def test_a_csv_file_has_a_line_per_sphere(sim: rf.Simulation, tmp_path: pathlib.Path) -> None:
    with sim.record(tmp_path / "film.csv", every=10):
        sim.run(20)
    assert len((tmp_path / "film.csv").read_text().splitlines()) == 1 + 3 * 45


SCRIPT = """
import rockfall as rf
scene = rf.Scene()
scene.add_spheres([[0, 0, 0], [5, 0, 0]], 0.5)
sim = rf.Simulation(scene, dt=0.01, backend="cpu")
sim.record("film.npz", every=10)
sim.run(50)
{end}
"""


@pytest.mark.parametrize("end", ["", "raise SystemExit(0)", "del sim"])
def test_a_recording_without_with_is_complete_at_the_end_of_the_program(end: str, tmp_path: pathlib.Path) -> None:
    script = SCRIPT.format(end=end)
    found = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (found.returncode, found.stderr) == (0, "")
    assert rf.Trajectory(tmp_path / "film.npz").steps == [0, 10, 20, 30, 40, 50]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are forked on Unix")
def test_a_forked_process_leaves_the_file_to_its_parent(tmp_path: pathlib.Path) -> None:
    script = SCRIPT.format(end="import os, sys\nif os.fork() == 0: sys.exit(0)\nos.wait()\nsim.run(10)")
    found = subprocess.run([sys.executable, "-W", "ignore", "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (found.returncode, found.stderr) == (0, "")
    assert len(rf.Trajectory(tmp_path / "film.npz")) == 7


def test_a_recording_is_complete_when_nothing_refers_to_it(scene: rf.Scene, tmp_path: pathlib.Path) -> None:
    sim = rf.Simulation(scene, dt=0.01, backend="cpu")
    recording = sim.record(tmp_path / "film.npz", every=10)
    sim.run(20)
    assert "film.npz" in repr(recording) and "3 frames" in repr(recording)
    del sim, recording
    gc.collect()
    assert len(rf.Trajectory(tmp_path / "film.npz")) == 3


@pytest.fixture
def trajectory(sim: rf.Simulation, tmp_path: pathlib.Path) -> rf.Trajectory:
    with sim.record(tmp_path / "film.npz", every=2):
        sim.run(10)
    return rf.Trajectory(tmp_path / "film.npz")


def test_a_trajectory_has_arrays_of_all_frames_and_slices(trajectory: rf.Trajectory) -> None:
    assert trajectory.positions.shape == trajectory.velocities.shape == trajectory.angular_momenta.shape == (6, 45, 3)
    assert trajectory.orientations.shape == (6, 45, 4) and trajectory.positions.dtype == np.float32
    for name in ("positions", "velocities", "orientations", "angular_momenta"):
        np.testing.assert_array_equal(getattr(trajectory, name), [getattr(frame, name) for frame in trajectory])
    part = trajectory[1:-1:2]
    assert (len(part), part.steps, part[-1].step) == (2, [2, 6], 6)
    assert part.times == [trajectory.times[1], trajectory.times[3]] and part[1:].steps == [6]
    np.testing.assert_array_equal(part.positions, trajectory.positions[1:-1:2])
    assert trajectory[:0].positions.shape == (0, 45, 3) and trajectory[:0].orientations.shape == (0, 45, 4)
    assert [frame.step for frame in reversed(trajectory)] == [10, 8, 6, 4, 2, 0]
    assert "6 frames from 0 to 0.1 s" in repr(trajectory) and "45 spheres" in repr(trajectory[0])


def test_a_trajectory_goes_to_pandas_and_xarray(trajectory: rf.Trajectory, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pandas")
    table = trajectory[2:4].to_pandas()
    assert list(table.columns[:6]) == ["step", "time", "sphere", "x", "y", "z"] and len(table) == 2 * 45
    row = table.iloc[45 + 7]
    assert (row.step, row.sphere, row.time) == (6, 7, trajectory.times[3])
    frame = trajectory[3]
    np.testing.assert_array_equal(row["x":"lz"], [*frame.positions[7], *frame.velocities[7], *frame.orientations[7], *frame.angular_momenta[7]])
    assert len(trajectory[:0].to_pandas()) == 0
    pytest.importorskip("xarray")
    data = trajectory.to_xarray()
    np.testing.assert_array_equal(data.positions.sel(axis="y").isel(time=3), frame.positions[:, 1])
    assert dict(data.sizes) == {"time": 6, "sphere": 45, "axis": 3, "component": 4} and data.step[3] == 6
    for name, method in (("pandas", trajectory.to_pandas), ("xarray", trajectory.to_xarray)):
        monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(ImportError, match=f"needs {name}: pip install {name}"):
            method()


def test_fields_have_a_short_text(sim: rf.Simulation) -> None:
    assert len(repr(sim.fields())) < 200
