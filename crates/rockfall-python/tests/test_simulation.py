"""Running, reading and editing simulations."""

from __future__ import annotations

import gc
import pathlib
import signal
import threading
import time

import numpy as np
import pytest

import rockfall as rf


def falling(**options: object) -> rf.Simulation:
    scene = rf.Scene()
    scene.add_spheres([[0, 10, 0], [5, 10, 0], [9, 10, 0]], 0.5, mass=[1, 2, 4])
    return rf.Simulation(scene, dt=0.125, backend="cpu", **options)  # type: ignore[arg-type]


def test_balls_fall_as_the_formula_says() -> None:
    sim = falling()
    report = sim.run(8)
    assert report == sim.report and (sim.steps, sim.time, sim.dt) == (8, 1.0, 0.125)
    np.testing.assert_allclose(sim.positions[:, 1], 9.5, rtol=1e-6)
    np.testing.assert_allclose(sim.velocities, [[0, -1, 0]] * 3, rtol=1e-6)
    sim.step()
    sim.dt = 0.25
    sim.step()
    assert (sim.steps, sim.time) == (10, 1.375)


def test_the_way_of_running_does_not_change_a_bit(scene: rf.Scene) -> None:
    def state(run: object) -> bytes:
        sim = rf.Simulation(scene, dt=0.01, backend="cpu")
        run(sim)  # type: ignore[operator]
        return sim.positions.tobytes() + sim.velocities.tobytes() + sim.orientations.tobytes()

    one_by_one = state(lambda sim: [sim.step() for _ in range(120)])
    assert one_by_one == state(lambda sim: sim.run(120))
    assert one_by_one == state(lambda sim: [(sim.run(40), sim.positions, sim.state.positions, sim.energy) for _ in range(3)])
    assert one_by_one == state(lambda sim: sim.run(120, progress=True))


def test_options_reach_the_simulation(scene: rf.Scene) -> None:
    sim = rf.Simulation(scene, backend="cpu", integrator="symplectic-euler", broad_phase="sort-and-skip", keep_going=True)
    assert (sim.integrator, sim.broad_phase_method) == ("symplectic-euler", "sort-and-skip")
    assert sim.backend.kind == "cpu" and "CPU" in sim.backend.device and sim.memory > 0
    assert "45 spheres" in repr(sim)
    grid = rf.Simulation(scene, backend="cpu", integrator="symplectic-euler", broad_phase="grid")
    sim.run(50), grid.run(50)
    assert sim.positions.tobytes() == grid.positions.tobytes()
    verlet = rf.Simulation(scene, backend="cpu", integrator="velocity-verlet")
    verlet.run(50)
    assert verlet.integrator == "velocity-verlet" and verlet.positions.tobytes() != grid.positions.tobytes()
    with pytest.raises(rf.SimulationError, match="stopped being finite"):
        explode(False).run(100)
    assert explode(True).run(100).non_finite > 0


def test_spheres_that_pass_a_wall_are_counted() -> None:
    scene = rf.Scene()
    scene.settings.gravity = 0
    scene.settings.collisions = False
    scene.add_polygons([-1, 0, -1], [0, 0, 4], [4, 0, 0])
    scene.add_spheres([[5, 1, 0], [0, 1, 0]], 0.1, velocity=[0, -40, 0])
    sim = rf.Simulation(scene, dt=0.02, backend="cpu")
    assert (sim.report.passages, sim.report.first_passage) == (0, None)
    report = sim.run(3)
    assert (report.passages, report.first_passage) == (1, (1, 2))


@pytest.mark.filterwarnings("error")
def test_the_first_steps_warn_of_an_unsuitable_time_step() -> None:
    scene = rf.Scene()
    scene.settings.update(contact_force=1e5, gravity=9.81)
    scene.add_box([-5, -1, -5], [5, 0, 5])
    scene.add_spheres(np.random.default_rng(1).uniform(0.2, 3, (200, 3)), 0.1, 1.0)
    concerns = [text for text in scene.check(0.02) if "at the start" not in text]
    assert any("unstable" in text for text in concerns)
    sim = rf.Simulation(scene, backend="cpu")
    with pytest.warns(rf.SceneWarning) as caught:
        sim.step()
    told = [str(warning.message) for warning in caught]
    assert told[:-1] == [f"time step 0.02 s: {text}" for text in concerns]
    assert "at the start, and" in told[-1]
    assert all(warning.filename == __file__ for warning in caught)
    sim.run(2)
    # Methods with keyword arguments have a frame more.
    with pytest.warns(rf.SceneWarning) as caught:
        rf.Simulation(scene, backend="cpu").run(1)
    assert all(warning.filename == __file__ for warning in caught)
    sim.dt = 0.01
    with pytest.warns(rf.SceneWarning, match="^time step 0.01 s: .*unstable"):
        sim.run(1)
    rf.Simulation(scene, backend="cpu", check=False).run(1)


def test_the_integrator_follows_the_contact_law() -> None:
    scene = rf.Scene()
    assert rf.Simulation(scene, backend="cpu").integrator == "rk4"
    scene.settings.contact_law = "hertz-mindlin"
    assert rf.Simulation(scene, backend="cpu").integrator == "velocity-verlet"
    with pytest.raises(ValueError, match="integrator rk4 is not allowed"):
        rf.Simulation(scene, backend="cpu", integrator="rk4")
    with pytest.raises(ValueError, match="integrator"):
        scene.check(0.01, "euler")


def explode(keep_going: bool) -> rf.Simulation:
    scene = rf.Scene()
    a, b = scene.add_spheres([[0, 0, 0], [5, 0, 0]], 0.1)
    scene.add_spring(a, b, 1e9, 1.0)
    return rf.Simulation(scene, dt=1.0, backend="cpu", keep_going=keep_going)


def test_single_phases_make_a_step(scene: rf.Scene) -> None:
    sims = [rf.Simulation(scene, dt=0.01, backend="cpu") for _ in range(2)]
    sims[0].step()
    sims[1].update_aabbs()
    sims[1].broad_phase()
    sims[1].handle_collisions()
    sims[1].update_positions()
    assert sims[1].steps == 1
    np.testing.assert_allclose(sims[0].positions, sims[1].positions, atol=1e-6)


def test_the_gpu_backend_agrees_and_copies_through_the_host(scene: rf.Scene) -> None:
    sims = [rf.Simulation(scene, dt=0.01, backend=backend) for backend in ("cpu", "gpu")]
    for sim in sims:
        sim.velocities[:] *= 0.5
        sim.run(10)
    assert sims[1].backend.kind == "gpu" and sims[1].memory > 0
    np.testing.assert_allclose(sims[0].positions, sims[1].positions, atol=1e-4)
    with pytest.raises(rf.SimulationError, match="state"):
        _ = sims[1].state


def test_writing_to_arrays_reaches_the_next_step() -> None:
    sim = falling()
    sim.velocities[:] = [0, 0, 0]
    sim.velocities[1] = [0, 4, 0]
    sim.positions[2, 0] += 1
    sim.settings.gravity = 0
    assert sim.velocities[1].tolist() == [0, 4, 0] and sim.positions[2, 0] == 10
    sim.run(8)
    assert sim.positions.tolist() == [[0, 10, 0], [5, 14, 0], [10, 10, 0]]
    sim.velocities = np.zeros((3, 3))
    sim.velocities += 1
    sim.positions = [0, 0, 0]
    np.add(sim.positions, [[0, 0, 0], [2, 0, 0], [4, 0, 0]], out=sim.positions)
    sim.orientations = [0, 1, 0, 0]
    sim.angular_momenta[0] = [0, 0, 1]
    sim.run(8)
    assert sim.positions.tolist() == [[1, 1, 1], [3, 1, 1], [5, 1, 1]]
    assert abs(sim.orientations[0, 3]) > 1e-3 or abs(sim.orientations[0, 2]) > 1e-3
    assert sim.angular_momenta[0].tolist() == [0, 0, 1] and sim.orientations[1].tolist() == [0, 1, 0, 0]
    sim.external_forces[:] = [[1, 0, 0]]
    sim.velocities[:] = 0
    sim.run(8)
    np.testing.assert_allclose(sim.velocities[:, 0], [1, 0.5, 0.25], rtol=1e-6)


def test_an_array_is_a_snapshot_after_the_next_step() -> None:
    sim = falling()
    before = sim.positions
    assert before is sim.positions, "the same array until the next step"
    sim.step()
    assert before[:, 1].tolist() == [10, 10, 10] and (sim.positions - before)[0, 1] < 0
    with pytest.raises(ValueError, match="read-only"):
        before[0] = 0
    for name in ("radii", "masses", "fixed"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(sim, name)[0] = 1


def test_views_share_the_memory() -> None:
    sim = falling()
    state = sim.state
    address = state.positions.__array_interface__["data"][0]
    assert sim.state.positions.__array_interface__["data"][0] == address, "the same memory, not a copy"
    assert np.from_dlpack(sim.positions).__array_interface__["data"] == sim.positions.__array_interface__["data"]
    assert state.positions.base is not None and not state.positions.flags.owndata
    order = np.argsort(state.order)
    np.testing.assert_array_equal(state.positions[order], sim.positions)
    np.testing.assert_array_equal(state.velocities[order], sim.velocities)
    np.testing.assert_array_equal(state.angular_momenta[order], sim.angular_momenta)
    np.testing.assert_array_equal(state.orientations_xyzw[order][:, [3, 0, 1, 2]], sim.orientations)
    np.testing.assert_array_equal(state.radii[order], sim.radii)
    np.testing.assert_array_equal(1 / state.inverse_masses[order], sim.masses)
    np.testing.assert_allclose(state.inverse_inertias[order], 1 / (0.4 * sim.masses * sim.radii**2), rtol=1e-6)
    assert len(state) == 3
    with pytest.raises(ValueError):
        state.positions[0] = 1
    with pytest.raises(ValueError):
        state.positions.flags.writeable = True
    for _ in range(3):
        sim.settings.gravity, _ = 2.0, (sim.energy, sim.contacts, sim.diagnostics, sim.positions, repr(sim))
    assert sim.state.positions.__array_interface__["data"][0] == address, "reading does not move the memory"


def test_views_keep_their_state_whatever_the_simulation_does() -> None:
    sim = falling()
    view = sim.state.positions
    old = view.copy()
    sim.run(5)
    np.testing.assert_array_equal(view, old)
    assert not np.array_equal(sim.state.positions, old)
    second = sim.state
    now = second.positions.copy()
    ids = sim.add_spheres(np.random.default_rng(1).random((1000, 3)) * 50 + [0, 20, 0], 0.1)
    sim.remove("sphere", ids[::2])
    sim.set(0, position=[0, 50, 0])
    sim.run(3)
    np.testing.assert_array_equal(second.positions, now)
    third = sim.state.orientations_xyzw
    kept = third.copy()
    del sim
    gc.collect()
    junk = [np.full(3000, 7.0) for _ in range(100)]
    np.testing.assert_array_equal(third, kept)
    np.testing.assert_array_equal(view, old)
    assert len(junk) == 100


def test_memory_is_sorted_in_a_large_scene() -> None:
    scene = rf.Scene()
    scene.add_spheres(np.random.default_rng(2).random((5000, 3)) * 50, 0.1)
    sim = rf.Simulation(scene, backend="cpu")
    state = sim.state
    assert not np.array_equal(state.order, np.arange(5000)), "this test needs a memory order of its own"
    positions = np.empty_like(sim.positions)
    positions[state.order] = state.positions
    np.testing.assert_array_equal(positions, sim.positions)


def test_set_and_impulses_by_number() -> None:
    sim = falling()
    sim.settings.gravity = 0
    sim.set([2, 0], position=[[1, 1, 1], [2, 2, 2]], velocity=[0, 0, 0], orientation=[0, 0, 1, 0], angular_momentum=[0, 0, 0])
    sim.set(1, force=[2, 0, 0])
    sim.apply_impulse([0, 2], [4, 0, 0])
    assert sim.positions.tolist() == [[2, 2, 2], [5, 10, 0], [1, 1, 1]]
    assert sim.velocities[:, 0].tolist() == [4, 0, 1] and sim.orientations[2].tolist() == [0, 0, 1, 0]
    sim.run(8)
    assert sim.velocities[1, 0] == 1 and sim.external_forces[1, 0] == 2


def test_objects_are_edited_between_steps() -> None:
    sim = falling()
    sim.run(2)
    ball = sim.add_sphere([0, 2, 0], 0.5)
    assert ball == 3 and sim.positions.shape == (4, 3)
    rod = sim.add_rod(0, ball, 0.1)
    spring = sim.add_spring(1, 2, 10)
    tether = sim.add_tethers(1, [5, 12, 0], 10)
    sim.update_springs(spring, stiffness=20)
    sim.update_tethers(tether, point=[5, 13, 0])
    sim.update_rods(rod, radius=0.2)
    sim.add_capsules([20, 5, 0], [21, 5, 0], 0.2)
    sim.add_boxes([-50, -1, -50], np.diag([100, 1, 100]))
    sim.add_polygons([0, -5, 0], [1, 0, 0], [0, 0, -1])
    sim.run(5)
    assert sim.counts == rf.Counts(6, 2, 1, 1, 1, 1, 1)
    sim.remove("sphere", 0)
    sim.remove("box", 0)
    assert sim.counts == rf.Counts(5, 1, 1, 1, 1, 0, 1)
    assert sim.sphere_ids.tolist() == [1, 2, 3, 4, 5]
    sim.run(5)
    assert sim.positions.shape == (5, 3) and np.isfinite(sim.positions).all()
    assert sim.scene.counts == sim.counts and "K 0 1 20 " in sim.scene.to_text()


def test_energies_of_symplectic_euler_are_those_of_the_time_step(tmp_path: pathlib.Path) -> None:
    scene = rf.Scene.parse("set gravity 0\nS 1 0.1 0 0 0 0 0 0 0 0 1 0.01\nT 1 0 0 0 10000 0 0\n")
    sim = rf.Simulation(scene, dt=1e-4, backend="cpu", integrator="symplectic-euler")
    assert sim.energy.kinetic == pytest.approx(0.5 * 0.05**2, rel=1e-4)
    sim.save_checkpoint(tmp_path / "a.ckpt")
    sim.dt = 2e-4
    assert sim.energy.kinetic == pytest.approx(0.5 * 0.1**2, rel=1e-4)
    sim.restore(tmp_path / "a.ckpt")
    assert sim.energy.kinetic == pytest.approx(0.5 * 0.1**2, rel=1e-4)
    resumed = rf.Simulation.resume(tmp_path / "a.ckpt", backend="cpu")
    assert resumed.dt == 1e-4 and resumed.energy.kinetic == pytest.approx(0.5 * 0.05**2, rel=1e-4)


def test_contacts_energies_and_diagnostics() -> None:
    scene = rf.Scene()
    scene.add_box([-5, -1, -5], [5, 0, 5])
    scene.add_spheres([[0, 0.5, 0], [3, 5, 0]], 0.5, mass=2)
    sim = rf.Simulation(scene, dt=0.01, backend="cpu")
    assert sim.energy.kinetic == 0 and sim.energy.potential == pytest.approx(2 * 5.5)
    sim.run(300)
    contacts = sim.contacts
    assert contacts["a_kind"].tolist() == ["sphere", "sphere"] and contacts["b_kind"].tolist() == ["box", "box"]
    assert sorted(contacts["a"]) == [0, 1] and contacts["b"].tolist() == [0, 0]
    row = contacts[contacts["a"] == 0][0]
    np.testing.assert_allclose(row["normal"], [0, -1, 0], atol=1e-6)
    np.testing.assert_allclose(row["point"], [0, 0, 0], atol=0.01)
    np.testing.assert_allclose(row["force"], [0, -2, 0], atol=0.05)
    assert row["overlap"] == pytest.approx(0.001, rel=0.1) and not row["impulse"].any()
    found = sim.diagnostics
    assert found["contacts"][0] == 1 and abs(found["net_force"][0]).max() < 0.05
    assert found["deepest_overlap"][0] == row["overlap"]
    energy = sim.energy
    assert energy.total == energy.kinetic + energy.potential + energy.spring + energy.contact
    assert energy.contact > 0 and len(energy.momentum) == len(energy.angular_momentum) == 3
    assert sim.max_overlap.bodies is not None and sim.max_overlap.bodies[1] == ("box", 0)
    assert sim.resting_overlap.units == pytest.approx(0.001, rel=0.2)


def test_rays_meet_the_first_body() -> None:
    sim = falling()
    hits = sim.cast_rays([[0, 0, 0], [0, 0, 0], [-5, 10, 0]], [[0, 1, 0], [0, -1, 0], [2, 0, 0]])
    assert hits["kind"].tolist() == ["sphere", "", "sphere"] and hits["index"].tolist() == [0, -1, 0]
    assert hits["distance"].tolist() == [9.5, np.inf, 4.5]
    assert hits["point"][0].tolist() == [0, 9.5, 0] and hits["normal"][2].tolist() == [-1, 0, 0]
    assert sim.cast_rays([0, 0, 0], [0, 1, 0])["index"].tolist() == [0]


def test_profile_measures_the_stages(sim: rf.Simulation) -> None:
    profile = sim.profile(10)
    assert profile.steps == 10 and sim.steps == 10 and profile.seconds > 0 and profile.clock == "host clock"
    assert {stage.phase for stage in profile.stages} >= {"update_aabbs", "broad_phase", "update_positions"}
    assert all(stage.runs > 0 and stage.seconds >= 0 for stage in profile.stages)


def test_ctrl_c_stops_a_long_profile_between_two_steps(sim: rf.Simulation) -> None:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            sim.profile(100_000)
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, before)
    done = sim.steps
    assert 0 < done < 100_000 and sim.profile(300).steps == 300 and sim.steps == done + 300


def test_tables_become_data_frames(sim: rf.Simulation) -> None:
    pandas = pytest.importorskip("pandas")
    sim.add_spheres([[9, 9, 9], [9, 9.9, 9]], 0.5)
    contacts = sim.contacts
    frame = rf.to_pandas(contacts)
    assert isinstance(frame, pandas.DataFrame) and len(frame) == len(contacts) > 0
    assert list(frame)[:7] == ["a_kind", "a", "b_kind", "b", "point_x", "point_y", "point_z"]
    np.testing.assert_array_equal(frame[["normal_x", "normal_y", "normal_z"]], contacts["normal"])
    assert set(frame["b_kind"]) <= {"sphere", "rod", "box"}
    assert list(rf.to_pandas(sim.diagnostics)) == ["contacts", "net_force_x", "net_force_y", "net_force_z", "deepest_overlap"]
    assert len(rf.to_pandas(sim.table("rod"))) == sim.counts.rods
    with pytest.raises(TypeError, match="table: expected a structured array"):
        rf.to_pandas(sim.positions)


def test_ctrl_c_stops_a_long_run_between_two_steps(sim: rf.Simulation) -> None:
    # A program that is started in the background ignores Ctrl-C, and the run would never end.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    start = time.monotonic()
    try:
        with pytest.raises(KeyboardInterrupt):
            sim.run(10**9)
    finally:
        signal.signal(signal.SIGINT, before)
    assert time.monotonic() - start < 5
    steps = sim.steps
    assert steps > 0 and np.isfinite(sim.positions).all()
    sim.step()
    assert sim.steps == steps + 1


def test_other_threads_run_while_a_simulation_steps(sim: rf.Simulation) -> None:
    ticks: list[float] = []
    stop = threading.Event()

    def tick() -> None:
        while not stop.is_set():
            ticks.append(sim.time)
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    sim.run(3000)
    stop.set()
    thread.join()
    under_way = [now for now in ticks if 0 < now < sim.time]
    assert len(set(under_way)) > 1, "the other thread saw the simulation under way"


def test_a_progress_bar_is_shown(sim: rf.Simulation, capsys: pytest.CaptureFixture[str]) -> None:
    sim.run(100, progress=True)
    assert "100" in capsys.readouterr().err
    sim.run(10)
    assert capsys.readouterr().err == ""


def test_progress_without_tqdm(sim: rf.Simulation, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "tqdm.auto", None)
    sim.run(100, progress=True)
    assert "100 of 100 steps" in capsys.readouterr().err


def test_nothing_leaks_over_ten_thousand_runs() -> None:
    def memory() -> int:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * 4096

    def cycle(count: int) -> None:
        for _ in range(count):
            scene = rf.Scene()
            scene.add_spheres([[0, 1, 0], [0, 3, 0]], 0.5)
            sim = rf.Simulation(scene, backend="cpu")
            view = sim.state.positions
            sim.velocities[:] = 1
            sim.run(2)
            assert view.shape == (2, 3)

    cycle(1000)
    before = memory()
    cycle(10_000)
    assert memory() - before < 20e6


def test_centres_have_all_digits_with_double_precision() -> None:
    scene = rf.Scene()
    scene.settings.update(contact_law="hertz-mindlin", gravity=0.0, precision="double")
    scene.add_material("m", density=1000, young=1e6, poisson=0.25)
    scene.add_spheres([[10, 0, 0], [10, 1, 0]], 0.001, mass=None, material="m", velocity=[1e-6, 0, 0])
    sim = rf.Simulation(scene, dt=0.01, backend="cpu")
    assert sim.settings.precision == "double" and sim.centres.dtype == np.float64
    sim.run(10)
    np.testing.assert_allclose(sim.centres[:, 0] - 10.0, 1e-7, rtol=1e-5)
    sim.centres = sim.centres + [0.0, 1e-9, 0.0]
    np.testing.assert_allclose(sim.centres[:, 1] - [0.0, 1.0], 1e-9, rtol=1e-5)
    assert (sim.positions[:, 0] == 10.0).all() and not sim.centres.flags.writeable
    with pytest.raises(ValueError, match="centres: expected"):
        sim.centres = [np.nan, 0.0, 0.0]
    with pytest.raises(TypeError, match="precision: expected the name of a precision"):
        sim.settings.precision = 2  # type: ignore[assignment]
