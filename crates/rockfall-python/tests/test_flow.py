"""Inlets and outlets."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rockfall as rf

DT = 1 / 64


def chute() -> rf.Scene:
    scene = rf.Scene()
    scene.add_box((0.4, -0.5, -1), (2, 0, 1))
    scene.add_inlet(
        "feed", (-1, 2, -0.8), (1, 2.6, 0.8), mass_rate=60, radius=(0.08, 0.16), by="mass", density=500, velocity=(0, -1, 0),
        seed=3, colour="orange",
    )
    scene.add_outlet("drain", (-5, -4, -5), (5, -1, 5))
    return scene


def test_grains_come_and_go_and_balance() -> None:
    sim = rf.Simulation(chute(), dt=DT, backend="cpu")
    assert sim.flow == rf.Flow({"feed": rf.Inflow(0, 0.0, 0)}, {"drain": rf.Outflow(0, 0.0)}, 0, 0.0)
    sim.run(150)
    flow = sim.flow
    feed, drain = flow.inlets["feed"], flow.outlets["drain"]
    assert feed.spheres > 20 and drain.spheres > 5
    assert feed.mass - drain.mass == flow.mass
    assert feed.spheres - drain.spheres == flow.spheres == len(sim.positions)
    # Numbers are never used again, and belong to the rows of arrays.
    numbers = sim.sphere_ids
    assert (np.diff(numbers) > 0).all()
    sim.set(numbers[-1], velocity=(0, 7, 0))
    assert sim.velocities[-1, 1] == 7
    before = set(numbers)
    sim.run(50)
    assert set(sim.sphere_ids) - before, "new ones have new numbers"


def test_calls_and_checkpoints_do_not_matter(tmp_path: Path) -> None:
    whole, parts = (rf.Simulation(chute(), dt=DT, backend="cpu") for _ in range(2))
    whole.run(120)
    parts.run(31)
    parts.save_checkpoint(tmp_path / "half.ckpt")
    parts = rf.Simulation.resume(tmp_path / "half.ckpt")
    parts.run(89)
    assert whole.flow == parts.flow
    np.testing.assert_array_equal(whole.positions, parts.positions)


def test_mixtures() -> None:
    scene = rf.Scene()
    glass = scene.add_material("glass", density=2500)
    kinds = [
        (rf.GrainKind("fine", radius=(0.05, 0.06), by="mass", material=glass, label="fine"), 1),
        (rf.GrainKind("coarse", radius=0.2, density=1000, label="coarse"), 3),
    ]
    scene.add_inlet("feed", (0, 0, 0), (9, 3, 9), mass_rate=40_000, mix=kinds, by="mass")
    sim = rf.Simulation(scene, dt=DT, backend="cpu")
    sim.run(64)
    masses, radii = sim.masses, sim.radii
    coarse = masses[radii > 0.1].sum() / masses.sum()
    assert len(masses) > 1000 and abs(coarse - 0.75) < 0.03, coarse
    assert "mix=fine:1,coarse:3 by=mass" in scene.to_text()
    with pytest.raises(TypeError, match="mix: expected no shape"):
        scene.add_inlet("a", (0, 0, 0), (1, 1, 1), rate=1, radius=0.1, mix=kinds)
    with pytest.raises(ValueError, match="a name for each kind"):
        scene.add_inlet("a", (0, 0, 0), (1, 1, 1), rate=1, mix=2 * kinds)
    with pytest.raises(TypeError, match="shape, radius: expected one of them, got none"):
        scene.add_inlet("a", (0, 0, 0), (1, 1, 1), rate=1, mix=[(rf.GrainKind("a"), 1)])


def test_radii() -> None:
    scene = rf.Scene()
    for name, radius in [("one", 0.1), ("range", (0.1, 0.2)), ("normal", "lognormal:0.1,0.2")]:
        scene.add_inlet(name, (0, 0, 0), (1, 1, 1), rate=0, radius=radius)
    text = scene.to_text()
    for radius in ["radius=0.1\n", "radius=0.1..0.2", "radius=lognormal:0.1,0.2"]:
        assert radius in text, text
    assert rf.Scene.parse(text).to_text() == text


def test_wrong_inlets_are_refused() -> None:
    scene = rf.Scene()
    box = ((0, 0, 0), (1, 1, 1))
    with pytest.raises(TypeError, match="expected one of them, got 0"):
        scene.add_inlet("a", *box, radius=0.1)
    with pytest.raises(TypeError, match="expected one of them, got 2"):
        scene.add_inlet("a", *box, rate=1, mass_rate=1, radius=0.1)
    with pytest.raises(ValueError, match="a box whose edges are at least as long"):
        scene.add_inlet("a", *box, rate=1, radius=0.6)
    with pytest.raises(ValueError, match="radius"):
        scene.add_inlet("a", *box, rate=1, radius="wide")
    with pytest.raises(ValueError, match="six finite numbers"):
        scene.add_outlet("a", (0, 0, 0), (1, 0, 1))
    with pytest.raises(LookupError):
        scene.add_inlet("a", *box, rate=1, radius=0.1, material="none")
    with pytest.raises(TypeError, match="shape, radius: expected one of them, got none"):
        scene.add_inlet("a", *box, rate=1)
    with pytest.raises(LookupError, match="there is no shape 0"):
        scene.add_inlet("a", *box, rate=1, shape=0)
    ball = scene.add_shape(rf.Shape().sphere((0, 0, 0), 0.1))
    with pytest.raises(TypeError, match="shape, radius: expected one of them, got both"):
        scene.add_inlet("a", *box, rate=1, shape=ball, radius=0.1)
    with pytest.raises(TypeError, match="expected none with a shape"):
        scene.add_inlet("a", *box, rate=1, shape=ball, mass=0.1)
    with pytest.raises(ValueError, match="volume_rate"):
        scene.add_inlet("a", *box, volume_rate=1, shape=ball)
    scene.add_outlet("a", *box)
    with pytest.raises(ValueError, match="no other outlet"):
        scene.add_outlet("a", *box)


def test_bodies_come_in_and_leave(tmp_path: Path) -> None:
    scene = rf.Scene()
    dimer = scene.add_shape(rf.Shape(density=500).capsule((0, 0, 0), (0.2, 0, 0), 0.1))
    scene.add_inlet("feed", (-1, 2, -1), (1, 2.6, 1), rate=30, shape=dimer, velocity=(0, -2, 0), seed=4)
    scene.add_outlet("drain", (-3, -2, -3), (3, 0, 3))
    assert rf.Scene.parse(scene.to_text()).to_text() == scene.to_text()
    sim = rf.Simulation(scene, dt=DT, backend="cpu")
    with sim.record(tmp_path / "run.npz", every=20):
        sim.run(200)
    flow, mass = sim.flow, scene.shape_mass(dimer).mass
    came, left = flow.inlets["feed"], flow.outlets["drain"]
    assert left.spheres > 10
    assert came.spheres - left.spheres == flow.spheres == sim.counts.bodies == len(sim.bodies.positions)
    assert came.mass == pytest.approx(mass * came.spheres)
    assert sim.counts.spheres == 2 * flow.spheres
    # The numbers of those that came in count on.
    assert len(set(sim.sphere_ids.tolist())) == 2 * flow.spheres
    frames = rf.Trajectory(tmp_path / "run.npz")
    assert len(frames) == 11
    for frame in frames:
        ends = frame.positions.reshape(-1, 2, 3)
        lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
        assert lengths == pytest.approx(0.2, abs=1e-5)


def test_a_rate_that_does_not_fit_is_a_concern() -> None:
    scene = rf.Scene()
    scene.add_inlet("feed", (0, 0, 0), (1, 1, 1), volume_rate=50, radius=0.1, velocity=(0, -1, 0))
    assert any("spheres will wait" in concern for concern in scene.check(DT))


def test_recordings_of_changing_spheres(tmp_path: Path) -> None:
    sim = rf.Simulation(chute(), dt=DT, backend="cpu")
    with sim.record(tmp_path / "run.csv", every=10):
        sim.run(100)
    lines = (tmp_path / "run.csv").read_text().splitlines()
    references = {int(line.split(",")[16]) for line in lines[1:]}
    assert references == set(range(1, len(references) + 1))


def test_npz_files_of_changing_spheres(tmp_path: Path) -> None:
    sim = rf.Simulation(chute(), dt=DT, backend="cpu")
    expected = [sim.positions.copy()]
    numbers = [sim.sphere_ids.copy()]
    with sim.record(tmp_path / "run.npz", every=25):
        for _ in range(6):
            sim.run(25)
            expected.append(sim.positions.copy())
            numbers.append(sim.sphere_ids.copy())
    with np.load(tmp_path / "run.npz") as file:
        offsets, ids = file["offsets"], file["id"]
        assert list(np.diff(offsets)) == [len(positions) for positions in expected]
        assert file["position"].shape == (offsets[-1], 3) and file["radius"].shape == ids.shape == (offsets[-1],)
        np.testing.assert_array_equal(ids[offsets[-2] :], file["scene_id"])
    trajectory = rf.Trajectory(tmp_path / "run.npz")
    assert not trajectory.is_constant and len(trajectory) == 7
    for frame, positions in zip(trajectory, expected, strict=True):
        np.testing.assert_array_equal(frame.positions, positions)
    # The same sphere has the same number in all frames.
    pairs = {(int(a), int(b)) for frame, of_sim in zip(trajectory, numbers, strict=True) for a, b in zip(frame.ids, of_sim, strict=True)}
    assert len({a for a, _ in pairs}) == len({b for _, b in pairs}) == len(pairs) == len(trajectory.radii)
    np.testing.assert_array_equal(trajectory.radii[trajectory[-1].ids], sim.radii)
    for use in (lambda: trajectory.positions, lambda: trajectory["y"], lambda: trajectory[1:].velocities):
        with pytest.raises(ValueError, match=r"spheres come and go in .*run.npz.* use the arrays of the frames, trajectory\[k\]"):
            use()


def test_spheres_are_added_and_removed_while_a_file_is_recorded(tmp_path: Path) -> None:
    scene = rf.Scene()
    first = scene.add_spheres([[0, 0, 0], [4, 0, 0]], [0.5, 1.0])
    sim = rf.Simulation(scene, dt=DT, backend="cpu")
    with sim.record(tmp_path / "run.npz", every=5):
        sim.run(5)
        sim.remove("sphere", first[0])
        sim.add_capsules([0, 9, 0], [0, 10, 0], 0.25)
        sim.run(5)
        with pytest.raises(ValueError, match="finish the recording first"):
            sim.restore(tmp_path / "any.ckpt")
    trajectory = rf.Trajectory(tmp_path / "run.npz")
    assert [list(frame.ids) for frame in trajectory] == [[0, 1], [0, 1], [1, 2, 3]]
    assert list(trajectory.radii) == [0.5, 1.0, 0.25, 0.25]
    size = (64, 48)
    pictures = [trajectory.render(size, frame=frame, camera=(0, 5, 30), look_at=(0, 5, 0)).numpy() for frame in (2, 0, 2)]
    np.testing.assert_array_equal(pictures[0], pictures[2])
    assert (pictures[0] != pictures[1]).any()
    assert len(rf.film(trajectory, fps=50, size=size)) > 2
    pytest.importorskip("pandas")
    table = trajectory.to_pandas()
    assert list(table["sphere"]) == [0, 1, 0, 1, 1, 2, 3] and list(table["step"]) == [0, 0, 5, 5, 10, 10, 10]
