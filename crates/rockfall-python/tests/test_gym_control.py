"""Environments whose actions are forces, their bounds, and films of them."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest

import rockfall as rf
from rockfall.gym import Force

OPTIONS: dict[str, Any] = {"backend": "cpu", "dt": 0.01, "frame_skip": 5, "noise": 0.0}
SIZE = (96, 54)


def balls() -> rf.Scene:
    """Two balls in empty space, on one of which a force acts already."""
    scene = rf.Scene()
    scene.settings.gravity = 0
    scene.add_spheres([[0, 0, 0], [3, 0, 0]], 0.5, mass=2.0, force=[[0, 0, 1], [0, 0, 0]])
    return scene


def test_actions_are_forces() -> None:
    forces = [Force(0, [0, 2, 0], 4.0), Force([0, 1], [1, 0, 0], 6.0), Force(1, [0, 0, 1], 8.0, against=0)]
    envs = rf.gym.make_vec(balls(), 2, forces=forces, **OPTIONS)
    assert envs.single_action_space.shape == (3,)
    envs.reset(seed=0)
    envs.step([[1.0, 0.0, 0.0], [0.0, -0.5, 9.0]])
    expected = [[[0, 4, 1], [0, 0, 0]], [[-1.5, 0, 1 - 8], [-1.5, 0, 8]]]
    np.testing.assert_allclose(envs.worlds.external_forces, expected)
    np.testing.assert_allclose(envs.worlds.velocities, np.array(expected) / 2.0 * 0.05, rtol=1e-5, atol=1e-7)
    # Forces of the body stay, and those of actions end with the next one.
    envs.step(np.zeros((2, 3)))
    np.testing.assert_allclose(envs.worlds.external_forces, 2 * [[[0, 0, 1], [0, 0, 0]]])


def test_springs_and_forces_act_together() -> None:
    body = rf.gym.walker(2, 1, 1)
    env = rf.gym.make(body, forces=[Force(0)], **OPTIONS)
    assert env.action_space.shape == (2,)
    env.reset(seed=0)
    env.step([1.0, -1.0])
    assert env.worlds.rest_lengths[0, 0] == pytest.approx(0.625) and env.worlds.external_forces[0, 0, 0] == -1.0
    only = rf.gym.make(body, muscles=False, forces=[Force(1)], **OPTIONS)
    only.reset(seed=0)
    only.step([0.5])
    assert only.action_space.shape == (1,) and only.worlds.rest_lengths[0, 0] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({"forces": [5]}, TypeError, r"forces: expected a rockfall\.gym\.Force at place 0, got int"),
        ({"forces": [Force(2)]}, LookupError, r"forces\[0\].spheres: there is no sphere 2 in every body"),
        ({"forces": [Force(0), Force(0, against=9)]}, LookupError, r"forces\[1\].against: there is no sphere 9"),
        ({"forces": [Force(0, [0, 0, 0])]}, ValueError, r"forces\[0\].direction: expected a vector that is not zero"),
        ({"forces": [Force([])]}, ValueError, r"forces\[0\].spheres: expected at least one sphere"),
        ({}, ValueError, "muscles, forces: expected springs or forces that actions change, got none"),
        ({"forces": [Force(0)], "bounds": ([0.0], [0.0])}, ValueError, "bounds: expected values that are greater"),
    ],
)
def test_wrong_forces_and_bounds_are_named(options: dict[str, Any], kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        rf.gym.make(balls(), **OPTIONS, **options)


def test_observations_stay_in_their_bounds() -> None:
    options: dict[str, Any] = {**OPTIONS, "forces": [Force(0)], "observe": lambda look: 100 * look.centres}
    env = rf.gym.make(balls(), bounds=([-1, -2, -3], [4, 5, 6]), **options)
    assert env.observation_space == gymnasium.spaces.Box(np.float32([-1, -2, -3]), np.float32([4, 5, 6]))  # type: ignore[arg-type]
    assert env.reset(seed=0)[0].tolist() == [4, 0, 0]
    assert rf.gym.make(balls(), bounds=7.0, **options).observation_space.high.tolist() == [7, 7, 7]  # type: ignore[attr-defined]


def balance(observation: np.ndarray) -> np.ndarray:
    """A force that holds the pole upright and the cart near the origin."""
    x, v, angle, rate = observation.T
    return np.clip(np.stack([0.1 * x + 0.2 * v + 2.0 * angle + 0.5 * rate], axis=-1), -1, 1)  # type: ignore[no-any-return]


def test_a_cart_is_balanced_by_a_policy_and_falls_without() -> None:
    name, options = "rockfall/Cart-v0", {"num_envs": 4, "vectorization_mode": "vector_entry_point", "backend": "cpu"}
    lengths = []
    for policy in (balance, lambda found: np.zeros((4, 1))):
        envs = gymnasium.make_vec(name, **options)  # type: ignore[arg-type]
        observation, _ = envs.reset(seed=3)
        assert observation.shape == (4, 4) and envs.single_action_space.shape == (1,)
        ends = np.zeros(4, int)
        for step in range(1, 501):
            observation, rewards, terminations, truncations, _ = envs.step(policy(observation))
            first = (terminations | truncations) & (ends == 0)
            ends[first] = step
            if (ends > 0).all():
                break
        lengths.append(ends.tolist())
    assert lengths[0] == [500] * 4 and max(lengths[1]) < 300, lengths


def test_an_episode_is_filmed() -> None:
    env = gymnasium.make("rockfall/Cart-v0", backend="cpu", max_steps=25)
    film = rf.gym.film(env, balance, fps=25, seed=1, size=SIZE, plain=True)
    # 25 steps of 0.02 s.
    assert len(film) == 13 and not np.array_equal(film[0].numpy(), film[12].numpy())
    assert env.unwrapped.worlds.report()["steps"].tolist() == [100]  # type: ignore[attr-defined]
    # It shows what the same actions give without a film.
    twin = gymnasium.make("rockfall/Cart-v0", backend="cpu", max_steps=25)
    observation, _ = twin.reset(seed=1)
    for _ in range(25):
        observation = twin.step(balance(observation))[0]
    mine, theirs = (one.unwrapped.worlds.positions.tobytes() for one in (env, twin))  # type: ignore[attr-defined]
    assert mine == theirs
    # The film ends with the episode. Vectors, and random actions.
    short = rf.gym.film(rf.gym.CartEnv(backend="cpu"), lambda found: [1.0], size=SIZE)
    assert 1 < len(short) < 60
    envs = rf.gym.make_vec(num_envs=2, backend="cpu", max_steps=4)
    assert len(rf.gym.film(envs, steps=3, fps=100, world=1, size=SIZE, progress=True)) == 16
    with pytest.raises(TypeError, match="env: expected an environment of rockfall"):
        rf.gym.film(5)  # type: ignore[arg-type]
    with pytest.raises(LookupError, match="there is no world 2"):
        rf.gym.film(envs, world=2)
