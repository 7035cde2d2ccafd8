"""What the actions of environments do."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from rockfall._arrays import FloatArray, floats, whole
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


class Actuators:
    """Applies actions to worlds: first the numbers for the springs, then those for the forces."""

    def __init__(self, worlds: Worlds, strength: float, muscles: bool, forces: Iterable[Force]) -> None:
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
        if self.count == 0:
            raise ValueError("muscles, forces: expected springs or forces that actions change, got none")

    @property
    def count(self) -> int:
        """Number of numbers in an action."""
        return self._springs + len(self._on)

    def apply(self, actions: FloatArray) -> None:
        """Applies actions of shape (W, M + F), which are from -1 to 1."""
        springs, forces = actions[:, : self._springs], actions[:, self._springs :]
        if self._springs:
            self._worlds.rest_lengths = self._lengths * (1.0 + self._strength * springs)
        if len(self._on):
            added: Any = np.einsum("wf,fni->wni", forces, self._on)
            self._worlds.external_forces = self._forces + added
