"""Environments of robots: a cart with a pole, a hopper and an ant."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import rockfall as rf

NAMES = ["rockfall/CartPole-v0", "rockfall/Hopper-v0", "rockfall/Ant-v0"]
VECTORS = {"CartPole": rf.gym.CartPoleVectorEnv, "Hopper": rf.gym.HopperVectorEnv, "Ant": rf.gym.AntVectorEnv}
SCENES = {"CartPole": rf.gym.cart_pole, "Hopper": rf.gym.hopper, "Ant": rf.gym.ant}
#: The force of a linear-quadratic regulator on the cart, per unit of place, velocity, angle and rate. For the linear
#: equations of a cart of 1 kg with a rod of 0.1 kg and 1 m, steps of 0.02 s, costs of 1, 1, 10 and 1 for the squares of these
#: and 0.1 for that of the force.
GAINS = np.array([2.776, 5.221, 45.343, 11.740])


def vector(name: str, count: int, **options: Any) -> Any:
    return VECTORS[name](None, count, **{"backend": "cpu", **options})


@pytest.mark.parametrize("name", NAMES)
def test_gymnasium_s_checker_passes(name: str) -> None:
    env = gymnasium.make(name, render_mode="rgb_array", render_size=(64, 48))
    check_env(env.unwrapped)
    assert env.unwrapped.worlds.backend.kind == "cpu"  # type: ignore[attr-defined]
    assert np.isfinite(env.observation_space.high).all()  # type: ignore[attr-defined]
    env.reset(seed=1)
    picture = env.render()
    assert isinstance(picture, np.ndarray) and picture.shape == (48, 64, 3) and picture.std() > 1


def test_spaces_are_those_of_gymnasium_s_environments() -> None:
    env: Any = rf.gym.CartPoleEnv()
    assert env.action_space == gymnasium.spaces.Discrete(2) and env.observation_space.shape == (4,)
    hopper, ant = rf.gym.HopperEnv(), rf.gym.AntEnv()
    assert hopper.action_space.shape == (3,) and hopper.observation_space.shape == (11,)
    assert ant.action_space.shape == (8,) and ant.observation_space.shape == (27,)
    assert hopper.worlds.masses.sum() == pytest.approx(15.82 + 0.2, abs=0.02)
    assert ant.worlds.masses.sum() == pytest.approx(0.911, abs=1e-3)
    first = ant.reset(seed=3)[0]
    np.testing.assert_allclose(first[5:13], [0, 1, 0, -1, 0, -1, 0, 1], atol=0.11)
    assert first[0] == pytest.approx(0.75, abs=0.11) and np.linalg.norm(first[1:5]) == pytest.approx(1.0, abs=1e-5)
    start = hopper.reset(seed=3)[0]
    np.testing.assert_allclose(start, [1.25] + [0] * 10, atol=5.1e-3)


def test_a_free_pole_falls_as_the_linear_pendulum() -> None:
    worlds = rf.Worlds(rf.gym.cart_pole(), 0.02, count=2, backend="cpu")
    lean = np.array([0.002, -0.001])
    worlds.place_joints(np.stack([np.zeros(2), lean], axis=1))
    rate = np.sqrt(9.81 / (0.5 * (4 / 3 - 0.1 / 1.1)))
    for frame in range(1, 31):
        worlds.run(1)
        expected = lean * np.cosh(rate * 0.02 * frame)
        np.testing.assert_allclose(worlds.joints.positions[:, 1], expected, rtol=0.03)
    # The common centre of mass stays where it is along x.
    place, angle = worlds.joints.positions.T
    np.testing.assert_allclose(place + 0.1 * 0.5 * np.sin(angle) / 1.1, 0.1 * 0.5 * np.sin(lean) / 1.1, atol=2e-6)


def test_a_linear_controller_balances_the_pole() -> None:
    envs = vector("CartPole", 8)
    observations, _ = envs.reset(seed=0)
    for step in range(1, 501):
        observations, rewards, terminations, truncations, _ = envs.step((observations @ GAINS > 0.0).astype(np.int64))
        assert not terminations.any() and (rewards == 1.0).all() and truncations.all() == (step == 500)
    # With forces in place of a choice it stands still.
    env: Any = rf.gym.CartPoleEnv(choices=None)
    found, _ = env.reset(seed=0)
    for _ in range(500):
        found, _, terminated, _, _ = env.step([found @ GAINS / 10.0])
        assert not terminated
    assert np.abs(found).max() < 2e-3


def test_a_pole_without_a_controller_is_lost() -> None:
    envs = vector("CartPole", 2)
    envs.reset(seed=0)
    steps = next(step for step in range(60) if envs.step(np.array([1, 0]))[2].any())
    assert 5 <= steps <= 14
    with pytest.raises(ValueError, match="actions: expected whole numbers below 2, got 2"):
        envs.step(np.array([2, 0]))
    with pytest.raises(TypeError, match="actions: expected integers"):
        envs.step(np.array([0.5, 0.5]))


@pytest.mark.parametrize("name", NAMES)
def test_a_vector_gives_the_bits_of_single_environments(name: str) -> None:
    made = [
        gymnasium.make_vec(name, num_envs=3, vectorization_mode=mode, backend="cpu", max_steps=40)
        for mode in ("vector_entry_point", "sync")
    ]
    ours, theirs = (envs.reset(seed=11)[0] for envs in made)
    np.testing.assert_array_equal(ours, theirs)
    made[0].action_space.seed(4)
    ends = 0
    for _ in range(60):
        actions = made[0].action_space.sample()
        one, other = (envs.step(actions) for envs in made)
        for mine, own in zip(one[:4], other[:4], strict=True):
            np.testing.assert_array_equal(mine, own)
        ends += int((one[2] | one[3]).sum())
    assert ends >= 3


@pytest.mark.parametrize("name", list(VECTORS))
def test_the_reset_of_some_leaves_the_others_bit_for_bit(name: str) -> None:
    envs, others = (vector(name, 4, autoreset_mode="Disabled", terminate=None) for _ in range(2))
    for made in (envs, others):
        made.reset(seed=2)
        made.action_space.seed(1)
    actions = [envs.action_space.sample() for _ in range(12)]
    mask = np.array([False, True, False, True])
    for step, action in enumerate(actions):
        if step == 6:
            begun, _ = envs.reset(options={"reset_mask": mask})
            assert not np.array_equal(begun[1], begun[3])
        found, expected = envs.step(action)[0], others.step(action)[0]
        np.testing.assert_array_equal(found[~mask], expected[~mask])
        assert step < 6 or not np.array_equal(found[mask], expected[mask])


def test_rewards_are_those_of_gymnasium_s_formulas() -> None:
    hopper = vector("Hopper", 2)
    hopper.reset(seed=0)
    before = hopper.worlds.bodies.positions[:, 2, 0]
    actions = np.array([[0.5, -0.5, 0.25], [0.0, 0.0, 0.0]], np.float32)
    _, rewards, terminations, _, infos = hopper.step(actions)
    speed = (hopper.worlds.bodies.positions[:, 2, 0] - before) / 0.008
    np.testing.assert_allclose(rewards, speed + 1.0 - 1e-3 * (actions**2).sum(axis=1), atol=1e-5)
    assert not terminations.any() and infos["centre"][0, 1] == pytest.approx(0.6, abs=0.01)

    ant = vector("Ant", 2)
    ant.reset(seed=0)
    before = ant.worlds.bodies.positions[:, 0, 0]
    actions = np.random.default_rng(1).uniform(-1, 1, (2, 8)).astype(np.float32)
    rewards = ant.step(actions)[1]
    speed = (ant.worlds.bodies.positions[:, 0, 0] - before) / 0.05
    np.testing.assert_allclose(rewards, speed + 1.0 - 0.5 * (actions**2).sum(axis=1), atol=1e-5)


def test_a_hopper_that_does_nothing_falls_and_ends() -> None:
    envs = vector("Hopper", 2)
    envs.reset(seed=0)
    steps = next(step for step in range(400) if envs.step(np.zeros((2, 3)))[2].all())
    assert steps > 20


def test_an_ant_stands_on_its_legs() -> None:
    env: Any = rf.gym.AntEnv()
    env.reset(seed=0)
    for _ in range(100):
        found, _, terminated, _, _ = env.step(np.tile([0.0, 0.0], 4))
        assert not terminated
    assert 0.2 < found[0] < 0.75
    # It does not sink into the ground, and it is at rest.
    assert np.abs(found[13:]).max() < 0.05 and env.worlds.bodies.positions[0, :, 1].min() > 0.05


def spin_about_the_centre(worlds: rf.Worlds) -> Any:
    """Angular momenta about the centres of mass."""
    energies = worlds.energies
    return energies["angular_momentum"] - np.cross(worlds.centres, energies["momentum"])


def test_momenta_of_an_ant_in_free_fall() -> None:
    worlds = rf.Worlds(rf.gym.ant(), 1 / 60, count=3, backend="cpu")
    worlds.set_bodies(bodies=0, positions=[[0, 50, 0]])
    worlds.place_joints(np.random.default_rng(0).uniform(-0.1, 0.1, (3, 8)), np.random.default_rng(1).uniform(-3, 3, (3, 8)))
    before = worlds.energies
    worlds.run(6)
    free = worlds.energies
    np.testing.assert_allclose(free["total"], before["total"], rtol=2e-3)
    mass = worlds.masses.sum(axis=1)
    worlds.set_joint_forces(np.random.default_rng(2).uniform(-3, 3, (3, 8)))
    worlds.run(6)
    driven = worlds.energies
    np.testing.assert_allclose(driven["momentum"], free["momentum"] - np.outer(mass, [0, 0.1 * 9.81, 0]), atol=2e-3)
    # About the centre of mass, motors change no angular momentum.
    spin = spin_about_the_centre(worlds)
    worlds.run(6)
    np.testing.assert_allclose(spin_about_the_centre(worlds), spin, atol=2e-3)
    assert (np.abs(worlds.energies["kinetic"] - driven["kinetic"]) > 1e-2).all()


def test_episodes_of_robots_are_filmed() -> None:
    env: Any = rf.gym.HopperEnv()
    film = rf.gym.film(env, lambda observation: np.zeros(3), steps=6, fps=25, seed=1, size=(64, 48))
    assert len(film) >= 1


def test_motors_starts_and_choices_are_yours() -> None:
    scene = rf.gym.cart_pole()
    options: dict[str, Any] = {"muscles": False, "dt": 0.02, "frame_skip": 1, "backend": "cpu"}
    start = rf.gym.Start(positions=[0.5, 0.0], speeds=[1.0, 0.0])
    envs = rf.gym.make_vec(
        scene, 2, motors=[rf.gym.Motor(0, 5.0, fastest=1.5)], choices=[[0.0], [1.0], [-1.0]], start=lambda random: start,
        observe=lambda look: look.joints.speeds, reward=lambda before, after, actions: actions[:, 0], **options,
    )  # fmt: skip
    first, _ = envs.reset(seed=0)
    np.testing.assert_allclose(first, [[1.0, 0.0], [1.0, 0.0]], atol=1e-6)
    found, rewards, _, _, _ = envs.step([1, 2])
    assert rewards.tolist() == [1.0, -1.0] and found[0, 0] > 1.05 and found[1, 0] < 0.95
    for _ in range(30):
        found = envs.step([1, 0])[0]
    assert found[0, 0] == pytest.approx(1.5, abs=0.05)
    with pytest.raises(ValueError, match="expected springs or forces"):
        rf.gym.make_vec(scene, 2, **options)
    wrong: list[tuple[Any, type[Exception], str]] = [
        (5, TypeError, r"motors: expected a rockfall\.gym\.Motor at place 0, got int"),
        (rf.gym.Motor(7), LookupError, r"motors\[0\].joint: there is no joint 7 in every body"),
        (rf.gym.Motor("wheel"), LookupError, r"motors\[0\].joint: expected a joint in the same place of every body"),
        (rf.gym.Motor(0, fastest=0.0), ValueError, r"motors\[0\].fastest: expected numbers greater than 0"),
    ]
    for motor, kind, message in wrong:
        with pytest.raises(kind, match=message):
            rf.gym.make_vec(scene, 2, motors=[motor], **options)
    with pytest.raises(ValueError, match=r"choices: expected an array of shape \(C, 1\), got \(1,\)"):
        rf.gym.make_vec(scene, 2, motors=[rf.gym.Motor(0)], choices=[1.0], **options)


@pytest.mark.parametrize("name", list(SCENES))
def test_scenes_can_be_changed_and_have_no_concerns(name: str) -> None:
    scene = SCENES[name]()
    assert scene.check(1 / 60) is not None
    scene.settings.gravity = 1.62
    envs: Any = VECTORS[name](scene, 2, backend="cpu")
    envs.reset(seed=0)
    assert np.isfinite(envs.step(envs.action_space.sample())[0]).all()


def test_a_robot_of_a_file_becomes_an_environment(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text("""
<mujoco><worldbody><body name="arm" pos="0 0 2">
  <joint name="shoulder" type="hinge" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -1" size="0.05"/>
</body></worldbody></mujoco>""")
    envs = rf.gym.make_vec(
        rf.load_mjcf(path), 3, dt=1 / 60, frame_skip=2, motors=[rf.gym.Motor("shoulder", 40.0)], backend="cpu",
        observe=lambda look: np.concatenate([look.joints.positions, look.joints.speeds], axis=1),
        reward=lambda before, after, actions: after.bodies.positions[:, 0, 2],
    )  # fmt: skip
    observations, _ = envs.reset(seed=0)
    assert not observations.any()
    observations, rewards, _, _, _ = envs.step([[1.0], [0.0], [-1.0]])
    assert observations[0, 0] > 0.005 and observations[2, 0] < -0.005 and abs(observations[1, 0]) < 1e-6
    np.testing.assert_allclose(rewards[[0, 2]], rewards[0], rtol=1e-5)
