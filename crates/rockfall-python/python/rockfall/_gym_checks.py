"""Checks of options of environments."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from rockfall._arrays import FloatArray, floats


def amount(name: str, value: Any, most: float | None = None) -> float:
    number = float(floats(name, value, (), 1, not_negative=True)[0])
    if most is not None and number > most:
        raise ValueError(f"{name}: expected a number from 0 to {most:g}, got {value}")
    return float(value)


def bounds_of(given: Any, width: int) -> tuple[FloatArray, FloatArray]:
    """The least and the greatest value of each number of an observation."""
    if isinstance(given, tuple) and len(given) == 2:
        low, high = (np.array(np.broadcast_to(np.asarray(side, np.float32), (width,))) for side in given)
    else:
        high = np.full(width, amount("bounds", given), np.float32)
        low = -high
    if not (low < high).all():
        raise ValueError("bounds: expected values that are greater than the least ones")
    return low, high


def reset_mask_of(value: Any, count: int) -> npt.NDArray[np.bool_]:
    if not isinstance(value, np.ndarray) or value.dtype != np.bool_ or value.shape != (count,):
        raise ValueError(f"options: expected a bool array of shape ({count},) as reset_mask, got {value!r}")
    if not value.any():
        raise ValueError("options: expected a reset_mask with at least one True")
    return value.copy()
