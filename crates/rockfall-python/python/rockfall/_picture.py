"""Pictures."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import PIL.Image

_JPEG_QUALITY = 92


class Picture:
    """A picture of a simulation. It shows itself in a notebook."""

    __slots__ = ("_native", "_png")

    def __init__(self, native: Any) -> None:
        self._native = native
        self._png: bytes | None = None

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, in pixels."""
        width, height = self._native.size()
        return width, height

    def numpy(self) -> npt.NDArray[np.uint8]:
        """The pixels as an array of shape (height, width, 3): red, green, blue in sRGB."""
        pixels: npt.NDArray[np.uint8] = self._native.pixels()
        return pixels

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> npt.NDArray[Any]:
        if copy is False:
            raise ValueError("copy: the pixels are always copied")
        return self.numpy() if dtype is None else self.numpy().astype(dtype)

    def pil(self) -> PIL.Image.Image:
        """The picture as an image of Pillow. Raises ImportError if Pillow is not installed."""
        import PIL.Image

        return PIL.Image.fromarray(self.numpy())

    def png(self) -> bytes:
        """The bytes of a PNG file."""
        png = self._png
        if png is None:
            self._png = png = bytes(self._native.png())
        return png

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the picture to a file whose name ends in .png, .jpg or .jpeg.

        Raises
        ------
        ValueError
            For another extension.
        OSError
            If the file cannot be written.
        """
        name = os.fspath(path)
        extension = os.path.splitext(name)[1].lower()
        if extension == ".png":
            data = self.png()
        elif extension in (".jpg", ".jpeg"):
            data = self._native.jpeg(_JPEG_QUALITY)
        else:
            raise ValueError(f"path: expected a name that ends in .png, .jpg or .jpeg, got {name!r}")
        with open(name, "wb") as file:
            file.write(data)

    def _repr_png_(self) -> bytes:
        return self.png()

    def __repr__(self) -> str:
        width, height = self.size
        return f"<rockfall.Picture {width}x{height}>"
