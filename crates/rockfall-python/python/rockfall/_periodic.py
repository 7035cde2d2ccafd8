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

    @property
    def shear(self) -> dict[str, Any] | None:
        """The shear of a periodic scene: a dict with its axes ``gradient`` and ``flow``, its ``rate`` (1/s), and the present
        ``displacement`` of the box above (periods along ``flow``, from -1/2 to 1/2). ``None`` without one.
        :meth:`Scene.set_shear` sets it."""
        found = _rockfall.shear(self._native)
        if found is None:
            return None
        gradient, flow, rate, displacement = found
        return {"gradient": AXES[gradient], "flow": AXES[flow], "rate": rate, "displacement": displacement}

    def in_box(self, positions: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Positions, of shape (N, 3) and in units, of the images that are in the box of a periodic scene. Positions of a simulation are where
        bodies have got to, with all periods that they have passed. In other scenes the positions stay."""
        found = np.array(floats("positions", positions, (3,)), dtype=np.float64)
        bounds, shear = self.periodic, self.shear
        if shear is not None:
            low, high = bounds[shear["gradient"]]
            boxes = np.floor((found[:, AXES.index(shear["gradient"])] - low) / (high - low))
            low, high = bounds[shear["flow"]]
            found[:, AXES.index(shear["flow"])] -= boxes * shear["displacement"] * (high - low)
        for place, axis in enumerate(AXES):
            if axis in bounds:
                low, high = bounds[axis]
                # The remainder of a tiny negative number may be rounded to the period.
                around = np.mod(found[:, place] - low, high - low)
                found[:, place] = low + np.where(around == high - low, 0.0, around)
        return found
