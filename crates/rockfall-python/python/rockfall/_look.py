"""What pictures show: sizes, cameras and colours."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from rockfall import _rockfall
from rockfall._arrays import FloatArray, floats, whole
from rockfall._warnings import warn

#: Largest number of pixels of a side, whatever the device supports.
_MOST_PIXELS = 1 << 16


def look(
    size: Any,
    colour_by: Any = None,
    range: Any = None,
    camera: Any = None,
    look_at: Any = None,
    plain: Any = False,
    *,
    view: Any = None,
    up: Any = "auto",
    title: Any = None,
    clock: Any = False,
    scale_bar: Any = False,
    label: Any = False,
    arrows: Any = None,
    trails: Any = 0.0,
    plot: Any = (),
) -> dict[str, Any]:
    """Checks the arguments of pictures and films, and returns them as the native module takes them."""
    if np.shape(size) != (2,):
        raise ValueError(f"size: expected width and height, got {size!r}")
    width, height = (whole("size", side, least=1) for side in size)
    if max(width, height) > _MOST_PIXELS:
        raise ValueError(f"size: expected sides up to {_MOST_PIXELS} pixels, got {width}x{height}")
    if view is not None and camera is not None:
        raise ValueError("view, camera: expected only one of them")
    length, trailed = _rockfall.trails_of(trails) if isinstance(trails, str) else (number("trails", trails), [])
    if length < 0:
        raise ValueError(f"trails: expected a number of at least 0, got {length:g}")
    ends = None
    if range is not None:
        if np.shape(range) != (2,) or not range[0] < range[1]:
            raise ValueError(f"range: expected two numbers, the first less than the second, got {range!r}")
        ends = [float(end) for end in floats("range", range, ())]
    return {
        "size": (width, height),
        "colour_by": colour_by,
        "range": ends,
        "camera": None if camera is None else _one_row("camera", camera).tolist(),
        "look_at": None if look_at is None else _one_row("look_at", look_at).tolist(),
        "view": view,
        "up": up,
        "plain": bool(plain),
        "title": title,
        "clock": bool(clock),
        "scale_bar": bool(scale_bar),
        "label": bool(label),
        "arrows": arrows,
        "trails": length,
        "trails_of": trailed,
        "plot": _texts("plot", plot),
    }


def warn_of_letters(simulation: Any, shown: dict[str, Any]) -> None:
    """Warns, where the package was called, of letters of the title and the labels that the font of pictures lacks."""
    text = _rockfall.warning_of_letters(simulation, shown)
    if text is not None:
        warn(text)


def _texts(name: str, value: Any) -> list[str]:
    texts = [value] if isinstance(value, str) else value
    if not isinstance(texts, Iterable) or not all(isinstance(text, str) for text in texts):
        raise TypeError(f"{name}: expected a text or a list of texts, got {value!r}")
    return list(texts)


def number(name: str, value: Any, *, positive: bool = False) -> float:
    """Returns a finite number."""
    rows = floats(name, value, (), positive=positive)
    if np.ndim(value) != 0:
        raise ValueError(f"{name}: expected a number, got shape {np.shape(value)}")
    return float(rows[0])


def _one_row(name: str, value: Any) -> FloatArray:
    rows = floats(name, value, (3,))
    if len(rows) != 1:
        raise ValueError(f"{name}: expected shape (3,), got {rows.shape}")
    row: FloatArray = rows[0]
    return row
