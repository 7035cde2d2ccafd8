"""What is found out about worlds."""

from __future__ import annotations

import pathlib
import pickle
import time
import warnings

import numpy as np
import pytest

import rockfall as rf


def pile(count: int) -> rf.Scene:
    """Balls on a floor that overlap a little."""
    scene = rf.Scene()
    scene.settings.update(gravity=9.81, collisions=False, contact_force=8000.0, contact_damping=60.0)
    scene.add_box([-5, -1, -5], [5, 0, 5])
    scene.add_spheres(np.arange(count)[:, None] * [0.0, 0.99, 0.0] + [0, 0.49, 0], 0.5, velocity=[0.3, 0, 0])
    return scene


@pytest.mark.parametrize("backend", ["cpu", "gpu"])
def test_energies_and_contacts_are_those_of_simulations(backend: str) -> None:
    scenes = [pile(3), pile(5), rf.Scene()]
    worlds = rf.Worlds(scenes, dt=0.001, backend=backend)  # type: ignore[arg-type]
    for steps in (0, 40):
        worlds.run(steps)
        energies = worlds.energies
        assert energies.shape == (3,) and energies["total"][2] == 0.0
        for world, scene in enumerate(scenes[:2]):
            sim = rf.Simulation(scene, dt=0.001, backend=backend)  # type: ignore[arg-type]
            sim.run(steps)
            for name in ("kinetic", "potential", "spring", "contact", "total", "momentum", "angular_momentum"):
                assert energies[name][world].tolist() == np.array(getattr(sim.energy, name)).tolist(), name
            contacts = worlds.contacts(world)
            assert contacts.tobytes() == sim.contacts.tobytes() and len(contacts) > 0
    assert len(rf.to_pandas(energies)) == 3
    with pytest.raises(LookupError, match="there is no world 3"):
        worlds.contacts(3)


@pytest.mark.parametrize("backend", ["cpu", "gpu"])
def test_a_simulation_goes_on_where_a_world_is(backend: str) -> None:
    worlds = rf.Worlds([pile(2), pile(4)], dt=0.001, backend=backend)  # type: ignore[arg-type]
    worlds.run(30)
    sim = worlds.simulation(1)
    assert (sim.steps, sim.dt, sim.backend.kind) == (30, 0.001, backend)
    sim.run(20)
    worlds.run(20)
    assert sim.positions.tobytes() == worlds.positions[1].tobytes() and sim.time == worlds.report()["time"][1]


def test_each_world_has_the_integrator_of_its_scene() -> None:
    other = pile(2)
    other.run = rf.RunDefaults(dt=0.001, integrator="velocity-verlet")
    worlds = rf.Worlds([pile(2), other], dt=0.001, backend="cpu")
    assert worlds.integrator == "auto"
    assert [worlds.simulation(world).integrator for world in (0, 1)] == ["rk4", "velocity-verlet"]
    assert rf.Worlds([pile(2)], backend="cpu", integrator="auto").integrator == "rk4"


def warned(worlds: rf.Worlds, steps: int = 1) -> list[str]:
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        worlds.run(steps)
    return [str(warning.message) for warning in found if warning.category is rf.SceneWarning]


def test_unsuitable_time_steps_are_warned_of_once() -> None:
    stiff = rf.Scene()
    a, b = stiff.add_spheres([[0, 0, 0], [1, 0, 0]], 0.1)
    stiff.add_spring(a, b, 1e6)
    # Worlds are not searched for bodies that fall for ever.
    expected = [text for text in stiff.check(0.1) if "fall for ever" not in text]
    assert expected
    worlds = rf.Worlds([rf.Scene(), stiff, stiff], dt=0.1, backend="cpu", keep_going=True)
    assert warned(worlds, 0) == []
    assert warned(worlds) == [f"time step 0.1 s: {text} (in 2 of 3 worlds, first in world 1)" for text in expected]
    assert warned(worlds) == [] and warned(worlds.copy()) == [] and warned(pickle.loads(pickle.dumps(worlds))) == []
    worlds.dt = 1e-5
    assert warned(worlds) == []
    worlds.dt = 0.1
    assert len(warned(worlds)) == len(expected)
    worlds.replace([1, 2], [rf.Scene(), rf.Scene()])
    assert warned(worlds) == []
    worlds.replace(0, stiff)
    assert "(in world 0)" in warned(worlds)[0]
    assert warned(rf.Worlds([stiff], dt=0.1, backend="cpu", keep_going=True, check=False)) == []
    many = rf.Worlds(stiff, dt=0.1, count=150, backend="cpu", keep_going=True)
    assert "(in 50 of 50 worlds that were checked, first in world 0)" in warned(many)[0]


def test_checkpoints_keep_the_time_step(tmp_path: pathlib.Path) -> None:
    worlds = rf.Worlds([pile(2)], dt=0.003, backend="cpu")
    worlds.save_checkpoint(tmp_path / "a.ckpt")
    assert rf.Worlds.resume(tmp_path / "a.ckpt").dt == 0.003
    assert rf.Worlds.resume(tmp_path / "a.ckpt", dt=0.01).dt == 0.01
    worlds.dt = 0.004
    worlds.save_checkpoint(tmp_path / "a.ckpt")
    assert rf.Worlds.resume(tmp_path / "a.ckpt").dt == 0.004 == worlds.copy().dt


def test_pictures_of_worlds_are_those_of_simulations_and_as_fast() -> None:
    worlds = rf.Worlds([pile(2), pile(5)], dt=0.001, backend="cpu")
    worlds.run(100)
    for world in (0, 1, 0):
        sim = worlds.simulation(world)
        for options in ({"colour_by": "speed"}, {"clock": True, "label": True}):
            picture = worlds.render(world, (96, 54), **options)  # type: ignore[arg-type]
            np.testing.assert_array_equal(picture.numpy(), sim.render((96, 54), **options).numpy())  # type: ignore[arg-type]

    def seconds(render: object) -> float:
        start = time.process_time()
        render()  # type: ignore[operator]
        return time.process_time() - start

    sim = worlds.simulation(0)
    sim.render((96, 54))
    own = min(seconds(lambda: sim.render((96, 54))) for _ in range(5))
    assert min(seconds(lambda: worlds.render(0, (96, 54))) for _ in range(5)) < 2 * own + 0.01
