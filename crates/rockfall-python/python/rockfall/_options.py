"""Types of keyword arguments that several functions pass on. Only type checkers use them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, TypedDict

import numpy as np
import numpy.typing as npt

from rockfall._arrays import FloatArray
from rockfall._materials import Materials
from rockfall.typing import (
    BackendName,
    BodyName,
    ColourName,
    ContactLawName,
    GoalName,
    IntegratorName,
    LookName,
    PrecisionName,
    UpName,
)

if TYPE_CHECKING:
    from gymnasium.vector import AutoresetMode

    from rockfall._scene import Scene
    from rockfall.gym import Force, Look, Motor, Start


class TagOptions(TypedDict, total=False):
    """Those of all objects with names."""

    name: str | None
    colour: str | None
    look: LookName | None
    label: str | None


class StaticOptions(TagOptions, total=False):
    """Those of boxes and rods."""

    group: npt.ArrayLike
    material: Materials


class BoxOptions(StaticOptions, total=False):
    """Those of :meth:`Objects.add_boxes`."""

    motion: str | None
    surface_velocity: npt.ArrayLike | None


class SphereOptions(StaticOptions, total=False):
    """Those of :meth:`Objects.add_spheres`."""

    velocity: npt.ArrayLike | None
    angular_momentum: npt.ArrayLike | None
    orientation: npt.ArrayLike | None
    force: npt.ArrayLike | None
    fixed: npt.ArrayLike


class SpringOptions(TagOptions, total=False):
    """Those of :meth:`Objects.add_springs`."""

    muscle: npt.ArrayLike | None


class SettingValues(TypedDict, total=False):
    """Those of :meth:`Settings.update`."""

    activation_threshold: float
    restitution: float
    contact_damping: float
    contact_force: float
    friction: float
    coulomb_friction: float
    collision_friction: float
    linear_damping: float
    angular_damping: float
    contact_law: ContactLawName
    gravity: float
    collisions: bool
    continuous_collisions: bool
    gravity_direction: npt.ArrayLike
    contact_pull: bool
    resting_overlap: float
    mesh_angle: float
    precision: PrecisionName


class LookOptions(TypedDict, total=False):
    """Those of :meth:`Simulation.render` besides the size."""

    colour_by: ColourName | None
    range: tuple[float, float] | None
    camera: npt.ArrayLike | None
    look_at: npt.ArrayLike | None
    up: UpName
    plain: bool


class PictureOptions(LookOptions, total=False):
    """Those of :meth:`Worlds.render` and :func:`rockfall.gym.film` besides the size."""

    view: str | None
    title: str | None
    clock: bool
    scale_bar: bool
    label: bool
    arrows: str | None


class ViewOptions(LookOptions, total=False):
    """Those of the widget."""

    steps: int
    size: tuple[int, int]


class EvolutionOptions(TypedDict, total=False):
    """Those of :class:`Evolution` besides the population."""

    seed: int
    goal: GoalName
    body: BodyName
    seconds: float
    dt: float
    integrator: IntegratorName
    backend: BackendName
    ground: Scene | None


class EnvOptions(TypedDict, total=False):
    """Those of a single environment."""

    dt: float
    frame_skip: int
    max_steps: int
    strength: float
    muscles: bool
    forces: Iterable[Force]
    motors: Iterable[Motor]
    choices: npt.ArrayLike | None
    clock: float
    noise: float
    start: Callable[[np.random.Generator], Start] | None
    bounds: float | tuple[npt.ArrayLike, npt.ArrayLike]
    observe: Callable[[Look], npt.ArrayLike] | None
    reward: Callable[[Look, Look, FloatArray], npt.ArrayLike] | None
    terminate: Callable[[Look], npt.ArrayLike] | None
    render_mode: str | None
    render_size: tuple[int, int]
    backend: BackendName
    integrator: IntegratorName


class VectorOptions(EnvOptions, total=False):
    """Those of a vector of environments."""

    autoreset_mode: str | AutoresetMode
