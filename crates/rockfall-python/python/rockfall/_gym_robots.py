"""Environments of robots: bodies with joints, and motors that actions drive."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rockfall._arrays import FloatArray
from rockfall._gym_actions import Motor
from rockfall._gym_bodies import Look, Start, upright
from rockfall._gym_env import WorldEnv, WorldsVectorEnv
from rockfall._gym_scenes import ANKLE, ANT_HEIGHT, HOPPER_HEIGHT, LEGS, ant, cart_pole, hopper
from rockfall._scene import Scene

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rockfall._options import EnvOptions, VectorOptions

_Bools = npt.NDArray[np.bool_]
_Doubles = npt.NDArray[np.float64]

#: Bodies of a hopper and of an ant whose places count: their torsos.
_HOPPER_TORSO, _ANT_TORSO = 2, 0
#: Angles of the joints of an ant in its scene, as Gymnasium counts them, in rad.
_BENT = np.array([angle for _, _, sign in LEGS for angle in (0.0, sign * ANKLE)])


# The cart

def _cart_start(random: np.random.Generator) -> Start:
    numbers = random.uniform(-0.05, 0.05, 4)
    return Start(positions=numbers[[0, 2]], speeds=numbers[[1, 3]])


def _cart_state(look: Look) -> FloatArray:
    """Place and velocity of the cart, angle of the pole and its rate."""
    found: FloatArray = np.stack([look.joints.positions, look.joints.speeds], axis=2).reshape(-1, 4)
    return found


def _cart_is_lost(look: Look) -> _Bools:
    place, angle = look.joints.positions.T
    lost: _Bools = (np.abs(place) > 2.4) | (np.abs(angle) > np.radians(12.0))
    return lost


# The hopper

def _hopper_start(random: np.random.Generator) -> Start:
    return Start(positions=random.uniform(-5e-3, 5e-3, 6), speeds=random.uniform(-5e-3, 5e-3, 6))


def _hopper_state(look: Look) -> FloatArray:
    """Height and angle of the torso, angles of thigh, leg and foot, and the rates of all joints up to 10."""
    places = look.joints.positions[:, 1:] + np.array([HOPPER_HEIGHT, 0, 0, 0, 0], np.float32)
    found: FloatArray = np.concatenate([places, np.clip(look.joints.speeds, -10.0, 10.0)], axis=1)
    return found


def _hopper_falls(look: Look) -> _Bools:
    _, lift, turn = look.joints.positions[:, :3].T
    rest = np.concatenate([look.joints.positions[:, 2:], look.joints.speeds], axis=1)
    stands: _Bools = (lift + HOPPER_HEIGHT > 0.7) & (np.abs(turn) < 0.2) & (np.abs(rest) < 100.0).all(axis=1)
    return ~stands


def _hopper_reward(before: Look, after: Look, actions: FloatArray) -> _Doubles:
    moved = _speed(before, after, _HOPPER_TORSO)
    found: _Doubles = moved + ~_hopper_falls(after) - 1e-3 * np.square(actions, dtype=np.float64).sum(axis=1)
    return found


# The ant

def _ant_start(random: np.random.Generator) -> Start:
    places, speeds = random.uniform(-0.1, 0.1, 15), 0.1 * random.standard_normal(14)
    turn = places[3:7] + [1.0, 0.0, 0.0, 0.0]
    return Start(
        positions=places[7:],
        speeds=speeds[6:],
        place=places[:3] + [0.0, ANT_HEIGHT, 0.0],
        turn=turn / np.sqrt(np.square(turn).sum()),
        velocity=speeds[:3],
        spin=speeds[3:6],
    )


def _upward(vectors: FloatArray) -> FloatArray:
    """Vectors with y up as those with z up."""
    found: FloatArray = np.stack([vectors[..., 0], -vectors[..., 2], vectors[..., 1]], axis=-1)
    return found


def _seen_from(turns: FloatArray, vectors: FloatArray) -> FloatArray:
    """Vectors in coordinates of bodies with these orientations."""
    scalar, axis = turns[:, :1], -turns[:, 1:]
    twice = 2.0 * np.cross(axis, vectors)
    return (vectors + scalar * twice + np.cross(axis, twice)).astype(np.float32)


def _ant_state(look: Look) -> FloatArray:
    """Height, orientation, angles of the joints, velocity, angular velocity and rates of the joints, with z up."""
    bodies = look.bodies
    turns, spins = bodies.orientations[:, _ANT_TORSO], bodies.spins[:, _ANT_TORSO]
    # q and -q are the same orientation.
    turns = np.where(turns[:, :1] < 0.0, -turns, turns)
    parts = [
        bodies.positions[:, _ANT_TORSO, 1:2],
        turns[:, :1],
        _upward(turns[:, 1:]),
        look.joints.positions + _BENT,
        _upward(bodies.velocities[:, _ANT_TORSO]),
        _upward(_seen_from(turns, spins)),
        look.joints.speeds,
    ]
    return np.concatenate(parts, axis=1).astype(np.float32)


def _ant_falls(look: Look) -> _Bools:
    height = look.bodies.positions[:, _ANT_TORSO, 1]
    stands: _Bools = (height >= 0.2) & (height <= 1.0)
    return ~stands


def _ant_reward(before: Look, after: Look, actions: FloatArray) -> _Doubles:
    moved = _speed(before, after, _ANT_TORSO)
    found: _Doubles = moved + ~_ant_falls(after) - 0.5 * np.square(actions, dtype=np.float64).sum(axis=1)
    return found


def _speed(before: Look, after: Look, body: int) -> _Doubles:
    """Mean velocity of a body along x in a step, in units/s."""
    places = [look.bodies.positions[:, body, 0].astype(np.float64) for look in (before, after)]
    found: _Doubles = (places[1] - places[0]) / (after.times - before.times)
    return found


_CART_POLE: dict[str, Any] = {
    "dt": 0.02,
    "frame_skip": 1,
    "max_steps": 500,
    "motors": (Motor("slide", 10.0),),
    "choices": [[-1.0], [1.0]],
    "start": _cart_start,
    "observe": _cart_state,
    "reward": upright,
    "terminate": _cart_is_lost,
    "bounds": ([-4.8, -100.0, -0.42, -100.0], [4.8, 100.0, 0.42, 100.0]),
}
_HOPPER: dict[str, Any] = {
    "dt": 0.008,
    "frame_skip": 1,
    "max_steps": 1000,
    "motors": tuple(Motor(name, 60.0, fastest=10.0) for name in ("thigh", "leg", "foot")),
    "start": _hopper_start,
    "observe": _hopper_state,
    "reward": _hopper_reward,
    "terminate": _hopper_falls,
    "bounds": 100.0,
}
_ANT: dict[str, Any] = {
    "dt": 1 / 60,
    "frame_skip": 3,
    "max_steps": 1000,
    "motors": tuple(Motor(f"{kind}_{leg}", 3.0, fastest=10.0) for leg in (4, 1, 2, 3) for kind in ("hip", "ankle")),
    "start": _ant_start,
    "observe": _ant_state,
    "reward": _ant_reward,
    "terminate": _ant_falls,
    "bounds": 100.0,
}


class CartPoleEnv(WorldEnv):
    """A cart on a rail with a pole to balance: the environment ``rockfall/CartPole-v0``, after CartPole-v1 of Gymnasium.

    The action is 0 for a force of -10 N on the cart along x, or 1 for 10 N. Observations are the place of the cart in m, its
    velocity in m/s, the angle of the pole in rad and its rate in rad/s. They begin between -0.05 and 0.05. The reward is 1
    for each step of 0.02 s. An episode ends when the cart is more than 2.4 m from the middle or the pole leans by more than
    12 degrees.

    Different from CartPole-v1: a step is one frame of the solver, not one of Euler, and bounds of velocities are finite.
    Options are those of :class:`WorldsVectorEnv`.
    """

    def __init__(self, body: Scene | None = None, **options: Unpack[EnvOptions]) -> None:
        merged: Any = {**_CART_POLE, **options}
        super().__init__(cart_pole() if body is None else body, **merged)


class CartPoleVectorEnv(WorldsVectorEnv):
    """Environments as :class:`CartPoleEnv` that step together."""

    def __init__(
        self, bodies: Scene | Sequence[Scene] | None = None, num_envs: int | None = None, **options: Unpack[VectorOptions]
    ) -> None:
        merged: Any = {**_CART_POLE, **options}
        super().__init__(cart_pole() if bodies is None else bodies, num_envs, **merged)


class HopperEnv(WorldEnv):
    """A leg that hops: the environment ``rockfall/Hopper-v0``, after Hopper-v5 of Gymnasium.

    The action has three numbers from -1 to 1: the torques of thigh, leg and foot. Observations are 11 numbers: height of the
    torso in m, angles of torso, thigh, leg and foot in rad, and the rates of the place along x, of the height and of these
    angles, from -10 to 10. All begin within 0.005 of the scene. A step takes 0.008 s. The reward is the velocity along x in
    m/s, and 1 while it is healthy, less 0.001 times the sum of the squares of the action. It is healthy while the torso is
    higher than 0.7 m and leans by less than 0.2 rad, and all other numbers are less than 100. Otherwise the episode ends.

    Different from Hopper-v5: the greatest torque is 60 N m and not 200, up to 10 rad/s, because the joints have no armature
    and no damping. The torso is on two carriers of 0.1 kg. Friction with the ground is 2 everywhere. Options are those of
    :class:`WorldsVectorEnv`.
    """

    def __init__(self, body: Scene | None = None, **options: Unpack[EnvOptions]) -> None:
        merged: Any = {**_HOPPER, **options}
        super().__init__(hopper() if body is None else body, **merged)


class HopperVectorEnv(WorldsVectorEnv):
    """Environments as :class:`HopperEnv` that step together."""

    def __init__(
        self, bodies: Scene | Sequence[Scene] | None = None, num_envs: int | None = None, **options: Unpack[VectorOptions]
    ) -> None:
        merged: Any = {**_HOPPER, **options}
        super().__init__(hopper() if bodies is None else bodies, num_envs, **merged)


class AntEnv(WorldEnv):
    """A ball that walks on four legs: the environment ``rockfall/Ant-v0``, after Ant-v5 of Gymnasium.

    The action has eight numbers from -1 to 1: the torques of hip_4, ankle_4, hip_1, ankle_1, hip_2, ankle_2, hip_3 and ankle_3.
    Observations are 27 numbers with z up: height of the torso in m, its orientation w, x, y, z, the angles of hip_1, ankle_1
    and so on to ankle_4 in rad, the velocity of the torso in m/s, its angular velocity in its own coordinates in rad/s, and
    the rates of the joints. Places and angles begin within 0.1 of the scene, and velocities have a standard deviation of 0.1.
    A step takes 0.05 s. The reward is the velocity along x in m/s, and 1 while it is healthy, less half the sum of the
    squares of the action. It is healthy while the torso is between 0.2 and 1 m high. Otherwise the episode ends.

    Different from Ant-v5: there are no contact forces in observations and no contact cost. The greatest torque is 3 N m and not
    150, up to 10 rad/s, because the joints have no armature and no damping. A step has 3 frames of 1/60 s. Options are those of
    :class:`WorldsVectorEnv`.
    """

    def __init__(self, body: Scene | None = None, **options: Unpack[EnvOptions]) -> None:
        merged: Any = {**_ANT, **options}
        super().__init__(ant() if body is None else body, **merged)


class AntVectorEnv(WorldsVectorEnv):
    """Environments as :class:`AntEnv` that step together."""

    def __init__(
        self, bodies: Scene | Sequence[Scene] | None = None, num_envs: int | None = None, **options: Unpack[VectorOptions]
    ) -> None:
        merged: Any = {**_ANT, **options}
        super().__init__(ant() if bodies is None else bodies, num_envs, **merged)
