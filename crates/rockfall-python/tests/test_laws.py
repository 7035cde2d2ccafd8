"""Forces that a program defines."""

from __future__ import annotations

import pathlib

import numpy as np
import pytest

import rockfall as rf

DT = 1 / 64


@pytest.fixture
def scene() -> rf.Scene:
    scene = rf.Scene()
    scene.settings.gravity = 0.0
    scene.add_spheres([[1, 0, 0], [-1, 0, 0.5]], [0.5, 0.2], mass=2.0, velocity=[[3, -1, 2], [0, 1, 0]])
    return scene


def simulation(scene: rf.Scene, *laws: rf.ForceLaw) -> rf.Simulation:
    return rf.Simulation(scene, DT, backend="cpu", force_laws=laws)


def test_drag_slows_exponentially(scene: rf.Scene) -> None:
    sim = simulation(scene, rf.ForceLaw("drag", "-c * velocity", parameters={"c": 0.75}))
    before = sim.velocities.copy()
    sim.run(64)
    np.testing.assert_allclose(sim.velocities, before * np.exp(-0.375), rtol=3e-6)


def test_expressions_equal_text(scene: rf.Scene) -> None:
    one = simulation(scene, rf.ForceLaw("swirl", "cross(velocity, position)", torque="-0.1 * angular_velocity"))
    other = simulation(scene)
    other.add_force_law("swirl", wgsl="let v = velocity;\nforce = cross(v, position);\ntorque = -0.1 * angular_velocity;")
    for sim in (one, other):
        sim.run(16)
    assert np.array_equal(one.positions, other.positions)


def test_backends_agree(scene: rf.Scene) -> None:
    law = rf.ForceLaw("trap", "-k * position + vec3f(0.0, cos(time), 0.0)", parameters={"k": 3.0})
    states = []
    for backend in ("cpu", "gpu"):
        sim = rf.Simulation(scene, DT, backend=backend, force_laws=[law])
        sim.run(8)
        sim.set_force_law_parameter("trap", "k", -5.0)
        sim.run(8)
        states.append(sim.positions.copy())
    np.testing.assert_allclose(states[0], states[1], atol=5e-6)


def test_laws_can_be_changed(scene: rf.Scene) -> None:
    sim = simulation(scene)
    sim.add_force_law("push", "vec3f(f, 0.0, 0.0)", parameters={"f": 2.0})
    before = sim.velocities.copy()
    sim.run(1)
    sim.set_force_law_parameter("push", "f", -6.0)
    assert sim.force_laws[0].parameters == {"f": -6.0}
    sim.run(1)
    sim.remove_force_law("push")
    assert sim.force_laws == ()
    sim.run(1)
    np.testing.assert_allclose(sim.velocities - before, [[(1 - 3) * DT, 0, 0]] * 2, atol=1e-6)


def test_errors_show_the_place(scene: rf.Scene) -> None:
    sim = simulation(scene)
    with pytest.raises(ValueError, match=r"law 'trap', line 1, column 14: .*`positon`\n    force = -k \* positon;\n +\^$"):
        sim.add_force_law("trap", "-k * positon", parameters={"k": 1.0})
    with pytest.raises(ValueError, match="law 'trap', line 2, column .*: the type of this value is not that of the variable"):
        rf.Simulation(scene, force_laws=[rf.ForceLaw("trap", wgsl="let a = 1.0;\nforce = a;")])
    with pytest.raises(ValueError, match="there is no force law of this name"):
        sim.set_force_law_parameter("trap", "k", 1.0)
    with pytest.raises(ValueError, match="value: expected a finite number"):
        sim.set_force_law_parameter("trap", "k", np.inf)
    with pytest.raises(TypeError, match=r"parameters\['k'\]: expected a number, got str"):
        rf.ForceLaw("trap", "position", parameters={"k": "1"})  # type: ignore[dict-item]
    with pytest.raises(ValueError, match="expected expressions for force and torque, or wgsl"):
        rf.ForceLaw("trap")
    with pytest.raises(TypeError, match=r"force_laws: expected rockfall.ForceLaw, got str"):
        rf.Simulation(scene, force_laws=["trap"])  # type: ignore[list-item]
    sim.add_force_law("sun", "-position / (length(position) - 1.0)")
    with pytest.raises(rf.SimulationError, match="law 'sun', line 1: the force on sphere number 0 in step 1 is .* not finite"):
        sim.run(1)


def test_checkpoints_need_their_laws(scene: rf.Scene, tmp_path: pathlib.Path) -> None:
    trap = rf.ForceLaw("trap", "-k * position", parameters={"k": 3.0})
    path = tmp_path / "a.ckpt"
    sim = simulation(scene, trap)
    sim.set_force_law_parameter("trap", "k", 4.0)
    sim.run(5)
    sim.save_checkpoint(path)
    sim.run(5)
    with pytest.raises(ValueError, match="law 'trap': the simulation of the checkpoint had this force law"):
        rf.Simulation.resume(path)
    with pytest.raises(ValueError, match="law 'trap': its WGSL is not that"):
        rf.Simulation.resume(path, force_laws=[rf.ForceLaw("trap", "k * position", parameters={"k": 3.0})])
    resumed = rf.Simulation.resume(path, force_laws=[trap])
    resumed.run(5)
    assert np.array_equal(resumed.positions, sim.positions)
    resumed.restore(path)
    resumed.run(5)
    assert np.array_equal(resumed.positions, sim.positions)
