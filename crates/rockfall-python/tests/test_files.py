"""Checkpoints and trajectories."""

from __future__ import annotations

import pathlib

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
