"""What the actions of environments do."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from rockfall._arrays import FloatArray, floats, integers, whole
from rockfall._look import number
from rockfall._worlds import Worlds


@dataclass(frozen=True)
class Force:
    """A force on spheres, which a number of an action from -1 to 1 sets: ``strength * number`` along ``direction``."""

    #: Rows of the spheres, among which the force is divided equally; or the row of one.
    spheres: int | Sequence[int]
    #: Direction of shape (3,), of any length except 0.
    direction: npt.ArrayLike = field(default=(1.0, 0.0, 0.0), compare=False)
    #: Greatest force, in mass units/s².
    strength: float = 1.0
    #: Rows of spheres that take the opposite force, or the row of one; by default none.
    against: int | Sequence[int] = ()

    def _on(self, rows: int, place: int) -> FloatArray:
        """The force on each of some spheres, of shape (rows, 3)."""
        name = f"forces[{place}]"
        direction = floats(f"{name}.direction", self.direction, (3,), 1)[0].astype(np.float64)
        length = np.linalg.norm(direction)
        if length == 0.0:
            raise ValueError(f"{name}.direction: expected a vector that is not zero, got {self.direction}")
        most = number(f"{name}.strength", self.strength)
        found = np.zeros((rows, 3))
        for sign, given, what in ((1.0, self.spheres, "spheres"), (-1.0, self.against, "against")):
            spheres = [whole(f"{name}.{what}", row) for row in np.atleast_1d(np.asarray(given, dtype=object)).tolist()]
            if what == "spheres" and not spheres:
                raise ValueError(f"{name}.spheres: expected at least one sphere")
            for row in spheres:
                if row >= rows:
                    raise LookupError(f"{name}.{what}: there is no sphere {row} in every body, expected numbers below {rows}")
                found[row] += sign * most / len(spheres) * direction / length
        return found.astype(np.float32)


@dataclass(frozen=True)
class Motor:
    """A torque on the axis of a hinge or a force on that of a slider, which a number of an action sets: ``strength * number``.

    See :meth:`Worlds.set_joint_forces`.
    """

    #: Name of the joint, or its number in order of addition.
    joint: int | str
    #: Greatest torque in mass units²/s², or force in mass units/s².
    strength: float = 1.0
    #: Speed up to which the motor pushes, in rad/s or units/s. By default there is no such speed.
    fastest: float | None = None

    def _place(self, worlds: Worlds, place: int) -> int:
        """The number of the joint, which is the same in all worlds."""
        names = worlds.joints.names
        if not isinstance(self.joint, str):
            number = whole(f"motors[{place}].joint", self.joint)
            if number >= min(len(own) for own in names):
                raise LookupError(f"motors[{place}].joint: there is no joint {number} in every body")
            return number
        found = {own.index(self.joint) if self.joint in own else -1 for own in names}
        if len(found) != 1 or -1 in found:
            raise LookupError(f"motors[{place}].joint: expected a joint in the same place of every body, got {self.joint!r}")
        return found.pop()


class Actuators:
    """Applies actions to worlds: first the numbers for the springs, then those for the forces, then those for the motors."""

    def __init__(
        self,
        worlds: Worlds,
        strength: float,
        muscles: bool,
        forces: Iterable[Force],
        motors: Iterable[Motor],
        choices: npt.ArrayLike | None,
    ) -> None:
        self._worlds = worlds
        self._strength = strength
        self._lengths, self._forces = worlds.rest_lengths, worlds.external_forces
        self._springs = self._lengths.shape[1] if muscles else 0
        given = list(forces)
        for place, force in enumerate(given):
            if not isinstance(force, Force):
                raise TypeError(f"forces: expected a rockfall.gym.Force at place {place}, got {type(force).__name__}")
        common = int(worlds.sphere_counts.min())
        on = np.zeros((len(given), *self._forces.shape[1:]), np.float32)
        for place, force in enumerate(given):
            on[place, :common] = force._on(common, place)
        self._on = on
        self._set_motors(list(motors))
        if self.count == 0:
            raise ValueError("muscles, forces: expected springs or forces that actions change, got none")
        self._choices = None if choices is None else self._checked(choices)

    def _set_motors(self, motors: Sequence[Motor]) -> None:
        for place, motor in enumerate(motors):
            if not isinstance(motor, Motor):
                raise TypeError(f"motors: expected a rockfall.gym.Motor at place {place}, got {type(motor).__name__}")
        self._joints = np.array([motor._place(self._worlds, place) for place, motor in enumerate(motors)], np.int64)
        strengths = [number(f"motors[{place}].strength", motor.strength) for place, motor in enumerate(motors)]
        fastest = [
            np.inf if motor.fastest is None else number(f"motors[{place}].fastest", motor.fastest, positive=True)
            for place, motor in enumerate(motors)
        ]
        self._strengths, self._fastest = np.array(strengths, np.float32), np.array(fastest, np.float32)

    def _checked(self, choices: npt.ArrayLike) -> FloatArray:
        rows = floats("choices", choices, (self.count,))
        if np.ndim(choices) != 2 or len(rows) == 0:
            raise ValueError(f"choices: expected an array of shape (C, {self.count}), got {np.shape(choices)}")
        return rows

    @property
    def space(self) -> spaces.Space[Any]:
        """The actions of one environment."""
        if self._choices is not None:
            return spaces.Discrete(len(self._choices))
        return spaces.Box(-1.0, 1.0, (self.count,), np.float32)

    def rows(self, name: str, actions: npt.ArrayLike) -> FloatArray:
        """Actions as numbers of shape (W, M + F): those that are given, or those that whole numbers choose."""
        if self._choices is None:
            return floats(name, actions, (self.count,), len(self._worlds))
        numbers = integers(name, actions, len(self._worlds))
        if (numbers >= len(self._choices)).any():
            raise ValueError(f"{name}: expected whole numbers below {len(self._choices)}, got {int(numbers.max())}")
        found: FloatArray = self._choices[numbers]
        return found

    @property
    def count(self) -> int:
        """Number of numbers in an action."""
        return self._springs + len(self._on) + len(self._joints)

    def apply(self, actions: FloatArray) -> None:
        """Applies actions of shape (W, M + F), which are from -1 to 1."""
        springs, forces, motors = np.split(actions, [self._springs, self._springs + len(self._on)], axis=1)
        if self._springs:
            self._worlds.rest_lengths = self._lengths * (1.0 + self._strength * springs)
        if len(self._on):
            added: Any = np.einsum("wf,fni->wni", forces, self._on)
            self._worlds.external_forces = self._forces + added
        if len(self._joints):
            forces, free = motors * self._strengths, np.isinf(self._fastest)
            if free.any():
                self._worlds.set_joint_forces(forces[:, free], joints=self._joints[free])
            if not free.all():
                bound = self._fastest[~free]
                self._worlds.set_joint_forces(forces[:, ~free], joints=self._joints[~free], fastest=bound)
