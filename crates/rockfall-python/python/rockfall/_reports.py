"""What simulations report."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rockfall._arrays import FloatArray

#: Rows of :attr:`Simulation.contacts`.
CONTACT = np.dtype(
    [
        ("a_kind", "U7"),
        ("a", np.int64),
        ("b_kind", "U7"),
        ("b", np.int64),
        ("point", np.float32, (3,)),
        ("normal", np.float32, (3,)),
        ("overlap", np.float32),
        ("force", np.float32, (3,)),
        ("impulse", np.float32, (3,)),
        ("normal_force", np.float32),
        ("tangential_force", np.float32, (3,)),
        ("slip", np.int8),
        ("displacement", np.float32, (3,)),
        ("moment", np.float32, (3,)),
    ]
)

#: Rows of :meth:`Simulation.contact_events`.
CONTACT_EVENT = np.dtype(
    [
        ("step", np.int64),
        ("time", np.float64),
        ("change", "U5"),
        ("a_kind", "U7"),
        ("a", np.int64),
        ("b_kind", "U7"),
        ("b", np.int64),
        ("point", np.float32, (3,)),
        ("normal", np.float32, (3,)),
        ("force", np.float32, (3,)),
    ]
)


def sensor_event(names: list[str]) -> np.dtype[np.void]:
    """Rows of :meth:`Simulation.sensor_events`, with room for the longest name."""
    longest = max((len(name) for name in names), default=1)
    return np.dtype(
        [
            ("step", np.int64),
            ("time", np.float64),
            ("change", "U5"),
            ("sensor", f"U{longest}"),
            ("kind", "U7"),
            ("index", np.int64),
            ("centre", np.float64, (3,)),
        ]
    )


#: Rows of :attr:`Simulation.tensions`.
TENSION = np.dtype(
    [
        ("kind", "U6"),
        ("index", np.int64),
        ("a", np.int64),
        ("b", np.int64),
        ("length", np.float32),
        ("tension", np.float32),
    ]
)

#: Rows of :meth:`Simulation.cast_rays`.
RAY_HIT = np.dtype(
    [
        ("kind", "U7"),
        ("index", np.int64),
        ("distance", np.float32),
        ("point", np.float32, (3,)),
        ("normal", np.float32, (3,)),
    ]
)

#: Rows of :attr:`Simulation.diagnostics`.
DIAGNOSTICS = np.dtype([("contacts", np.uint32), ("net_force", np.float32, (3,)), ("deepest_overlap", np.float32)])

#: Rows of :meth:`Worlds.report`.
WORLD_REPORTS = np.dtype(
    [
        ("steps", np.int64),
        ("time", np.float64),
        ("contacts", np.int64),
        ("max_overlap", np.float32),
        ("collisions", np.int64),
        ("total_collisions", np.int64),
        ("replays", np.int64),
        ("list_builds", np.int64),
        ("non_finite", np.int64),
        ("stopped", np.bool_),
        ("escaped", np.int64),
        ("workgroup", np.bool_),
        ("sleeping", np.bool_),
    ]
)

#: Rows of :attr:`Worlds.energies`.
ENERGIES = np.dtype(
    [
        ("kinetic", np.float64),
        ("potential", np.float64),
        ("spring", np.float64),
        ("contact", np.float64),
        ("total", np.float64),
        ("momentum", np.float64, (3,)),
        ("angular_momentum", np.float64, (3,)),
    ]
)

#: Kinds of bodies in contacts and ray hits.
BODY_KINDS = np.array(["sphere", "rod", "box", "polygon", ""])

#: Kinds of objects in events.
PARTY_KINDS = np.array(["sphere", "rod", "capsule", "body", "box", "polygon"])

#: Kinds in tensions.
LINK_KINDS = np.array(["spring", "muscle", "tether"])


@dataclass(frozen=True)
class Report:
    """Counts and times of all steps so far."""

    #: Number of steps done.
    steps: int
    #: Time simulated, in s.
    time: float
    #: Number of contacts at the beginning of the last step.
    contacts: int
    #: Deepest overlap at the beginning of the last step, in units.
    max_overlap: float
    #: Number of collisions in the last step.
    collisions: int
    #: Number of collisions in all steps.
    total_collisions: int
    #: Number of times that a step was repeated, because a list had to grow or a body left its AABB.
    replays: int
    #: Number of steps in which pair lists were rebuilt.
    list_builds: int
    #: Number of times that a body was stopped because its state was no longer finite.
    non_finite: int
    #: Number of times that the centre of a sphere passed a polygon, a triangle or a plane within a step.
    passages: int
    #: Index of the first of these spheres, and the step; ``None`` if there was none.
    first_passage: tuple[int, int] | None


@dataclass(frozen=True)
class Energy:
    """Energies in mass units²/s² and momenta of a state, without fixed spheres."""

    #: Kinetic energy, including rotation.
    kinetic: float
    #: Potential energy in gravity.
    potential: float
    #: Elastic energy of springs and tethers.
    spring: float
    #: Elastic energy of contacts.
    contact: float
    #: Momentum of shape (3,), in mass units/s.
    momentum: tuple[float, float, float]
    #: Angular momentum about the origin of shape (3,), in mass units²/s.
    angular_momentum: tuple[float, float, float]

    @property
    def total(self) -> float:
        """Sum of all energies."""
        return self.kinetic + self.potential + self.spring + self.contact


@dataclass(frozen=True)
class Backend:
    """The backend that runs a simulation."""

    #: ``gpu`` or ``cpu``.
    kind: str
    #: Name of the device.
    device: str
    #: Driver and its version; empty on the CPU.
    driver: str
    #: The reason for the choice.
    reason: str


@dataclass(frozen=True)
class Device:
    """A graphics adapter."""

    #: Name of the device.
    name: str
    #: Graphics API, for example ``vulkan``.
    backend: str
    #: Kind of the adapter.
    kind: str
    #: Driver and its version.
    driver: str
    #: Whether a CPU emulates the adapter. Such an adapter is used only with ``backend="gpu"``.
    software: bool


@dataclass(frozen=True)
class Overlap:
    """The deepest overlaps of a state."""

    #: The deepest overlap, in units; 0 without contacts.
    units: float
    #: The largest overlap in radii of the smaller body; 0 without contacts.
    radii: float
    #: Kind and row of the two bodies with the overlap ``radii``; None without contacts.
    bodies: tuple[tuple[str, int], tuple[str, int]] | None


class StageTime(NamedTuple):
    """The time of a stage over all steps."""

    #: Name of the stage.
    name: str
    #: The phase that it is part of.
    phase: str
    #: Number of dispatches.
    runs: int
    #: Time of all dispatches, in s.
    seconds: float
    #: Least number of bytes that they had to move.
    least_bytes: int


@dataclass(frozen=True)
class Profile:
    """The time that steps took, stage by stage."""

    #: The stages that had work.
    stages: list[StageTime]
    #: Wall time of all steps, in s.
    seconds: float
    #: Number of steps.
    steps: int
    #: Time in steps that were rejected, in s.
    rejected_seconds: float
    #: The clock that measured the times.
    clock: str


class State:
    """The memory of the CPU backend, without copies, at the time that :attr:`Simulation.state` was read.

    The arrays are read-only and in the order of memory: row k belongs to the sphere with row ``order[k]`` in arrays such as
    :attr:`Simulation.positions`. They keep showing this state. When the simulation goes on while one of them exists, it first
    moves to a copy of the memory, so read :attr:`Simulation.state` again to see the new state, and do not keep arrays that are
    not needed: without them, nothing is copied.
    """

    __slots__ = ("_orientations", "_order", "_rows", "_spheres")

    def __init__(self, rows: FloatArray, orientations: FloatArray, order: np.ndarray) -> None:
        self._rows = rows
        self._orientations = orientations
        self._order = order
        self._spheres = len(orientations)

    def _region(self, region: int) -> FloatArray:
        return self._rows[region * self._spheres : (region + 1) * self._spheres]

    @property
    def order(self) -> np.ndarray:
        """Row of each sphere in order of addition, int64 of shape (N,). ``positions[np.argsort(order)]`` is in that order."""
        return self._order

    @property
    def positions(self) -> FloatArray:
        """Centres of shape (N, 3), in units."""
        return self._region(0)[:, :3]

    @property
    def radii(self) -> FloatArray:
        """Radii of shape (N,), in units."""
        return self._region(0)[:, 3]

    @property
    def velocities(self) -> FloatArray:
        """Velocities of shape (N, 3), in units/s."""
        return self._region(1)[:, :3]

    @property
    def inverse_masses(self) -> FloatArray:
        """1 / mass of shape (N,); 0 for fixed spheres."""
        return self._region(1)[:, 3]

    @property
    def angular_momenta(self) -> FloatArray:
        """Angular momenta of shape (N, 3), in mass units²/s."""
        return self._region(2)[:, :3]

    @property
    def inverse_inertias(self) -> FloatArray:
        """1 / moment of inertia of shape (N,), in 1/(mass units²)."""
        return self._region(2)[:, 3]

    @property
    def orientations_xyzw(self) -> FloatArray:
        """Unit quaternions of shape (N, 4), with the scalar part last."""
        return self._orientations

    def __len__(self) -> int:
        return self._spheres

    def __repr__(self) -> str:
        return f"<rockfall.State of {self._spheres} spheres>"
