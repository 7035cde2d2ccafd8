"""Spheres, rods, capsules, springs and tethers, in bulk."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import IntArray, common, floats, integers, quaternions, rows_of, switches


class Capsules(NamedTuple):
    """Numbers of capsules and their parts, as :meth:`Objects.add_capsules` returns them."""

    #: Numbers of the capsules, of shape (N,).
    capsules: IntArray
    #: Numbers of the spheres at both ends, of shape (N, 2).
    spheres: IntArray
    #: Numbers of the rods, of shape (N,).
    rods: IntArray


def numbers_from(first: int, count: int) -> IntArray:
    return np.arange(first, first + count, dtype=np.int64)


class Bodies:
    """Adds what can move. A base of :class:`Objects`."""

    _native: Any

    def _edited(self) -> None:
        """Called before objects are added, removed or changed."""

    def add_spheres(
        self,
        position: npt.ArrayLike,
        radius: npt.ArrayLike,
        mass: npt.ArrayLike = 1.0,
        velocity: npt.ArrayLike | None = None,
        *,
        angular_momentum: npt.ArrayLike | None = None,
        orientation: npt.ArrayLike | None = None,
        force: npt.ArrayLike | None = None,
        fixed: npt.ArrayLike = False,
        group: npt.ArrayLike = 0,
    ) -> IntArray:
        """Add solid balls.

        Parameters
        ----------
        position : array_like, shape (N, 3) or (3,)
            Centres, in units.
        radius : array_like, shape (N,) or ()
            Radii in units, greater than 0.
        mass : array_like, shape (N,) or ()
            Masses, greater than 0.
        velocity : array_like, shape (N, 3) or (3,), optional
            Velocities, in units/s; at rest by default.
        angular_momentum : array_like, shape (N, 3) or (3,), optional
            Angular momenta, in mass units²/s.
        orientation : array_like, shape (N, 4) or (4,), optional
            Unit quaternions w, x, y, z.
        force : array_like, shape (N, 3) or (3,), optional
            External forces in mass units/s², which act until they are changed.
        fixed : array_like of bool, shape (N,) or ()
            Whether the spheres never move.
        group : array_like of int, shape (N,) or ()
            Collision groups from 0 to 65535. Objects of different groups never touch.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the spheres.

        Raises
        ------
        ValueError
            For a wrong shape, a number that is not finite or out of range.
        TypeError
            For an array that does not hold numbers, or that is on a device.
        """
        count = common(
            position=(position, (3,)),
            radius=(radius, ()),
            mass=(mass, ()),
            velocity=(velocity, (3,)),
            angular_momentum=(angular_momentum, (3,)),
            orientation=(orientation, (4,)),
            force=(force, (3,)),
            fixed=(fixed, ()),
            group=(group, ()),
        )

        def vectors(name: str, value: Any) -> Any:
            return floats(name, (0.0, 0.0, 0.0) if value is None else value, (3,), count)

        arguments = (
            floats("position", position, (3,), count),
            floats("radius", radius, (), count, positive=True),
            floats("mass", mass, (), count, positive=True),
            vectors("velocity", velocity),
            vectors("angular_momentum", angular_momentum),
            quaternions("orientation", (1.0, 0.0, 0.0, 0.0) if orientation is None else orientation, count),
            vectors("force", force),
            switches("fixed", fixed, count),
            integers("group", group, count, dtype=np.uint16),
        )
        self._edited()
        return numbers_from(_rockfall.add_spheres(self._native, *arguments), count)

    def add_sphere(self, position: npt.ArrayLike, radius: float, mass: float = 1.0, **options: Any) -> int:
        """Add one sphere and return its number. The options are those of :meth:`add_spheres`."""
        _check_single("add_spheres", position=(position, (3,)), radius=(radius, ()), mass=(mass, ()))
        return first_of(self.add_spheres(position, radius, mass, **options))

    def add_rods(
        self,
        end1: npt.ArrayLike,
        end2: npt.ArrayLike,
        radius: npt.ArrayLike,
        length: npt.ArrayLike | None = None,
        *,
        group: npt.ArrayLike = 0,
    ) -> IntArray:
        """Add rods (cylinders without caps and mass) between spheres.

        Parameters
        ----------
        end1, end2 : array_like of int, shape (N,) or ()
            Numbers of the spheres at the ends.
        radius : array_like, shape (N,) or ()
            Radii in units, greater than 0.
        length : array_like, shape (N,) or (), optional
            Lengths at which the rods are held, in units. 0, and None, leave a rod free.
        group : array_like of int, shape (N,) or ()
            Collision groups from 0 to 65535.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the rods.

        Raises
        ------
        ValueError, TypeError
            As for :meth:`add_spheres`, and for a rod from a sphere to itself.
        LookupError
            For a sphere that does not exist.
        """
        count = common(end1=(end1, ()), end2=(end2, ()), radius=(radius, ()), length=(length, ()), group=(group, ()))
        arguments = (
            integers("end1", end1, count),
            integers("end2", end2, count),
            floats("radius", radius, (), count, positive=True),
            floats("length", 0.0 if length is None else length, (), count, not_negative=True),
            integers("group", group, count, dtype=np.uint16),
        )
        self._edited()
        return numbers_from(_rockfall.add_rods(self._native, *arguments), count)

    def add_rod(self, end1: int, end2: int, radius: float, length: float | None = None, *, group: int = 0) -> int:
        """Add one rod and return its number; see :meth:`add_rods`."""
        _check_single("add_rods", end1=(end1, ()), end2=(end2, ()), radius=(radius, ()), length=(length, ()))
        return first_of(self.add_rods(end1, end2, radius, length, group=group))

    def add_capsules(
        self,
        end1: npt.ArrayLike,
        end2: npt.ArrayLike,
        radius: npt.ArrayLike,
        mass: npt.ArrayLike = 1.0,
        velocity: npt.ArrayLike | None = None,
        *,
        group: npt.ArrayLike = 0,
    ) -> Capsules:
        """Add capsules: rigid bodies of two spheres, each with half the mass, and a rod of fixed length.

        Parameters
        ----------
        end1, end2 : array_like, shape (N, 3) or (3,)
            Centres of the spheres at the ends, in units.
        radius : array_like, shape (N,) or ()
            Radii in units, greater than 0.
        mass : array_like, shape (N,) or ()
            Masses of the whole capsules, greater than 0.
        velocity : array_like, shape (N, 3) or (3,), optional
            Velocities of both ends, in units/s.
        group : array_like of int, shape (N,) or ()
            Collision groups from 0 to 65535.

        Returns
        -------
        Capsules
            Numbers of the capsules, their spheres and their rods.

        Raises
        ------
        ValueError, TypeError
            As for :meth:`add_spheres`, and for ends that coincide.
        """
        count = common(
            end1=(end1, (3,)), end2=(end2, (3,)), radius=(radius, ()), mass=(mass, ()), velocity=(velocity, (3,)), group=(group, ())
        )
        arguments = (
            floats("end1", end1, (3,), count),
            floats("end2", end2, (3,), count),
            floats("radius", radius, (), count, positive=True),
            floats("mass", mass, (), count, positive=True),
            floats("velocity", (0.0, 0.0, 0.0) if velocity is None else velocity, (3,), count),
            integers("group", group, count, dtype=np.uint16),
        )
        self._edited()
        capsules, spheres, rods = _rockfall.add_capsules(self._native, *arguments)
        return Capsules(numbers_from(capsules, count), numbers_from(spheres, 2 * count).reshape(count, 2), numbers_from(rods, count))

    def add_springs(
        self,
        a: npt.ArrayLike,
        b: npt.ArrayLike,
        stiffness: npt.ArrayLike,
        length: npt.ArrayLike | None = None,
        damping: npt.ArrayLike = 0.0,
    ) -> IntArray:
        """Add damped springs between spheres.

        Parameters
        ----------
        a, b : array_like of int, shape (N,) or ()
            Numbers of the spheres.
        stiffness : array_like, shape (N,) or ()
            Stiffness in mass/s², not negative.
        length : array_like, shape (N,) or (), optional
            Rest lengths in units, not negative; by default the distance of the spheres.
        damping : array_like, shape (N,) or ()
            Damping in mass/s, not negative.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the springs.

        Raises
        ------
        ValueError, TypeError, LookupError
            As for :meth:`add_rods`.
        """
        count = common(a=(a, ()), b=(b, ()), stiffness=(stiffness, ()), length=(length, ()), damping=(damping, ()))
        arguments = (
            integers("a", a, count),
            integers("b", b, count),
            floats("stiffness", stiffness, (), count, not_negative=True),
            floats("length", -1.0, (), count) if length is None else floats("length", length, (), count, not_negative=True),
            floats("damping", damping, (), count, not_negative=True),
        )
        self._edited()
        return numbers_from(_rockfall.add_springs(self._native, *arguments), count)

    def add_spring(self, a: int, b: int, stiffness: float, length: float | None = None, damping: float = 0.0) -> int:
        """Add one spring and return its number; see :meth:`add_springs`."""
        _check_single("add_springs", a=(a, ()), b=(b, ()), stiffness=(stiffness, ()), length=(length, ()))
        return first_of(self.add_springs(a, b, stiffness, length, damping))

    def add_tethers(
        self,
        sphere: npt.ArrayLike,
        point: npt.ArrayLike,
        stiffness: npt.ArrayLike,
        length: npt.ArrayLike = 0.0,
        damping: npt.ArrayLike = 0.0,
    ) -> IntArray:
        """Add damped springs between spheres and points in space.

        Parameters
        ----------
        sphere : array_like of int, shape (N,) or ()
            Numbers of the spheres.
        point : array_like, shape (N, 3) or (3,)
            Fixed points, in units.
        stiffness, length, damping : array_like, shape (N,) or ()
            Stiffness in mass/s², rest length in units and damping in mass/s, not negative.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the tethers.

        Raises
        ------
        ValueError, TypeError, LookupError
            As for :meth:`add_rods`.
        """
        count = common(
            sphere=(sphere, ()), point=(point, (3,)), stiffness=(stiffness, ()), length=(length, ()), damping=(damping, ())
        )
        arguments = (
            integers("sphere", sphere, count),
            floats("point", point, (3,), count),
            floats("stiffness", stiffness, (), count, not_negative=True),
            floats("length", length, (), count, not_negative=True),
            floats("damping", damping, (), count, not_negative=True),
        )
        self._edited()
        return numbers_from(_rockfall.add_tethers(self._native, *arguments), count)


def first_of(numbers: IntArray) -> int:
    return int(numbers[0])


def _check_single(several: str, **arguments: tuple[Any, tuple[int, ...]]) -> None:
    """Checks that every argument has one row."""
    for name, (value, columns) in arguments.items():
        rows = None if value is None else rows_of(name, value, columns)
        if rows is not None and rows != 1:
            raise ValueError(f"{name}: expected the values of one object, got {rows} rows; {several} takes several objects")
