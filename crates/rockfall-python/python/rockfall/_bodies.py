"""Spheres, rods, capsules, springs and tethers, in bulk."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import (
    GROUP,
    MATERIAL,
    NOT_NEGATIVE,
    NUMBER,
    POSITIVE,
    QUATERNION,
    REAL,
    SWITCH,
    VECTOR,
    IntArray,
    Kind,
    columns,
    rows_of,
)
from rockfall._materials import Materials, MaterialTable
from rockfall._names import Names, Tag, tag_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rockfall._options import SphereOptions, SpringOptions, StaticOptions
    from rockfall.typing import LookName

_ZERO = (0.0, 0.0, 0.0)
_NO_TAG = Tag()
#: The kinds of objects that can have names, by the functions that add them.
_TAGGED = {
    _rockfall.add_spheres: "sphere",
    _rockfall.add_rods: "rod",
    _rockfall.add_springs: "spring",
    _rockfall.add_boxes: "box",
    _rockfall.add_polygons: "polygon",
}


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


class Bodies(MaterialTable, Names):
    """Adds what can move. A base of :class:`Objects`."""

    def _add(self, add: Callable[..., Any], **arguments: tuple[Any, Kind]) -> tuple[int, Any]:
        """Adds objects with a native function. Returns their number and what the function returns."""
        count, arrays = columns(**arguments)
        self._edited()
        return count, add(self._native, *arrays)

    def _add_kind(self, tag: Tag, add: Callable[..., int], **arguments: tuple[Any, Kind]) -> IntArray:
        """Adds objects with a native function that returns the number of the first. Returns the numbers of all."""
        count, first = self._add(add, **arguments)
        numbers = numbers_from(first, count)
        self._put_tag(_TAGGED.get(add, ""), numbers, tag)
        return numbers

    def _put_tag(self, kind: str, numbers: IntArray, tag: Tag) -> None:
        if tag != _NO_TAG:
            _rockfall.set_tags(self._native, kind, numbers, tag)

    def add_spheres(
        self,
        position: npt.ArrayLike,
        radius: npt.ArrayLike,
        mass: npt.ArrayLike | None = 1.0,
        velocity: npt.ArrayLike | None = None,
        *,
        angular_momentum: npt.ArrayLike | None = None,
        orientation: npt.ArrayLike | None = None,
        force: npt.ArrayLike | None = None,
        fixed: npt.ArrayLike = False,
        group: npt.ArrayLike = 0,
        material: Materials = None,
        name: str | None = None,
        colour: str | None = None,
        label: str | None = None,
        look: LookName | None = None,
    ) -> IntArray:
        """Add solid balls.

        Parameters
        ----------
        position : array_like, shape (N, 3) or (3,)
            Centres, in units.
        radius : array_like, shape (N,) or ()
            Radii in units, greater than 0.
        mass : array_like, shape (N,) or (), or None
            Masses, greater than 0. None stands for the volumes times the densities of the materials.
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
        material : int, str or array_like of them, shape (N,) or (), optional
            Materials, by number or by name; none by default. See :meth:`add_material`.
        name, colour, label, look : str, optional
            Name, colour, label and look of the objects. See :meth:`set_tag`.

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
        return self._add_kind(
            tag_of(name, colour, label, look),
            _rockfall.add_spheres,
            position=(position, VECTOR),
            radius=(radius, POSITIVE),
            mass=_mass(mass),
            velocity=(_ZERO if velocity is None else velocity, VECTOR),
            angular_momentum=(_ZERO if angular_momentum is None else angular_momentum, VECTOR),
            orientation=((1.0, 0.0, 0.0, 0.0) if orientation is None else orientation, QUATERNION),
            force=(_ZERO if force is None else force, VECTOR),
            fixed=(fixed, SWITCH),
            group=(group, GROUP),
            material=(self._material_numbers("material", material), MATERIAL),
        )

    def add_sphere(
        self, position: npt.ArrayLike, radius: float, mass: float | None = 1.0, **options: Unpack[SphereOptions]
    ) -> int:
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
        material: Materials = None,
        name: str | None = None,
        colour: str | None = None,
        label: str | None = None,
        look: LookName | None = None,
    ) -> IntArray:
        """Add rods (cylinders without caps and mass) between spheres.

        Parameters
        ----------
        end1, end2 : array_like of int, shape (N,) or ()
            Numbers of the spheres at the ends.
        radius : array_like, shape (N,) or ()
            Radii in units, greater than 0.
        length : array_like, shape (N,) or (), optional
            Lengths at which the rods are held, in units; by default the present distance of the spheres. 0 leaves a rod free: its
            ends move apart and together.
        group : array_like of int, shape (N,) or ()
            Collision groups from 0 to 65535.
        material : int, str or array_like of them, shape (N,) or (), optional
            Materials, by number or by name; none by default. See :meth:`add_material`.
        name, colour, label, look : str, optional
            Name, colour, label and look of the objects. See :meth:`set_tag`.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the rods.

        Raises
        ------
        ValueError, TypeError
            As for :meth:`add_spheres`, for a rod from a sphere to itself, and for one without a length between spheres at the same place.
        LookupError
            For a sphere that does not exist.
        """
        return self._add_kind(
            tag_of(name, colour, label, look),
            _rockfall.add_rods,
            end1=(end1, NUMBER),
            end2=(end2, NUMBER),
            radius=(radius, POSITIVE),
            length=(-1.0, REAL) if length is None else (length, NOT_NEGATIVE),
            group=(group, GROUP),
            material=(self._material_numbers("material", material), MATERIAL),
        )

    def add_rod(
        self, end1: int, end2: int, radius: float, length: float | None = None, **options: Unpack[StaticOptions]
    ) -> int:
        """Add one rod and return its number. The options are those of :meth:`add_rods`."""
        _check_single("add_rods", end1=(end1, ()), end2=(end2, ()), radius=(radius, ()), length=(length, ()))
        return first_of(self.add_rods(end1, end2, radius, length, **options))

    def add_capsules(
        self,
        end1: npt.ArrayLike,
        end2: npt.ArrayLike,
        radius: npt.ArrayLike,
        mass: npt.ArrayLike | None = 1.0,
        velocity: npt.ArrayLike | None = None,
        *,
        group: npt.ArrayLike = 0,
        material: Materials = None,
        name: str | None = None,
        colour: str | None = None,
        label: str | None = None,
        look: LookName | None = None,
    ) -> Capsules:
        """Add capsules: rigid bodies of two spheres, each with half the mass, and a rod of fixed length.

        Parameters
        ----------
        end1, end2 : array_like, shape (N, 3) or (3,)
            Centres of the spheres at the ends, in units.
        radius : array_like, shape (N,) or ()
            Radii in units, greater than 0.
        mass : array_like, shape (N,) or (), or None
            Masses of the whole capsules, greater than 0. None stands for the volumes times the densities of the materials.
        velocity : array_like, shape (N, 3) or (3,), optional
            Velocities of both ends, in units/s.
        group : array_like of int, shape (N,) or ()
            Collision groups from 0 to 65535.
        material : int, str or array_like of them, shape (N,) or (), optional
            Materials, by number or by name; none by default. See :meth:`add_material`.
        name, colour, label, look : str, optional
            Name, colour, label and look of the objects. See :meth:`set_tag`.

        Returns
        -------
        Capsules
            Numbers of the capsules, their spheres and their rods.

        Raises
        ------
        ValueError, TypeError
            As for :meth:`add_spheres`, and for ends that coincide.
        """
        tag = tag_of(name, colour, label, look)
        count, (capsules, spheres, rods) = self._add(
            _rockfall.add_capsules,
            end1=(end1, VECTOR),
            end2=(end2, VECTOR),
            radius=(radius, POSITIVE),
            mass=_mass(mass),
            velocity=(_ZERO if velocity is None else velocity, VECTOR),
            group=(group, GROUP),
            material=(self._material_numbers("material", material), MATERIAL),
        )
        self._put_tag("capsule", numbers_from(capsules, count), tag)
        return Capsules(numbers_from(capsules, count), numbers_from(spheres, 2 * count).reshape(count, 2), numbers_from(rods, count))

    def add_springs(
        self,
        a: npt.ArrayLike,
        b: npt.ArrayLike,
        stiffness: npt.ArrayLike,
        length: npt.ArrayLike | None = None,
        damping: npt.ArrayLike = 0.0,
        *,
        muscle: npt.ArrayLike | None = None,
        name: str | None = None,
        colour: str | None = None,
        label: str | None = None,
        look: LookName | None = None,
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
        muscle : array_like, shape (N, 3) or (3,), optional
            Amplitude A from -1 to 1, frequency F in 1/s and phase P in turns. They make the rest length l of a spring oscillate:
            l (1 + A sin(2 pi (F t + P))), where t is the time since the start of the simulation. A row of zeros is a spring
            without a muscle.
        name, colour, label, look : str, optional
            Name, colour, label and look of the objects. See :meth:`set_tag`.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the springs.

        Raises
        ------
        ValueError, TypeError, LookupError
            As for :meth:`add_rods`.
        """
        return self._add_kind(
            tag_of(name, colour, label, look),
            _rockfall.add_springs,
            a=(a, NUMBER),
            b=(b, NUMBER),
            stiffness=(stiffness, NOT_NEGATIVE),
            length=(-1.0, REAL) if length is None else (length, NOT_NEGATIVE),
            damping=(damping, NOT_NEGATIVE),
            muscle=(_ZERO if muscle is None else muscle, VECTOR),
        )

    def add_spring(
        self,
        a: int,
        b: int,
        stiffness: float,
        length: float | None = None,
        damping: float = 0.0,
        **options: Unpack[SpringOptions],
    ) -> int:
        """Add one spring and return its number. The options are those of :meth:`add_springs`."""
        _check_single("add_springs", a=(a, ()), b=(b, ()), stiffness=(stiffness, ()), length=(length, ()))
        return first_of(self.add_springs(a, b, stiffness, length, damping, **options))

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
        return self._add_kind(
            _NO_TAG,
            _rockfall.add_tethers,
            sphere=(sphere, NUMBER),
            point=(point, VECTOR),
            stiffness=(stiffness, NOT_NEGATIVE),
            length=(length, NOT_NEGATIVE),
            damping=(damping, NOT_NEGATIVE),
        )


def _mass(mass: npt.ArrayLike | None) -> tuple[Any, Kind]:
    """Masses. The native part takes 0 for the mass that follows from the density of the material."""
    return (0.0, REAL) if mass is None else (mass, POSITIVE)


def first_of(numbers: IntArray) -> int:
    return int(numbers[0])


def _check_single(several: str, **arguments: tuple[Any, tuple[int, ...]]) -> None:
    """Checks that every argument has one row."""
    for name, (value, columns) in arguments.items():
        rows = None if value is None else rows_of(name, value, columns)
        if rows is not None and rows != 1:
            raise ValueError(f"{name}: expected the values of one object, got {rows} rows; {several} takes several objects")
