"""Events: contacts that begin and end, and what enters and leaves sensors."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._observe import Observed
from rockfall._reports import CONTACT_EVENT, PARTY_KINDS, sensor_event

#: What happens to contacts and at sensors.
_CONTACTS, _SENSORS = np.array(["begin", "end"]), np.array(["enter", "leave"])


class Watched(Observed):
    """Events of a simulation. A base of :class:`Simulation`."""

    def watch_contacts(self, on: bool = True) -> None:
        """Begin or stop to note where contacts begin and end, for :meth:`contact_events`.

        It changes no result, but the contacts are found after every step. What touches in the present state has begun already. A
        simulation that is copied or resumed does not watch: call it again there.
        """
        self._commit()
        _rockfall.watch_contacts(self._native, bool(on))

    def contact_events(self) -> npt.NDArray[Any]:
        """The contacts that began and ended since the last call, as a structured array with one row per event.

        Fields: ``step`` and ``time`` in s, after which it was seen, ``change`` (begin or end), ``a_kind``, ``a``, ``b_kind`` and ``b``
        (kind and row of both objects: sphere, rod, capsule, body, box or polygon), ``point`` (3) in units, ``normal`` (3) from A to
        B, and ``force`` (3) on B in mass units/s² in the state in which it began, with the impulse of a collision divided by the time
        step; 0 at the end. A rigid body or a capsule is one object with all its parts. Rows are in the order of steps, in each first
        those that end. :func:`rockfall.to_pandas` makes a data frame of them.

        Raises
        ------
        ValueError
            Unless contacts are watched (:meth:`watch_contacts`).
        """
        whole, times, real = _rockfall.contact_events(self._native)
        found = np.zeros(len(whole), dtype=CONTACT_EVENT)
        found["step"], found["time"], found["change"] = whole[:, 0], times, _CONTACTS[whole[:, 1]]
        for place, party in enumerate(("a", "b")):
            found[f"{party}_kind"] = PARTY_KINDS[whole[:, 2 + 2 * place]]
            found[party] = whole[:, 3 + 2 * place]
        found["point"], found["normal"], found["force"] = real[:, :3], real[:, 3:6], real[:, 6:9]
        return found

    def watch_sensors(self, on: bool = True) -> None:
        """Begin or stop to note what enters and leaves sensors, for :meth:`sensor_events`. See :meth:`add_sensor`.

        It changes no result, but the state is read back after every step. What is inside in the present state has entered already. A
        simulation that is copied or resumed does not watch: call it again there.
        """
        self._commit()
        _rockfall.watch_sensors(self._native, bool(on))

    def sensor_events(self) -> npt.NDArray[Any]:
        """What entered and left sensors since the last call, as a structured array with one row per event.

        Fields: ``step`` and ``time`` in s, after which it was seen, ``change`` (enter or leave), ``sensor`` (its name), ``kind`` and
        ``index`` (kind and row of the sphere, capsule or body), and ``centre`` (3) in units.

        Raises
        ------
        ValueError
            Unless sensors are watched (:meth:`watch_sensors`).
        """
        whole, real, names = _rockfall.sensor_events(self._native)
        found = np.zeros(len(whole), dtype=sensor_event(names))
        found["step"], found["time"], found["change"] = whole[:, 0], real[:, 0], _SENSORS[whole[:, 1]]
        found["sensor"] = np.array(names)[whole[:, 2]] if len(whole) else ""
        found["kind"], found["index"], found["centre"] = PARTY_KINDS[whole[:, 3]], whole[:, 4], real[:, 1:]
        return found
