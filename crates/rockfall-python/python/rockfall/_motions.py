"""Walls that move, and meshes."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import IntArray, floats, integers, vector
from rockfall._bodies import Bodies, numbers_from
from rockfall._names import tag_of
from rockfall._warnings import warn
from rockfall.typing import LookName

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: The kinds of objects that can follow a motion.
WallKind = Literal["box", "polygon"]

_ZERO = (0.0, 0.0, 0.0)
_Z = (0.0, 0.0, 1.0)


class MotionTerm(NamedTuple):
    """A term of a motion, as :attr:`Objects.motions` lists it."""

    #: Velocity, in units/s.
    velocity: tuple[float, float, float]
    #: Amplitude of the oscillation, in units.
    amplitude: tuple[float, float, float]
    #: Direction of the axis.
    axis: tuple[float, float, float]
    #: A point of the axis, in units.
    through: tuple[float, float, float]
    #: Angular velocity about the axis, in rad/s.
    spin: float
    #: Frequency of the oscillation, in 1/s.
    frequency: float
    #: Phase of the oscillation at its start, in turns.
    phase: float
    #: Time at which the term begins, in s.
    start: float
    #: Time at which it ends, in s; infinite if it does not.
    end: float


class Servo(NamedTuple):
    """A wall that seeks a force or a torque, as :attr:`Objects.servos` lists it."""

    #: Force in mass units/s², or torque in mass units²/s², that the walls exert on the bodies along the direction.
    target: float
    #: Greatest speed, in units/s or rad/s.
    speed: float
    #: Present displacement along the direction in units, or angle about it in rad.
    displacement: float
    #: Present rate of the displacement, in units/s or rad/s.
    velocity: float
    #: Unit vector along the force, or along the axis.
    direction: tuple[float, float, float]
    #: Whether the walls turn.
    turns: bool


class WallLoad(NamedTuple):
    """The load of all contacts on walls, as :meth:`Simulation.wall_load` returns it."""

    #: Force on the walls in mass units/s², of shape (3,).
    force: NDArray[np.float64]
    #: Torque about the origin in mass units²/s², of shape (3,).
    torque: NDArray[np.float64]
    #: Number of contacts.
    contacts: int


@dataclass(frozen=True)
class PlaneFlow:
    """What has passed the plane of a gauge, along its normal minus against it. See :attr:`Simulation.gauges`."""

    #: Mass of the spheres.
    mass: float
    #: Number of spheres.
    count: int


def motion_term(
    velocity: npt.ArrayLike, spin: float, axis: npt.ArrayLike, through: npt.ArrayLike, amplitude: npt.ArrayLike,
    frequency: float, phase: float, start: float, end: float,
) -> list[float]:
    vectors = {"velocity": velocity, "amplitude": amplitude, "axis": axis, "through": through}
    numbers = [number for name, value in vectors.items() for number in vector(name, value)]
    return [*numbers, *(float(number) for number in (spin, frequency, phase, start, end))]


class Walls(Bodies):
    """Adds meshes and motions. A base of :class:`Objects`."""

    def add_mesh(
        self,
        mesh: str | os.PathLike[str] | npt.ArrayLike,
        triangles: npt.ArrayLike | None = None,
        *,
        scale: float = 1.0,
        axis: npt.ArrayLike = _Z,
        turn: float = 0.0,
        at: npt.ArrayLike = _ZERO,
        group: int = 0,
        material: int | str | None = None,
        motion: str | None = None,
        surface_velocity: npt.ArrayLike | None = None,
        name: str | None = None,
        colour: str | None = None,
        label: str | None = None,
        look: LookName | None = None,
    ) -> IntArray:
        """Add the triangles of a mesh as walls. Both of their sides can be touched.

        The mesh is scaled, then turned about an axis through its origin, then moved. Triangles without an area are left out with a
        warning. Results do not depend on the order of the triangles.

        Parameters
        ----------
        mesh : path, or array_like of shape (V, 3)
            An STL, OBJ or PLY file, or vertices.
        triangles : array_like of int, shape (T, 3), optional
            Indices of vertices from 0, for a mesh of vertices.
        scale : float
            Units per unit of the mesh. A negative scale mirrors.
        axis, turn : array_like of shape (3,), float
            Axis and angle of the turn, in degrees.
        at : array_like, shape (3,)
            Where the origin of the mesh comes to lie, in units.
        group : int
            Collision group from 0 to 65535.
        material : int or str, optional
            Material, by number or by name. See :meth:`add_material`.
        motion : str, optional
            Name of the motion that the mesh follows. See :meth:`add_motion`.
        surface_velocity : array_like of shape (3,), optional
            Velocity of the surface, like that of a conveyor, in units/s.
        name, colour, label, look : str, optional
            Name, colour, label and look of the triangles. See :meth:`set_tag`.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the triangles, which are polygons.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            For a file of another format, a wrong index, and a coordinate that is not finite.
        """
        tag = tag_of(name, colour, label, look)
        self._check_motion(motion)
        file = mesh if isinstance(mesh, (str, os.PathLike)) else None
        if (file is None) != (triangles is not None):
            raise TypeError("triangles: expected indices with vertices, and none with a file")
        corners = floats("mesh", mesh, (3,)) if file is None else np.zeros((0, 3), np.float32)
        indices = integers("triangles", [] if triangles is None else np.asarray(triangles).reshape(-1))
        if len(indices) % 3 or (len(indices) and not (0 <= indices.min() and indices.max() < max(len(corners), 1))):
            raise ValueError(f"triangles: expected shape (T, 3) with indices from 0 to {len(corners) - 1}")
        place = (float(scale), vector("axis", axis), float(turn), vector("at", at))
        number = int(self._material_numbers("material", material))
        self._edited()
        first, count, left_out = _rockfall.add_mesh(
            self._native, file, corners, indices.reshape(-1, 3).tolist(), place, int(group), number
        )
        if left_out:
            warn(f"{left_out} triangles have no area and were left out")
        numbers = numbers_from(first, count)
        self._put_tag("polygon", numbers, tag)
        return self._following("polygon", numbers, motion, surface_velocity)

    def add_motion(
        self,
        name: str,
        *,
        velocity: npt.ArrayLike = _ZERO,
        spin: float = 0.0,
        axis: npt.ArrayLike = _Z,
        through: npt.ArrayLike = _ZERO,
        amplitude: npt.ArrayLike = _ZERO,
        frequency: float = 0.0,
        phase: float = 0.0,
        start: float = 0.0,
        end: float = np.inf,
    ) -> None:
        """Add a motion, which boxes and polygons can follow, or a further term to the motion of that name.

        The displacement at ``s`` seconds after ``start``, held at ``end``, is ``velocity * s + amplitude * (sin(2 pi (frequency * s +
        phase)) - sin(2 pi phase))``, and the turn ``spin * s`` about the axis. A later term is inside the earlier ones. Nothing is
        integrated, so errors do not add up.

        Parameters
        ----------
        name : str
            One word.
        velocity, amplitude : array_like, shape (3,)
            Velocity in units/s, and amplitude of an oscillation in units.
        spin : float
            Angular velocity in rad/s.
        axis, through : array_like, shape (3,)
            Direction of the axis, and a point of it, in units.
        frequency, phase : float
            Frequency in 1/s and phase in turns of the oscillation.
        start, end : float
            Times in s. Before ``start`` the walls rest, after ``end`` they stay where they are.

        Raises
        ------
        ValueError
            For numbers that are not finite, an axis without a direction, a negative frequency, or an end before the start.
        """
        self._edited()
        term = motion_term(velocity, spin, axis, through, amplitude, frequency, phase, start, end)
        _rockfall.add_motion(self._native, name, term)

    def add_servo(
        self,
        name: str,
        *,
        force: npt.ArrayLike | None = None,
        torque: float | None = None,
        axis: npt.ArrayLike = _Z,
        through: npt.ArrayLike = _ZERO,
        speed: float,
    ) -> None:
        """Add a motion that seeks a force or a torque, which boxes, polygons and meshes can follow.

        The walls move along the force, or turn about the axis, until they exert the force or torque on the bodies. Without contacts they
        move at the greatest speed.

        Parameters
        ----------
        name : str
            One word that no motion has as its name.
        force : array_like, shape (3,), optional
            Force that the walls exert on the bodies, in mass units/s².
        torque : float, optional
            Torque that they exert about the axis, in mass units²/s².
        axis, through : array_like, shape (3,)
            Direction of the axis of a torque, and a point of it, in units.
        speed : float
            Greatest speed in units/s, or in rad/s for a torque.

        Raises
        ------
        ValueError
            For numbers that are not finite, a force of 0, an axis without a direction, a speed that is not above 0, and a name that is
            in use.
        """
        if (force is None) == (torque is None):
            raise TypeError("force, torque: expected one of them")
        self._edited()
        turning = None if torque is None else (float(torque), vector("axis", axis), vector("through", through))
        pushing = None if force is None else vector("force", force)
        _rockfall.add_servo(self._native, name, pushing, turning, float(speed))

    def set_servo(self, name: str, *, target: float | None = None, speed: float | None = None) -> None:
        """Change what a servo seeks, or its greatest speed. The walls go on from where they are.

        Parameters
        ----------
        name : str
            Name of the servo.
        target : float, optional
            Force along its direction, above 0, or torque about it.
        speed : float, optional
            Greatest speed in units/s or rad/s.

        Raises
        ------
        LookupError
            For an unknown name, or a motion without a servo.
        ValueError
            For a force that is not above 0, and numbers that are not finite.
        """
        self._edited()
        _rockfall.set_servo(self._native, name, None if target is None else float(target), None if speed is None else float(speed))

    @property
    def servos(self) -> dict[str, Servo]:
        """All walls that seek a force or a torque, by name, where they are now."""
        rows = _rockfall.servos(self._native)
        return {
            name: Servo(target, speed, displacement, velocity, (x, y, z), turns)
            for name, (target, speed, displacement, velocity), (x, y, z), turns in rows
        }

    def add_gauge(
        self,
        name: str,
        *,
        wall: str | None = None,
        plane: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
    ) -> None:
        """Add a gauge of the load on walls, or of the flow through a plane. It changes no result.

        Parameters
        ----------
        name : str
            One word that no other gauge has as its name.
        wall : str, optional
            Name of boxes or polygons, or of the motion that they follow.
        plane : pair of array_like, each of shape (3,), optional
            A point of a plane, in units, and its normal. The gauge counts spheres whose centre passes the plane along the normal, and
            subtracts those that pass it against the normal. Fixed spheres do not count, and neither do spheres that are added, removed or
            moved by hand. In a simulation it counts from now on.

        Raises
        ------
        ValueError
            For a name that is in use or not one word, an unknown wall, and a plane with numbers that are not finite or without a
            direction.
        """
        if (wall is None) == (plane is None):
            raise TypeError("wall, plane: expected one of them")
        point, normal = (_ZERO, _Z) if plane is None else plane
        self._edited()
        _rockfall.add_gauge(self._native, name, wall, [*vector("plane", point), *vector("plane", normal)])

    def add_motion_table(self, name: str, times: npt.ArrayLike, displacements: npt.ArrayLike) -> None:
        """Add a translation along straight lines, each at constant speed.

        Parameters
        ----------
        name : str
            One word that no motion has as its name.
        times : array_like, shape (N,)
            Times in s, which increase; at least two.
        displacements : array_like, shape (N, 3)
            Displacements from where the walls are written, in units. The first one is subtracted from all.

        Raises
        ------
        ValueError
            For wrong shapes, times that do not increase, numbers that are not finite, and a name that is in use.
        """
        at, places = np.asarray(times, np.float64), np.asarray(displacements, np.float64)
        if at.ndim != 1 or len(at) < 2 or places.shape != (len(at), 3):
            raise ValueError(f"times, displacements: expected shapes (N,) and (N, 3) with N > 1, got {at.shape} and {places.shape}")
        if not (np.isfinite(at).all() and np.isfinite(places).all() and (np.diff(at) > 0).all()):
            raise ValueError("times, displacements: expected finite numbers, and times that increase")
        if name in self.motions:
            raise ValueError(f"name: there is a motion {name!r} already")
        speeds = np.diff(places, axis=0) / np.diff(at)[:, None]
        for velocity, start, end in zip(speeds, at[:-1], at[1:], strict=True):
            self.add_motion(name, velocity=velocity, start=float(start), end=float(end))

    @property
    def motions(self) -> dict[str, list[MotionTerm]]:
        """The terms of all motions, by name."""

        def term(numbers: list[float]) -> MotionTerm:
            x = [tuple(numbers[3 * k : 3 * k + 3]) for k in range(4)]
            return MotionTerm(*x, *numbers[12:])  # type: ignore[arg-type]

        return {name: [term(numbers) for numbers in terms] for name, terms in _rockfall.motions(self._native)}

    def _check_motion(self, motion: str | None) -> None:
        if motion is not None and motion not in (known := self.motions):
            expected = f"one of {', '.join(known)}" if known else "none, because there are no motions"
            raise LookupError(f"motion: {motion!r} is unknown, expected {expected}")

    def _following(
        self, kind: WallKind, numbers: IntArray, motion: str | None, surface_velocity: npt.ArrayLike | None
    ) -> IntArray:
        if motion is not None:
            self.follow(kind, numbers, motion)
        if surface_velocity is not None:
            self.set_surface_velocity(kind, numbers, surface_velocity)
        return numbers

    def set_surface_velocity(self, kind: WallKind, ids: npt.ArrayLike, velocity: npt.ArrayLike) -> None:
        """Set the velocity of the surfaces of boxes or polygons, like that of conveyors. The objects stay where they are.

        Parameters
        ----------
        kind : str
            box or polygon.
        ids : array_like of int, shape (N,) or ()
            Numbers of the objects.
        velocity : array_like, shape (3,)
            Velocity in units/s. Only the part along the surface counts. 0 stops the belt.

        Raises
        ------
        LookupError
            For an object that does not exist.
        ValueError
            For another kind of object, and numbers that are not finite.
        """
        numbers: NDArray[np.int64] = np.atleast_1d(integers("ids", ids))
        self._edited()
        _rockfall.set_surface_velocity(self._native, kind, numbers.tolist(), vector("velocity", velocity))

    def follow(self, kind: WallKind, ids: npt.ArrayLike, motion: str | None) -> None:
        """Let boxes or polygons follow a motion.

        Parameters
        ----------
        kind : str
            box or polygon.
        ids : array_like of int, shape (N,) or ()
            Numbers of the objects.
        motion : str or None
            Name of the motion. None: the objects never move.

        Raises
        ------
        LookupError
            For an unknown motion, and an object that does not exist.
        ValueError
            For another kind of object.
        """
        numbers: NDArray[np.int64] = np.atleast_1d(integers("ids", ids))
        self._edited()
        _rockfall.follow(self._native, kind, numbers.tolist(), motion)

