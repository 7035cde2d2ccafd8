"""Contact laws that a program defines."""

from __future__ import annotations

import pathlib
from typing import Any

import numpy as np
import pytest

import rockfall as rf

DT = 1 / 1024
SOFT = rf.ContactLaw(
    "soft",
    "k * overlap**1.5 + c * speed",
    tangential_stiffness="k * sqrt(overlap)",
    tangential_damping="0.5 * c",
    parameters={"k": 1e4, "c": 2.0},
)


@pytest.fixture
def scene() -> rf.Scene:
    """Two balls that meet off centre with a spin, and a box that they touch."""
    scene = rf.Scene()
    scene.settings.update(gravity=0.0, coulomb_friction=0.5)
    scene.add_spheres([[0, 0, 0], [1, 0.2, 0]], 0.5, mass=2.0, velocity=[[2, 0, 0], [0, 0, 1]])
    scene.add_boxes([-2, -1.5, -2], np.diag([4, 1.01, 4]))
    return scene


def simulation(scene: rf.Scene, law: rf.ContactLaw = SOFT, **options: Any) -> rf.Simulation:
    return rf.Simulation(scene, DT, contact_law=law, **{"backend": "cpu", **options})


def test_expressions_are_translated() -> None:
    def of(expression: str) -> str:
        return rf.ContactLaw("one", expression, parameters={"k": 1.0}).wgsl

    assert of("k * overlap**1.5") == "normal_force = (k * (overlap * sqrt(overlap)));"
    assert of("-k + speed**2 / 3") == "normal_force = ((-k) + ((speed * speed) / 3.0));"
    assert of("overlap**-0.5 + mass**k") == "normal_force = ((1.0 / (sqrt(overlap))) + pow(mass, k));"
    assert of("max(1, k, radius)") == "normal_force = max(max(1.0, k), radius);"
    text = "normal_force = select(0.0, k, (((0.0 < speed) && (speed < 1.0)) || (!((overlap == 0.0)))));"
    assert of("k if 0 < speed < 1 or not overlap == 0 else 0") == text


@pytest.mark.parametrize(
    ("expression", "line", "column", "message"),
    [
        ("k * overlp", 1, 5, "'overlp' is not known here, expected one of: k, mass, overlap, radius, shear, speed, young"),
        ("k * (overlap", 1, 5, "this is no expression of Python: '\\(' was never closed"),
        ("k +\n", 1, 4, "this is no expression of Python"),
        ("  k ** sine(speed)", 1, 8, "this function is not known, expected one of: abs,"),
        ("(k +\n  min(speed))", 2, 3, r"min\(\) takes 2 to 8 arguments, got 1"),
        ("k // 2", 1, 1, "this is not allowed, expected numbers"),
        ("k > 2", 1, 1, "a condition is no number"),
        ("1 if k else 2", 1, 6, "expected a comparison"),
        ("'k'", 1, 1, "expected a number, got 'k'"),
        ("k * 1e39", 1, 5, "this number is out of the range of float32"),
    ],
)
def test_mistakes_in_expressions_show_the_place(expression: str, line: int, column: int, message: str) -> None:
    place = f"contact law 'one', normal_force, line {line}, column {column}: {message}"
    with pytest.raises(ValueError, match=place):
        rf.ContactLaw("one", expression, parameters={"k": 1.0})
    shown = expression.splitlines()[line - 1]
    with pytest.raises(ValueError, match=r"\^") as raised:
        rf.ContactLaw("one", expression, parameters={"k": 1.0})
    assert str(raised.value).endswith(f"\n    {shown}\n    {' ' * (column - 1)}^")


def test_deep_expressions_are_refused() -> None:
    for expression in ("1" + " + 1" * 5000, "-" * 5000 + "1"):
        with pytest.raises(ValueError, match="contact law 'one'"):
            rf.ContactLaw("one", expression)
    with pytest.raises(ValueError, match="too long"):
        rf.ContactLaw("one", "((((overlap**8)**8)**8)**8)**8")


def test_arguments_are_checked(scene: rf.Scene) -> None:
    with pytest.raises(ValueError, match="expected an expression for normal_force, or wgsl, but not both"):
        rf.ContactLaw("one")
    with pytest.raises(ValueError, match="or wgsl, but not both"):
        rf.ContactLaw("one", tangential_damping="1", wgsl="normal_force = 1.0;")
    with pytest.raises(TypeError, match="normal_force: expected a str, got int"):
        rf.ContactLaw("one", 3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="expected two names of materials, got 'a'"):
        rf.ContactLaw("one", "1", pair_parameters={"a": {}})  # type: ignore[dict-item]
    with pytest.raises(TypeError, match=r"contact_law: expected rockfall.ContactLaw, got str"):
        rf.Simulation(scene, contact_law="linear")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="law 'one', line 2, column 16: "):
        simulation(scene, rf.ContactLaw("one", wgsl="let a = 1.0;\nnormal_force = b;"))
    with pytest.raises(ValueError, match="parameter 'k' is given for the material 'ice'; the scene has none"):
        simulation(scene, rf.ContactLaw("one", "k", parameters={"k": 1}, pair_parameters={("ice", "ice"): {"k": 2}}))
    with pytest.raises(ValueError, match="user with the integrator rk4"):
        simulation(scene, integrator="rk4")
    scene.settings.contact_law = "user"
    with pytest.raises(ValueError, match="a scene alone cannot define one"):
        rf.Simulation(scene, integrator="symplectic-euler")


def test_impact_gives_time_and_restitution() -> None:
    impact = rf.ContactLaw("square", "k * overlap**2", parameters={"k": 1e6}).impact(1.0, mass=1.0, radius=0.05)
    assert impact is not None
    depth = (3 / 2e6) ** (1 / 3)
    np.testing.assert_allclose(impact, (2.80436 * depth, depth, 1.0), rtol=2e-3)
    assert rf.ContactLaw("none", "0 * overlap").impact(1.0) is None


def test_backends_agree(scene: rf.Scene) -> None:
    states = []
    for backend in ("cpu", "gpu"):
        sim = simulation(scene, backend=backend)
        assert sim.settings.contact_law == "user"
        assert not sim.settings.collisions
        sim.run(64)
        sim.set_contact_law_parameter("c", 4.0)
        sim.run(64)
        states.append((sim.positions.copy(), sim.angular_momenta.copy()))
    for one, other in zip(*states, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-5)
    assert np.abs(states[0][1]).max() > 1e-3, "friction turns the balls"


def test_parameters_belong_to_pairs() -> None:
    scene = rf.Scene()
    scene.settings.gravity = 0.0
    soft, hard = (scene.add_material(name) for name in ("soft", "hard"))
    scene.add_spheres([[0, 0, 0], [0.875, 0, 0]], 0.5, mass=2.0, material=soft)
    scene.add_spheres([[0, 4, 0], [0.875, 4, 0]], 0.5, mass=2.0, material=hard)
    law = rf.ContactLaw("k", "k * overlap", parameters={"k": 4}, pair_parameters={("hard", "hard"): {"k": 64}})
    sim = simulation(scene, law)

    def stiffness() -> Any:
        before = sim.velocities.copy()
        sim.run(1)
        return ((sim.velocities - before)[1::2, 0] / DT * 2 / 0.125).round(0)

    np.testing.assert_array_equal(stiffness(), [4, 64])
    sim.set_contact_law_parameter("k", 8.0)
    sim.set_contact_law_parameter("k", 32.0, materials=("hard", "hard"))
    np.testing.assert_array_equal(stiffness(), [8, 32])
    present = sim.contact_law
    assert present is not None
    assert (present.parameters, present.pair_parameters) == ({"k": 8.0}, {("hard", "hard"): {"k": 32.0}})
    with pytest.raises(ValueError, match="it has no parameter 'j': it has k"):
        sim.set_contact_law_parameter("j", 1.0)
    with pytest.raises(ValueError, match="the simulation has no contact law of the program"):
        rf.Simulation(rf.Scene()).set_contact_law_parameter("k", 1.0)


def test_results_that_are_not_finite_are_reported(scene: rf.Scene) -> None:
    sim = simulation(scene, rf.ContactLaw("pole", "1 / (overlap - overlap)"))
    with pytest.raises(rf.SimulationError, match="law 'pole', line 1: the normal_force of a contact of sphere .* not finite"):
        sim.run(1)


def test_checkpoints_need_their_law(scene: rf.Scene, tmp_path: pathlib.Path) -> None:
    path = tmp_path / "a.ckpt"
    sim = simulation(scene)
    sim.set_contact_law_parameter("c", 3.0)
    sim.run(40)
    sim.save_checkpoint(path)
    sim.run(40)
    with pytest.raises(ValueError, match=r"law 'soft': the simulation of the checkpoint had this contact law.*contact_law=\.\.\."):
        rf.Simulation.resume(path)
    with pytest.raises(ValueError, match="law 'soft': its WGSL is not that"):
        rf.Simulation.resume(path, contact_law=rf.ContactLaw("soft", "k", parameters={"k": 1, "c": 1}))
    resumed = rf.Simulation.resume(path, contact_law=SOFT)
    resumed.run(40)
    assert np.array_equal(resumed.positions, sim.positions)
    resumed.restore(path)
    resumed.run(40)
    assert np.array_equal(resumed.positions, sim.positions)
