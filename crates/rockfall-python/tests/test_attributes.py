"""Attributes that do not exist, copies, and pickles."""

from __future__ import annotations

import copy
import pathlib
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import rockfall as rf

WRONG: list[tuple[Callable[[rf.Simulation], Any], str]] = [
    (lambda s: setattr(s, "velocity", 0), "a Simulation has no attribute 'velocity': did you mean velocities"),
    (lambda s: s.velocity, "did you mean velocities"),  # type: ignore[attr-defined]
    (lambda s: setattr(s, "position", 0), "did you mean positions"),
    (lambda s: s.forces, "external_forces"),  # type: ignore[attr-defined]
    (lambda s: s.mass, "did you mean masses"),  # type: ignore[attr-defined]
    (lambda s: setattr(s, "gravity", 20), "did you mean settings.gravity or settings.gravity_direction"),
    (lambda s: setattr(s.scene, "gravity", 20), "a Scene has no attribute 'gravity': did you mean settings.gravity"),
    (lambda s: s.scene.add_marble, r"a Scene has no attribute 'add_marble': .*(add_|help)"),  # type: ignore[attr-defined]
    (lambda s: s.scene.xyzzy, r"a Scene has no attribute 'xyzzy': help\(rockfall.Scene\)"),  # type: ignore[attr-defined]
    (lambda s: setattr(s.settings, "gravty", 1), "a Settings has no attribute 'gravty': did you mean gravity"),
    (lambda s: s.settings.damping, "contact_damping"),  # type: ignore[attr-defined]
    (lambda s: s.settings.update(gravty=1), "gravty: did you mean gravity"),  # type: ignore[call-arg, unused-ignore]
    (lambda s: setattr(s, "run", 5), "run is a method of Simulation"),
    (lambda s: setattr(rf.Worlds(s.scene, count=1, backend="cpu"), "velocity", 0), "a Worlds has no .*did you mean velocities"),
]


KEYWORDS: list[tuple[Callable[[rf.Simulation], Any], str]] = [
    (lambda s: s.scene.copy().add_spheres([0, 1, 0], radius=0.1, color="red"), r"add_spheres\(\) got .* 'color': did you mean colour"),
    (lambda s: s.scene.copy().add_sphere([0, 1, 0], radius=0.1, mas=1), "'mas': did you mean mass"),
    (lambda s: s.scene.copy().add_box([0, 0, 0], [1, 1, 1], color="red"), "did you mean colour"),
    (lambda s: s.render(color_by="speed"), "'color_by': did you mean colour_by"),
    (lambda s: rf.film(s, 3, color_by="speed"), "'color_by': did you mean colour_by"),
    (lambda s: rf.Simulation(s.scene, integrater="rk4"), "did you mean integrator"),
    (lambda s: s.scene.copy().add_spheres([0, 1, 0], radius=0.1, xyzzy=1), "unexpected keyword argument 'xyzzy'$"),
]


@pytest.mark.parametrize("case", range(len(KEYWORDS)))
def test_an_unknown_keyword_is_an_error_that_names_similar_ones(case: int, sim: rf.Simulation) -> None:
    call, message = KEYWORDS[case]
    with pytest.raises(TypeError, match=message):
        call(sim)


@pytest.mark.parametrize("case", range(len(WRONG)))
def test_an_unknown_attribute_is_an_error_that_names_similar_ones(case: int, sim: rf.Simulation) -> None:
    call, message = WRONG[case]
    with pytest.raises(AttributeError, match=message):
        call(sim)


def test_derived_classes_may_have_attributes_of_their_own(scene: rf.Scene) -> None:
    class Mine(rf.Simulation):
        pass

    mine = Mine(scene, backend="cpu")
    mine.note = "mine"  # type: ignore[attr-defined]
    assert mine.note == "mine" and type(mine.copy()) is Mine  # type: ignore[attr-defined]


def state(sim: rf.Simulation) -> bytes:
    return sim.positions.tobytes() + sim.velocities.tobytes() + sim.orientations.tobytes()


COPIES: list[Callable[[Any], Any]] = [lambda sim: sim.copy(), copy.deepcopy, lambda sim: pickle.loads(pickle.dumps(sim))]


@pytest.mark.parametrize("backend", ["cpu", "gpu"])
@pytest.mark.parametrize("make", COPIES)
def test_a_copy_of_a_simulation_is_independent_and_takes_the_same_steps(
    make: Callable[[Any], Any], backend: str, scene: rf.Scene
) -> None:
    sim = rf.Simulation(scene, dt=0.01, backend=backend)
    sim.run(20)
    sim.velocities[:, 0] += 0.25
    twin = make(sim)
    assert (twin.steps, twin.dt, twin.backend.kind) == (20, 0.01, backend)
    before = state(twin)
    sim.run(30)
    assert state(twin) == before
    twin.run(30)
    assert state(twin) == state(sim)


def test_a_copy_keeps_numbers_and_laws(scene: rf.Scene) -> None:
    law = rf.ForceLaw("trap", "-k * position", parameters={"k": 4.0})
    sim = rf.Simulation(scene, dt=0.01, backend="cpu", force_laws=[law])
    sim.remove("sphere", [0, 3])
    sim.set_force_law_parameter("trap", "k", 2.0)
    twin, stored = sim.copy(), pickle.loads(pickle.dumps(sim))
    assert twin.sphere_ids.tolist() == sim.sphere_ids.tolist() and stored.sphere_ids[0] == 0
    with pytest.raises(LookupError):
        twin.set(3, velocity=[0, 0, 0])
    for other in (twin, stored):
        assert other.force_laws[0].parameters == {"k": 2.0}
    for each in (sim, twin, stored):
        each.run(10)
    assert state(sim) == state(twin) == state(stored)


def test_a_shallow_copy_is_an_error_that_names_copy(sim: rf.Simulation) -> None:
    with pytest.raises(TypeError, match=r"call sim.copy\(\)"):
        copy.copy(sim)
    with pytest.raises(TypeError, match=r"call worlds.copy\(\)"):
        copy.copy(rf.Worlds(sim.scene, count=1, backend="cpu"))


def test_scenes_and_worlds_are_copied_and_pickled(scene: rf.Scene, tmp_path: pathlib.Path) -> None:
    for other in (copy.copy(scene), copy.deepcopy(scene), pickle.loads(pickle.dumps(scene)), pickle.loads(pickle.dumps(rf.Scene()))):
        assert other.to_text() in (scene.to_text(), rf.Scene().to_text())
        other.settings.gravity = 3.0
    assert scene.settings.gravity == rf.Scene().settings.gravity
    worlds = rf.Worlds(scene, 0.01, count=3, backend="cpu")
    worlds.velocities = np.linspace(0, 1, 3)[:, None, None] * np.broadcast_to([1.0, 0.0, 0.0], (45, 3))
    worlds.run(20)
    twins = [make(worlds) for make in COPIES]
    worlds.run(20)
    for twin in twins:
        assert twin.dt == worlds.dt and (twin.report()["steps"] == 20).all()
        twin.run(20)
        assert twin.positions.tobytes() == worlds.positions.tobytes()
