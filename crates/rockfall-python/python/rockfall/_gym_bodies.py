"""Bodies for environments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from rockfall._arrays import FloatArray, IntArray, whole
from rockfall._look import number
from rockfall._scene import Scene
from rockfall._world_mechanisms import WorldBodies, WorldJoints
from rockfall._worlds import Worlds

#: Distance of a cart from the origin, in units, and angle of its pole, in rad, that end an episode.
_FAR, _LEANS = 2.4, 0.5


@dataclass(frozen=True)
class Look:
    """The states of all worlds at one time. W is the number of worlds and N the largest number of spheres in one."""

    #: Centres of the spheres of shape (W, N, 3), in units; 0 for spheres that do not exist.
    positions: FloatArray
    #: Velocities of the spheres of shape (W, N, 3), in units/s.
    velocities: FloatArray
    #: Which spheres exist, bool of shape (W, N).
    mask: npt.NDArray[np.bool_]
    #: Centres of mass of shape (W, 3), in units.
    centres: npt.NDArray[np.float64]
    #: Times since the start of each episode, of shape (W,), in s.
    times: npt.NDArray[np.float64]
    #: What the joints do: positions and speeds of shape (W, J), and more.
    joints: WorldJoints
    #: States of the rigid bodies: positions of shape (W, B, 3) in units, and more.
    bodies: WorldBodies


@dataclass(frozen=True)
class Start:
    """How a mechanism begins an episode. What is None stays as in the scene."""

    #: Positions of the joints of shape (J,), in rad or units (:meth:`Worlds.place_joints`); or one number for all.
    positions: npt.ArrayLike | None = None
    #: Rates of the positions of shape (J,), in rad/s or units/s.
    speeds: npt.ArrayLike = 0.0
    #: Centre of mass of the first rigid body of shape (3,), in units.
    place: npt.ArrayLike | None = None
    #: Its orientation, a unit quaternion w, x, y, z of shape (4,).
    turn: npt.ArrayLike | None = None
    #: Velocity of its centre of shape (3,), in units/s.
    velocity: npt.ArrayLike | None = None
    #: Its angular velocity of shape (3,), in rad/s.
    spin: npt.ArrayLike | None = None


def begin(worlds: Worlds, numbers: IntArray, starts: Sequence[Start]) -> None:
    """Lets each of some worlds begin in its own way. All starts give the same of their fields."""
    names = {"positions": "place", "orientations": "turn", "velocities": "velocity", "spins": "spin"}
    rows = {name: [getattr(start, field) for start in starts] for name, field in names.items()}
    given: dict[str, Any] = {name: np.stack(row)[:, None] for name, row in rows.items() if row[0] is not None}
    if given:
        worlds.set_bodies(numbers, 0, **given)
    if starts[0].positions is not None:
        shape = (len(worlds.joints),)
        positions = np.stack([np.broadcast_to(np.asarray(start.positions), shape) for start in starts])
        speeds = np.stack([np.broadcast_to(np.asarray(start.speeds), shape) for start in starts])
        worlds.place_joints(positions, speeds, numbers)


def walker(length: int = 3, width: int = 2, height: int = 2, *, stiffness: float = 1500.0) -> Scene:
    """A body to begin with: spheres on a lattice of length x height x width points, joined by springs, on level ground.

    The lattice has a spacing of 0.5 units. Springs run along the edges of its cells, and along the diagonals of faces and
    cells. Their stiffness is in mass/s². Gravity points down the y axis.
    """
    numbers = [whole(name, value, least=1) for name, value in (("length", length), ("height", height), ("width", width))]
    scene = Scene()
    scene.settings.update(gravity=9.81, collisions=False, contact_force=8000.0, contact_damping=60.0, friction=16000.0)
    scene.add_box([-200, -1, -200], [200, 0, 200])
    corners = np.stack(np.meshgrid(*(np.arange(number) for number in numbers), indexing="ij"), -1).reshape(-1, 3)
    places = (corners - [0.5 * (numbers[0] - 1), 0, 0.5 * (numbers[2] - 1)]) * 0.5 + [0, 0.12, 0]
    balls = scene.add_spheres(places, radius=0.12)
    a, b = np.triu_indices(len(balls), 1)
    near = np.linalg.norm(places[a] - places[b], axis=1) < 0.875
    if near.any():
        scene.add_springs(balls[a[near]], balls[b[near]], stiffness=stiffness, damping=8.0)
    return scene


def cart(pole: float = 1.0, *, mass: float = 0.1) -> Scene:
    """A cart with a pole to balance: two balls on level ground, on which a third one stands by springs.

    The balls 0 and 1 are the wheels of the cart, and ball 2 is the top of the pole, ``pole`` units above it. The pole turns about the
    line through the wheels, along z. Rods of free length show the axle and the pole. The ground has no friction, and gravity points
    down the y axis.
    """
    height = number("pole", pole, positive=True)
    scene = Scene()
    scene.settings.update(gravity=9.81, collisions=False, contact_force=8000.0, contact_damping=60.0, friction=0.0)
    scene.add_box([-200, -1, -200], [200, 0, 200])
    radius = 0.15
    places = [[0, radius, -0.25], [0, radius, 0.25], [0, radius + height, 0]]
    balls = scene.add_spheres(places, radius=[radius, radius, 0.1], mass=[0.5, 0.5, mass], look="plain", colour="#39424e")
    scene.set_tag("sphere", balls[2], look="plain", colour="#d2483f")
    wood = "#c9a25e"
    scene.add_springs(balls[[0, 0, 1]], balls[[1, 2, 2]], stiffness=[4000, 1000, 1000], damping=[20, 2, 2], colour=wood)
    scene.add_rods(balls[[0, 0, 1]], balls[[1, 2, 2]], radius=[0.11, 0.04, 0.04], length=0, colour=wood)
    return scene


def tilt(look: Look) -> FloatArray:
    """What describes a cart: place in units and velocity in units/s along x, angle of the pole in rad and its rate in rad/s."""
    middle, speed = (array[:, :2].mean(axis=1) for array in (look.positions, look.velocities))
    pole, rate = look.positions[:, 2] - middle, look.velocities[:, 2] - speed
    square = pole[:, 0] ** 2 + pole[:, 1] ** 2
    turns = (rate[:, 0] * pole[:, 1] - rate[:, 1] * pole[:, 0]) / np.where(square > 0, square, 1)
    found: FloatArray = np.stack([middle[:, 0], speed[:, 0], np.arctan2(pole[:, 0], pole[:, 1]), turns], axis=1)
    return found


def is_lost(look: Look) -> npt.NDArray[np.bool_]:
    """Whether a cart is too far from the origin, or its pole leans too much."""
    found = tilt(look)
    lost: npt.NDArray[np.bool_] = (np.abs(found[:, 0]) > _FAR) | (np.abs(found[:, 2]) > _LEANS)
    return lost


def upright(before: Look, after: Look, actions: FloatArray) -> npt.NDArray[np.float64]:
    """1 for each step."""
    return np.ones(len(after.times))


def surroundings(look: Look, clock: float) -> FloatArray:
    """Height of the centre of mass, sin and cos of a clock, and positions from the centre and velocities of the spheres."""
    count = len(look.times)
    turns = 2.0 * np.pi * clock * look.times
    places = np.where(look.mask[:, :, None], look.positions - look.centres[:, None, :], 0.0)
    parts = [look.centres[:, 1:2], np.sin(turns)[:, None], np.cos(turns)[:, None]]
    parts += [places.reshape(count, -1), look.velocities.reshape(count, -1)]
    return np.concatenate(parts, axis=1).astype(np.float32)
