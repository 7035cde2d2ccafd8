"""Creatures in worlds as environments of Gymnasium: ``pip install 'rockfall[gym]'``.

Each environment is a world with a body of spheres and springs, or with a robot. Actions set rest lengths of the springs, its
muscles, forces on the spheres (:class:`Force`) and torques of joints (:class:`Motor`). All environments of a vector step
together, on all cores or on the GPU.

>>> import rockfall as rf
>>> envs = rf.gym.make_vec(num_envs=16)
>>> observations, infos = envs.reset(seed=1)
>>> observations, rewards, terminations, truncations, infos = envs.step(envs.action_space.sample())
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

try:
    import gymnasium
except ImportError as error:
    raise ImportError("rockfall.gym needs Gymnasium: pip install 'rockfall[gym]'") from error

from rockfall._attributes import keywords
from rockfall._film import Film
from rockfall._filming import Live, Shot
from rockfall._gym_actions import Force, Motor
from rockfall._gym_bodies import Look, Start, cart, is_lost, tilt, upright, walker
from rockfall._gym_env import WorldEnv, WorldsVectorEnv
from rockfall._gym_robots import AntEnv, AntVectorEnv, CartPoleEnv, CartPoleVectorEnv, HopperEnv, HopperVectorEnv
from rockfall._gym_scenes import ant, cart_pole, hopper
from rockfall._look import look
from rockfall._progress import Progress
from rockfall._scene import Scene

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rockfall._options import EnvOptions, PictureOptions, VectorOptions

__all__ = [
    "AntEnv", "AntVectorEnv", "CartEnv", "CartPoleEnv", "CartPoleVectorEnv", "CartVectorEnv", "Force", "HopperEnv",
    "HopperVectorEnv", "Look", "Motor", "Start", "WorldEnv", "WorldsVectorEnv", "ant", "cart", "cart_pole", "film", "hopper",
    "make", "make_vec", "walker",
]

#: Options of environments with a cart. Observations are place and velocity of the cart, angle of the pole and its rate.
_CART: dict[str, Any] = {
    "frame_skip": 4,
    "max_steps": 500,
    "muscles": False,
    "forces": (Force([0, 1], [1, 0, 0], 10.0),),
    "observe": tilt,
    "reward": upright,
    "terminate": is_lost,
    "bounds": ([-10.0, -100.0, -np.pi, -100.0], [10.0, 100.0, np.pi, 100.0]),
}


class CartEnv(WorldEnv):
    """A cart with a pole to balance (:func:`cart`): the environment ``rockfall/Cart-v0``.

    The action is the force on the cart along x, from -1 to 1 for -10 to 10 mass units/s². Observations are the place of the cart in
    units, its velocity in units/s, the angle of the pole in rad and its rate in rad/s. The reward is 1 for each step. An episode
    ends when the cart is more than 2.4 units from the origin or the pole leans by more than 0.5 rad. Options are those of
    :class:`WorldsVectorEnv`.
    """

    def __init__(self, body: Scene | None = None, **options: Unpack[EnvOptions]) -> None:
        merged: Any = {**_CART, **options}
        super().__init__(cart() if body is None else body, **merged)


class CartVectorEnv(WorldsVectorEnv):
    """Environments as :class:`CartEnv` that step together."""

    def __init__(
        self, bodies: Scene | Sequence[Scene] | None = None, num_envs: int | None = None, **options: Unpack[VectorOptions]
    ) -> None:
        merged: Any = {**_CART, **options}
        super().__init__(cart() if bodies is None else bodies, num_envs, **merged)


def make_vec(
    bodies: Scene | Sequence[Scene] | None = None, num_envs: int | None = None, **options: Unpack[VectorOptions]
) -> WorldsVectorEnv:
    """Environments that step together, one world each. Arguments are those of :class:`WorldsVectorEnv`."""
    return WorldsVectorEnv(bodies, num_envs, **options)


def make(body: Scene | None = None, **options: Unpack[EnvOptions]) -> WorldEnv:
    """A single environment. The arguments are those of :class:`WorldsVectorEnv` without ``num_envs`` and ``autoreset_mode``."""
    return WorldEnv(body, **options)


@keywords
def film(
    env: gymnasium.Env[Any, Any] | WorldsVectorEnv,
    policy: Callable[[Any], Any] | None = None,
    steps: int | None = None,
    fps: int = 25,
    *,
    world: int = 0,
    seed: int | None = None,
    size: tuple[int, int] = (1280, 720),
    speed: float | None = None,
    follow: int | str | None = None,
    orbit: float = 0.0,
    trails: float | str = 0.0,
    progress: bool = False,
    **options: Unpack[PictureOptions],
) -> Film:
    """Begin an episode and film it, up to its end.

    Parameters
    ----------
    env : gymnasium.Env or WorldsVectorEnv
        An environment of this module, which may be wrapped, or a vector of them.
    policy : callable, optional
        ``policy(observation)`` returns the action; of a vector, those of all environments. By default, actions are random.
    steps : int, optional
        Greatest number of steps of the environment; by default its ``max_steps``.
    fps, size, speed, follow, orbit, trails, progress, **options
        As for :func:`rockfall.film`. The camera fits the start of the episode, unless it is given.
    world : int
        Number of the environment of a vector that is filmed.
    seed : int, optional
        As for ``env.reset``.

    Returns
    -------
    Film
        The film, in memory. Between two pictures is the same time, also within a step of the environment.

    Raises
    ------
    ValueError, TypeError, LookupError
        As for :func:`rockfall.film`.
    """
    base = getattr(env, "unwrapped", env)
    envs = base._envs if isinstance(base, WorldEnv) else base
    if not isinstance(envs, WorldsVectorEnv):
        raise TypeError(f"env: expected an environment of rockfall.gym, got {type(base).__name__}")
    place = envs.worlds._world(world)
    count = envs._max_steps if steps is None else steps
    shown = look(size, trails=trails, **options)
    shot = Shot.checked(shown, count, envs.worlds.dt, fps, speed, follow, orbit).stretched(envs._frame_skip)
    observation, _ = env.reset(seed=seed)
    envs._live = Live(shot, lambda: envs.worlds._alone(place))
    try:
        with Progress(int(count) if progress else None) as bar:
            for _ in range(int(count)):
                action = env.action_space.sample() if policy is None else policy(observation)
                observation, _, terminations, truncations, _ = env.step(action)
                bar.advance(1)
                if np.ravel(terminations)[place] or np.ravel(truncations)[place]:
                    break
        return Film(envs._live.end(), shot.fps, shown["size"])
    finally:
        envs._live = None


for _name, _env, _vector in (
    ("Walker", "WorldEnv", "WorldsVectorEnv"),
    ("Cart", "CartEnv", "CartVectorEnv"),
    ("CartPole", "CartPoleEnv", "CartPoleVectorEnv"),
    ("Hopper", "HopperEnv", "HopperVectorEnv"),
    ("Ant", "AntEnv", "AntVectorEnv"),
):
    gymnasium.register(
        f"rockfall/{_name}-v0", entry_point=f"rockfall.gym:{_env}", vector_entry_point=f"rockfall.gym:{_vector}"
    )
