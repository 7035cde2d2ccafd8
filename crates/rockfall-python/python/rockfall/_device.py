"""Arrays on the device."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float32]

#: Number of CUDA among the device types of DLPack.
_CUDA = 2


class DeviceArray(np.lib.mixins.NDArrayOperatorsMixin):
    """An array of float32 on an NVIDIA card, as attributes such as :attr:`Simulation.positions` give it on the GPU backend.

    PyTorch, CuPy, JAX and others take it without a copy through the host: ``torch.from_dlpack(sim.positions)``. It holds the
    state in which it was read, and does not change with the simulation.

    Everything else works as with a NumPy array of the same contents: the first use of its elements copies it to the host.
    """

    #: Precedes NumPy arrays and scalars in operators.
    __array_priority__ = 10.0

    def __init__(self, shared: Any) -> None:
        self._shared = shared
        self._host: FloatArray | None = None
        #: Somebody may have written to the elements on the host.
        self._touched = False
        self._frozen = False

    def numpy(self) -> FloatArray:
        """The elements in host memory, copied at the first use. Writing to this array does not change the simulation."""
        copied = self._on_host()
        view = copied.view()
        view.flags.writeable = False
        return view

    def _on_host(self) -> FloatArray:
        host = self._host
        if host is None:
            self._host = host = self._shared.host()
        return host

    def _changed(self) -> bool:
        """Whether the elements on the host differ from those on the device."""
        return self._touched and self._on_host().tobytes() != self._shared.host().tobytes()

    def _freeze(self) -> None:
        """Makes the array a snapshot."""
        self._frozen = True
        if self._host is not None:
            self._host.flags.writeable = False

    # DLPack

    def __dlpack_device__(self) -> tuple[int, int]:
        device: tuple[int, int] = (1, 0) if self._changed() else self._shared.__dlpack_device__()
        return device

    def __dlpack__(
        self,
        *,
        stream: Any = None,
        max_version: tuple[int, int] | None = None,
        dl_device: tuple[int, int] | None = None,
        copy: bool | None = None,
    ) -> Any:
        """Export by DLPack. What the consumer writes to the memory does not change the simulation: assign it."""
        changed = self._changed()
        if changed or (dl_device is not None and tuple(dl_device)[0] == 1):
            if copy is False and not changed:
                raise BufferError("the array is on the GPU, so it cannot be used on the host without a copy")
            return self._on_host().copy().__dlpack__()
        return self._shared.__dlpack__(stream=stream, max_version=max_version, dl_device=dl_device, copy=copy)

    # NumPy

    @property
    def shape(self) -> tuple[int, int]:
        """Number of rows and of columns."""
        shape: tuple[int, int] = self._shared.shape
        return shape

    @property
    def dtype(self) -> np.dtype[np.float32]:
        """float32."""
        return np.dtype(np.float32)

    @property
    def ndim(self) -> int:
        """2."""
        return 2

    @property
    def size(self) -> int:
        """Number of elements."""
        return self.shape[0] * self.shape[1]

    def __len__(self) -> int:
        return self.shape[0]

    def __iter__(self) -> Iterator[Any]:
        return iter(self._on_host())

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        if copy is False and self._host is None:
            raise ValueError("the array is on the GPU, so it cannot be used on the host without a copy")
        host = self._on_host()
        if dtype is not None and np.dtype(dtype) != host.dtype:
            return host.astype(dtype)
        return host.copy() if copy is not False else host

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, out: Any = None, **options: Any) -> Any:
        if out is not None:
            if any(isinstance(target, DeviceArray) and target is not self for target in out):
                return NotImplemented
            options["out"] = tuple(target._writable() if isinstance(target, DeviceArray) else target for target in out)
        found = getattr(ufunc, method)(*(_plain(value) for value in inputs), **options)
        return self if out is not None and any(target is self for target in out) else found

    def __array_function__(self, function: Any, types: Any, arguments: Any, options: Any) -> Any:
        return function(*_plain(arguments), **{name: _plain(value) for name, value in options.items()})

    def _writable(self) -> FloatArray:
        if self._frozen:
            raise ValueError("assignment destination is read-only: the simulation has gone on; read the attribute again")
        self._touched = True
        return self._on_host()

    def __getitem__(self, key: Any) -> Any:
        # A part of an array can be written to, as in `array[:, 1] += 1`.
        return self.numpy()[_plain(key)] if self._frozen else self._writable()[_plain(key)]

    def __setitem__(self, key: Any, value: Any) -> None:
        self._writable()[_plain(key)] = _plain(value)

    def __getattr__(self, name: str) -> Any:
        # What is not defined here is that of the array on the host: mean, max, copy, tolist and others.
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self.numpy(), name)

    def __repr__(self) -> str:
        return f"rockfall.DeviceArray({self._on_host()!r})"


def _plain(value: Any) -> Any:
    """The same with arrays on the host in place of those on the device."""
    if isinstance(value, DeviceArray):
        return value._on_host()
    if isinstance(value, (tuple, list)):
        return type(value)(_plain(part) for part in value)
    return value


def is_on_cuda(value: Any) -> bool:
    """Whether a value is an array on an NVIDIA card."""
    device = getattr(value, "__dlpack_device__", None)
    return device is not None and not isinstance(value, np.ndarray) and int(device()[0]) == _CUDA
