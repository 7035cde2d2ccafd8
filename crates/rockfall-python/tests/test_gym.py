"""Environments of Gymnasium."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import rockfall as rf

OPTIONS: dict[str, Any] = {"backend": "cpu", "frame_skip": 4, "max_steps": 6, "noise": 0.05}
BODIES = [rf.gym.walker(2, 2, 2), rf.gym.walker(3, 1, 2), rf.gym.walker(1, 2, 2)]


@pytest.mark.parametrize("name", ["rockfall/Walker-v0", "rockfall/Cart-v0"])
def test_gymnasium_s_checker_passes(name: str) -> None:
    # It warns of spaces without bounds, and a warning is an error here.
    env = gymnasium.make(name, render_mode="rgb_array", render_size=(64, 48), backend="cpu")
    check_env(env.unwrapped)
    for space in (env.observation_space, env.action_space):
        assert np.isfinite(space.low).all() and np.isfinite(space.high).all()  # type: ignore[attr-defined]
    assert env.unwrapped.worlds.backend.kind == "cpu"  # type: ignore[attr-defined]
    env.reset()
    picture = env.render()
    assert isinstance(picture, np.ndarray) and picture.shape == (48, 64, 3)


def test_gymnasium_makes_vectors() -> None:
    envs = gymnasium.make_vec("rockfall/Walker-v0", num_envs=3, vectorization_mode="vector_entry_point", **OPTIONS)
    observations, infos = envs.reset(seed=3)
    assert envs.observation_space.contains(observations) and infos["centre"].shape == (3, 3)
    found = envs.step(envs.action_space.sample())
    assert envs.observation_space.contains(found[0])
    assert [array.dtype for array in found[1:4]] == [np.float64, np.bool_, np.bool_]
    envs.close()
    assert rf.gym.make_vec(num_envs=1, render_mode="rgb_array", render_size=(32, 24), **OPTIONS).render()[0].shape == (24, 32, 3)


class Twin(gymnasium.Env):  # type: ignore[type-arg]
    """A body in an environment of its own that ends early, with room for the spheres and springs of larger bodies."""

    def __init__(self, body: rf.Scene, like: rf.gym.WorldsVectorEnv, end: float) -> None:
        self.env = rf.gym.make(body, observe=lambda look: pad(look, like), terminate=lambda look: look.times >= end, **OPTIONS)
        self.observation_space, self.action_space = like.single_observation_space, like.single_action_space

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        return self.env.reset(seed=seed)

    def step(self, action: Any) -> Any:
        return self.env.step(action[: self.env.action_space.shape[0]])  # type: ignore[index]


def pad(look: rf.gym.Look, like: rf.gym.WorldsVectorEnv) -> Any:
    """Observations of fewer spheres, with zeros for those that the largest body has in addition."""
    places = look.positions - look.centres[:, None]
    rows = like.worlds.mask.shape[1]
    fill = [(0, 0), (0, rows - places.shape[1]), (0, 0)]
    turns = 2 * np.pi * look.times
    parts = [look.centres[:, 1:2], np.sin(turns)[:, None], np.cos(turns)[:, None]]
    return np.concatenate(parts + [np.pad(part, fill).reshape(len(places), -1) for part in (places, look.velocities)], axis=1)


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_a_vector_behaves_as_gymnasium_s_own_vector_of_single_environments(mode: AutoresetMode) -> None:
    ends = np.array([0.06, 1.0, 0.1])
    ours = rf.gym.make_vec(BODIES, terminate=lambda look: look.times >= ends, autoreset_mode=mode.value, **OPTIONS)
    twins = [lambda body=body, end=end: Twin(body, ours, end) for body, end in zip(BODIES, ends, strict=True)]
    theirs = SyncVectorEnv(twins, autoreset_mode=mode)
    assert ours.metadata["autoreset_mode"] == theirs.metadata["autoreset_mode"] == mode
    assert ours.observation_space == theirs.observation_space and ours.action_space == theirs.action_space
    same(ours.reset(seed=7), theirs.reset(seed=7))
    random = np.random.default_rng(0)
    ended = []
    for _ in range(16):
        actions = random.uniform(-1.2, 1.2, ours.action_space.shape or ())
        found, expected = ours.step(actions), theirs.step(actions)
        same(found, expected)
        done = found[2] | found[3]
        ended.append(done.tolist())
        if mode == AutoresetMode.DISABLED and done.any():
            with pytest.raises(RuntimeError, match="have ended"):
                ours.step(actions)
            same(ours.reset(options={"reset_mask": done}), theirs.reset(options={"reset_mask": done.copy()}), partial=True)
    assert np.any(ended, axis=0).all() and not np.all(ended, axis=0).any()


def same(found: Any, expected: Any, *, partial: bool = False) -> None:
    """Compares results of reset or step, infos too, bit by bit."""
    assert len(found) == len(expected)
    for one, other in zip(found[:-1], expected[:-1], strict=True):
        np.testing.assert_array_equal(one, other)
        assert one.dtype == other.dtype
    assert set(found[-1]) == set(expected[-1])
    for key, value in expected[-1].items():
        if isinstance(value, dict):
            same((found[-1][key],), (value,))
        elif key == "final_obs":
            assert all(np.array_equal(one, other) for one, other in zip(found[-1][key], value, strict=True))
        else:
            np.testing.assert_array_equal(found[-1][key], value)


def test_seeds_decide_over_episodes() -> None:
    def play(seed: Any) -> Any:
        envs = rf.gym.make_vec(num_envs=2, **OPTIONS)
        first, _ = envs.reset(seed=seed)
        for _ in range(8):
            last = envs.step(np.full(envs.action_space.shape or (), 0.5))[0]
        return np.stack([first, last])

    one, again, other, swapped = play(5), play(5), play(6), play([6, 5])
    np.testing.assert_array_equal(one, again)
    np.testing.assert_array_equal(one[:, 1], other[:, 0])
    np.testing.assert_array_equal(one, swapped[:, ::-1])
    assert not np.array_equal(one[0, 0], one[0, 1])


def test_the_gpu_gives_the_same_episodes_in_any_company() -> None:
    options = {**OPTIONS, "backend": "gpu"}
    several, alone = rf.gym.make_vec(BODIES[:2], **options), rf.gym.make(BODIES[0], **options)
    assert several.worlds.report()["workgroup"].all()
    first, single = several.reset(seed=2)[0], alone.reset(seed=2)[0]
    np.testing.assert_array_equal(first[0, : 3 + 24], single[: 3 + 24])
    action = np.linspace(-1, 1, several.single_action_space.shape[0])  # type: ignore[index]
    rewards = several.step([action, action])[1]
    assert rewards[0] == alone.step(action[: alone.action_space.shape[0]])[1] and rewards[0] != 0.0  # type: ignore[index]


def test_rewards_observations_and_ends_are_yours() -> None:
    envs = rf.gym.make_vec(
        num_envs=3,
        observe=lambda look: look.centres,
        reward=lambda before, after, actions: after.centres[:, 1] - before.centres[:, 1] - actions.sum(axis=1),
        terminate=lambda look: np.array([False, True, False]),
        **OPTIONS,
    )
    assert envs.single_observation_space.shape == (3,)
    before, _ = envs.reset(seed=0)
    found, rewards, terminations, truncations, _ = envs.step(np.zeros(envs.action_space.shape or ()))
    np.testing.assert_allclose(rewards, found[:, 1] - before[:, 1], atol=1e-6)
    assert terminations.tolist() == [False, True, False] and not truncations.any()


def test_episodes_are_truncated_after_max_steps() -> None:
    envs = rf.gym.make_vec(num_envs=2, **OPTIONS)
    envs.reset(seed=0)
    found = [envs.step(np.zeros(envs.action_space.shape or ()))[3].tolist() for _ in range(13)]
    # The step after the sixth begins the next episode.
    assert [number for number, truncated in enumerate(found, 1) if all(truncated)] == [6, 13]
    assert envs.worlds.report()["steps"].tolist() == [24, 24]


def test_an_environment_that_is_not_finite_ends() -> None:
    bad = rf.gym.walker(2, 2, 2)
    bad.add_spheres([[0, 3, 0], [0.1, 3, 0]], radius=0.1, mass=1e-30, force=[1e30, 0, 0])
    envs = rf.gym.make_vec([rf.gym.walker(2, 2, 2), bad], noise=0.0, backend="cpu")
    envs.reset(seed=0)
    found, _, terminations, _, _ = envs.step(np.zeros(envs.action_space.shape or ()))
    assert terminations.tolist() == [False, True] and np.isfinite(found).all()
    found, rewards, terminations, _, _ = envs.step(np.zeros(envs.action_space.shape or ()))
    assert rewards[1] == 0.0 and not terminations.any()


WRONG: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"bodies": [rf.Scene(), 5]}, TypeError, "scenes: expected a Scene at place 1"),
    ({"bodies": []}, ValueError, "bodies: expected at least one Scene"),
    ({"bodies": BODIES, "num_envs": 2}, ValueError, "num_envs: expected the number of bodies, 3, got 2"),
    ({"num_envs": 0}, ValueError, "num_envs: expected a whole number of at least 1"),
    ({"strength": 1.5}, ValueError, "strength: expected a number from 0 to 1, got 1.5"),
    ({"frame_skip": 0}, ValueError, "frame_skip"),
    ({"max_steps": 0}, ValueError, "max_steps"),
    ({"noise": -1}, ValueError, "noise: expected numbers that are not negative"),
    ({"dt": "fast"}, TypeError, "dt: expected a number of seconds"),
    ({"autoreset_mode": "Never"}, ValueError, "autoreset_mode: expected one of 'NextStep', 'SameStep', 'Disabled'"),
    ({"render_mode": "human"}, ValueError, "render_mode: expected None or 'rgb_array'"),
    ({"observe": lambda look: np.zeros(3)}, ValueError, r"observe: expected an array of shape \(1, D\), got \(3,\)"),
]


@pytest.mark.parametrize("number", range(len(WRONG)))
def test_errors_name_the_argument(number: int) -> None:
    options, kind, message = WRONG[number]
    with pytest.raises(kind, match=message):
        rf.gym.make_vec(**{"backend": "cpu", **options})


def test_errors_of_reset_and_step_name_the_argument() -> None:
    envs = rf.gym.make_vec(num_envs=2, reward=lambda before, after, actions: 0.0, backend="cpu")
    with pytest.raises(ValueError, match="seed: expected 2 seeds, one per environment, got 1"):
        envs.reset(seed=[1])
    with pytest.raises(ValueError, match=r"options: expected a bool array of shape \(2,\) as reset_mask"):
        envs.reset(options={"reset_mask": [True, False]})
    with pytest.raises(ValueError, match=r"actions: expected shape \(2, 50\) or \(50,\), got \(2, 3\)"):
        envs.step(np.zeros((2, 3)))
    with pytest.raises(ValueError, match=r"reward: expected an array of shape \(2,\), got \(\)"):
        envs.step(np.zeros((2, 50)))
    with pytest.raises(TypeError, match="num_envs: make_vec has this argument"):
        rf.gym.make(num_envs=2)
    with pytest.raises(ValueError, match="length: expected a whole number of at least 1"):
        rf.gym.walker(0)


def test_without_gymnasium_the_error_names_what_to_install() -> None:
    code = """
import sys
sys.modules["gymnasium"] = None
import rockfall as rf
try:
    rf.gym
except ImportError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "pip install 'rockfall[gym]'" in done.stdout


def test_a_picture_before_processes_does_not_break_them() -> None:
    # A forked process cannot use a graphics device that its parent has used.
    code = """
import warnings
import gymnasium as gym
import rockfall.gym
warnings.simplefilter("ignore")
env = gym.make("rockfall/Cart-v0", render_mode="rgb_array", render_size=(64, 36))
env.reset(seed=1)
env.render()
assert env.unwrapped._envs.worlds.backend.kind == "cpu"
envs = gym.make_vec("rockfall/Cart-v0", num_envs=2, vectorization_mode="async", vector_kwargs={"context": "fork"})
envs.reset(seed=1)
print(envs.step(envs.action_space.sample())[1])
envs.close()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300)
    assert "[1. 1.]" in done.stdout, done.stderr


def test_a_single_small_environment_needs_no_graphics_device(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    class Worlds(rf.Worlds):
        def __init__(self, *scenes: Any, backend: Any, **options: Any) -> None:
            asked.append(backend)
            super().__init__(*scenes, backend="cpu", **options)

    monkeypatch.setattr("rockfall._gym_env.Worlds", Worlds)
    rf.gym.make()
    rf.gym.make(backend="gpu")
    rf.gym.make(rf.gym.walker(40))
    rf.gym.make_vec(num_envs=2)
    assert asked == ["cpu", "gpu", "auto", "auto"]
