"""Contacts, energies, diagnostics and ray casts."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import floats
from rockfall._fields import Fields
from rockfall._reports import BODY_KINDS, DIAGNOSTICS, LINK_KINDS, RAY_HIT, TENSION, Energy, Overlap
from rockfall._states import States
from rockfall._tables import contact_table
from rockfall.typing import KernelName


class Observed(States):
    """What can be found out about a state. A base of :class:`Simulation`."""

    @property
    def energy(self) -> Energy:
        """Energies and momenta of the current state."""
        self._commit()
        found = _rockfall.energy(self._native)
        found["momentum"] = tuple(found["momentum"])
        found["angular_momentum"] = tuple(found["angular_momentum"])
        return Energy(**found)

    @property
    def contacts(self) -> np.ndarray:
        """All contacts of the current state, as a structured array with one row per contact.

        Fields: ``a_kind``, ``a``, ``b_kind`` and ``b`` (kind and row of both bodies, in order of addition), ``point`` (3) and
        ``overlap`` in units, ``normal`` (3) from A to B, ``force`` (3) on B in mass units/s² and ``impulse`` (3) on B in mass
        units/s, of which one is zero. ``normal_force`` is the part of the force along the normal, positive where it pushes the bodies
        apart, and ``tangential_force`` (3) the rest. With a contact law that keeps springs, ``slip`` is 1 at Coulomb's limit and 0
        below it, ``displacement`` (3) is that of the tangential spring in units, and ``moment`` (3) the torque of the springs against
        rolling and twisting on B in mass units²/s²; otherwise they are -1, 0 and 0. :func:`rockfall.to_pandas` makes a data frame
        of them.
        """
        self._commit()
        return contact_table(*_rockfall.contacts(self._native))

    @property
    def tensions(self) -> np.ndarray:
        """The lengths and tensions of all springs, then of all tethers, as a structured array with one row for each.

        Fields: ``kind`` (spring, muscle or tether), ``index`` (row among springs with muscles, or among tethers), ``a`` and ``b``
        (rows of the spheres, in order of addition; ``b`` is -1 for a tether), ``length`` (distance of the ends, in units) and
        ``tension`` (in mass units/s², with the damping, negative where the spring pushes its ends apart). Rods are not among them:
        the model keeps their lengths without a force. :func:`rockfall.to_pandas` makes a data frame of them.
        """
        self._commit()
        whole, real = _rockfall.tensions(self._native)
        found = np.empty(len(whole), dtype=TENSION)
        found["kind"] = LINK_KINDS[whole[:, 0]]
        found["index"], found["a"], found["b"] = whole[:, 1], whole[:, 2], whole[:, 3]
        found["length"], found["tension"] = real[:, 0], real[:, 1]
        return found

    def fields(self, width: float | None = None, *, spacing: float | None = None, kernel: KernelName = "gaussian") -> Fields:
        """Coarse-grained density, velocity, stress and temperature of the current state on a grid.

        Forces of contacts count; impulses of collisions, springs and external forces do not. Fixed bodies, boxes and polygons are
        walls. The formulas are those of Goldhirsch, Granular Matter 12 (2010), 239-252.

        Parameters
        ----------
        width : float, optional
            Width of the smoothing function, in units. Default: the diameter of the largest moving sphere.
        spacing : float, optional
            Distance between points of the grid, in units. Default: the width.
        kernel : {"gaussian", "heaviside"}
            A Gaussian that ends at 3 widths, or the same weight up to 1 width.

        Raises
        ------
        ValueError
            For a value that is not allowed, without moving bodies, and for a grid of more than 10^8 points.
        """
        for name, value in (("width", width), ("spacing", spacing)):
            if value is not None and (isinstance(value, (bool, str, bytes)) or not isinstance(value, (int, float, np.number))):
                raise TypeError(f"{name}: expected a number, got {type(value).__name__}")
        if not isinstance(kernel, str):
            raise TypeError(f"kernel: expected a str, got {type(kernel).__name__}")
        self._commit()
        return Fields(**_rockfall.fields(self._native, width, spacing, kernel))

    @property
    def diagnostics(self) -> np.ndarray:
        """Number of contacts, net force (3) in mass units/s² and deepest overlap in units of every sphere.

        A structured array of shape (N,) with the fields ``contacts``, ``net_force`` and ``deepest_overlap``.
        """
        self._commit()
        contacts, forces, overlaps = _rockfall.diagnostics(self._native)
        found = np.empty(len(contacts), dtype=DIAGNOSTICS)
        found["contacts"], found["net_force"], found["deepest_overlap"] = contacts, forces, overlaps
        return found

    def _overlap(self, resting: bool) -> Overlap:
        self._commit()
        units, radii, bodies = _rockfall.max_overlap(self._native, resting)
        return Overlap(units, radii, None if bodies is None else (bodies[0], bodies[1]))

    @property
    def max_overlap(self) -> Overlap:
        """The deepest overlap of the current state, in units and in radii, and the two bodies."""
        return self._overlap(False)

    @property
    def resting_overlap(self) -> Overlap:
        """The deepest overlap between bodies at rest, in units and in radii, and the two bodies."""
        return self._overlap(True)

    def cast_rays(self, origin: npt.ArrayLike, direction: npt.ArrayLike) -> np.ndarray:
        """The first body that each ray enters.

        Parameters
        ----------
        origin, direction : array_like, shape (M, 3) or (3,)
            Origins in units, and directions of any length except 0.

        Returns
        -------
        ndarray, structured, shape (M,)
            Fields ``kind`` and ``index`` (row in order of addition), ``distance`` and ``point`` (3) in units, and ``normal`` (3).
            A ray that enters nothing has kind "", index -1, an infinite distance, and NaN.
        """
        self._commit()
        count = max(len(floats("origin", origin, (3,))), len(floats("direction", direction, (3,))))
        origins, directions = floats("origin", origin, (3,), count), floats("direction", direction, (3,), count)
        zero = ~directions.any(axis=1)
        if zero.any():
            row = int(np.flatnonzero(zero)[0])
            raise ValueError(f"direction: expected vectors that are not zero, got [0, 0, 0] at row {row}")
        whole_numbers, real = _rockfall.cast_rays(self._native, origins, directions)
        found = np.empty(count, dtype=RAY_HIT)
        found["kind"], found["index"] = BODY_KINDS[whole_numbers[:, 0]], whole_numbers[:, 1]
        found["distance"], found["point"], found["normal"] = real[:, 0], real[:, 1:4], real[:, 4:]
        return found
