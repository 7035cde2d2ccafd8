"""Structured arrays, and what they become in pandas."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
import numpy.typing as npt

from rockfall._arrays import FloatArray, IntArray
from rockfall._reports import BODY_KINDS, CONTACT

#: Names of the columns of a field with several numbers, by their count.
_AXES = {3: "xyz", 4: "wxyz"}


def needed(name: str, by: str) -> Any:
    """A module that the package does not need otherwise."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"{by} needs {name}: pip install {name}") from error


def contact_table(whole: IntArray, real: FloatArray) -> npt.NDArray[Any]:
    """The contacts from the two tables of the native module."""
    found = np.zeros(len(whole), dtype=CONTACT)
    for place, body in enumerate(("a", "b")):
        found[f"{body}_kind"] = BODY_KINDS[whole[:, 2 * place]]
        found[body] = whole[:, 2 * place + 1]
    found["point"], found["normal"], found["overlap"] = real[:, :3], real[:, 3:6], real[:, 9]
    found["normal_force"], found["tangential_force"] = real[:, 10], real[:, 11:14]
    found["slip"], found["displacement"], found["moment"] = whole[:, 5], real[:, 14:17], real[:, 17:20]
    is_impulse = whole[:, 4:5] != 0
    found["impulse"] = np.where(is_impulse, real[:, 6:9], 0)
    found["force"] = np.where(is_impulse, 0, real[:, 6:9])
    return found


def to_pandas(table: npt.NDArray[Any]) -> Any:
    """A ``pandas.DataFrame`` with the rows of a structured array. Needs pandas.

    A field of 3 numbers, such as ``point``, becomes the columns ``point_x``, ``point_y`` and ``point_z``.

    Parameters
    ----------
    table : ndarray, structured, shape (K,)
        For example :attr:`Simulation.contacts`, :attr:`Simulation.diagnostics`, :meth:`Objects.table`, :meth:`Worlds.report` or
        :attr:`Worlds.energies`.

    Raises
    ------
    TypeError
        For another array.
    ImportError
        If pandas is not installed.

    Examples
    --------
    >>> rf.to_pandas(sim.contacts).groupby("a_kind")["overlap"].max()  # doctest: +SKIP
    """
    names = getattr(getattr(table, "dtype", None), "names", None)
    if names is None or table.ndim != 1:
        raise TypeError(f"table: expected a structured array with one row per object, got {type(table).__name__}")
    pandas = needed("pandas", "to_pandas")
    columns: dict[str, Any] = {}
    for name in names:
        field = table[name]
        if field.ndim == 1:
            # pandas keeps text as objects of Python.
            columns[name] = field.astype(object) if field.dtype.kind == "U" else field
            continue
        width = field.shape[1]
        for place in range(width):
            columns[f"{name}_{_AXES[width][place] if width in _AXES else place}"] = field[:, place]
    return pandas.DataFrame(columns)
