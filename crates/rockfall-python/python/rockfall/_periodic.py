"""Periodic boundaries."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import floats
from rockfall._attributes import Strict

AXES = ("x", "y", "z")


class Periodic(Strict):
    """What scenes and simulations know of periodic boundaries."""

    _native: Any

    @property
    def periodic(self) -> dict[str, tuple[float, float]]:
        """Bounds of the box along each periodic axis, in units: a dict such as ``{"x": (-1.0, 1.0)}``. :meth:`Scene.set_periodic`
        sets them."""
        bounds = _rockfall.periodic(self._native)
        return {axis: (pair[0], pair[1]) for axis, pair in zip(AXES, bounds, strict=True) if pair is not None}

    def in_box(self, positions: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Positions, of shape (N, 3), of the images that are in the box of a periodic scene. Positions of a simulation are where
        bodies have got to, with all periods that they have passed. In other scenes the positions stay."""
        found = np.array(floats("positions", positions, (3,)), dtype=np.float64)
        for place, axis in enumerate(AXES):
            if axis in self.periodic:
                low, high = self.periodic[axis]
                # The remainder of a tiny negative number may be rounded to the period.
                around = np.mod(found[:, place] - low, high - low)
                found[:, place] = low + np.where(around == high - low, 0.0, around)
        return found
