"""Bodies that stay where they are, or follow a motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import QUATERNION, VECTOR, IntArray, columns
from rockfall._bodies import numbers_from
from rockfall._names import tag_of
from rockfall._rigid import Rigid, shape_number
from rockfall._smooth import SmoothWalls
from rockfall.typing import LookName

_UPRIGHT = (1.0, 0.0, 0.0, 0.0)


class StaticBody(NamedTuple):
    """Numbers of the objects that :meth:`Objects.add_static_body` added."""

    #: Numbers of the fixed spheres, one for each sphere of the shape; none with a motion.
    spheres: IntArray
    #: Numbers of the rods, one for each rod of the shape; none with a motion.
    rods: IntArray
    #: Numbers of the boxes, one for each box of the shape.
    boxes: IntArray
    #: Numbers of the smooth walls: with a motion one for each sphere of the shape, then one for each rod.
    polygons: IntArray


class StaticBodies(Rigid, SmoothWalls):
    """Adds bodies that do not move by forces. A base of :class:`Objects`."""

    def add_static_body(
        self,
        shape: int,
        position: npt.ArrayLike,
        orientation: npt.ArrayLike | None = None,
        *,
        motion: str | None = None,
        name: str | None = None,
        colour: str | None = None,
        label: str | None = None,
        look: LookName | None = None,
    ) -> StaticBody:
        """Add the parts of a shape at a place where they stay, or from which they follow a motion.

        Without a motion, spheres become fixed spheres, with rods between them. Parts that follow a motion are walls: balls and
        cylinders (:meth:`add_ball`, :meth:`add_cylinder`). Boxes are boxes in both cases, with sharp edges.

        Parameters
        ----------
        shape : int
            Number of the shape, as :meth:`add_shape` returned it.
        position : array_like, shape (3,)
            Where the origin of the shape comes to lie, in units.
        orientation : array_like, shape (4,), optional
            Unit quaternion w, x, y, z, which turns coordinates of the shape into those of the world.
        motion : str, optional
            Name of the motion that the parts follow. See :meth:`add_motion`.
        name, colour, label, look : str, optional
            Name, colour, label and look of parts whose shape does not give them. See :meth:`set_tag`.

        Returns
        -------
        StaticBody
            Numbers of the spheres, rods, boxes and smooth walls.

        Raises
        ------
        ValueError, TypeError
            For numbers of another shape or that are not finite, and an orientation that is not a unit quaternion.
        LookupError
            For a shape or a motion that does not exist.
        """
        tag = tag_of(name, colour, label, look)
        self._check_motion(motion)
        count, (positions, orientations) = columns(
            position=(position, VECTOR), orientation=(_UPRIGHT if orientation is None else orientation, QUATERNION)
        )
        if count != 1:
            raise ValueError(f"position: expected shape (3,), got {count} rows")
        self._edited()
        firsts, counts = _rockfall.add_static_body(
            self._native, shape_number(shape), positions, orientations, motion, tag
        )
        return StaticBody(*(numbers_from(first, number) for first, number in zip(firsts, counts, strict=True)))
