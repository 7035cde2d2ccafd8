"""Converts arguments to arrays, with errors that name the argument."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from rockfall._device import DeviceArray

FloatArray = npt.NDArray[np.float32]
IntArray = npt.NDArray[np.int64]


def _host(name: str, value: Any) -> npt.NDArray[Any]:
    """Returns a value as an array in host memory. Takes lists, NumPy arrays and whatever speaks DLPack on the CPU."""
    if isinstance(value, DeviceArray):
        return value.numpy()
    device = getattr(value, "__dlpack_device__", None)
    try:
        if device is not None and not isinstance(value, np.ndarray):
            kind = int(device()[0])
            if kind != 1:
                raise TypeError(
                    f"{name}: expected an array in host memory, got one on a device (DLPack device type {kind}); "
                    "move it to the host first, for example with .cpu() or .get()"
                )
            if getattr(value, "requires_grad", False):
                raise TypeError(f"{name}: expected an array without a gradient; call .detach() first")
            return np.from_dlpack(value)
        return np.asarray(value)
    except TypeError as error:
        if str(error).startswith(f"{name}:"):
            raise
        raise TypeError(f"{name}: expected an array of numbers, got {type(value).__name__}: {error}") from None
    except (ValueError, BufferError, RuntimeError) as error:
        raise ValueError(f"{name}: expected an array of numbers with rows of the same length: {error}") from None


def _shape(columns: tuple[int, ...], count: int | None) -> str:
    inner = ", ".join(str(column) for column in columns)
    rows = "N" if count is None else str(count)
    whole = f"({rows}, {inner})" if columns else f"({rows},)"
    return f"{whole} or ({inner}{',' if len(columns) == 1 else ''})"


def rows_of(name: str, value: Any, columns: tuple[int, ...] = ()) -> int | None:
    """Returns the number of rows of an argument; None for a single row, which counts for all."""
    shape = tuple(value.shape) if hasattr(value, "shape") else _host(name, value).shape
    return None if len(shape) == len(columns) else int(shape[0]) if shape else None


def floats(
    name: str,
    value: Any,
    columns: tuple[int, ...] = (),
    count: int | None = None,
    *,
    positive: bool = False,
    not_negative: bool = False,
) -> FloatArray:
    """Returns a C-contiguous float32 array of shape ``(count, *columns)``. A single row is repeated."""
    array = _host(name, value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: expected real numbers, got dtype {array.dtype}")
    if array.ndim not in (len(columns), len(columns) + 1) or array.shape[array.ndim - len(columns) :] != columns:
        raise ValueError(f"{name}: expected shape {_shape(columns, count)}, got {array.shape}")
    if array.ndim == len(columns):
        array = np.broadcast_to(array, (1 if count is None else count, *columns))
    elif count is not None and len(array) != count:
        raise ValueError(f"{name}: expected shape {_shape(columns, count)}, got {array.shape}")
    with np.errstate(over="ignore"):
        single: FloatArray = np.ascontiguousarray(array, dtype=np.float32)
    bad = ~np.isfinite(single)
    what = "finite numbers (in the range of float32)"
    if not bad.any():
        if positive:
            bad, what = single <= 0, "numbers greater than 0 (in the range of float32)"
        elif not_negative:
            bad, what = single < 0, "numbers that are not negative"
    if bad.any():
        row = tuple(int(place) for place in np.argwhere(bad)[0])
        raise ValueError(f"{name}: expected {what}, got {array[row]} at index {list(row)}")
    return single


def vector(name: str, value: npt.ArrayLike, *, is_direction: bool = False) -> list[float]:
    """Returns three finite numbers, which are not all 0 for a direction."""
    array = np.asarray(value, dtype=np.float64)
    if array.shape != (3,):
        raise ValueError(f"{name}: expected shape (3,), got {array.shape}")
    numbers = [float(number) for number in array]
    if not np.isfinite(array).all() or (is_direction and not array.any()):
        raise ValueError(f"{name}: expected three finite numbers{', not all 0' if is_direction else ''}, got {numbers}")
    return numbers


def quaternions(name: str, value: Any, count: int | None = None) -> FloatArray:
    """Returns unit quaternions w, x, y, z of shape ``(count, 4)``."""
    array = floats(name, value, (4,), count)
    length = np.einsum("ij,ij->i", array, array, dtype=np.float64)
    wrong = np.abs(length - 1.0) > 1e-4
    if wrong.any():
        row = int(np.flatnonzero(wrong)[0])
        raise ValueError(f"{name}: expected unit quaternions w, x, y, z, got {array[row].tolist()} at row {row}")
    return array


def integers(name: str, value: Any, count: int | None = None, *, dtype: Any = np.int64) -> npt.NDArray[Any]:
    """Returns a contiguous array of integers of shape ``(count,)``. A single number is repeated."""
    array = _host(name, value)
    if array.dtype.kind not in "iu" and not (array.size == 0 and array.dtype.kind == "f"):
        raise TypeError(f"{name}: expected integers, got dtype {array.dtype}")
    if array.ndim > 1:
        raise ValueError(f"{name}: expected shape {_shape((), count)}, got {array.shape}")
    if array.ndim == 0:
        array = np.broadcast_to(array, (1 if count is None else count,))
    elif count is not None and len(array) != count:
        raise ValueError(f"{name}: expected shape {_shape((), count)}, got {array.shape}")
    info = np.iinfo(dtype)
    wrong = (array < 0) | (array > info.max)
    if wrong.any():
        row = int(np.flatnonzero(wrong)[0])
        raise ValueError(f"{name}: expected integers from 0 to {info.max}, got {array[row]} at index [{row}]")
    return np.ascontiguousarray(array, dtype=dtype)


def switches(name: str, value: Any, count: int) -> npt.NDArray[np.bool_]:
    """Returns a contiguous array of booleans of shape ``(count,)``. A single value is repeated."""
    array = _host(name, value)
    if array.dtype.kind != "b":
        raise TypeError(f"{name}: expected booleans, got dtype {array.dtype}")
    if array.ndim > 1 or (array.ndim == 1 and len(array) != count):
        raise ValueError(f"{name}: expected shape {_shape((), count)}, got {array.shape}")
    return np.ascontiguousarray(np.broadcast_to(array, (count,)))


def common(**arguments: tuple[Any, tuple[int, ...]]) -> int:
    """Returns the number of rows that the arguments have in common; 1 if all are single rows."""
    found: tuple[str, int] | None = None
    for name, (value, columns) in arguments.items():
        if value is None:
            continue
        rows = rows_of(name, value, columns)
        if rows is None:
            continue
        if found is not None and found[1] != rows:
            raise ValueError(f"{name}: expected {found[1]} rows as in {found[0]}, got {rows}")
        found = found or (name, rows)
    return 1 if found is None else found[1]


class Kind(NamedTuple):
    """What an argument with one row per object holds."""

    #: Shape of a row.
    columns: tuple[int, ...]
    #: Converts an argument, from its name, its value and the number of rows.
    convert: Callable[[str, Any, int], npt.NDArray[Any]]


REAL = Kind((), lambda name, value, count: floats(name, value, (), count))
POSITIVE = Kind((), lambda name, value, count: floats(name, value, (), count, positive=True))
NOT_NEGATIVE = Kind((), lambda name, value, count: floats(name, value, (), count, not_negative=True))
VECTOR = Kind((3,), lambda name, value, count: floats(name, value, (3,), count))
#: Three vectors in a row, which become three rows.
MATRIX = Kind((3, 3), lambda name, value, count: floats(name, value, (3, 3), count).reshape(3 * count, 3))
QUATERNION = Kind((4,), quaternions)
NUMBER = Kind((), integers)
GROUP = Kind((), lambda name, value, count: integers(name, value, count, dtype=np.uint16))
SWITCH = Kind((), switches)
#: Numbers of materials, -1 for none. :meth:`MaterialTable._material_numbers` has made them.
MATERIAL = Kind((), lambda name, value, count: np.ascontiguousarray(np.broadcast_to(value, (count,)), dtype=np.int64))


def columns(**arguments: tuple[Any, Kind]) -> tuple[int, list[npt.NDArray[Any]]]:
    """Returns the number of rows that the arguments have in common, and the arguments as arrays with this number of rows."""
    count = common(**{name: (value, kind.columns) for name, (value, kind) in arguments.items()})
    return count, [kind.convert(name, value, count) for name, (value, kind) in arguments.items()]


def whole(name: str, value: Any, *, least: int = 0) -> int:
    """Returns a whole number that is at least ``least``."""
    try:
        number = value.__index__()
    except AttributeError:
        raise TypeError(f"{name}: expected a whole number, got {type(value).__name__}") from None
    if number < least or number >= 2**63:
        raise ValueError(f"{name}: expected a whole number of at least {least}, got {number}")
    return int(number)


def box_between(low: Any, high: Any, hint: str = "") -> tuple[FloatArray, FloatArray]:
    """Returns a corner of shape (3,) and the edges of shape (3, 3) of a box along the axes, from the arguments `min` and `max`."""
    least, greatest = floats("min", low, (3,)), floats("max", high, (3,))
    if len(least) != 1 or len(greatest) != 1:
        raise ValueError(f"min, max: expected shape (3,) each, got {least.shape} and {greatest.shape}{hint}")
    with np.errstate(over="ignore"):
        size = greatest[0] - least[0]
    if not (size > 0).all():
        corners = f"min {least[0].tolist()} and max {greatest[0].tolist()}"
        raise ValueError(f"min, max: expected a greater number in every coordinate of max than of min, got {corners}")
    return least[0], np.diag(size)


def time_step(name: str, value: Any) -> float:
    """Returns a time step in s: positive and finite as float32."""
    if isinstance(value, (bool, str, bytes)):
        raise TypeError(f"{name}: expected a number of seconds, got {type(value).__name__}")
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected a number of seconds, got {type(value).__name__}") from None
    with np.errstate(over="ignore", under="ignore"):
        single = float(np.float32(number))
    if not (np.isfinite(single) and single > 0.0):
        raise ValueError(f"{name}: expected a finite number of seconds greater than 0, got {value}")
    return number
