"""Materials, pairs, contact laws and muscles: the same scenes as from text, bit for bit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rockfall as rf

TEXT = """
set contact_law hertz-mindlin
set gravity 9.81
@material glass density=2500 young=5e7 poisson=0.2
@material steel density=7800 young=2e8 poisson=0.3
@pair glass steel restitution=0.9 friction=0.3 characteristic_velocity=0.5
@pair glass glass restitution=0.8 friction=0.2 rolling_friction=0.1 rolling_damping=0.5 surface_energy=0.05 cohesion=jkr
@pair steel steel friction=0.4 rolling_friction=0.05 rolling_model=a twisting_friction=0.1
@use steel
B -5 -1 -5 10 0 0 0 1 0 0 0 10
@use glass
S 0 0 0.3125 0 0.5 0 0 0 0 0 - 0.25 0
S 1 0.625 0.3125 0 0 0 0 0 0 0 - 0.25 0
@use steel
S 2 0.3125 0.8125 0.125 0 -1 0 0 0 0 - 0.2 0
P -5 0 -5 10 0 0 0 5 0
@use -
"""


def built() -> rf.Scene:
    scene = rf.Scene()
    scene.settings.update(contact_law="hertz-mindlin", gravity=9.81)
    glass = scene.add_material("glass", density=2500, young=5e7, poisson=0.2)
    steel = scene.add_material("steel", density=7800, young=2e8, poisson=0.3)
    assert (glass, steel) == (0, 1)
    scene.set_pair("glass", steel, restitution=0.9, friction=0.3, characteristic_velocity=0.5)
    scene.set_pair(
        glass,
        glass,
        restitution=0.8,
        friction=0.2,
        rolling_friction=0.1,
        rolling_damping=0.5,
        surface_energy=0.05,
        cohesion="jkr",
    )
    scene.set_pair("steel", "steel", friction=0.4, rolling_friction=0.05, rolling_model="a", twisting_friction=0.1)
    scene.add_box([-5, -1, -5], [5, 0, 5], material="steel")
    scene.add_spheres(
        [[0, 0.3125, 0], [0.625, 0.3125, 0], [0.3125, 0.8125, 0.125]],
        radius=[0.25, 0.25, 0.2],
        mass=None,
        velocity=[[0.5, 0, 0], [0, 0, 0], [0, -1, 0]],
        material=["glass", "glass", "steel"],
    )
    scene.add_polygons([-5, 0, -5], [10, 0, 0], [0, 5, 0], material=steel)
    return scene


def test_a_built_scene_with_materials_is_that_of_the_text() -> None:
    # The positions are exact in single precision. Text keeps further digits of others, and arrays do not.
    parsed, scene = rf.Scene.parse(TEXT), built()
    assert scene.to_text() == parsed.to_text()
    assert scene.table("sphere")["material"].tolist() == [0, 0, 1]
    assert scene.table("box")["material"].tolist() == scene.table("polygon")["material"].tolist() == [1]
    sims = [rf.Simulation(of, dt=1e-4, backend="cpu", integrator="symplectic-euler") for of in (scene, parsed)]
    for sim in sims:
        sim.run(2000)
    assert sims[0].positions.tolist() == sims[1].positions.tolist()
    assert np.ptp(sims[0].velocities) > 0.1


def test_contacts_of_laws_with_history_have_tangential_forces() -> None:
    scene = rf.Scene()
    scene.settings.update(contact_law="hertz-mindlin", gravity=9.81, gravity_direction=(0.3, -1, 0))
    scene.add_material("glass", density=2500, young=5e7, poisson=0.2)
    scene.set_pair("glass", "glass", restitution=0.3, friction=0.5, rolling_friction=0.5)
    scene.add_box([-5, -1, -5], [5, 0, 5], material="glass")
    scene.add_sphere([0, 0.25, 0], radius=0.25, mass=None, material="glass")
    sim = rf.Simulation(scene, dt=2e-5, backend="cpu", integrator="symplectic-euler")
    sim.run(20000)
    (contact,) = sim.contacts
    # The ball rests on the ground: the ground carries its weight, and static friction holds it.
    weight = sim.masses[0] * 9.81 / np.sqrt(1.09)
    assert contact["normal_force"] == pytest.approx(weight, rel=0.01)
    assert np.linalg.norm(contact["tangential_force"]) == pytest.approx(0.3 * weight, rel=0.01)
    assert contact["slip"] == 0 and np.linalg.norm(contact["displacement"]) > 0
    assert contact["force"] == pytest.approx(contact["tangential_force"] + contact["normal_force"] * contact["normal"], rel=1e-4, abs=1e-4)
    thesis = rf.Simulation(rf.Scene.parse("S 1 0 0.4 0 0 0 0 0 0 0 1 0.5 0\nB -5 -1 -5 10 0 0 0 1 0 0 0 10\n"), backend="cpu")
    assert thesis.contacts["slip"].tolist() == [-1] and not thesis.contacts["displacement"].any()


def test_materials_and_pairs_are_read_back() -> None:
    scene = built()
    assert scene.materials[0] == rf.Material("glass", 2500.0, 5e7, pytest.approx(0.2))
    assert scene.pair("steel", "glass")[:3] == (pytest.approx(0.9), pytest.approx(0.3), None)
    glass = rf.Pair(*map(pytest.approx, [0.8, 0.2, None, None, 0.1, 0.5, None, 0.05]), None, "jkr")
    assert scene.pair(None, 0) == scene.pair(0, 0) == glass
    assert scene.pair(0, 1).characteristic_velocity == 0.5
    assert scene.pair(1, 1).rolling_model == "a" and scene.pair(1, 1).twisting_friction == pytest.approx(0.1)
    assert scene.pair(None, None) == rf.Pair(None, None, None)
    scene.update_material("glass", young=6e7)
    assert scene.materials[0].young == 6e7 and scene.materials[0].density == 2500.0
    scene.set_pair(0, 1, stiffness=100)
    assert scene.pair(0, 1).stiffness == 100.0


def test_rods_and_capsules_have_materials() -> None:
    text = (
        "@material wood density=600\n@use wood\nC 0 1 0 0 2 0 0 0 0 - 0.5\n"
        "S 2 3 0 0 0 0 0 0 0 0 - 0.5 0\nS 3 5 0 0 0 0 0 0 0 0 - 0.5 0\nR 2 3 0.1 2\n"
    )
    scene = rf.Scene()
    scene.add_material("wood", density=600)
    scene.add_capsules([0, 1, 0], [0, 2, 0], radius=0.5, mass=None, material=0)
    balls = scene.add_spheres([[3, 0, 0], [5, 0, 0]], radius=0.5, mass=None, material=[0, 0])
    scene.add_rod(*balls, 0.1, 2, material="wood")
    assert scene.to_text() == rf.Scene.parse(text).to_text()
    assert scene.table("rod")["material"].tolist() == [0, 0]


def test_muscles_are_those_of_the_text() -> None:
    text = (
        "S 0 0 0 0 0 0 0 0 0 0 1 0.1 0\nS 1 1 0 0 0 0 0 0 0 0 1 0.1 0\nS 2 2 0 0 0 0 0 0 0 0 1 0.1 0\n"
        "K 0 1 100 1 0.5\n@muscle 0.2 1.5 0.25\nK 1 2 100 1 0.5\nK 0 2 50 2 0\n@muscle -0.1 2 0\n"
    )
    scene = rf.Scene()
    balls = scene.add_spheres([[0, 0, 0], [1, 0, 0], [2, 0, 0]], radius=0.1)
    scene.add_springs(balls[:2], balls[1:], 100, damping=0.5, muscle=[[0.2, 1.5, 0.25], [0, 0, 0]])
    last = scene.add_spring(0, 2, 50, muscle=[-0.1, 2, 0])
    parsed = rf.Scene.parse(text)
    assert scene.to_text() == parsed.to_text()
    np.testing.assert_array_equal(scene.table("spring")["muscle"], np.float32([[0.2, 1.5, 0.25], [0, 0, 0], [-0.1, 2, 0]]))
    sims = [rf.Simulation(of, dt=0.01, backend="cpu") for of in (scene, parsed)]
    for sim in sims:
        sim.run(200)
    assert sims[0].positions.tolist() == sims[1].positions.tolist() and np.abs(sims[0].velocities).max() > 0.01
    scene.update_springs([0, last], muscle=[[0, 0, 0], [0.3, 1, 0]])
    assert "@muscle 0.3 1 0" in scene.to_text() and scene.to_text().count("@muscle") == 1
    sims[0].update_springs(0, muscle=[0.1, 1, 0])
    assert sims[0].table("spring")["muscle"][0].tolist() == pytest.approx([0.1, 1, 0])


def test_simulations_take_materials_between_steps() -> None:
    sim = rf.Simulation(rf.Scene(), backend="cpu")
    sim.add_material("rubber", density=1100)
    sim.set_pair(0, 0, restitution=0.7)
    sim.add_spheres([[0, 0, 0]], radius=0.5, mass=None, material="rubber")
    sim.run(2)
    assert sim.masses[0] == pytest.approx(1100 * 4 / 3 * np.pi / 8) and sim.materials[0].name == "rubber"


WRONG: list[tuple[Any, type[Exception], str]] = [
    (lambda s: s.add_material("two words"), ValueError, "material.name"),
    (lambda s: s.add_material("m"), ValueError, "material.name.*a name that no other material has"),
    (lambda s: s.add_material(5), TypeError, "name: expected a str, got int"),
    (lambda s: s.add_material("n", density="heavy"), TypeError, "density: expected real numbers"),
    (lambda s: s.add_material("n", density=-1), ValueError, "material.density"),
    (lambda s: s.add_material("n", poisson=0.5), ValueError, "material.poisson"),
    (lambda s: s.update_material("x", young=1), LookupError, "material: there is no material 'x', expected one of: m"),
    (lambda s: s.update_material(None, young=1), TypeError, "material: expected the number or the name"),
    (lambda s: s.set_pair(0, 4), LookupError, "there is no material 4"),
    (lambda s: s.set_pair(0, 0, restitution=2), ValueError, "pair.restitution"),
    (lambda s: s.set_pair(0, 0, surface_energy=-1), ValueError, "pair.surface_energy"),
    (lambda s: s.set_pair(0, 0, rolling_model="b"), ValueError, "pair.rolling_model.*a or c"),
    (lambda s: s.set_pair(0, 0, cohesion="glue"), ValueError, "pair.cohesion.*dmt or jkr"),
    (lambda s: s.set_pair(0, 0, cohesion=2), TypeError, "cohesion: expected a str"),
    (lambda s: s.set_pair(0, 0, rolling_model=1), TypeError, "rolling_model: expected a str"),
    (lambda s: s.set_pair([0, 0], 0), TypeError, "one: expected the number or the name of a material"),
    (lambda s: s.add_spheres([0, 0, 0], 1, material=1), LookupError, "there is no material 1"),
    (lambda s: s.add_spheres([0, 0, 0], 1, material=-1), ValueError, "material: expected numbers of materials from 0, got -1"),
    (lambda s: s.add_spheres([0, 0, 0], 1, material="n"), LookupError, "material: there is no material 'n'"),
    (lambda s: s.add_spheres([0, 0, 0], 1, material=0.5), TypeError, "material: expected numbers or names"),
    (lambda s: s.add_spheres(np.zeros((2, 3)), 1, material=["m"] * 3), ValueError, "material: expected 2 rows .* got 3"),
    (lambda s: s.add_spheres([0, 0, 0], 1, None, material="m"), ValueError, "row 0: mass: .* a material with a density"),
    (lambda s: s.add_capsules([0, 0, 0], [1, 0, 0], 1, None), ValueError, "row 0: mass: .* a material with a density"),
    (lambda s: s.add_spring(0, 1, 1, muscle=[2, 1, 0]), ValueError, "row 0: muscle.amplitude"),
    (lambda s: s.add_springs([0, 0], [1, 1], 1, muscle=[[0.1, 1, 0], [0.1, -1, 0]]), ValueError, "row 1: muscle.frequency"),
    (lambda s: s.add_spring(0, 1, 1, muscle=[0.1, 1]), ValueError, r"muscle: expected shape \(1, 3\) or \(3,\)"),
]


@pytest.mark.parametrize("number", range(len(WRONG)))
def test_errors_name_the_argument_and_change_nothing(number: int) -> None:
    call, kind, message = WRONG[number]
    scene = rf.Scene()
    scene.add_material("m")
    scene.add_spheres([[0, 0, 0], [1, 0, 0]], radius=0.1)
    before = scene.to_text()
    with pytest.raises(kind, match=message):
        call(scene)
    assert scene.to_text() == before


def test_set_pair_changes_what_it_is_given_and_keeps_the_rest() -> None:
    scene = rf.Scene()
    scene.add_material("sand", density=2500, young=1e7, poisson=0.25)
    scene.set_pair("sand", "sand", restitution=0.25, friction=0.5, rolling_model="a", cohesion="jkr")
    scene.set_pair("sand", "sand", friction=0.75, rolling_friction=0.125)
    pair = scene.pair("sand", "sand")
    assert (pair.restitution, pair.friction, pair.rolling_friction) == (0.25, 0.75, 0.125)
    assert (pair.rolling_model, pair.cohesion) == ("a", "jkr")
    # What is not set for a pair is still mixed from both materials.
    scene.add_material("steel", density=7800, young=1e8, poisson=0.25)
    scene.set_pair("sand", "steel", friction=0.1)
    scene.set_pair("sand", "sand", restitution=0.5)
    assert scene.pair("sand", "steel").restitution == 0.5
