"""Smooth walls: planes, cylinders, cones and balls."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import vector
from rockfall._materials import Materials
from rockfall._motions import Walls
from rockfall._names import tag_of
from rockfall.typing import LookName

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rockfall._options import BoxOptions


def _length(name: str, value: float) -> float:
    if not (np.isfinite(value) and value > 0):
        raise ValueError(f"{name}: expected a finite number greater than 0, got {value}")
    return float(value)


class SmoothWalls(Walls):
    """Adds smooth walls. A base of :class:`Objects`."""

    def add_plane(self, at: npt.ArrayLike, normal: npt.ArrayLike, **options: Unpack[BoxOptions]) -> int:
        """Add a plane without ends. Bodies touch it on the side of its normal.

        Parameters
        ----------
        at : array_like, shape (3,)
            A point of the plane, in units.
        normal : array_like, shape (3,)
            Its normal, of any length but 0.
        **options
            ``group``, ``material``, ``motion``, ``surface_velocity``, ``name``, ``colour``, ``label`` and ``look``, as for
            :meth:`add_polygons`.

        Returns
        -------
        int
            Number of the wall, which is a polygon.

        Raises
        ------
        ValueError
            For numbers that are not finite, and a normal that is 0.
        """
        place = vector("at", at), vector("normal", normal, is_direction=True)
        return self._add_smooth("plane", place, ((1.0, 1.0), 1.0, False), **options)

    def add_cylinder(
        self,
        at: npt.ArrayLike,
        axis: npt.ArrayLike,
        radius: float,
        length: float,
        *,
        inside: bool = False,
        **options: Unpack[BoxOptions],
    ) -> int:
        """Add a cylinder without caps. Bodies touch it from outside, or only from inside.

        Parameters
        ----------
        at : array_like, shape (3,)
            Centre of the end at which the axis begins, in units.
        axis : array_like, shape (3,)
            Direction of the axis, of any length but 0.
        radius, length : float
            Radius and length, in units.
        inside : bool
            Whether it is touched from inside, like a drum or a pipe.
        **options
            As for :meth:`add_plane`.

        Returns
        -------
        int
            Number of the wall, which is a polygon.

        Raises
        ------
        ValueError
            For numbers that are not finite, an axis that is 0, and a radius or length that is not positive.
        """
        radius = _length("radius", radius)
        return self.add_cone(at, axis, (radius, radius), length, inside=inside, **options)

    def add_cone(
        self,
        at: npt.ArrayLike,
        axis: npt.ArrayLike,
        radii: tuple[float, float],
        length: float,
        *,
        inside: bool = False,
        **options: Unpack[BoxOptions],
    ) -> int:
        """Add a cone without caps. Bodies touch it from outside, or only from inside.

        Parameters
        ----------
        at : array_like, shape (3,)
            Centre of the end at which the axis begins, in units.
        axis : array_like, shape (3,)
            Direction of the axis, of any length but 0.
        radii : tuple of two floats
            Radii at the beginning and at the end of the axis, in units. One of them may be 0.
        length : float
            Length of the axis, in units.
        inside : bool
            Whether it is touched from inside, like a funnel.
        **options
            As for :meth:`add_plane`.

        Returns
        -------
        int
            Number of the wall, which is a polygon.

        Raises
        ------
        ValueError
            As for :meth:`add_cylinder`, and for two radii that are 0.
        """
        both = np.asarray(radii, dtype=np.float64)
        if both.shape != (2,) or not np.isfinite(both).all() or both.min() < 0 or both.max() == 0:
            raise ValueError(f"radii: expected two finite numbers, not negative and not both 0, got {radii}")
        place = vector("at", at), vector("axis", axis, is_direction=True)
        size = (float(both[0]), float(both[1])), _length("length", length), bool(inside)
        return self._add_smooth("cone", place, size, **options)

    def add_ball(
        self, at: npt.ArrayLike, radius: float, *, inside: bool = False, **options: Unpack[BoxOptions]
    ) -> int:
        """Add a ball as a wall. Bodies touch it from outside, or only from inside.

        Parameters
        ----------
        at : array_like, shape (3,)
            Its centre, in units.
        radius : float
            Its radius, in units.
        inside : bool
            Whether it is touched from inside, like a bowl.
        **options
            As for :meth:`add_plane`.

        Returns
        -------
        int
            Number of the wall, which is a polygon.

        Raises
        ------
        ValueError
            For numbers that are not finite, and a radius that is not positive.
        """
        place = vector("at", at), [0.0, 0.0, 1.0]
        radius = _length("radius", radius)
        return self._add_smooth("ball", place, ((radius, radius), 1.0, bool(inside)), **options)

    def _add_smooth(
        self,
        kind: str,
        place: tuple[list[float], list[float]],
        size: tuple[tuple[float, float], float, bool],
        *,
        group: npt.ArrayLike = 0,
        material: Materials = None,
        motion: str | None = None,
        surface_velocity: npt.ArrayLike | None = None,
        name: str | None = None,
        colour: str | None = None,
        label: str | None = None,
        look: LookName | None = None,
    ) -> int:
        tag = tag_of(name, colour, label, look)
        self._check_motion(motion)
        of_material = int(self._material_numbers("material", material))
        self._edited()
        number = _rockfall.add_smooth(self._native, kind, *place, size, int(np.asarray(group)), of_material)
        numbers = np.array([number], dtype=np.int64)
        self._put_tag("polygon", numbers, tag)
        self._following("polygon", numbers, motion, surface_velocity)
        return number
